# The paper, Appendix "Gallery of Scenarios", "Robot Motion Planning with a Bottleneck", in the syntax of Section 4.
model mars

ego = Rover at (0, -2)
goal = Goal at (Range(-2, 2), Range(2, 2.5))

halfGapWidth = (1.2 * ego.width) / 2
bottleneck = OrientedPoint offset by (Range(-1.5, 1.5), Range(0.5, 1.5)), facing Range(-30, 30) deg
require abs((angle to goal) - (angle to bottleneck)) <= 10 deg
BigRock at bottleneck

leftEnd = OrientedPoint left of bottleneck by halfGapWidth,
        facing Range(60, 120) deg relative to bottleneck
rightEnd = OrientedPoint right of bottleneck by halfGapWidth,
        facing Range(-120, -60) deg relative to bottleneck
Pipe ahead of leftEnd, with length Range(1, 2)
Pipe ahead of rightEnd, with length Range(1, 2)

BigRock beyond bottleneck by (Range(-0.5, 0.5), Range(0.5, 1))
BigRock beyond bottleneck by (Range(-0.5, 0.5), Range(0.5, 1))
Pipe
Rock
Rock
Rock
