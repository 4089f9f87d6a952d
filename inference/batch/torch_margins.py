"""By how much requirements are met, as functions that torch differentiates: of the random numbers of runs, and of the poses of objects.

The margins are those of `evaluate.margins`, and of what lies in a polygon also inside: how far its boundary is. What has no such measure has a
margin of 1 or -1 and no gradient. So have, of their own, choices among values, headings of fields of cells, and what NumPy computes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import torch
from torch import Tensor

from ...semantics.machine.outcome import Requirement
from ...semantics.space.regions import PolygonalRegion
from ...semantics.space.vectors import Vector
from ..moves.states import StateNumbers, States
from .evaluation_plan import cone, roots_of
from .graph import GraphEvent, GraphNode, Macro, RowCall, Site
from .primitives.torch_polygons import TensorPolygon
from .symbolic import Scalar, nodes_in
from .torch_evaluator import TensorColumns, looked_at
from .torch_lowering import Kit, Rounded, device_of
from .violations import DIFFERENCES, IN_POLYGON, UNKNOWN

if TYPE_CHECKING:
    from ..moves.target import Target

PIECE = 1 << 22
"""Pairs of a row and an edge that are looked at together."""


class Margins:
    """The margins of a program's requirements, `requirements`, whose states are those of `target`, on a device, "cpu" or "cuda".

    `reasons` are the operations that torch does not have: there are no gradients by what they are computed from.
    """

    def __init__(self, target: Target, device: str = "cpu") -> None:
        self.target = target
        self.kit = Kit(target.graph, device_of(device))
        events = target.graph.events
        self.events = tuple(e for e in events if e.kind == "require")
        self.others = tuple(e for e in events if e.kind != "require")
        self.requirements: tuple[Requirement, ...] = tuple(e.requirement for e in self.events if e.requirement is not None)
        self.poses = [poses_of(o.properties) for o in target.batch.template.objects]
        roots = [root for event in events for root in roots_of(event)]
        self.nodes = cone([*roots, *(n for pose in self.poses for n in pose if n is not None)], set())

    @property
    def reasons(self) -> tuple[str, ...]:
        """The operations that torch does not have."""
        return self.kit.reasons

    def at(self, states: States) -> MarginsAt:
        """The margins of some states; what is drawn by a word of a state (`sites.states`) has no gradient."""
        uniforms = torch.from_numpy(states.uniforms.copy()).to(self.kit.device).requires_grad_()
        watched = {n.number for pose in self.poses for n in pose if n is not None}

        def watch(number: int, made: Rounded) -> Rounded:
            flat = number in watched and not made.values.requires_grad
            return made._replace(values=made.values.clone().requires_grad_()) if flat else made

        space = self.target.space
        columns = TensorColumns(self.kit, StateNumbers(space, states), Given(space.number, uniforms), watch, twice=True)
        columns.compute(self.nodes)
        lost = [np.logical_or(*looked_at(event, columns)) for event in self.others]
        described = ~np.any(lost, axis=0) if lost else np.ones(len(states), dtype=bool)
        values = [requirement_margin(event, columns) for event in self.events]
        stacked = torch.stack(values) if values else uniforms.new_zeros((0, len(states)))
        poses = tuple(tuple(None if n is None else columns[n.number].values for n in pose) for pose in self.poses)
        return MarginsAt(self.requirements, stacked, uniforms, poses, torch.from_numpy(described))


class MarginsAt(NamedTuple):
    """Margins of some states, (requirements, states): a requirement is met where its margin is positive, and violated where it is negative.

    `uniforms`, (numbers, states), are what they are functions of, and `poses` for each object its x, y and heading (states,), None for what
    is not drawn. Where the graph does not describe a run, or a field or region has no value, `described` is False and the margins say nothing.
    """

    requirements: tuple[Requirement, ...]
    values: Tensor
    uniforms: Tensor
    poses: tuple[tuple[Tensor | None, ...], ...]
    described: Tensor

    def by_uniforms(self) -> Tensor:
        """The derivative of each margin by each random number, (requirements, numbers, states); 0 where there is none."""
        return torch.stack([self.derivatives(values, [self.uniforms])[0] for values in self.values]) if len(self.values) else self.values[:, None]

    def by_pose(self, number: int) -> Tensor:
        """The derivative of each margin by x, y (in metres) and heading (in radians) of an object, (requirements, 3, states).

        What is relative to the object moves with it. It is 0 for what is not drawn, and where there is none.
        """
        parts = self.poses[number]
        drawn = [part for part in parts if part is not None]
        rows: list[Tensor] = []
        for values in self.values:
            found = iter(self.derivatives(values, drawn))
            rows.append(torch.stack([torch.zeros_like(values) if part is None else next(found) for part in parts]))
        return torch.stack(rows) if rows else self.values[:, None].expand(0, 3, -1)

    def descent(self) -> tuple[Tensor, Tensor]:
        """The violation of each state, (states,), which is the sum of what its negative margins lack; and the direction in which that falls
        fastest, minus its derivative by each random number, (numbers, states).
        """
        violation = (-self.values).clamp(min=0.0).sum(0)
        return violation.detach(), -self.derivatives(violation, [self.uniforms])[0]

    def derivatives(self, values: Tensor, parts: Sequence[Tensor]) -> list[Tensor]:
        """The derivatives of a row for each state by parts of these states."""
        if not (values.requires_grad and parts):
            return [torch.zeros_like(part) for part in parts]
        found = torch.autograd.grad(values.sum(), parts, retain_graph=True, allow_unused=True)
        return [torch.zeros_like(p) if d is None else torch.nan_to_num(d, 0.0, 0.0, 0.0) for d, p in zip(found, parts, strict=True)]


class Given:
    """The random numbers of states: `places` says which row of `uniforms` those of a site are."""

    def __init__(self, places: Mapping[tuple[tuple[int, ...], int], int], uniforms: Tensor) -> None:
        self.places, self.uniforms = places, uniforms

    def column(self, site: Site) -> Tensor:
        """The numbers in [0, 1) of a site, (states,)."""
        return self.uniforms[self.places[site.address, site.index]]

    def keep(self, kept: Tensor) -> None:
        """States are never left out."""
        raise AssertionError(kept)


def poses_of(properties: Mapping[str, object]) -> tuple[GraphNode | None, GraphNode | None, GraphNode | None]:
    """The nodes of an object's x, y and heading, None for what is not one number of the graph."""
    position, heading = properties["position"], properties["heading"]
    x, y = position if isinstance(position, Vector) else (None, None)
    return node_of(x), node_of(y), node_of(heading)


