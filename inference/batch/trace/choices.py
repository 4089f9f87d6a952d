"""Draws from what another draw has chosen: an item of a container, or a point of a region, such as the centerline of a drawn lane."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ....semantics.kernel.unmet import NothingToDraw, unmet
from ....semantics.kernel.values import unwrap
from ....semantics.space.distributions import Distribution, PointIn, Uniform
from ....semantics.space.numeric import pick
from ....semantics.space.regions import PolygonalRegion, PolylineRegion, Workspace
from ....semantics.space.regions.sampling import PieceSampler
from ....semantics.space.symbols import Spread
from ....semantics.syntax.nodes import NOWHERE
from .graph import GraphNode, ItemOf, SearchPart
from .recording import Recorder, is_constant_choice
from .structures import symbols_in
from .symbols import Choice, Scalar

MOST_ITEMS = 1 << 16
"""Containers with more items than this together, and regions of more pieces, are drawn from row by row."""
Uniforms = Callable[[], Any]


def draw_from_choice(distribution: Distribution, uniform: Uniforms, made: Recorder) -> Any:
    """Return the symbol for a draw of which all that is random is a choice among constant containers or regions.

    Returns NotImplemented for any other draw. `uniform` gives the numbers of the draw.
    """
    if isinstance(distribution, Uniform):
        return draw_item(distribution, uniform, made)
    if isinstance(distribution, PointIn) and isinstance(distribution.region, Choice):
        return draw_point(distribution.region, uniform, made)
    return NotImplemented


def draw_item(distribution: Uniform, uniform: Uniforms, made: Recorder) -> Any:
    """Draw one of the items of containers that a choice decides; where there are none, the run is rejected."""
    entries = [unwrap(value)[0] for value in distribution.values]
    choices = [entry.container for entry in entries if isinstance(entry, Spread)]
    if not choices or not all(map(is_constant_choice, choices)) or len({choice.node for choice in choices}) > 1:
        return NotImplemented
    if symbols_in([entry for entry in entries if not isinstance(entry, Spread)]):
        return NotImplemented
    if not all(isinstance(unwrap(value)[0], (tuple, list)) for choice in choices for value in choice.values):
        return NotImplemented

    def items_in(entry: object, case: int) -> Sequence[Any]:
        return unwrap(entry.container.values[case])[0] if isinstance(entry, Spread) else [entry]  # type: ignore[return-value]

    cases = range(len(choices[0].values))
    among = [[item for entry in entries for item in items_in(entry, case)] for case in cases]
    if sum(map(len, among)) > MOST_ITEMS:
        return NotImplemented
    index = choices[0].node
    empty = {case: unmet(NothingToDraw(distribution.name), NOWHERE) for case in cases if not among[case]}
    if empty:
        made.note_failures(index, empty, len(among), distribution.name)
    return pick_item(index, among, uniform, made)


def pick_item(index: GraphNode, among: Sequence[Sequence[object]], uniform: Uniforms, made: Recorder) -> Any:
    """Draw one of the items among[index], each equally likely. An item that stands in several places has one number."""
    everything = [item for items in among for item in items]
    distinct = list({id(item): item for item in everything}.values())
    number_of = {id(item): number for number, item in enumerate(distinct)}
    numbers = np.array([*(number_of[id(item)] for item in everything), 0])  # the last follows an empty container at the end
    counts = np.array([len(items) for items in among])
    starts = part_starts(counts)
    position = uniform() * made.table(index, counts.astype(float))
    example = int(numbers[starts[index.example] + int(position.example)])  # type: ignore[call-overload]
    node = made.node(ItemOf(numbers, starts), (index, position.node), "int", example, object())
    return made.merge(node, distinct)


def part_starts(counts: np.ndarray) -> np.ndarray:
    """Return the position of the first element of each part, for parts of these sizes one after the other."""
    return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)


def draw_point(choice: Choice, uniform: Uniforms, made: Recorder) -> Any:
    """Draw a uniform point of one of several constant curves, or polygons. The pieces of all of them stand in one array."""
    samplers = [sampler for value in choice.values if (sampler := piece_sampler(value)) is not None]
    if len(samplers) < len(choice.values) or len(set(map(type, samplers))) != 1:
        return NotImplemented
    pieces = [piece for sampler in samplers for piece in sampler.pieces]
    if len(pieces) > MOST_ITEMS:
        return NotImplemented
    counts = np.array([len(sampler.pieces) for sampler in samplers])
    ends = np.array([end for sampler in samplers for end in (*sampler.ends, np.inf)])
    search = SearchPart(ends, np.append(part_starts(counts), len(pieces)))
    along = uniform() * made.table(choice.node, np.array([sampler.total for sampler in samplers]))
    begin = int(search.starts[choice.node.example])  # type: ignore[call-overload]
    example = begin + bisect_right(samplers[choice.node.example].ends, along.example)  # type: ignore[call-overload]
    node = made.node(search, (choice.node, along.node), "int", example, object())
    return samplers[0].point(pick(pieces, Scalar(made, node, example)), along, uniform)


def piece_sampler(region: object) -> PieceSampler | None:
    """Return the sampler of a curve or polygon that has pieces, None for any other region."""
    while isinstance(region, Workspace):
        region = region.region
    if not isinstance(region, (PolylineRegion, PolygonalRegion)) or symbols_in(region):
        return None
    return region.sampler if region.sampler.pieces else None
