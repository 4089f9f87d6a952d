"""Inference: the distribution that a program defines, by rejection and by the backends tested against it."""
