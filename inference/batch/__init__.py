"""The batch backend: a program is run once on symbols, and the graph that this gives is evaluated for many scenes at a time."""

from ...semantics.space.symbol_seam import NotLifted
from .block_rejection import Batch, Block
from .tracing import Impossible

__all__ = ["Batch", "Block", "Impossible", "NotLifted"]
