# The paper, Appendix "Gallery of Scenarios", "An Oncoming Car", in the syntax of Section 4.
model scenic.simulators.gta.model

ego = Car
car2 = Car offset by (Range(-10, 10), Range(20, 40)), with viewAngle 30 deg
require car2 can see ego
