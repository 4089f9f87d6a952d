"""Runs as points of a cube: the random numbers of their draw sites, how far they are from being accepted, and moves that leave the law as it is."""
