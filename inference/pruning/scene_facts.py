"""What the default requirements say about the objects of a traced program: their final positions, containers and visibility.

Mutation needs no rule of its own: the final position of a mutated object is the drawn point plus noise, another pair of nodes, about which the
requirements say nothing that would restrict the drawn point.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from ...semantics.kernel.classes import view_distance
from ...semantics.kernel.config import State
from ...semantics.kernel.values import Instance, unwrap
from ...semantics.scenes.default_requirements import default_requirements, in_region_of_its_own, in_workspace, visible, workspace_of
from .facts import Contained, container_of, min_radius
from .forms import Point, bounds_of_value, point_of


class Near(NamedTuple):
    """Two points are at most `distance` metres apart in every accepted run."""

    first: Point
    second: Point
    distance: float


def property_of(state: State, instance: Instance, name: str) -> object:
    """A property at the end, with symbols in it."""
    return unwrap(state.objects[instance.number].get(name))[0]


def position_of(state: State, instance: Instance) -> Point | None:
    """The final position."""
    return point_of(property_of(state, instance, "position"))


def name_of(state: State, instance: Instance) -> str:
    """What a report calls an object."""
    return state.names.get(instance.number) or f"{instance.class_.name} (object {state.scene.index(instance)})"


def is_mutated(state: State, instance: Instance) -> bool:
    """Whether noise may be added to the position."""
    scale = property_of(state, instance, "mutationScale")
    return not (isinstance(scale, (int, float)) and scale == 0)


def default_containers(state: State) -> Iterator[Contained]:
    """boundingBox(o) ⊆ workspace, and ⊆ o.regionContainedIn, for containers that are polygons."""
    for premise in default_requirements(state):
        if premise.holds in (in_workspace, in_region_of_its_own):
            (o,) = premise.objects
            region = workspace_of(state) if premise.holds is in_workspace else property_of(state, o, "regionContainedIn")
            point, shape = position_of(state, o), container_of(region)
            if point is not None and shape is not None:
                yield Contained(point, shape, min_radius(*(property_of(state, o, n) for n in ("width", "length"))))


def default_distances(state: State) -> Iterator[Near]:
    """An object that ego must see is no farther than ego sees, and half the diagonal of its own box."""
    for premise in default_requirements(state):
        if premise.holds is not visible or property_of(state, premise.objects[0], "requireVisible") is not True:
            continue
        o, ego = premise.objects
        viewer, seen = position_of(state, ego), position_of(state, o)
        if ego is not o and viewer is not None and seen is not None:
            sizes = [bounds_of_value(property_of(state, o, n)).largest / 2 for n in ("width", "length")]
            distance = bounds_of_value(property_of(state, ego, view_distance(state.settings.readings))).high + math.hypot(*sizes)
            if math.isfinite(distance):
                yield Near(viewer, seen, max(distance, 0.0))
