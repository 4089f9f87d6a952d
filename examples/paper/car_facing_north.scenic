# The paper, Section "Basic Scenarios", "Local Coordinate Systems": "not quite what we want", since it is within 5 degrees of North.
model scenic.simulators.gta.model
ego = Car

Car offset by (Range(-10, 10), Range(20, 40)),
    facing Range(-5, 5) deg
