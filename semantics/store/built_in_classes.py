"""Classes: Table "Properties of the built-in classes", single inheritance, default value expressions, `class` itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

from ..space.vectors import Vector
from ..syntax import expressions as e
from ..syntax.nodes import Node
from ..syntax.python_expressions import Attribute, Constant, Name, TupleDisplay
from .scenic_classes import ScenicClass
from .scopes import Scope
from .undo_log import Versions

EMPTY = Scope("builtins", Versions())


SPELLINGS: Mapping[str, tuple[str, str]] = {"height": ("height", "length"), "visibleDistance": ("view-distance", "viewDistance")}
"""Second spellings of properties: the reading that knows of one, and the alternative under which it is one, which is the first spelling."""


def canonical(name: str, readings: Mapping[str, str]) -> str:
    """The property that a name stands for (readings `height` and `view-distance`)."""
    if name not in SPELLINGS:
        return name
    reading, first = SPELLINGS[name]
    return first if readings[reading] == first else name


def view_distance(readings: Mapping[str, str]) -> str:
    """The property that says how far a Point sees (reading `view-distance`)."""
    return "viewDistance" if readings["view-distance"] == "viewDistance" else "visibleDistance"


def _constant(value: object) -> Constant:
    return Constant(value=value)


def _self(name: str) -> Attribute:
    return Attribute(value=Name(name="self"), name=name)


def _pair(x: Node, y: Node) -> TupleDisplay:
    return TupleDisplay(items=(x, y))  # type: ignore[arg-type]


ORIGIN = _pair(_constant(0), _constant(0))

POINT_CLASS = ScenicClass(
    name="Point",
    superclasses=(),
    own_defaults={
        "position": _constant(Vector(0.0, 0.0)),
        "viewDistance": _constant(50),
        "mutationScale": _constant(0),
        "positionStdDev": _constant(1),
    },
    scope=EMPTY,
    built_in=True,
)

ORIENTED_POINT_CLASS = ScenicClass(
    name="OrientedPoint",
    superclasses=(POINT_CLASS,),
    own_defaults={
        "heading": _constant(0.0),
        "viewAngle": _constant(math.radians(360)),
        "headingStdDev": _constant(math.radians(5)),
    },
    scope=EMPTY,
    built_in=True,
)

OBJECT_CLASS = ScenicClass(
    name="Object",
    superclasses=(ORIENTED_POINT_CLASS,),
    own_defaults={
        "width": _constant(1),
        "length": _constant(1),
        "speed": _constant(0),
        # velocity = (0, 0) offset along self.heading by (0, self.speed): "default from speed, heading"
        "velocity": e.OffsetAlong(base=ORIGIN, direction=_self("heading"), offset=_pair(_constant(0), _self("speed"))),
        "angularSpeed": _constant(0),
        "behavior": _constant(None),
        "allowCollisions": _constant(False),
        "requireVisible": _constant(True),
        "regionContainedIn": _constant(None),
    },
    scope=EMPTY,
    built_in=True,
)

BUILT_IN_CLASSES: Mapping[str, ScenicClass] = {c.name: c for c in (POINT_CLASS, ORIENTED_POINT_CLASS, OBJECT_CLASS)}

VIEW_DISTANCES = ("viewDistance", "visibleDistance")
"""Under one reading `view-distance` there is the first alone; under the other the second, and the first is a name like any other."""
VECTOR_PROPERTIES = frozenset({"position", "velocity"})
SCALAR_PROPERTIES = frozenset(
    {"heading", "width", "length", *VIEW_DISTANCES, "viewAngle", "speed", "angularSpeed", "mutationScale", "positionStdDev", "headingStdDev"}
)
BOOLEAN_PROPERTIES = frozenset({"allowCollisions", "requireVisible"})
NON_NEGATIVE_PROPERTIES = frozenset({"width", "length", *VIEW_DISTANCES, "viewAngle", "mutationScale", "positionStdDev", "headingStdDev"})


@cache
def built_in_defaults(class_: ScenicClass, distance: str = "viewDistance") -> Mapping[str, object]:
    """The default values of a built-in class that are constants; `distance` says how far a Point sees."""
    renamed = {"viewDistance": distance}
    return {renamed.get(name, name): default.value for name, (default, _) in class_.defaults.items() if isinstance(default, Constant)}


def defaults_of(class_: ScenicClass, readings: Mapping[str, str]) -> Mapping[str, tuple[Node, ScenicClass]]:
    """The most-derived default value expression of every property, with the class that it stands in (reading `view-distance`)."""
    return class_.defaults if readings["view-distance"] == "viewDistance" else class_.defaults_in_releases
