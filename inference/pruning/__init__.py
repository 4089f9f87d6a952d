"""The paper's pruning (Section "Domain-Specific Sampling Techniques"): smaller regions to draw positions from, the scenes distributed as before."""

from .algorithms import prune_by_containment, prune_by_heading, prune_by_offset, prune_by_reachability, prune_by_width
from .analysis import prune
from .report import PAPER, TECHNIQUES, Finding, Pruned, Pruning, Technique

__all__ = [
    "PAPER", "TECHNIQUES", "Finding", "Pruned", "Pruning", "Technique", "prune", "prune_by_containment", "prune_by_heading",
    "prune_by_offset", "prune_by_reachability", "prune_by_width",
]
