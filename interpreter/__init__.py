"""From text to runs: the grammar, the parser, static checks, imports, and the loop that drives the machine."""
