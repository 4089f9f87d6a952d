"""A traced program with the points that it draws: which region, at which address, and the symbols for the coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple

from ...semantics.config import Config, State
from ...semantics.distributions import Distribution, PointIn
from ...semantics.outcome import Draw
from ...semantics.regions import Region
from ..batch import tracing
from ..batch.graph import Graph
from ..batch.scenes import template_of
from ..batch.trace import Trace
from .forms import Point, point_of

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


def record(start: Callable[[], Config], fuel: int, draws: Mapping[Address, Distribution] | None = None) -> Recorded:
    """The graph of a program and its points. Draws at the addresses in `draws` are from those distributions instead. Raises `NotLifted`."""
    with recording(draws or {}) as points:
        graph, state = tracing.trace(start, fuel)
    template_of(state)  # raises where ego or the workspace is random
    return Recorded(graph, state, points)


@contextmanager
def recording(draws: Mapping[Address, Distribution]) -> Iterator[dict[Address, DrawnPoint]]:
    """The points drawn by the programs that are traced inside, with the draws at the addresses in `draws` replaced."""
    points: dict[Address, DrawnPoint] = {}
    original, traces = tracing.draw_symbol, set[Trace]()

    def draw_symbol(draw: Draw, made: Trace) -> object:
        distribution = draws.get(draw.address, draw.distribution) if isinstance(draw.distribution, PointIn) else draw.distribution
        if made not in traces:  # an earlier run got stuck: its points are forgotten
            points.clear()
            traces.add(made)
        drawn = original(draw._replace(distribution=distribution), made)
        coordinates = point_of(drawn)
        if isinstance(distribution, PointIn) and coordinates is not None:
            points[draw.address] = DrawnPoint(draw.address, distribution.region, coordinates)
        return drawn

    tracing.draw_symbol = draw_symbol
    try:
        yield points
    finally:
        tracing.draw_symbol = original
