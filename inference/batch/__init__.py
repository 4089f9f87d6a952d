"""The batch backend: a program is run once on symbols, and the graph that this gives is evaluated for many scenes at a time."""

from ...semantics.space.symbols import NotLifted
from .evaluate.sampling import Batch, Block
from .trace.running import Impossible

__all__ = ["Batch", "Block", "Impossible", "NotLifted"]
