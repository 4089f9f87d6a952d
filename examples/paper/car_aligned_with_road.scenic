# The paper, Section "Basic Scenarios", "Local Coordinate Systems": within 5 degrees of the road's direction.
model scenic.simulators.gta.model
ego = Car

Car offset by (Range(-10, 10), Range(20, 40)),
  facing Range(-5, 5) deg relative to roadDirection
