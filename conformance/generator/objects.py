"""Object and class definitions of generated programs, with specifiers that Algorithm 1 accepts, in any order."""

from __future__ import annotations

from typing import Literal, NamedTuple

from ...semantics.syntax import Expression, Specifier
from ...semantics.syntax import expressions as e
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s
from ...semantics.syntax.python_expressions import Attribute, Name
from . import expressions
from .ast_builders import as_whole_value, attribute, call, constant_literal, degrees, name, new_object, number_literal, operation, pair
from .program_draft import Class, Draft, Property

Side = Literal["left", "right", "ahead", "behind"]
SIDES: tuple[Side, ...] = ("ahead", "behind", "left", "right")


class PlaceSpecifier(NamedTuple):
    """A position specifier, if any; whether it depends on the heading, so that no heading may depend on the position."""

    specifier: Specifier | None
    needs_heading: bool = False


def random_specifiers(draft: Draft, class_: Class, depth: int) -> list[Specifier]:
    """The specifiers of an object, in random order."""
    place = position(draft, depth)
    found = [place.specifier] if place.specifier is not None else []
    if draft.choices.chance(0.6):
        found.append(heading_specifier(draft, depth, free=not place.needs_heading))
    found += properties(draft, class_, depth)
    if class_.is_object and draft.choices.chance(overlap_chance(draft, place.specifier)):
        found.append(q.WithSpecifier(property="allowCollisions", value=expressions.flag(draft, 1)))
    return draft.choices.some(found, len(found), len(found)) if draft.choices.chance(0.5) else found


def overlap_chance(draft: Draft, place: Specifier | None) -> float:
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
            return PlaceSpecifier(q.AtSpecifier(vector=expressions.vector_expression(draft, reach, depth)))
        case "beside a vector":
            return PlaceSpecifier(beside_specifier(draft, expressions.vector_expression(draft, reach, 1)), needs_heading=True)
        case "beside":
            return PlaceSpecifier(beside_specifier(draft, name(draft.choices.pick(draft.known("object", "point")).name)))
        case "offset by":
            return PlaceSpecifier(q.OffsetBySpecifier(offset=expressions.vector_expression(draft, reach / 2, depth)))
        case "offset along":
            return PlaceSpecifier(
                q.OffsetAlongSpecifier(direction=expressions.direction(draft, 1), offset=expressions.vector_expression(draft, reach / 2, 1))
            )
        case "beyond" | "beyond from" as form:
            return PlaceSpecifier(beyond(draft, from_ego=form == "beyond"))
        case "following" | "following from" as form:
            return PlaceSpecifier(following_specifier(draft, from_ego=form == "following"))
        case "in":
            return PlaceSpecifier(q.InSpecifier(keyword=draft.choices.pick(["in", "on"]), region=expressions.region_argument(draft)))
        case "visible":
            return PlaceSpecifier(visible(draft))
        case _:
            return PlaceSpecifier(None)


def can_sample(draft: Draft) -> bool:
    """Whether a random point of a region may stand here."""
    return draft.may_draw() and not draft.settings.finite


def beside_specifier(draft: Draft, reference: Expression) -> q.BesideSpecifier:
    """`left of X [by S]`, ...; without a distance two objects touch."""
    gap = None if draft.choices.chance(0.1) else expressions.scalar(draft, 0.25, 5, 1)
    return q.BesideSpecifier(side=draft.choices.pick(SIDES), reference=reference, gap=gap)


def beyond(draft: Draft, *, from_ego: bool) -> q.BeyondSpecifier:
    """`beyond V by V [from V]`."""
    offset = pair(expressions.scalar(draft, -3, 3, 0), expressions.scalar(draft, 1, 6, 0))
    vector = expressions.vector_argument(draft, 1)
    return q.BeyondSpecifier(vector=vector, offset=offset, origin=None if from_ego else expressions.vector_argument(draft, 1))


def following_specifier(draft: Draft, *, from_ego: bool) -> q.FollowingSpecifier:
    """`following F [from V] for S`."""
    field, distance = name(draft.choices.pick(draft.known("field")).name), expressions.scalar(draft, 3, 12, 1)
    return q.FollowingSpecifier(field=field, distance=distance, origin=None if from_ego else expressions.vector_argument(draft, 1))


