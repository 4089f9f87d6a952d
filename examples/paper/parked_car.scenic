# The paper, Section "Basic Scenarios", "Specifying Multiple Properties Together", as printed, completed by ego.
model scenic.simulators.gta.model
ego = Car

spot = OrientedPoint on visible curb
Car left of spot by 0.25
