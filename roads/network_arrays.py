"""Networks as arrays, and networks from arrays: how they are kept between processes."""

from __future__ import annotations

import enum
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from inspect import get_annotations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from ..semantics.space.vectors import Vector
from ..semantics.store.sets import FrozenSet
from .immutable import Fixed, complete
from .lane_edges import Points
from .map_cache import FAULTS, Arrays, arrays_in, keep, map_cache_path, pack_shapes, unpack_shapes
from .network import (
    BikeLane,
    Intersection,
    Lane,
    LaneGroup,
    LaneSection,
    Maneuver,
    ManeuverType,
    Network,
    PedestrianCrossing,
    Road,
    RoadSection,
    Shoulder,
    Sidewalk,
    Signal,
    VehicleType,
)

KINDS: Mapping[str, type[Fixed]] = {
    kind.__name__: kind
    for kind in (
        Network, Road, RoadSection, LaneGroup, Lane, LaneSection, Intersection, Maneuver, Signal, Sidewalk, Shoulder, BikeLane, PedestrianCrossing,
    )
}  # fmt: skip
ENUMERATIONS: Mapping[str, type[enum.Enum]] = {"ManeuverType": ManeuverType, "VehicleType": VehicleType}
APART = frozenset({"source", "again"})
"""Attributes of a network that those who ask for it know."""


def load_network(source: bytes, tolerance: float) -> Network | None:
    """The network of a map, if it was kept; `source` and `again` are for the caller to add."""
    arrays = arrays_in(map_cache_path("network", source, tolerance))
    if arrays is None:
        return None
    try:
        return NetworkReader(arrays).network()
    except FAULTS:
        return None


def keep_network(network: Network) -> None:
    """Keep a network for the next process that reads its map."""
    place = map_cache_path("network", network.source, network.tolerance)
    if place is not None:
        keep(place, NetworkWriter().arrays(network))


@dataclass
class NetworkWriter:
    """Objects, each with the values of its attributes, where numbers stand for other objects, lines and shapes."""

    numbers: dict[int, int] = field(default_factory=dict[int, int])
    objects: list[Fixed] = field(default_factory=list[Fixed])
    points: list[Points] = field(default_factory=list[Points])
    count: int = 0
    shapes: list[BaseGeometry] = field(default_factory=list[BaseGeometry])

    def arrays(self, network: Network) -> dict[str, NDArray[Any]]:
        """A network with all that it consists of."""
        self.number(network)
        records = list[tuple[str, dict[str, object]]]()
        for one in self.objects:  # which grows meanwhile
            kind = type(one)
            given = {name: value for name, value in vars(one).items() if name not in APART and not is_calculated(kind, name)}
            records.append((kind.__name__, {name: self.value(value) for name, value in given.items()}))
        text = json.dumps(records).encode()
        return {
            "objects": np.frombuffer(text, dtype=np.uint8), "points": np.concatenate([np.empty((0, 2)), *self.points]), **pack_shapes(self.shapes)
        }

    def number(self, one: Fixed) -> int:
        """The number of an object, which will be written."""
        found = self.numbers.setdefault(id(one), len(self.objects))
        if found == len(self.objects):
            self.objects.append(one)
        return found

    def value(self, value: object) -> object:
        """A value as JSON has it. Raises `TypeError` for what no attribute is."""
        if isinstance(value, Fixed):
            return [self.number(value)]  # by far the most frequent
        if value is None or isinstance(value, (bool, int, float, str)):
            return value
        if isinstance(value, tuple):
            return {"tuple": [self.value(one) for one in value]}
        if isinstance(value, np.ndarray):
            self.points.append(value)
            self.count += len(value)
            return {"points": [self.count - len(value), self.count]}
        if isinstance(value, BaseGeometry):
            self.shapes.append(value)
            return {"shape": len(self.shapes) - 1}
        if isinstance(value, Vector):
            return {"vector": [value.x, value.y]}
        if isinstance(value, enum.Enum):
            return {"enumeration": [type(value).__name__, value.name]}
        if isinstance(value, Mapping):
            return {"mapping": [[self.value(key), self.value(one)] for key, one in value.items()]}
        if isinstance(value, FrozenSet):
            return {"set": [self.value(one) for one in value]}
        raise TypeError(f"a network has no {type(value).__name__}")


class NetworkReader:
    """The objects of a file."""

    def __init__(self, arrays: Arrays) -> None:
        self.records: list[tuple[str, dict[str, Any]]] = json.loads(arrays["objects"].tobytes())
        self.objects = [kind.__new__(kind) for kind in (KINDS[name] for name, _ in self.records)]
        self.points = arrays["points"]
        self.shapes = unpack_shapes(arrays)

    def network(self) -> Network:
        """The network, and all that it consists of."""
        for one, (_, attributes) in zip(self.objects, self.records, strict=True):
            complete(one, **{name: self.value(value) for name, value in attributes.items()})
        network = self.objects[0]
        if not isinstance(network, Network) or not vars(network).keys() | APART >= get_annotations(Network).keys():
            raise TypeError("the first object is no network")
        return network

    def value(self, value: Any) -> object:
        """Return the value that `NetworkWriter.value` was given."""
        if isinstance(value, list):
            return self.objects[value[0]]
        if not isinstance(value, dict):
            return value
        [(what, told)] = value.items()
        match what:
            case "tuple":
                return tuple([self.value(one) for one in told])
            case "points":
                return self.points[told[0] : told[1]]
            case "shape":
                return self.shapes[told]
            case "vector":
                return Vector(*told)
            case "enumeration":
                return ENUMERATIONS[told[0]][told[1]]
            case "mapping":
                return {self.value(key): self.value(one) for key, one in told}
            case "set":
                return FrozenSet(self.value(one) for one in told)
            case _:
                raise ValueError(f"there is no {what}")


def is_calculated(kind: type, name: str) -> bool:
    """Whether an attribute was calculated when it was asked for, and will be again."""
    return isinstance(getattr(kind, name, None), cached_property)
