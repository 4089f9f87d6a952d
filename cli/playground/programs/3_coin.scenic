# A coin per run, or per scene? The reading `soft`
# Readings, soft: is the coin of require[0.5] thrown in every attempt, or once for a scene?
x = Range(0, 1)
ego = Object at (0, 0)
other = Object at (10 * x, 5)
require[0.5] x < 0.1
param x = x
