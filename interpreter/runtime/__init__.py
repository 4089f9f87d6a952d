"""Runs: the loop that drives the machine, random numbers, traces, and the walls around programs of others."""
