"""The machine: the state of the paper, what one step can say, values and their kinds, premises and draws, and the border to host code."""
