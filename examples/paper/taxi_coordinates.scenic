# The paper, Section "Data Types": Points and OrientedPoints are interpreted as vectors and headings where these are expected.
taxi = Object at (10, 20), facing 90 deg
ego = Object at (10, 10)
spot = taxi offset by (1, 2)
param spot = spot.position,
      heading = 30 deg relative to taxi
