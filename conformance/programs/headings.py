"""Headings, in radians: degrees that wrap, sums of headings, directions of operators."""

from __future__ import annotations

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from . import distributions, scalars, vectors
from .draft import Draft, Option, first_that_works
from .tree import attribute, call, degrees, field_at, name, operation

NOTABLE = (0, 90, 45, -30, 180, 170, -190, 270, 360, -90, 10, 720)
"""Degrees that go round the circle, or nearly so."""


def heading_literal(draft: Draft) -> Expression:
    """`170 deg`."""
    return degrees(draft.choices.pick(NOTABLE)) if draft.choices.chance(0.7) else scalars.scalar_literal(draft, -3, 3)


def heading(draft: Draft, depth: int) -> Expression:
    """A heading."""
    options: list[Option] = [(4, lambda: heading_literal(draft))]
    if draft.may_draw():
        options += [(2, lambda: distributions.choice(draft, [(1, lambda: heading_literal(draft))])), (2, lambda: turned(draft, depth))]
    if draft.known("heading"):
        options.append((4, lambda: name(draft.choices.pick(draft.known("heading")).name)))
    if depth > 0:
        options += composed_heading(draft, depth - 1)
    return first_that_works(draft, options)


def turned(draft: Draft, depth: int) -> Expression:
    """`Range(a, b) deg`, or `Uniform(a, b) deg`: also across the half turn."""
    low = draft.choices.pick([0, -90, 100, 170, -190])
    return degrees(scalars.scalar(draft, low, low + draft.choices.pick([10, 45, 90]), min(depth, 1)))


def composed_heading(draft: Draft, depth: int) -> list[Option]:
    """The ways to put headings together."""
    options: list[Option] = [
        (2, lambda: e.RelativeTo(left=heading(draft, depth), right=heading_argument(draft, depth))),
        (1, lambda: operation(heading(draft, depth), draft.choices.pick(["+", "-"]), heading(draft, 0))),
        (1, lambda: e.Angle(origin=vectors.vector_argument(draft, depth), target=vectors.vector_argument(draft, depth))),
        (1, lambda: e.RelativeHeading(heading=heading(draft, depth), origin=heading_argument(draft, depth))),
        (1, lambda: call("abs", heading(draft, depth))),
    ]
    if draft.known("field"):
        options.append((3, lambda: field_at(name(draft.choices.pick(draft.known("field")).name), vectors.vector_argument(draft, depth))))
    if draft.known("object", "point"):
        options.append((2, lambda: attribute(name(draft.choices.pick(draft.known("object", "point")).name), "heading")))
    return options


def heading_argument(draft: Draft, depth: int) -> Expression:
    """A heading where an operator or specifier takes one: an OrientedPoint or Object will do."""
    options: list[Option] = [(3, lambda: heading(draft, depth))]
    if draft.known("object", "point"):
        options.append((1, lambda: name(draft.choices.pick(draft.known("object", "point")).name)))
    return first_that_works(draft, options)
