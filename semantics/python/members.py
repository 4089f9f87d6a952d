"""Attributes and methods of the released implementations that say what an operator says: `o.distanceTo(v)` is `distance from o to v`.

Each is a rewriting into an operator, of values that are known already; so it means the same in every backend. A property or method that the
program defines comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from inspect import signature
from types import MappingProxyType
from typing import ClassVar

import shapely

from ..kernel.classes import ORIENTED_POINT_CLASS, canonical
from ..kernel.config import Config, Stack, State
from ..kernel.errors import RunError
from ..kernel.host import HostException
from ..kernel.kinds import OBJECT, REGION, Reader, has_kind, is_a, is_object, is_oriented, kind_name
from ..kernel.outcome import Next, Outcome
from ..kernel.premises import premises
from ..kernel.values import Bound, Constructor, Dynamic, Function, Instance, Method, Native, Special, plain
from ..space import geometry, regions
from ..space.boundaries import METRES
from ..space.distributions import PointIn
from ..space.fields import OutsideField, VectorField
from ..space.numeric import lifted
from ..space.regions import Region
from ..space.vectors import Vector
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax import specifiers as q
from ..syntax.nodes import Expression, Node

Rewrite = Callable[..., Expression]
"""From the value and the arguments, as expressions, to what the member stands for."""
ZERO = p.Constant(value=Vector(0.0, 0.0))


def pair(x: Expression, y: Expression) -> Expression:
    """(x, y)."""
    return e.VectorOf(x=x, y=y)


def number(x: float) -> Expression:
    """A number."""
    return p.Constant(value=x)


def box(o: Expression) -> Expression:
    """The bounding box of an object, as a region."""
    properties = (p.Attribute(value=o, name=name) for name in ("position", "heading", "width", "length"))
    return p.Call(function=p.Constant(value=regions.RectangularRegion), arguments=tuple(properties))


def boxes_meet(o: Expression, other: Expression) -> Expression:
    """Whether the bounding boxes of two objects share a point."""
    return p.Call(function=p.Attribute(value=box(o), name="intersects"), arguments=(box(other),))


def within(point: Expression, region: Expression) -> Expression:
    """`point in region`."""
    return p.Comparison(left=point, operators=("in",), operands=(region,))


def length(v: Expression) -> Expression:
    """The length of a vector."""
    return e.Distance(origin=ZERO, target=v)


def turned(v: Expression, angle: Expression) -> Expression:
    """The vector, rotated anticlockwise."""
    return e.OffsetAlong(base=ZERO, direction=angle, offset=v)


def product(v: Expression, w: Expression, axis: str) -> Expression:
    """The product of a coordinate of two vectors."""
    return p.BinaryOperation(operator="*", left=p.Attribute(value=v, name=axis), right=p.Attribute(value=w, name=axis))


def corners(o: Expression) -> Expression:
    """The four corners of an object, from the front right one on, anticlockwise."""
    sides: tuple[e.Side, ...] = ("front right", "front left", "back left", "back right")
    return p.TupleDisplay(items=tuple(p.Attribute(value=e.SideOf(side=s, object=o), name="position") for s in sides))


def side(name: e.Side) -> Rewrite:
    """`front of O` and its siblings."""
    return lambda o: e.SideOf(side=name, object=o)


def half(name: str) -> Rewrite:
    """Half of a size of an object."""
    return lambda o: p.BinaryOperation(operator="/", left=p.Attribute(value=o, name=name), right=number(2))


SIDES: Mapping[str, Rewrite] = {
    "hw": half("width"), "hl": half("length"),
    "left": side("left"), "right": side("right"), "front": side("front"), "back": side("back"), "frontLeft": side("front left"),
    "frontRight": side("front right"), "backLeft": side("back left"), "backRight": side("back right"), "corners": corners,
}  # fmt: skip
AXES: Mapping[str, Rewrite] = {
    axis: lambda o, axis=axis: p.Attribute(value=p.Attribute(value=o, name="position"), name=axis) for axis in ("x", "y")
}
"""The coordinates of a point's position, which has no properties of these names."""
SEEING: Mapping[str, Rewrite] = {"visibleRegion": lambda o: e.VisibleFrom(region=p.Constant(value=regions.everywhere), viewer=o)}

