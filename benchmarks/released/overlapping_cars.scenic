# In Scenic 3, `beyond` gives an object the heading of what it refers to unless another is specified; in the paper it only gives the position.
from gta import *
wiggle = Range(-10 deg, 10 deg)
ego = new EgoCar with roadDeviation wiggle
c = new Car visible, with roadDeviation resample(wiggle)
leftRight = Uniform(1.0, -1.0) * Range(1.25, 2.75)
new Car beyond c by leftRight @ Range(4, 10), facing resample(wiggle) relative to roadDirection
