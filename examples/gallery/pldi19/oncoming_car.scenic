# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "An Oncoming Car", as printed.
from scenic.simulators.gta.model import *

ego = Car
car2 = Car offset by (-10, 10) @ (20, 40), with viewAngle 30 deg
require car2 can see ego
