# In Scenic 3, `at` and `beyond` give an object the heading of what it refers to unless another is specified; in the paper they only give the position.
from mars import *
ego = new Rover at 0 @ -2
goal = new Goal at Range(-2, 2) @ Range(2, 2.5)
halfGapWidth = (1.2 * ego.width) / 2
bottleneck = new OrientedPoint offset by Range(-1.5, 1.5) @ Range(0.5, 1.5), facing Range(-30, 30) deg
require abs((angle to goal) - (angle to bottleneck)) <= 10 deg
new BigRock at bottleneck, facing Range(0, 360) deg
leftEnd = new OrientedPoint left of bottleneck by halfGapWidth, facing Range(60, 120) deg relative to bottleneck
rightEnd = new OrientedPoint right of bottleneck by halfGapWidth, facing Range(-120, -60) deg relative to bottleneck
new Pipe ahead of leftEnd, with length Range(1, 2)
new Pipe ahead of rightEnd, with length Range(1, 2)
new BigRock beyond bottleneck by Range(-0.5, 0.5) @ Range(0.5, 1), facing Range(0, 360) deg
new BigRock beyond bottleneck by Range(-0.5, 0.5) @ Range(0.5, 1), facing Range(0, 360) deg
new Pipe
new Rock
new Rock
new Rock