def visible(draft: Draft) -> q.VisibleSpecifier:
    """`visible [from P]`."""
    return q.VisibleSpecifier(viewer=None if draft.choices.chance(0.5) else name(draft.choices.pick(draft.known("object", "point")).name))


def heading_specifier(draft: Draft, depth: int, *, free: bool) -> Specifier:
    """A heading specifier; one that depends on the position only if `free`."""
    forms: list[tuple[int, str]] = [(4, "facing"), (1, "with")]
    if free:
        forms += [(2, "toward"), (2, "away"), (1, "apparently from")]
        forms += [(2, "apparently")] if draft.has_ego else []
        forms += [(3, "field"), (3, "relative")] if draft.known("field") else []
        forms += [(12, "waiting")] if draft.known("waiting") else []
    match draft.choices.weighted(forms):
        case "with":
            return q.WithSpecifier(property="heading", value=expressions.heading_argument(draft, 1))
        case "toward":
            return q.FacingTowardSpecifier(vector=expressions.vector_argument(draft, 1))
        case "away":
            return q.FacingAwayFromSpecifier(vector=expressions.vector_argument(draft, 1))
        case "apparently":
            return q.ApparentlyFacingSpecifier(heading=expressions.heading_argument(draft, 1))
        case "apparently from":
            return q.ApparentlyFacingSpecifier(heading=expressions.heading_argument(draft, 1), origin=expressions.vector_argument(draft, 1))
        case "field":
            return q.FacingSpecifier(direction=name(draft.choices.pick(draft.known("field")).name))
        case "relative":
            return q.FacingSpecifier(direction=relative(draft))
        case "waiting":
            waiting = name(draft.choices.pick(draft.known("waiting")).name)
            direction = call("max", waiting, expressions.heading_literal(draft)) if draft.choices.chance(0.2) else waiting
            return q.FacingSpecifier(direction=direction)
        case _:
            return q.FacingSpecifier(direction=expressions.heading_argument(draft, depth))


def relative(draft: Draft) -> Expression:
    """`H relative to F`, `F relative to H`, `F relative to F`: it waits for the position of the object."""
    field = name(draft.choices.pick(draft.known("field")).name)
    match draft.choices.integer(0, 2):
        case 0:
            return e.RelativeTo(left=expressions.heading(draft, 0), right=field)
        case 1:
            return e.RelativeTo(left=field, right=expressions.heading(draft, 0))
        case _:
            return e.RelativeTo(left=field, right=name(draft.choices.pick(draft.known("field")).name))


def properties(draft: Draft, class_: Class, depth: int) -> list[Specifier]:
    """`with property E` for some properties."""
    ranges = {"width": (0.5, 3.0), "length": (0.5, 3.0), "speed": (0.0, 5.0)} if class_.is_object else {}
    ranges |= {each.name: (each.low, each.high) for each in class_.properties}
    chosen = draft.choices.some(list(ranges), 0, 2)
    found: list[Specifier] = [q.WithSpecifier(property=each, value=expressions.scalar(draft, *ranges[each], depth)) for each in chosen]
    if draft.choices.chance(0.1):
        found.append(q.WithSpecifier(property="tag", value=constant_literal(draft.choices.pick(["red", "blue"]))))
    if class_.is_object and draft.allows("visibility") and draft.choices.chance(0.3):
        found.append(visibility_specifier(draft))
    if class_.is_object and draft.allows("workspace") and draft.known("region") and draft.choices.chance(0.3):
        wide = call("CircularRegion", expressions.vector_literal(draft, 2), number_literal(2 * draft.settings.area))
        found.append(q.WithSpecifier(property="regionContainedIn", value=wide))
    return found


def visibility_specifier(draft: Draft) -> Specifier:
    """How far and how wide an object sees, or whether it must be seen."""
    match draft.choices.integer(0, 2):
        case 0:
            return q.WithSpecifier(property="requireVisible", value=expressions.flag(draft, 0.3))
        case 1:
            return q.WithSpecifier(property=draft.view_distance, value=expressions.scalar(draft, 30, 60, 1))
        case _:
            return q.WithSpecifier(property="viewAngle", value=degrees(draft.choices.pick([360, 270, 200, 400])))


