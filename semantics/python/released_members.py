"""Attributes and methods of the released implementations that say what an operator says: `o.distanceTo(v)` is `distance from o to v`.

Each is a rewriting into an operator, of values that are known already; so it means the same in every backend. A property or method that the
program defines comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from inspect import signature
from types import MappingProxyType
from typing import get_args

import shapely

from ..machine.config import Config, Stack, State
from ..machine.host_calls import HostException
from ..machine.operand_kinds import (
    FLAT,
    OBJECT,
    REGION,
    Reader,
    has_kind,
    is_a,
    is_object,
    is_oriented,
    kind_name,
)
from ..machine.outcome import Next, Outcome
from ..machine.premises import premises
from ..machine.values import (
    Applicable,
    Bound,
    Constructor,
    Dynamic,
    Function,
    Instance,
    Method,
    Native,
    Special,
    value_in_run,
)
from ..space import geometry, regions
from ..space.boundaries import METRES
from ..space.distributions import PointIn
from ..space.fields import OutsideField, VectorField
from ..space.numeric_functions import lift_method
from ..space.regions import Region
from ..space.vectors import Vector
from ..store.built_in_classes import ORIENTED_POINT_CLASS, canonical
from ..store.errors import RunError
from ..store.scenic_classes import name_in_messages
from ..store.sets import FrozenSet, Set
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax import specifiers as q
from ..syntax.nodes import Expression, Node
from .functions import make_function

Rewrite = Callable[..., Expression]
"""From the value and the arguments, as expressions, to what the member stands for."""
ZERO = p.Constant(value=Vector(0.0, 0.0))
NORMALISED = Native("normalizeAngle", geometry.normalise_heading)


def pair(x: Expression, y: Expression) -> Expression:
    """Return the expression (x, y)."""
    return e.VectorOf(x=x, y=y)


def number_constant(x: float) -> Expression:
    """Return the expression for a number."""
    return p.Constant(value=x)


def box(o: Expression) -> Expression:
    """The bounding box of an object, as a region."""
    properties = (p.Attribute(value=o, name=name) for name in ("position", "heading", "width", "length"))
    return p.Call(function=p.Constant(value=regions.RectangularRegion), arguments=tuple(properties))


def boxes_meet(o: Expression, other: Expression) -> Expression:
    """Whether the bounding boxes of two objects share a point."""
    return p.Call(function=p.Attribute(value=box(o), name="intersects"), arguments=(box(other),))


def membership_test(point: Expression, region: Expression) -> Expression:
    """`point in region`."""
    return p.Comparison(left=point, operators=("in",), operands=(region,))


def length(v: Expression) -> Expression:
    """The length of a vector."""
    return e.Distance(origin=ZERO, target=v)


def rotated_vector(v: Expression, angle: Expression) -> Expression:
    """The vector, rotated anticlockwise."""
    return e.OffsetAlong(base=ZERO, direction=angle, offset=v)


def direction(v: Expression) -> Expression:
    """The heading of a vector."""
    return e.Angle(origin=ZERO, target=v)


def normalised_angle(angle: Expression) -> Expression:
    """The angle in (-π, π] that is the same up to full turns."""
    return p.Call(function=p.Constant(value=NORMALISED), arguments=(angle,))


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
    return lambda o: p.BinaryOperation(operator="/", left=p.Attribute(value=o, name=name), right=number_constant(2))


SIDES: Mapping[str, Rewrite] = {
    "hw": half("width"), "hl": half("length"), **dict.fromkeys(("polygon", "_boundingPolygon"), lambda o: p.Attribute(value=box(o), name="polygon")),
    "left": side("left"), "right": side("right"), "front": side("front"), "back": side("back"), "frontLeft": side("front left"),
    "frontRight": side("front right"), "backLeft": side("back left"), "backRight": side("back right"), "corners": corners,
}  # fmt: skip
AXES: Mapping[str, Rewrite] = {
    axis: lambda o, axis=axis: p.Attribute(value=p.Attribute(value=o, name="position"), name=axis) for axis in ("x", "y")
}
"""The coordinates of a point's position, which has no properties of these names."""
SEEING: Mapping[str, Rewrite] = {"visibleRegion": lambda o: e.VisibleFrom(region=p.Constant(value=regions.everywhere), viewer=o)}

NOT_GIVEN = p.Constant(value=None)


