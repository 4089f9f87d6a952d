"""Worlds to put scenes in, and simulators that run them."""