OBJECT = Class("Object")


def may_create(draft: Draft, count: int = 1) -> bool:
    """Whether this number of objects in every turn of the loops around is not too large."""
    return draft.objects + count * draft.repeats <= draft.settings.max_objects


def definition(draft: Draft, depth: int) -> Expression:
    """`class specifier, ..., specifier`; in a finite program only of a class that can be afforded."""
    class_ = draft.choices.pick([OBJECT, *draft.classes]) if draft.choices.chance(0.7) else OBJECT
    if not draft.afford(class_.cost):
        class_ = OBJECT
    found = random_specifiers(draft, class_, depth)
    if draft.settings.finite and draft.allows("mutate"):
        found += [q.WithSpecifier(property=each, value=constant_literal(0)) for each in ("positionStdDev", "headingStdDev")]
    draft.objects += draft.repeats
    return new_object(class_.name, found) if found else name(class_.name)


def class_definition(draft: Draft) -> tuple[s.ClassDefinition, Class]:
    """A class whose default values depend on each other, in an order without circles."""
    ancestor = draft.choices.pick([OBJECT, *draft.classes])
    made: list[s.PropertyDefault] = []
    properties = list(ancestor.properties)
    with draft.definition():
        draft.inside, before = "function", draft.inside
        for _ in range(draft.choices.integer(1, 4)):
            each = new_default(draft, properties, made)
            if each is not None:
                made.append(each)
        draft.inside, draft.own = before, ()
        cost = draft.cost_so_far() * ancestor.cost
    class_ = Class(draft.fresh("C"), tuple(properties), cost)
    superclasses = (name(ancestor.name),) if ancestor is not OBJECT or draft.choices.chance(0.4) else ()
    return s.ClassDefinition(name=class_.name, superclasses=superclasses, properties=tuple(made)), class_


def derived_default(draft: Draft) -> Expression:
    """A default value computed from the position and size of the object, on which no other property depends."""
    position, size = attribute(name("self"), "position"), attribute(name("self"), draft.choices.pick(["width", "length"]))
    match draft.choices.integer(0, 2):
        case 0:
            return operation(size, "*", number_literal(2))
        case 1:
            return attribute(position, draft.choices.pick(["x", "y"]))
        case _:
            return e.Distance(origin=position, target=expressions.vector_literal(draft, draft.settings.area))


def new_default(draft: Draft, properties: list[Property], made: list[s.PropertyDefault]) -> s.PropertyDefault | None:
    """A property with its default; it may mention those that stand before it in `properties`, which a new one joins."""
    done = {each.name for each in made}
    form = draft.choices.weighted([(4, "new"), (2, "size"), (1, "override"), (1, "heading"), (1, "flag"), (1, "derived")])
    match form:
        case "size":
            each = Property(draft.choices.pick(["width", "length"]), 0.5, 3)
        case "override":
            free = [known for known in properties if known.name not in done]
            each = draft.choices.pick(free) if free else Property(draft.fresh("p"), 0, 4)
        case "heading":
            return None if "heading" in done else s.PropertyDefault(name="heading", value=as_whole_value(expressions.heading(draft, 1)))
        case "derived":
            return s.PropertyDefault(name=draft.fresh("d"), value=as_whole_value(derived_default(draft)))
        case "flag":
            return None if "tag" in done else s.PropertyDefault(name="tag", value=constant_literal("plain"))
        case _:
            each = Property(draft.fresh("p"), *draft.choices.pick([(0, 4), (1, 2), (-5, 5)]))
    if each.name in done:
        return None
    names = [known.name for known in properties]
    rank = names.index(each.name) if each.name in names else len(properties)
    draft.own = tuple(known for known in properties[:rank])
    if rank == len(properties):
        properties.append(each)
    return s.PropertyDefault(name=each.name, value=as_whole_value(expressions.scalar(draft, each.low, each.high, 2)))

