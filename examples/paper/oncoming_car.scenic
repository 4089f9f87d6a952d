# The paper, Section "Basic Scenarios", "Declarative Specifications of Hard and Soft Constraints", as printed, completed by ego.
model scenic.simulators.gta.model
ego = Car

carB = Car offset by (Range(-10, 10), Range(20, 40)),
           with viewAngle 30 deg
require carB can see ego
