"""Regions and vector fields."""

from __future__ import annotations

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from . import headings, scalars, vectors
from .draft import Draft, Option, Variable, first_that_works
from .tree import attribute, call, constant, degrees, name, number, operation, pair, visible_from

ANGLES = (90, 180, 270, 360, 40)
"""Degrees of sectors."""


def region(draft: Draft, depth: int) -> Expression:
    """A region; its measure is not 0."""
    options: list[Option] = [
        (3, lambda: call("CircularRegion", centre(draft), radius(draft))),
        (2, lambda: call("RectangularRegion", centre(draft), headings.heading(draft, 0), radius(draft), radius(draft))),
        (2, lambda: call("SectorRegion", centre(draft), radius(draft), headings.heading(draft, 0), degrees(draft.choices.pick(ANGLES)))),
        (1, lambda: call("PolygonalRegion", corners(draft))),
        (1, lambda: polyline(draft)),
        (1, lambda: call("PointSetRegion", constant("spots"), spots(draft))),
    ]
    if depth > 0 and draft.allows("visibility") and draft.has_ego:
        options.append((2, lambda: limited(draft)))
    return first_that_works(draft, options)


def centre(draft: Draft) -> Expression:
    """The centre of a region, not far from the origin."""
    return vectors.vector(draft, draft.settings.area / 4, 1)


def radius(draft: Draft) -> Expression:
    """A length that is not small."""
    reach = draft.settings.area
    return scalars.scalar(draft, reach / 2, 1.5 * reach, 1)


def corners(draft: Draft) -> Expression:
    """The corners of a convex polygon around the origin, anticlockwise."""
    reach = draft.settings.area
    east, north, west, south = (number(draft.choices.pick([reach, reach / 2])) for _ in range(4))
    return p.ListDisplay(items=(pair(east, number(0)), pair(number(0), north), pair(negative(west), number(1)), pair(number(0), negative(south))))


def negative(node: Expression) -> Expression:
    """`-a`."""
    return p.UnaryOperation(operator="-", operand=node)


def polyline(draft: Draft) -> Expression:
    """A curve, which orients what stands on it, or not."""
    reach = draft.settings.area
    ends = [pair(number(k * reach / 2 - reach), scalars.scalar_literal(draft, -reach, reach)) for k in range(draft.choices.integer(2, 4))]
    points = p.ListDisplay(items=tuple(ends))
    return call("PolylineRegion", points) if draft.choices.chance(0.7) else call("PolylineRegion", points, orientation=constant(False))


def spots(draft: Draft) -> Expression:
    """Some points: as many draws as points are counted, even where no draw follows."""
    reach = draft.settings.area
    return p.ListDisplay(items=tuple(pair(number(k * 5 - 10), scalars.scalar_literal(draft, -reach, reach)) for k in range(3)))


def limited(draft: Draft) -> Expression:
    """`visible R`, `R visible from P`."""
    inner = name(draft.choices.pick(draft.known("region")).name) if draft.known("region") else name("everywhere")
    if draft.choices.chance(0.5):
        return e.Visible(region=inner)
    return visible_from(inner, name(draft.choices.pick(draft.known("object", "point")).name))


def region_argument(draft: Draft) -> Expression:
    """A region where one is asked about: a variable, or one made on the spot."""
    options: list[Option] = [(1, lambda: region(draft, 1))]
    if draft.known("region"):
        options.append((3, lambda: name(draft.choices.pick(draft.known("region")).name)))
    return first_that_works(draft, options)


def field(draft: Draft) -> Expression:
    """`VectorField('name', lambda v: E)`."""
    with draft.block(), draft.without_draws():
        at = draft.fresh("v")
        options: list[Option] = [
            (2, lambda: headings.heading_literal(draft)),
            (3, lambda: operation(attribute(name(at), draft.choices.pick(["x", "y"])), "*", degrees(draft.choices.pick([2, 5, -3])))),
            (1, lambda: operation(attribute(name(at), "x"), "/", number(10))),
            (1, lambda: e.Angle(origin=name(at), target=vectors.vector_literal(draft, draft.settings.area))),
        ]
        if draft.known("heading"):
            options.append((2, lambda: name(draft.choices.pick(draft.known("heading")).name)))
        body = first_that_works(draft, options)
    function = p.Lambda(parameters=(p.Parameter(name=at),), body=body)
    return call("VectorField", constant("field"), function)


def defined_field(draft: Draft) -> Variable:
    """The variable that a field is bound to."""
    return Variable(draft.fresh("f"), "field")
