"""How fast programs are sampled: what `scenic-ref bench` measures, and the scripts of the figures in docs/benchmarks.md.

`course` is a benchmark from its request to its `figures`. The `contenders` draw the programs in `processes` of their own: `own_sampler` for
this package, `released_sampler` for a released implementation. `terminal` and `bars` show the figures.
"""