OF_POINTS: Mapping[str, Rewrite] = {
    "toVector": lambda o: p.Attribute(value=o, name="position"),
    "distanceTo": lambda o, point: e.Distance(origin=o, target=point),
    "angleTo": lambda o, other: e.Angle(origin=o, target=other),
    "canSee": lambda o, other: e.CanSee(viewer=o, target=other),
}
OF_ORIENTED_POINTS: Mapping[str, Rewrite] = {
    **OF_POINTS,
    "distancePast": lambda o, vec: e.DistancePast(oriented_point=o, vector=vec),
    "relativize": lambda o, vec: e.RelativeTo(left=vec, right=o),
}
OF_OBJECTS: Mapping[str, Rewrite] = {
    **OF_ORIENTED_POINTS, "containsPoint": lambda o, point: within(point, box(o)), "intersects": boxes_meet,
}  # fmt: skip


def to_box(o: Expression, point: Expression) -> Expression:
    """The distance between the bounding box of an object and a position."""
    return e.Distance(origin=point, target=box(o))


def to_position_or_box(v: Expression, other: Expression) -> Expression:
    """The distance between a position and the bounding box of an object, or another position."""
    inner = plain(other.value) if isinstance(other, p.Constant) else None
    return to_box(other, v) if isinstance(inner, Instance) and is_object(inner) else e.Distance(origin=v, target=other)


OF_VECTORS: Mapping[str, Rewrite] = {
    "distanceTo": lambda v, other: e.Distance(origin=v, target=other),
    "angleTo": lambda v, other: e.Angle(origin=v, target=other),
    "toVector": lambda v: v,
    "norm": length,
    "dot": lambda v, other: p.BinaryOperation(operator="+", left=product(v, other, "x"), right=product(v, other, "y")),
    "normalized": lambda v: p.BinaryOperation(operator="/", left=v, right=length(v)),
    "rotatedBy": turned,
    "offsetRotated": lambda v, heading, offset: e.OffsetAlong(base=v, direction=heading, offset=offset),
    "offsetRadially": lambda v, radius, heading: e.OffsetAlong(base=v, direction=heading, offset=pair(number(0), radius)),
}
def computed(function: Callable[..., object]) -> Rewrite:
    """A function of the value, by the library."""
    native = Native(function.__name__, function)
    return lambda o: p.Call(function=p.Constant(value=native), arguments=(o,))


def corners_of(r: regions.RectangularRegion) -> tuple[Vector, ...]:
    """The four corners of a rectangle, from the front right one on, anticlockwise."""
    return geometry.corners(r.position, r.heading, r.width, r.length)


def bounding_box(r: regions.Region) -> tuple[tuple[float, float], tuple[float, float]]:
    """The south-west and north-east corners of the box along the axes around a region. Raises ValueError if it is unbounded."""
    bounds = r.bounds()
    if bounds is None:
        raise ValueError("the region is unbounded")
    west, south, east, north = bounds
    return (west, south), (east, north)


def boundary_of(r: regions.PolygonalRegion | regions.RectangularRegion) -> regions.PolylineRegion:
    """The boundary of a polygon or rectangle, with that of holes."""
    if isinstance(r, regions.RectangularRegion):
        first, *others = corners_of(r)
        return regions.PolylineRegion([first, *others, first])
    return regions.PolylineRegion(polyline=r.polygon.boundary)  # type: ignore[arg-type]


def area_of(r: regions.PolygonalRegion | regions.RectangularRegion) -> float:
    """The area of a polygon or rectangle, in square metres."""
    return r.width * r.length if isinstance(r, regions.RectangularRegion) else r.polygon.area


def length_of_line(line: regions.PolylineRegion) -> float:
    """`line.length`."""
    return line.measure()


def points_of(r: regions.PolylineRegion) -> tuple[Vector, ...]:
    """The points of a polyline, from its beginning on."""
    return tuple(point for line in r.lines for point in line)


def start_of(line: regions.PolylineRegion) -> Vector:
    """The first point of a polyline."""
    return line.lines[0][0]


def end_of(line: regions.PolylineRegion) -> Vector:
    """The last point of a polyline."""
    return line.lines[-1][-1]


