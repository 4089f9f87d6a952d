"""Object definitions and class definitions."""

from __future__ import annotations

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s
from . import headings, scalars, specifiers, vectors
from .draft import Class, Draft, Property
from .tree import attribute, constant, held, name, new_object, number, operation

OBJECT = Class("Object")


def may_create(draft: Draft, count: int = 1) -> bool:
    """Whether this number of objects in every turn of the loops around is not too large."""
    return draft.objects + count * draft.repeats <= draft.settings.max_objects


def definition(draft: Draft, depth: int) -> Expression:
    """`class specifier, ..., specifier`; in a finite program only of a class that can be afforded."""
    class_ = draft.choices.pick([OBJECT, *draft.classes]) if draft.choices.chance(0.7) else OBJECT
    if not draft.afford(class_.cost):
        class_ = OBJECT
    found = specifiers.specifiers(draft, class_, depth)
    if draft.settings.finite and draft.allows("mutate"):
        found += [q.WithSpecifier(property=each, value=constant(0)) for each in ("positionStdDev", "headingStdDev")]
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


def derived(draft: Draft) -> Expression:
    """What follows from where an object stands and how large it is; nothing else depends on it."""
    position, size = attribute(name("self"), "position"), attribute(name("self"), draft.choices.pick(["width", "length"]))
    match draft.choices.integer(0, 2):
        case 0:
            return operation(size, "*", number(2))
        case 1:
            return attribute(position, draft.choices.pick(["x", "y"]))
        case _:
            return e.Distance(origin=position, target=vectors.vector_literal(draft, draft.settings.area))


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
            return None if "heading" in done else s.PropertyDefault(name="heading", value=held(headings.heading(draft, 1)))
        case "derived":
            return s.PropertyDefault(name=draft.fresh("d"), value=held(derived(draft)))
        case "flag":
            return None if "tag" in done else s.PropertyDefault(name="tag", value=constant("plain"))
        case _:
            each = Property(draft.fresh("p"), *draft.choices.pick([(0, 4), (1, 2), (-5, 5)]))
    if each.name in done:
        return None
    names = [known.name for known in properties]
    rank = names.index(each.name) if each.name in names else len(properties)
    draft.own = tuple(known for known in properties[:rank])
    if rank == len(properties):
        properties.append(each)
    return s.PropertyDefault(name=each.name, value=held(scalars.scalar(draft, each.low, each.high, 2)))