def can_see(o: Expression, other: Expression, occludingObjects: Expression = NOT_GIVEN, debug: Expression = NOT_GIVEN) -> Expression:
    """`o can see other`. Raises `HostException` if there are objects that would hide it; `debug`, of Scenic 3, draws a picture."""
    hiding = value_in_run(occludingObjects.value) if isinstance(occludingObjects, p.Constant) else occludingObjects
    if not (hiding is None or (isinstance(hiding, (tuple, list, Set, FrozenSet)) and not hiding)):
        error = TypeError("occludingObjects= must be empty: no object hides another one in this reference")
        error.add_note("leave it out, or write occludingObjects=()")
        raise HostException(error)
    return e.CanSee(viewer=o, target=other)


OF_POINTS: Mapping[str, Rewrite] = {
    "toVector": lambda o: p.Attribute(value=o, name="position"),
    "distanceTo": lambda o, point: e.Distance(origin=o, target=point),
    "angleTo": lambda o, other: e.Angle(origin=o, target=other),
    "canSee": can_see,
}
OF_ORIENTED_POINTS: Mapping[str, Rewrite] = {
    **OF_POINTS,
    "toHeading": lambda o: p.Attribute(value=o, name="heading"),
    "distancePast": lambda o, vec: e.DistancePast(oriented_point=o, vector=vec),
    "relativize": lambda o, vec: e.RelativeTo(left=vec, right=o),
    "relativePosition": lambda o, vec: p.Attribute(value=e.RelativeTo(left=vec, right=o), name="position"),
}
OF_OBJECTS: Mapping[str, Rewrite] = {
    **OF_ORIENTED_POINTS, "containsPoint": lambda o, point: membership_test(point, box(o)), "intersects": boxes_meet,
}  # fmt: skip


def to_box(o: Expression, point: Expression) -> Expression:
    """The distance between the bounding box of an object and a position."""
    return e.Distance(origin=point, target=box(o))


def to_position_or_box(v: Expression, other: Expression) -> Expression:
    """The distance between a position and the bounding box of an object, or another position."""
    inner = value_in_run(other.value) if isinstance(other, p.Constant) else None
    return to_box(other, v) if isinstance(inner, Instance) and is_object(inner) else e.Distance(origin=v, target=other)


OF_VECTORS: Mapping[str, Rewrite] = {
    "distanceTo": lambda v, other: e.Distance(origin=v, target=other),
    "angleTo": lambda v, other: e.Angle(origin=v, target=other),
    "azimuthTo": lambda v, other: e.Angle(origin=v, target=other),
    "angleWith": lambda v, other: normalised_angle(p.BinaryOperation(operator="-", left=direction(other), right=direction(v))),
    "toVector": lambda v: v,
    "norm": length,
    "dot": lambda v, other: p.BinaryOperation(operator="+", left=product(v, other, "x"), right=product(v, other, "y")),
    "normalized": lambda v: p.BinaryOperation(operator="/", left=v, right=length(v)),
    "rotatedBy": rotated_vector,
    "offsetRotated": lambda v, angleOrOrientation, offset: e.OffsetAlong(base=v, direction=angleOrOrientation, offset=offset),
    "offsetLocally": lambda v, orientation, offset: e.OffsetAlong(base=v, direction=orientation, offset=offset),
    "offsetRadially": lambda v, radius, heading: e.OffsetAlong(base=v, direction=heading, offset=pair(number_constant(0), radius)),
}
def library_rewrite(function: Callable[..., object]) -> Rewrite:
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


def polygon_of_rectangle(r: regions.RectangularRegion) -> regions.PlaneShape:
    """The polygon of a rectangle."""
    return regions.PolygonalRegion(corners_of(r)).plane_shape


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


def oriented_point_rewrite(point: Callable[[regions.PolylineRegion], Vector]) -> Rewrite:
    """A point of a polyline, oriented along it: `OrientedPoint at (the point), facing (the heading of the line there)`."""

    def heading_there(line: regions.PolylineRegion) -> float:
        return line.heading_at(point(line))

    return lambda r: e.ObjectDefinition(
        class_=p.Constant(value=ORIENTED_POINT_CLASS),
        specifiers=(q.AtSpecifier(vector=library_rewrite(point)(r)), q.FacingSpecifier(direction=library_rewrite(heading_there)(r))),
    )


def field_of_regions(regions: list[Region], tolerance: float = 0.0) -> VectorField:
    """A field with the orientation of the first of some regions that has the point, or of the nearest one within `tolerance` metres."""

    @lift_method(float)
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


