"""Vectors, and OrientedPoints: points that operators derive from others."""

from __future__ import annotations

from typing import get_args

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from ...semantics.syntax import specifiers as q
from . import distributions, headings, scalars
from .draft import Draft, Option, first_that_works
from .tree import attribute, call, name, new_object, offset_along, offset_by, pair

VECTOR_SIDES = get_args(e.Side)


def vector(draft: Draft, reach: float, depth: int) -> Expression:
    """A vector, as a rule within `reach` of the origin along both axes."""
    options: list[Option] = [(5, lambda: coordinates(draft, reach, min(depth, 1)))]
    fitting = [v for v in draft.known("vector") if v.high <= reach]
    if fitting:
        options.append((3, lambda: name(draft.choices.pick(fitting).name)))
    options.append((1, lambda: e.VectorOf(x=scalars.scalar(draft, -reach, reach, 0), y=scalars.scalar(draft, -reach, reach, 0))))
    options.append((1, lambda: call("Vector", scalars.scalar_literal(draft, -reach, reach), scalars.scalar(draft, -reach, reach, 0))))
    if depth > 0:
        options += composed_vector(draft, reach, depth - 1)
    return first_that_works(draft, options)


def coordinates(draft: Draft, reach: float, depth: int) -> Expression:
    """`(x, y)`."""
    return pair(scalars.scalar(draft, -reach, reach, depth), scalars.scalar(draft, -reach, reach, depth))


def vector_literal(draft: Draft, reach: float) -> Expression:
    """A pair of numbers."""
    return pair(scalars.scalar_literal(draft, -reach, reach), scalars.scalar_literal(draft, -reach, reach))


def composed_vector(draft: Draft, reach: float, depth: int) -> list[Option]:
    """The vector operators, and choices among vectors."""
    half = reach / 2
    options: list[Option] = [
        (1, lambda: offset_by(vector(draft, half, depth), vector(draft, half, depth))),
        (1, lambda: offset_along(vector(draft, half, depth), direction(draft, depth), vector(draft, half, 0))),
        (1, lambda: e.RelativeTo(left=vector(draft, half, depth), right=vector(draft, half, depth))),
    ]
    if draft.may_draw():
        options.append((1, lambda: distributions.choice(draft, [(1, lambda: vector_literal(draft, reach))])))
    if draft.known("object", "point") and draft.has_ego:
        options.append((2, lambda: attribute(name(draft.choices.pick(draft.known("object", "point")).name), "position")))
        options.append((1, lambda: offset_by(attribute(name("ego"), "position"), vector(draft, half, depth))))
        if draft.allows("released"):
            options.append((3, lambda: e.RelativePosition(target=vector_argument(draft, depth), origin=vector_argument(draft, depth))))
            options.append((1, lambda: e.RelativePosition(target=vector_argument(draft, depth))))
    return options


def direction(draft: Draft, depth: int) -> Expression:
    """What follows `offset along`: a heading or a field."""
    options: list[Option] = [(3, lambda: headings.heading_argument(draft, depth))]
    if draft.known("field"):
        options.append((3, lambda: name(draft.choices.pick(draft.known("field")).name)))
    return first_that_works(draft, options)


def vector_argument(draft: Draft, depth: int) -> Expression:
    """A vector where an operator or specifier takes one: a Point will do."""
    options: list[Option] = [(3, lambda: vector(draft, draft.settings.area, depth))]
    if draft.known("object", "point"):
        options.append((2, lambda: name(draft.choices.pick(draft.known("object", "point")).name)))
    return first_that_works(draft, options)


def oriented_point(draft: Draft, depth: int) -> Expression:
    """An OrientedPoint: one made by specifiers, or derived from an object."""
    reach = draft.settings.area
    options: list[Option] = [(3, lambda: new_object("OrientedPoint", placed(draft, reach, depth)))]
    known = draft.known("object", "point")
    if known:
        options += [
            (2, lambda: offset_by(name(draft.choices.pick(known).name), vector(draft, reach / 4, depth))),
            (2, lambda: e.RelativeTo(left=vector(draft, reach / 4, depth), right=name(draft.choices.pick(known).name))),
        ]
    if draft.known("object"):
        options.append((4, lambda: e.SideOf(side=draft.choices.pick(VECTOR_SIDES), object=name(draft.choices.pick(draft.known("object")).name))))
    if draft.known("field"):
        options.append((6, lambda: followed(draft, depth)))
    return first_that_works(draft, options)


def placed(draft: Draft, reach: float, depth: int) -> list[q.AtSpecifier | q.FacingSpecifier]:
    """`at V, facing H`."""
    found: list[q.AtSpecifier | q.FacingSpecifier] = [q.AtSpecifier(vector=vector(draft, reach, depth))]
    if draft.choices.chance(0.7):
        found.append(q.FacingSpecifier(direction=headings.heading_argument(draft, depth)))
    return found


def followed(draft: Draft, depth: int) -> Expression:
    """`follow F [from V] for S`."""
    field, distance = name(draft.choices.pick(draft.known("field")).name), scalars.scalar(draft, 0, 10, 0)
    if draft.has_ego and draft.choices.chance(0.4):
        return e.Follow(field=field, distance=distance)
    return e.Follow(field=field, distance=distance, origin=vector_argument(draft, depth))