def node_of(value: object) -> GraphNode | None:
    """The node of a number."""
    found = nodes_in(value) if isinstance(value, Scalar) else []
    return found[0] if found and found[0].kind == "float" else None


# Margins


def requirement_margin(event: GraphEvent, columns: TensorColumns) -> Tensor:
    """By how much the requirement of an event is met, or the coin under which it counts shows tails."""
    found = margin(event.node, columns, columns)
    found = found if event.expected else -found
    return found if event.condition is None else torch.maximum(found, -margin(event.condition, columns, columns))


def margin(node: object, columns: TensorColumns, known: Mapping[int, Rounded]) -> Tensor:
    """By how much a condition holds, (states,): not where it is negative. `known` are the columns of its graph, which may be that of a macro."""
    if not isinstance(node, GraphNode):
        return torch.full((len(columns.numbers),), torch.inf if node else -torch.inf, dtype=torch.float64, device=columns.kit.device)
    function, arguments = node.function, node.arguments
    if function in DIFFERENCES:
        left, right = (known[a.number].values if isinstance(a, GraphNode) else float(a) for a in arguments)  # type: ignore[arg-type]
        return DIFFERENCES[function] * (right - left)  # type: ignore[index, return-value]
    if function is np.logical_not:
        return -margin(arguments[0], columns, known)
    if function in (np.logical_and, np.logical_or):
        best = torch.minimum if function is np.logical_and else torch.maximum
        return best(*(margin(a, columns, known) for a in arguments))
    if function is np.where:
        condition, *sides = arguments
        first, second = (margin(a, columns, known) for a in sides)
        if not isinstance(condition, GraphNode):
            return first if condition else second
        return torch.where(known[condition.number].values.to(torch.bool), first, second)
    if isinstance(function, Macro):
        inner, _ = columns.inside(function, arguments)
        return margin(columns.kit.macro(function).result, columns, inner)
    if isinstance(function, RowCall) and function.function in IN_POLYGON and isinstance(function.structure[0], PolygonalRegion):
        numbers = [n.values for n in columns.operands(function)[0]]
        polygon = columns.kit.polygon(function.structure[0])
        inside = known[node.number].values
        return point_margin(polygon, inside, *numbers) if len(numbers) == 2 else box_margin(polygon, inside, *numbers)  # type: ignore[call-arg]
    return torch.where(known[node.number].values.to(torch.bool), UNKNOWN, -UNKNOWN).to(torch.float64)


