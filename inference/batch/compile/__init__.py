"""The graph as a function that numba compiles."""
