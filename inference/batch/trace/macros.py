"""The graph of a macro: its function traced on symbols of its own, for evaluators that cannot call it."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from ....semantics.kernel.budget import Budget
from ....semantics.space.symbols import NotLifted
from .graph import GraphNode, Macro, Site
from .recording import Recorder
from .symbols import Traced


class MacroGraph(NamedTuple):
    """The nodes of the numbers that a macro takes, those that are computed from them in order, and its result."""

    arguments: tuple[GraphNode, ...]
    nodes: tuple[GraphNode, ...]
    result: object


@lru_cache(maxsize=64)
def graph_of(macro: Macro) -> MacroGraph:
    """The graph of a macro, made once. Raises `NotLifted` if the course of its function depends on its arguments."""
    trace = Recorder(lambda site: 0.37 + 0.01 * site.index, Budget())
    symbols = [trace.site((), i, False) for i in range(sum(macro.shape))]
    for symbol in symbols:
        symbol.node.bounds = None
    found = Macro(macro.function.__wrapped__, macro.shape).call(symbols)  # type: ignore[attr-defined]
    if trace.graph.events:
        raise NotLifted(macro.function.__name__)
    nodes = tuple(node for node in trace.graph.nodes if not isinstance(node.function, Site))
    return MacroGraph(tuple(s.node for s in symbols), nodes, found.node if isinstance(found, Traced) else found)
