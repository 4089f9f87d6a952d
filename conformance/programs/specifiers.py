"""Specifiers: combinations that Algorithm 1 accepts, in any order."""

from __future__ import annotations

from typing import Literal, NamedTuple

from ...semantics.syntax import Expression, Specifier
from ...semantics.syntax import expressions as e
from ...semantics.syntax import specifiers as q
from ...semantics.syntax.python_expressions import Attribute, Name
from . import booleans, headings, regions, scalars, vectors
from .draft import Class, Draft
from .tree import call, constant, degrees, name, number, pair

Side = Literal["left", "right", "ahead", "behind"]
SIDES: tuple[Side, ...] = ("ahead", "behind", "left", "right")


class PlaceSpecifier(NamedTuple):
    """A position specifier, if any; whether it depends on the heading, so that no heading may depend on the position."""

    specifier: Specifier | None
    needs_heading: bool = False


def specifiers(draft: Draft, class_: Class, depth: int) -> list[Specifier]:
    """The specifiers of an object, in random order."""
    place = position(draft, depth)
    found = [place.specifier] if place.specifier is not None else []
    if draft.choices.chance(0.6):
        found.append(facing(draft, depth, free=not place.needs_heading))
    found += properties(draft, class_, depth)
    if class_.is_object and draft.choices.chance(overlapping(draft, place.specifier)):
        found.append(q.WithSpecifier(property="allowCollisions", value=booleans.flag(draft, 1)))
    return draft.choices.some(found, len(found), len(found)) if draft.choices.chance(0.5) else found


def overlapping(draft: Draft, place: Specifier | None) -> float:
    """How often an object with this position may overlap others: where it would as a rule, nearly always."""
    match place:
        case None | q.AtSpecifier(vector=Attribute()) | q.BesideSpecifier(gap=None):
            return 0.95
        case q.AtSpecifier(vector=Name()) | q.OffsetBySpecifier(offset=Attribute()):
            return 0.7
        case _:
            return 0.9 if draft.repeats > 1 else 0.15


def position(draft: Draft, depth: int) -> PlaceSpecifier:
    """A position specifier of any form that can be written here."""
    reach = draft.settings.area
    forms: list[tuple[int, str]] = [(6, "at"), (1, "none"), (1, "beside a vector")]
    if draft.known("object", "point"):
        forms += [(5, "beside"), (1, "beyond from")]
    if draft.has_ego:
        forms += [(2, "offset by"), (2, "offset along"), (2, "beyond")]
        if draft.known("field"):
            forms.append((5, "following"))
    if draft.known("field"):
        forms.append((3, "following from"))
    if can_sample(draft):
        forms += [(4, "in")] if draft.allows("regions") else []
        forms += [(5, "visible")] if draft.allows("visibility") and draft.has_ego else []
    match draft.choices.weighted(forms):
        case "at":
            return PlaceSpecifier(q.AtSpecifier(vector=vectors.vector(draft, reach, depth)))
        case "beside a vector":
            return PlaceSpecifier(beside(draft, vectors.vector(draft, reach, 1)), needs_heading=True)
        case "beside":
            return PlaceSpecifier(beside(draft, name(draft.choices.pick(draft.known("object", "point")).name)))
        case "offset by":
            return PlaceSpecifier(q.OffsetBySpecifier(offset=vectors.vector(draft, reach / 2, depth)))
        case "offset along":
            return PlaceSpecifier(q.OffsetAlongSpecifier(direction=vectors.direction(draft, 1), offset=vectors.vector(draft, reach / 2, 1)))
        case "beyond" | "beyond from" as form:
            return PlaceSpecifier(beyond(draft, from_ego=form == "beyond"))
        case "following" | "following from" as form:
            return PlaceSpecifier(following(draft, from_ego=form == "following"))
        case "in":
            return PlaceSpecifier(q.InSpecifier(keyword=draft.choices.pick(["in", "on"]), region=regions.region_argument(draft)))
        case "visible":
            return PlaceSpecifier(visible(draft))
        case _:
            return PlaceSpecifier(None)


def can_sample(draft: Draft) -> bool:
    """Whether a random point of a region may stand here."""
    return draft.may_draw() and not draft.settings.finite


def beside(draft: Draft, reference: Expression) -> q.BesideSpecifier:
    """`left of X [by S]`, ...; without a distance two objects touch."""
    gap = None if draft.choices.chance(0.1) else scalars.scalar(draft, 0.25, 5, 1)
    return q.BesideSpecifier(side=draft.choices.pick(SIDES), reference=reference, gap=gap)


