"""One primitive, all its forms: for columns (NumPy), for one run after the other (numba), and for tensors (torch)."""