def union_of_polygons(polygons: list[Region], buf: float = 0) -> regions.PolygonalRegion:
    """`PolygonalRegion.unionAll(regions)`: all of some polygons."""
    if buf != 0:
        raise TypeError("buf= is outside this reference: polygons are put together as they are; leave it out")
    return regions.PolygonalRegion(polygon=polygons)  # type: ignore[arg-type]


UNION_OF_POLYGONS = Native("unionAll", union_of_polygons)
FIELD_OF_REGIONS = Native("forUnionOf", field_of_regions)
OF_FIELD_CLASS: Mapping[str, Rewrite] = {"forUnionOf": lambda f: p.Constant(value=FIELD_OF_REGIONS)}
def follow_from(f: Expression, pos: Expression, dist: Expression, steps: Expression = NOT_GIVEN, stepSize: Expression = NOT_GIVEN) -> Expression:
    """`(follow F from V for S).position`, in so many steps, or in steps of at most that size."""
    if steps is not NOT_GIVEN or stepSize is not NOT_GIVEN:
        f = p.Call(function=p.Constant(value=Native("followFrom", VectorField.stepping)), arguments=(f, steps, stepSize))
    return p.Attribute(value=e.Follow(field=f, origin=pos, distance=dist), name="position")


OF_FIELDS: Mapping[str, Rewrite] = {"followFrom": follow_from, "valueAt": lambda f, pos: e.FieldAt(field=f, vector=pos)}
OF_POLYLINES: Mapping[str, Rewrite] = {
    "length": library_rewrite(length_of_line),
    "start": oriented_point_rewrite(start_of),
    "points": library_rewrite(points_of),
    "end": oriented_point_rewrite(end_of),
}
OF_POLYGONS: Mapping[str, Rewrite] = {"boundary": library_rewrite(boundary_of), "area": library_rewrite(area_of)}
OF_RECTANGLES: Mapping[str, Rewrite] = {**OF_POLYGONS, "corners": library_rewrite(corners_of), "polygon": library_rewrite(polygon_of_rectangle)}
OF_REGIONS: Mapping[str, Rewrite] = {
    "getAABB": library_rewrite(bounding_box),
    "distanceTo": lambda r, point: e.Distance(origin=point, target=r),
    "containsObject": lambda r, obj: membership_test(obj, r),
}
SPATIAL: Mapping[type, tuple[Mapping[str, Rewrite], Mapping[str, Rewrite]]] = {
    VectorField: ({}, OF_FIELDS),
    regions.PolylineRegion: (OF_POLYLINES, OF_REGIONS),
    regions.PolygonalRegion: (OF_POLYGONS, OF_REGIONS),
    regions.RectangularRegion: (OF_RECTANGLES, OF_REGIONS),
    regions.Region: ({}, OF_REGIONS),
}
"""The attributes and methods of what is in space, by the first class that a value is of."""


def given_or_none(argument: Expression) -> Expression | None:
    """An argument that may be left out, or be None."""
    return None if isinstance(argument, p.Constant) and argument.value is None else argument


def angle_between(X: Expression = NOT_GIVEN, Y: Expression = NOT_GIVEN) -> Expression:
    """`angle [from X] [to Y]`."""
    return e.Angle(origin=given_or_none(X), target=given_or_none(Y))


def side_function(words: e.Side) -> Rewrite:
    """`front of X` and its siblings, of a parameter with the releases' name."""
    return lambda X: e.SideOf(side=words, object=X)


def outside_the_plane(name: str) -> Rewrite:
    """An operator of three dimensions, which is refused by its name."""

    def refuse(X: Expression = NOT_GIVEN, Y: Expression = NOT_GIVEN) -> Expression:
        raise HostException(TypeError(f"{name}() {FLAT}"))

    return refuse


