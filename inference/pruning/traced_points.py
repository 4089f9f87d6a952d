"""A traced program with the points that it draws: which region, at which address, and the symbols for the coordinates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from ...interpreter.runtime.answerers import AS_THEY_ARE, Draws
from ...semantics.machine.config import Config, State
from ...semantics.space.regions import Region
from ..batch.graph import Graph
from ..batch.scene_template import template_of
from ..batch.tracing import trace_program
from .node_bounds import Point, point_of

Address = tuple[int, ...]


class DrawnPoint(NamedTuple):
    """A point that is drawn uniformly from `region` at `address`."""

    address: Address
    region: Region
    point: Point


class Recorded(NamedTuple):
    """A program as a graph, the state at its end, and the points drawn, by address."""

    graph: Graph
    state: State
    points: Mapping[Address, DrawnPoint]


def record_points(start: Callable[[], Config], fuel: int, draws: Draws = AS_THEY_ARE) -> Recorded:
    """The graph of a program and its points. Draws at the addresses in `draws` are from those distributions instead. Raises `NotLifted`."""
    graph, state = trace_program(start, fuel, draws)
    template_of(state)  # raises where ego or the workspace is random
    drawn = ((address, region, point_of(value)) for address, (region, value) in graph.points.items())
    return Recorded(graph, state, {address: DrawnPoint(address, region, point) for address, region, point in drawn if point is not None})
