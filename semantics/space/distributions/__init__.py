"""The distributions of the paper's Table "Distributions", and uniformPointIn of a region.

Each is sampled by a deterministic map of numbers that are uniform in [0, 1): the inverse distribution function of one number,
but for points of regions. Where the inverse is infinite at 0, the number 0 counts as 2^-54. Parameters are checked when the
distribution is made: `BadParameters` says which is wrong, and why.
"""

from ..regions.point_sampling import Numbers
from .distribution import BadParameters, Distribution, NoValues, Support
from .families import Coin, Discrete, Normal, PointIn, Range, TruncatedNormal, Uniform

__all__ = [
    "BadParameters",
    "Coin",
    "Discrete",
    "Distribution",
    "NoValues",
    "Normal",
    "Numbers",
    "PointIn",
    "Range",
    "Support",
    "TruncatedNormal",
    "Uniform",
]
