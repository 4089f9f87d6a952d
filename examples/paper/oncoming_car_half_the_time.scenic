# The paper, Section "Basic Scenarios": "if we only need this constraint to hold part of the time", as printed.
model scenic.simulators.gta.model
ego = Car

carB = Car offset by (Range(-10, 10), Range(20, 40)),
           with viewAngle 30 deg
require[0.5] carB can see ego
