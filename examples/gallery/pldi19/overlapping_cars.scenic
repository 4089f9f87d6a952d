# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "Two Overlapping Cars", as printed.
from scenic.simulators.gta.model import *

wiggle = (-10 deg, 10 deg)
ego = EgoCar with roadDeviation wiggle

c = Car visible, with roadDeviation resample(wiggle)

leftRight = Uniform(1.0, -1.0) * (1.25, 2.75)
Car beyond c by leftRight @ (4, 10), with roadDeviation resample(wiggle)
