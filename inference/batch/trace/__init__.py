"""One run of a program on symbols, kept as a graph of operations."""
