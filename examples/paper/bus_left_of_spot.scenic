# The paper, Section "Basic Scenarios", "Readable, Flexible Specifiers", as printed, completed by the spot of the next paragraph.
model scenic.simulators.gta.model
ego = Car
spot = OrientedPoint on visible curb

Car left of spot by 0.5, with model BUS