OPERATOR_FUNCTIONS: Mapping[str, Rewrite] = {
    "Visible": lambda region: e.Visible(region=region),
    "NotVisible": lambda region: e.NotVisible(region=region),
    **{"".join(map(str.capitalize, words.split())): side_function(words) for words in get_args(e.Side)},
    "RelativeHeading": lambda X, Y=NOT_GIVEN: e.RelativeHeading(heading=X, origin=given_or_none(Y)),
    "ApparentHeading": lambda X, Y=NOT_GIVEN: e.ApparentHeading(oriented_point=X, origin=given_or_none(Y)),
    "RelativePosition": lambda X, Y=NOT_GIVEN: e.RelativePosition(target=X, origin=given_or_none(Y)),
    "DistanceFrom": lambda X, Y=NOT_GIVEN: e.Distance(origin=X, target=given_or_none(Y)),
    "DistancePast": lambda X, Y=NOT_GIVEN: e.DistancePast(vector=X, oriented_point=given_or_none(Y)),
    "AngleTo": lambda X: e.Angle(target=X),
    "AngleFrom": angle_between,
    "Follow": lambda F, X, D: e.Follow(field=F, origin=X, distance=D),
    "FieldAt": lambda X, Y: e.FieldAt(field=X, vector=Y),
    "RelativeTo": lambda X, Y: e.RelativeTo(left=X, right=Y),
    "OffsetAlong": lambda X, H, Y: e.OffsetAlong(base=X, direction=H, offset=Y),
    "CanSee": lambda X, Y: e.CanSee(viewer=X, target=Y),
    "Intersects": lambda X, Y: e.Intersects(left=X, right=Y),
    "VisibleFromOp": lambda region, base: e.VisibleFrom(region=region, viewer=base),
    "NotVisibleFromOp": lambda region, base: e.NotVisible(region=region, viewer=base),
    **{name: outside_the_plane(name) for name in ("AltitudeTo", "AltitudeFrom", "Top", "Bottom")},
}
"""The functions behind operators that the releases give to every program, with the names of their parameters."""


@name_in_messages("function")
@dataclass(frozen=True, slots=True)
class OperatorFunction(Applicable):
    """A function that says what an operator says: `DistanceFrom(X, Y)` is `distance from X to Y`."""

    name: str
    rewrite: Rewrite

    def __repr__(self) -> str:
        return f"<function {self.name}>"


CLASSES: Mapping[type, Mapping[str, Rewrite]] = {
    regions.PolylineRegion: {**OF_REGION_CLASS, "unionAll": lambda r: p.Constant(value=UNION_OF_LINES)},
    regions.PolygonalRegion: {**OF_REGION_CLASS, "unionAll": lambda r: p.Constant(value=UNION_OF_POLYGONS)},
    regions.Region: OF_REGION_CLASS,
    VectorField: OF_FIELD_CLASS,
}


@name_in_messages("method")
@dataclass(frozen=True, slots=True)
class Member(Applicable):
    """A method of the released implementations, of a value."""

    subject: object
    name: str
    rewrite: Rewrite

    def __repr__(self) -> str:
        return f"<method {self.name}>"


def own_name(value: object) -> str | None:
    """`v.__name__` of a function, method, distribution or class of behaviors; None for anything else."""
    match value:
        case Function() | Native() | Bound() | Special() | Constructor() | Member() | OperatorFunction():
            return value.name
        case Method(function=Function(name=name)) | Dynamic(arguments=None, definition=object(name=name)):
            return name
        case _:
            return None


def member(subject: object, name: str, state: State) -> tuple[Rewrite, bool] | None:
    """Return the rewriting of an attribute of a value, if the program does not define it, and whether it is a
    method.
    """
    inner = value_in_run(subject)
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
    left, right = (box(p.Constant(value=v)) if isinstance(value_in_run(v), Instance) else p.Constant(value=v) for v in values)
    meeting = p.Call(function=p.Attribute(value=left, name="intersects"), arguments=(right,), span=node.span)
    return Next("O-Intersects", Config(meeting, stack, state), node)


def call_member(
    node: Node, function: Member | OperatorFunction, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State
) -> Outcome:
    """Apply a method, or a function that says what an operator says. Raises `HostException` for arguments that it does not take."""
    subjects = (function.subject,) if isinstance(function, Member) else ()
    taken = signature(function.rewrite)
    try:
        taken.bind(*subjects, *arguments, **keywords)
    except TypeError as problem:
        names = list(taken.parameters)[len(subjects) :]
        raise HostException(TypeError(f"{function.name}() takes ({', '.join(names)}): {problem}")) from None
    return rewritten(node, function.rewrite, (*subjects, *arguments), stack, state, keywords)


def as_function(argument: object, state: State) -> object:
    """A method or function that says what an operator says, as a function of the program, which host code can call."""
    if not isinstance(argument, (Member, OperatorFunction)):
        return argument
    call = p.Call(function=p.Constant(value=argument), arguments=(p.Starred(value=p.Name(name="arguments")),))
    return make_function(p.Lambda(parameters=(p.Parameter(name="arguments", kind="*args"),), body=call), [], state)
