# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "A Single Car", as printed.
from scenic.simulators.gta.model import *

wiggle = (-10 deg, 10 deg)
ego = EgoCar with roadDeviation wiggle
Car visible, with roadDeviation resample(wiggle)