def oriented(point: Callable[[regions.PolylineRegion], Vector]) -> Rewrite:
    """A point of a polyline, oriented along it: `OrientedPoint at (the point), facing (the heading of the line there)`."""

    def heading_there(line: regions.PolylineRegion) -> float:
        return line.heading_at(point(line))

    return lambda r: e.ObjectDefinition(
        class_=p.Constant(value=ORIENTED_POINT_CLASS),
        specifiers=(q.AtSpecifier(vector=computed(point)(r)), q.FacingSpecifier(direction=computed(heading_there)(r))),
    )


def field_of_regions(regions: list[Region], tolerance: float = 0.0) -> VectorField:
    """A field with the orientation of the first of some regions that has the point, or of the nearest one within `tolerance` metres."""

    @lifted(float)
    def heading(v: Vector) -> float:
        near = next((r for r in regions if r.contains_point(v)), None) or min(regions, key=lambda r: r.distance_to(v), default=None)
        if near is None or near.orientation is None or near.distance_to(v) > max(tolerance, METRES):
            raise OutsideField(field, v)
        return near.orientation.at(v)

    if not all(isinstance(region, Region) for region in regions):
        raise TypeError("forUnionOf() takes a list of regions")
    field = VectorField("union of regions", heading)
    return field


def union_of_lines(lines: list[regions.PolylineRegion]) -> regions.PolylineRegion:
    """All of some polylines, one after the other."""
    return regions.PolylineRegion(polyline=[part for line in lines for part in shapely.get_parts(line.polyline)])


UNION_OF_LINES = Native("unionAll", union_of_lines)
UNIFORM_POINT = Constructor("uniformPointIn", PointIn, keeps_values=False, takes="region")
OF_REGION_CLASS: Mapping[str, Rewrite] = {"uniformPointIn": lambda r: p.Constant(value=UNIFORM_POINT)}
FIELD_OF_REGIONS = Native("forUnionOf", field_of_regions)
OF_FIELD_CLASS: Mapping[str, Rewrite] = {"forUnionOf": lambda f: p.Constant(value=FIELD_OF_REGIONS)}
NOT_GIVEN = p.Constant(value=None)


def follow_from(f: Expression, pos: Expression, dist: Expression, steps: Expression = NOT_GIVEN, stepSize: Expression = NOT_GIVEN) -> Expression:
    """`(follow F from V for S).position`, in so many steps, or in steps of at most that size."""
    if steps is not NOT_GIVEN or stepSize is not NOT_GIVEN:
        f = p.Call(function=p.Constant(value=Native("followFrom", VectorField.stepping)), arguments=(f, steps, stepSize))
    return p.Attribute(value=e.Follow(field=f, origin=pos, distance=dist), name="position")


OF_FIELDS: Mapping[str, Rewrite] = {"followFrom": follow_from}
OF_POLYLINES: Mapping[str, Rewrite] = {
    "length": computed(length_of_line),
    "start": oriented(start_of),
    "points": computed(points_of),
    "end": oriented(end_of),
}
OF_POLYGONS: Mapping[str, Rewrite] = {"boundary": computed(boundary_of), "area": computed(area_of)}
OF_RECTANGLES: Mapping[str, Rewrite] = {**OF_POLYGONS, "corners": computed(corners_of)}
OF_REGIONS: Mapping[str, Rewrite] = {
    "getAABB": computed(bounding_box),
    "distanceTo": lambda r, point: e.Distance(origin=point, target=r),
    "containsObject": lambda r, obj: within(obj, r),
}
SPATIAL: Mapping[type, tuple[Mapping[str, Rewrite], Mapping[str, Rewrite]]] = {
    VectorField: ({}, OF_FIELDS),
    regions.PolylineRegion: (OF_POLYLINES, OF_REGIONS),
    regions.PolygonalRegion: (OF_POLYGONS, OF_REGIONS),
    regions.RectangularRegion: (OF_RECTANGLES, OF_REGIONS),
    regions.Region: ({}, OF_REGIONS),
}
"""The attributes and methods of what is in space, by the first class that a value is of."""


CLASSES: Mapping[type, Mapping[str, Rewrite]] = {
    regions.PolylineRegion: {**OF_REGION_CLASS, "unionAll": lambda r: p.Constant(value=UNION_OF_LINES)},
    regions.Region: OF_REGION_CLASS,
    VectorField: OF_FIELD_CLASS,
}


