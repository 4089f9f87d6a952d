# The paper, Appendix "Gallery of Scenarios", "Four Cars, in Poor Driving Conditions", in the syntax of Section 4.
model scenic.simulators.gta.model

param weather = 'RAIN'
param time = 0 * 60   # midnight

wiggle = Range(-10 deg, 10 deg)
ego = EgoCar with roadDeviation wiggle
Car visible, with roadDeviation resample(wiggle)
Car visible, with roadDeviation resample(wiggle)
Car visible, with roadDeviation resample(wiggle)
Car visible, with roadDeviation resample(wiggle)
