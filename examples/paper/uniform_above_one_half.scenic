# The paper, Section "Semantics of Scenic": x is uniform over the interval (0.5, 1).
x = Range(0, 1)
require x > 0.5
ego = Object with x x
