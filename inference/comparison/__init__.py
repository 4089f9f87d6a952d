"""Tests of whether two samples have "the same distribution": anytime-valid, by betting, with their evidence
and their power.
"""

from .comparison import DEFAULT_TV, Sampler, compare, compare_invariance
from .exact_laws import DEFAULT_ALPHA, BoundedMean, Categorical, Continuous, Law, contradicts, evidence
from .verdict import Feature, Verdict

__all__ = [
    "DEFAULT_ALPHA",
    "DEFAULT_TV",
    "BoundedMean",
    "Categorical",
    "Continuous",
    "Feature",
    "Law",
    "Sampler",
    "Verdict",
    "compare",
    "compare_invariance",
    "contradicts",
    "evidence",
]