def point_margin(polygon: TensorPolygon, inside: Tensor, x: Tensor, y: Tensor) -> Tensor:
    """How far points are from the boundary of a polygon, in metres; negative outside."""
    with torch.no_grad():
        edge = nearest(polygon, lambda edges, rows: squared_edge_distances(polygon.edges[edges], x[rows, None], y[rows, None]), len(x))
    away = torch.sqrt(squared_edge_distances(polygon.edges[edge], x, y).clamp(min=1e-300))
    return torch.where(inside, away, -away)


def box_margin(polygon: TensorPolygon, inside: Tensor, x: Tensor, y: Tensor, heading: Tensor, width: Tensor, length: Tensor) -> Tensor:
    """How far boxes are from the boundary of a polygon that contains them, in metres, on the axis that separates them best.

    For others it is negative: as far as the farthest corner is outside, or where none is, as deep as an edge is in the box.
    """
    box = (x, y, heading, width / 2, length / 2)
    with torch.no_grad():
        edge = nearest(polygon, lambda edges, rows: polygon.gaps(edges, *(v[rows, None] for v in box)), len(x))
    gap = polygon.gaps(edge, *box)
    c, s = torch.cos(heading), torch.sin(heading)
    depths: list[Tensor] = []
    for a, b in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        across, along = a * width / 2, b * length / 2
        px, py = x + across * c - along * s, y + across * s + along * c
        depths.append(point_margin(polygon, polygon.contains_point(px.detach(), py.detach(), 0.0)[0], px, py))
    deepest = torch.stack(depths).amin(0)
    return torch.where(inside & (gap > 0), gap, torch.where(deepest < 0, deepest, gap.clamp(max=0.0)))


def nearest(polygon: TensorPolygon, measure: Callable[[Tensor, slice], Tensor], rows: int) -> Tensor:
    """The edge with the least measure for each row; `measure` gives those of some edges, (1, edges), and rows."""
    count = len(polygon.edges)
    edges = torch.arange(count, device=polygon.device)[None]
    step = max(1, PIECE // count)
    pieces = [measure(edges, slice(first, first + step)).argmin(1) for first in range(0, rows, step)]
    return torch.cat(pieces) if pieces else torch.zeros(0, dtype=torch.int64, device=polygon.device)


def squared_edge_distances(edges: Tensor, x: Tensor, y: Tensor) -> Tensor:
    """The squared distances of points from edges, in square metres."""
    ax, ay, bx, by = edges.unbind(-1)
    dx, dy = bx - ax, by - ay
    share = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy).clamp(min=1e-300)).clamp(0.0, 1.0)
    return (ax + share * dx - x) ** 2 + (ay + share * dy - y) ** 2
