# The paper, Section "Basic Scenarios": "a car that is 20-40 m ahead of the camera", as printed, completed by ego.
model scenic.simulators.gta.model
ego = Car

Car offset by (Range(-10, 10), Range(20, 40))