@dataclass(frozen=True, slots=True)
class Member:
    """A method of the released implementations, of a value."""

    scenic_names: ClassVar[frozenset[str]] = frozenset()
    """What programs may ask of it: nothing."""
    subject: object
    name: str
    rewrite: Rewrite

    def __repr__(self) -> str:
        return f"<method {self.name}>"


def own_name(value: object) -> str | None:
    """`v.__name__` of a function, method, distribution or class of behaviors; None for anything else."""
    match value:
        case Function() | Native() | Bound() | Special() | Constructor() | Member():
            return value.name
        case Method(function=Function(name=name)) | Dynamic(arguments=None, definition=object(name=name)):
            return name
        case _:
            return None


def member(subject: object, name: str, state: State) -> tuple[Rewrite, bool] | None:
    """What an attribute of a value stands for, if the program does not define it, and whether it is a method."""
    inner = plain(subject)
    match inner:
        case Instance():
            if canonical(name, state.settings.readings) in state.objects[inner.number] or inner.class_.method(name) is not None:
                return None
            attributes = {**AXES, **SEEING, **(SIDES if is_object(inner) else {})}
            methods = OF_OBJECTS if is_object(inner) else OF_ORIENTED_POINTS if is_oriented(inner) else OF_POINTS
        case Vector():
            attributes, methods = {"coordinates": coordinates}, OF_VECTORS
        case type() if inner in CLASSES:
            attributes, methods = CLASSES[inner], {}
        case _:
            kind = next((kind for kind in SPATIAL if is_a(inner, kind)), None)
            if kind is None:
                return None
            attributes, methods = SPATIAL[kind]
    if name in attributes:
        return attributes[name], False
    if name == "distanceTo" and isinstance(inner, (Instance, Vector)) and state.reading("distance-method") == "box":
        return (to_box if methods is OF_OBJECTS else to_position_or_box), True
    return (methods[name], True) if name in methods else None


def coordinates(v: Expression) -> Expression:
    """The pair of the coordinates."""
    return p.TupleDisplay(items=(p.Attribute(value=v, name="x"), p.Attribute(value=v, name="y")))


def rewritten(
    node: Node, rewrite: Rewrite, values: tuple[object, ...], stack: Stack, state: State, keywords: Mapping[str, object] = MappingProxyType({})
) -> Outcome:
    """⟦E.name(E_1, ..., E_n)⟧ = ⟦the operator that says the same⟧ of the values of E and E_i, and likewise ⟦E.name⟧."""
    expression = rewrite(
        *(p.Constant(value=v, span=node.span) for v in values), **{name: p.Constant(value=v, span=node.span) for name, v in keywords.items()}
    )
    return Next("E-Member", Config(replace(expression, span=node.span), stack, state), node)


def intersects(node: e.Intersects, stack: Stack, state: State) -> Outcome:
    """The operands of `X intersects Y` come first."""
    return premises(node, [node.left, node.right], meet, stack, state)


def meet(node: e.Intersects, values: list[object], stack: Stack, state: State) -> Outcome:
    """⟦X intersects Y⟧ = ⟦X⟧ ∩ ⟦Y⟧ ≠ ∅, where an object is its bounding box."""
    reader = Reader(state)
    for operand in map(reader.plain, values):
        if not (has_kind(operand, REGION) or has_kind(operand, OBJECT)):
            raise RunError(f"`intersects` expects a region or an Object, not {kind_name(operand)}", node.span, rule="O-Intersects")
    left, right = (box(p.Constant(value=v)) if isinstance(plain(v), Instance) else p.Constant(value=v) for v in values)
    meeting = p.Call(function=p.Attribute(value=left, name="intersects"), arguments=(right,), span=node.span)
    return Next("O-Intersects", Config(meeting, stack, state), node)


def call_member(node: Node, function: Member, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """Apply a method. Raises `HostException` for arguments that it does not take."""
    taken = signature(function.rewrite)
    try:
        taken.bind(function.subject, *arguments, **keywords)
    except TypeError as problem:
        _, *names = taken.parameters
        raise HostException(TypeError(f"{function.name}() takes ({', '.join(names)}): {problem}")) from None
    return rewritten(node, function.rewrite, (function.subject, *arguments), stack, state, keywords)

