"""A writer of road maps: OpenDRIVE files of a few kinds, from parameters.

    generate_map("crossing", lanes=2, sidewalks=True)

Metres, x to the East and y to the North. Every junction has one road for each way from a lane to a lane, and lanes meet exactly.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from . import map_kinds
from .opendrive_writer import opendrive_text
from .road_plans import PlannedRoad
from .street_networks import Style

__all__ = ["KINDS", "MapKind", "MapParameter", "generate_map"]

Value = bool | int | float


@dataclass(frozen=True)
class MapParameter:
    """A parameter: its default, whose type it has, what it is, and of a number the least and the largest value."""

    default: Value
    about: str
    least: float = 0.0
    most: float = 0.0

    @property
    def values(self) -> str:
        """Which values it may have, in words."""
        if isinstance(self.default, bool):
            return "True or False"
        return f"{'a whole number' if isinstance(self.default, int) else 'a number'} from {self.least:g} to {self.most:g}"

    def checked(self, name: str, value: object) -> Value:
        """The value. Raises `ValueError` if it is none of this parameter."""
        if isinstance(self.default, bool):
            if not isinstance(value, bool):
                raise ValueError(f"{name} must be {self.values}, not {value!r}")
            return value
        kinds = int if isinstance(self.default, int) else (int, float)
        if isinstance(value, bool) or not isinstance(value, kinds) or not (math.isfinite(value) and self.least <= value <= self.most):
            raise ValueError(f"{name} must be {self.values}, not {value!r}")
        return type(self.default)(value)


@dataclass(frozen=True)
class MapKind:
    """A kind of map: what it is, its parameters, and the function that lays out its roads."""

    description: str
    parameters: Mapping[str, MapParameter]
    roads: Callable[..., list[PlannedRoad]]


def leg(default: float) -> MapParameter:
    """The length of legs."""
    return MapParameter(default, "metres from the middle of a junction to the end of a leg", 10, 10_000)


LANES = {
    "lanes": MapParameter(1, "lanes for each direction", 1, 4),
    "lane_width": MapParameter(3.5, "metres", 2, 6),
}
LEFT_HAND = {"left_hand": MapParameter(False, "whether traffic keeps to the left")}
STREETS = {
    **LANES,
    "radius": MapParameter(6.0, "metres, of the curbs at corners", 0.5, 200),
    "sidewalks": MapParameter(True, "whether there are sidewalks"),
    "shoulders": MapParameter(False, "whether there are shoulders"),
    "shoulder_width": MapParameter(1.5, "metres", 0.5, 6),
    "bike_lanes": MapParameter(False, "whether there are bike lanes"),
    "signals": MapParameter(False, "whether there are traffic lights before junctions"),
    "crosswalks": MapParameter(False, "whether there are crosswalks before junctions"),
    **LEFT_HAND,
}
BLOCKS = {
    "rows": MapParameter(3, "junctions from South to North", 1, 50),
    "columns": MapParameter(3, "junctions from West to East", 1, 50),
    "block": MapParameter(80.0, "metres between the middles of junctions", 10, 10_000),
    "leg": leg(60.0),
}
LEGS = {"legs": MapParameter(4, "legs", 3, 4), "leg": leg(80.0)}

KINDS: Mapping[str, MapKind] = MappingProxyType(
    {
        "grid": MapKind(
            "straight streets that cross at right angles",
            {**BLOCKS, "one_way": MapParameter(False, "whether streets are one-way, each in the other direction than those beside it"), **STREETS},
            map_kinds.grid,
        ),
        "crossing": MapKind("one junction of four streets, or of three at equal angles", {**LEGS, **STREETS}, map_kinds.crossing),
        "t": MapKind("one junction of a street from West to East and one from the South", {"leg": leg(80.0), **STREETS}, map_kinds.t),
        "roundabout": MapKind(
            "a ring of one-way roads, with a junction for each leg",
            {**LEGS, "island": MapParameter(15.0, "metres, the radius of the island in its middle", 3, 500), **STREETS},
            map_kinds.roundabout,
        ),
        "highway": MapKind(
            "two carriageways, with an on-ramp and an off-ramp",
            {
                **LANES,
                "lanes": MapParameter(2, "lanes for each direction", 1, 4),
                "radius": MapParameter(50.0, "metres, of the ramps", 15, 1000),
                "leg": MapParameter(150.0, "metres of the highway before and after the ramps, and of the straight part of these", 10, 10_000),
                "ramp_lane": MapParameter(100.0, "metres of the lanes before and after a ramp, without their tapers", 10, 10_000),
                "taper": MapParameter(50.0, "metres in which these lanes end and begin", 10, 10_000),
                "shoulders": MapParameter(True, "whether there are shoulders"),
                **LEFT_HAND,
            },
            map_kinds.highway,
        ),
        "suburb": MapKind(
            "winding streets, some of them dead ends, with junctions of three and of four",
            {
                **BLOCKS,
                "rows": MapParameter(3, "places for junctions from South to North", 2, 20),
                "columns": MapParameter(3, "places for junctions from West to East", 2, 20),
                "block": MapParameter(100.0, "metres between these places, about", 10, 10_000),
                "seed": MapParameter(0, "of the random choices", 0, 2**63),
                **STREETS,
            },
            map_kinds.suburb,
        ),
    }
)
"""The kinds of maps by their names."""  # fmt: skip


def generate_map(kind: str, **parameters: Value) -> str:
    """The text of an OpenDRIVE 1.6 file: the same for the same parameters. Those that are not given have their defaults (`KINDS`).

    Raises `ValueError` for another kind or parameter, a value out of range, and values that do not fit together.
    """
    if kind not in KINDS:
        raise ValueError(f"there is no kind of map {kind!r}: there are {', '.join(KINDS)}")
    known = KINDS[kind].parameters
    for name in parameters:
        if name not in known:
            raise ValueError(f"maps of the kind {kind} have no parameter {name!r}: they have {', '.join(known)}")
    values = {name: parameter.checked(name, parameters.get(name, parameter.default)) for name, parameter in known.items()}
    left_hand = bool(values.pop("left_hand"))
    common = [field.name for field in dataclasses.fields(Style)]
    if all(name in values for name in common):
        values = {"style": Style(**{name: values.pop(name) for name in common}), **values}  # type: ignore[arg-type]
    return opendrive_text(KINDS[kind].roads(**values), kind, left_hand)
