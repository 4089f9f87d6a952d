# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "The Simplest Possible Scenario", as printed.
from scenic.simulators.gta.model import *

ego = Car
Car
