# dialect: pldi19
# The paper, Appendix "Gallery of Scenarios", "A Platoon, in Daytime", as printed.
from scenic.simulators.gta.model import *

param time = (8, 20) * 60    # 8 am to 8 pm
ego = Car with visibleDistance 60
c2 = Car visible
platoon = createPlatoonAt(c2, 5, dist=(2, 8))
