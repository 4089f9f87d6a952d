"""What "the same distribution" means: anytime-valid tests by betting, with their evidence and their power."""

from .comparison import DEFAULT_ALPHA, DEFAULT_TV, Sampler, compare, compare_invariance
from .verdict import Feature, Verdict

__all__ = ["DEFAULT_ALPHA", "DEFAULT_TV", "Feature", "Sampler", "Verdict", "compare", "compare_invariance"]
