# The paper, Appendix "Gallery of Scenarios", "A Single Car", in the syntax of Section 4.
model scenic.simulators.gta.model

wiggle = Range(-10 deg, 10 deg)
ego = EgoCar with roadDeviation wiggle
Car visible, with roadDeviation resample(wiggle)
