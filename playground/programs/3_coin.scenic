# A coin per run, or per scene? The reading `soft`
# Is this coin thrown in every attempt, or once for a scene?
# Try the other answer to `soft` under Readings.
x = Range(0, 1)
ego = Object at (0, 0)
other = Object at (10 * x, 5)
require[0.5] x < 0.1
param x = x