def beyond(draft: Draft, *, from_ego: bool) -> q.BeyondSpecifier:
    """`beyond V by V [from V]`."""
    offset = pair(scalars.scalar(draft, -3, 3, 0), scalars.scalar(draft, 1, 6, 0))
    vector = vectors.vector_argument(draft, 1)
    return q.BeyondSpecifier(vector=vector, offset=offset, origin=None if from_ego else vectors.vector_argument(draft, 1))


def following(draft: Draft, *, from_ego: bool) -> q.FollowingSpecifier:
    """`following F [from V] for S`."""
    field, distance = name(draft.choices.pick(draft.known("field")).name), scalars.scalar(draft, 3, 12, 1)
    return q.FollowingSpecifier(field=field, distance=distance, origin=None if from_ego else vectors.vector_argument(draft, 1))


def visible(draft: Draft) -> q.VisibleSpecifier:
    """`visible [from P]`."""
    return q.VisibleSpecifier(viewer=None if draft.choices.chance(0.5) else name(draft.choices.pick(draft.known("object", "point")).name))


def facing(draft: Draft, depth: int, *, free: bool) -> Specifier:
    """A heading specifier; one that depends on the position only if `free`."""
    forms: list[tuple[int, str]] = [(4, "facing"), (1, "with")]
    if free:
        forms += [(2, "toward"), (2, "away"), (1, "apparently from")]
        forms += [(2, "apparently")] if draft.has_ego else []
        forms += [(3, "field"), (3, "relative")] if draft.known("field") else []
        forms += [(12, "waiting")] if draft.known("waiting") else []
    match draft.choices.weighted(forms):
        case "with":
            return q.WithSpecifier(property="heading", value=headings.heading_argument(draft, 1))
        case "toward":
            return q.FacingTowardSpecifier(vector=vectors.vector_argument(draft, 1))
        case "away":
            return q.FacingAwayFromSpecifier(vector=vectors.vector_argument(draft, 1))
        case "apparently":
            return q.ApparentlyFacingSpecifier(heading=headings.heading_argument(draft, 1))
        case "apparently from":
            return q.ApparentlyFacingSpecifier(heading=headings.heading_argument(draft, 1), origin=vectors.vector_argument(draft, 1))
        case "field":
            return q.FacingSpecifier(direction=name(draft.choices.pick(draft.known("field")).name))
        case "relative":
            return q.FacingSpecifier(direction=relative(draft))
        case "waiting":
            waiting = name(draft.choices.pick(draft.known("waiting")).name)
            direction = call("max", waiting, headings.heading_literal(draft)) if draft.choices.chance(0.2) else waiting
            return q.FacingSpecifier(direction=direction)
        case _:
            return q.FacingSpecifier(direction=headings.heading_argument(draft, depth))


def relative(draft: Draft) -> Expression:
    """`H relative to F`, `F relative to H`, `F relative to F`: it waits for the position of the object."""
    field = name(draft.choices.pick(draft.known("field")).name)
    match draft.choices.integer(0, 2):
        case 0:
            return e.RelativeTo(left=headings.heading(draft, 0), right=field)
        case 1:
            return e.RelativeTo(left=field, right=headings.heading(draft, 0))
        case _:
            return e.RelativeTo(left=field, right=name(draft.choices.pick(draft.known("field")).name))


def properties(draft: Draft, class_: Class, depth: int) -> list[Specifier]:
    """`with property E` for some properties."""
    ranges = {"width": (0.5, 3.0), "length": (0.5, 3.0), "speed": (0.0, 5.0)} if class_.is_object else {}
    ranges |= {each.name: (each.low, each.high) for each in class_.properties}
    chosen = draft.choices.some(list(ranges), 0, 2)
    found: list[Specifier] = [q.WithSpecifier(property=each, value=scalars.scalar(draft, *ranges[each], depth)) for each in chosen]
    if draft.choices.chance(0.1):
        found.append(q.WithSpecifier(property="tag", value=constant(draft.choices.pick(["red", "blue"]))))
    if class_.is_object and draft.allows("visibility") and draft.choices.chance(0.3):
        found.append(seeing(draft))
    if class_.is_object and draft.allows("workspace") and draft.known("region") and draft.choices.chance(0.3):
        wide = call("CircularRegion", vectors.vector_literal(draft, 2), number(2 * draft.settings.area))
        found.append(q.WithSpecifier(property="regionContainedIn", value=wide))
    return found


def seeing(draft: Draft) -> Specifier:
    """How far and how wide an object sees, or whether it must be seen."""
    match draft.choices.integer(0, 2):
        case 0:
            return q.WithSpecifier(property="requireVisible", value=booleans.flag(draft, 0.3))
        case 1:
            return q.WithSpecifier(property=draft.view_distance, value=scalars.scalar(draft, 30, 60, 1))
        case _:
            return q.WithSpecifier(property="viewAngle", value=degrees(draft.choices.pick([360, 270, 200, 400])))
