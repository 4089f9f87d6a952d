# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "Four Cars, in Poor Driving Conditions", as printed.
from scenic.simulators.gta.model import *

param weather = 'RAIN'
param time = 0 * 60   # midnight

wiggle = (-10 deg, 10 deg)
ego = EgoCar with roadDeviation wiggle
Car visible, with roadDeviation resample(wiggle)
Car visible, with roadDeviation resample(wiggle)
Car visible, with roadDeviation resample(wiggle)
Car visible, with roadDeviation resample(wiggle)
