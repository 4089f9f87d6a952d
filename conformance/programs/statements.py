"""Simple statements: each function writes one (or a few that belong together) and notes what it defines; None if it cannot stand here."""

from __future__ import annotations

from collections.abc import Callable

from ...semantics.syntax import Block, Expression
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s
from . import booleans, distributions, functions, headings, objects, regions, scalars, specifiers, vectors
from .draft import FAR, Draft, Variable
from .tree import alone, assign, attribute, call, comparison, constant, name, new_object, number, operation

Form = Callable[[Draft], "Block | None"]

INTERVALS = ((0.0, 1.0), (0.0, 4.0), (-5.0, 5.0), (1.0, 3.0), (-20.0, 20.0))
CHANCES = (0.5, 0.75, 0.25)


def scalar(draft: Draft) -> Block:
    """`x = E`, random or not."""
    low, high = draft.choices.pick(INTERVALS)
    target = draft.fresh("x")
    if draft.choices.chance(0.3):
        with draft.without_randomness():
            value = scalars.scalar(draft, low, high, draft.settings.max_depth)
        draft.define(Variable(target, "scalar", low, high, random=False))
    else:
        value = None
        if draft.choices.chance(0.5):
            value = distributions.distribution(draft, low, high, draft.settings.max_depth)
        value = value or scalars.scalar(draft, low, high, draft.settings.max_depth)
        draft.define(Variable(target, "scalar", low, high, random=draft.is_random(value), ways=distributions.ways_of(value)))
    return (assign(target, value),)


def again(draft: Draft) -> Block | None:
    """`x = resample(y)`, a draw that can itself be drawn again."""
    known = [v for v in draft.known("scalar") if v.ways]
    if not known:
        return None
    chosen = draft.choices.pick(known)
    if not draft.afford(chosen.ways):
        return None
    target = draft.fresh("x")
    draft.define(Variable(target, "scalar", chosen.low, chosen.high, ways=chosen.ways))
    return (assign(target, call("resample", name(chosen.name))),)


def unpacking(draft: Draft) -> Block:
    """`a, b = E, E`, or `a = b = E`."""
    low, high = draft.choices.pick(INTERVALS)
    first, second = draft.fresh("x"), draft.fresh("x")
    if draft.choices.chance(0.5):
        value = scalars.scalar(draft, low, high, 2)
        made = s.Assignment(targets=(name(first), name(second)), value=assign("_", value).value)
    else:
        values = p.TupleDisplay(items=(scalars.scalar(draft, low, high, 2), scalars.scalar(draft, low, high, 2)))
        made = s.Assignment(targets=(p.TupleDisplay(items=(name(first), name(second))),), value=values)
    for each in (first, second):
        draft.define(Variable(each, "scalar", low, high))
    return (made,)


def heading(draft: Draft) -> Block:
    """`h = H`."""
    value = headings.heading(draft, draft.settings.max_depth)
    return (assign(draft.define(Variable(draft.fresh("h"), "heading")).name, value),)


def vector(draft: Draft) -> Block:
    """`v = V`."""
    reach = draft.settings.area * draft.choices.pick([0.5, 1, 0.25])
    value = vectors.vector(draft, reach, draft.settings.max_depth)
    return (assign(draft.define(Variable(draft.fresh("v"), "vector", -reach, reach)).name, value),)


def boolean(draft: Draft) -> Block:
    """`b = B`."""
    value = booleans.value(draft, 1)
    return (assign(draft.define(Variable(draft.fresh("b"), "boolean")).name, value),)


def point(draft: Draft) -> Block:
    """`spot = OrientedPoint ...`, or a derived point."""
    value = vectors.oriented_point(draft, 2)
    return (assign(draft.define(Variable(draft.fresh("spot"), "point")).name, value),)


def region(draft: Draft) -> Block:
    """`r = R`."""
    value = regions.region(draft, 1)
    return (assign(draft.define(Variable(draft.fresh("r"), "region")).name, value),)


def field(draft: Draft) -> Block:
    """`f = VectorField(...)`."""
    value = regions.field(draft)
    return (assign(draft.define(regions.defined_field(draft)).name, value),)


def thing(draft: Draft) -> Block | None:
    """`o = Object ...`, or an object without a name."""
    if not objects.may_create(draft):
        return None
    value = objects.definition(draft, 2)
    if draft.choices.chance(0.2):
        return (alone(value),)
    return (assign(draft.define(Variable(draft.fresh("o"), "object")).name, value),)


def made_by_function(draft: Draft) -> Block | None:
    """`o = make(E)`."""
    makers = [v for v in draft.known("maker") if objects.may_create(draft)]
    if not makers:
        return None
    chosen = draft.choices.pick(makers)
    if not draft.afford(chosen.cost):
        return None
    value = call(chosen.name, scalars.scalar(draft, *chosen.takes[0], 1))
    draft.objects += draft.repeats
    if not chosen.named:
        return (alone(value),)
    return (assign(draft.define(Variable(draft.fresh("o"), "object")).name, value),)


def chosen_object(draft: Draft) -> Block | None:
    """`o = Uniform(a, b)`: an object that is random."""
    known = [v for v in draft.known("object") if not v.ways]
    if len(known) < 2 or not draft.afford(2):
        return None
    first, second = draft.choices.some(known, 2, 2)
    value = call("Uniform", name(first.name), name(second.name))
    return (assign(draft.define(Variable(draft.fresh("any"), "object", ways=2)).name, value),)


def listed(draft: Draft) -> Block:
    """`xs = [E, ...]`, a slice or a sorted copy of it."""
    low, high = draft.choices.pick(INTERVALS[:4])
    size = draft.choices.integer(1, draft.settings.max_loop)
    value: Expression = p.ListDisplay(items=tuple(scalars.scalar(draft, low, high, 2) for _ in range(size)))
    if draft.choices.chance(0.2):
        value = p.Subscript(value=value, index=p.Slice(step=number(-1)))
    return (assign(draft.define(Variable(draft.fresh("xs"), "list", low, high, size=size, most=size)).name, value),)


def delayed(draft: Draft) -> Block | None:
    """`w = H relative to F`, or a list of such values, and perhaps an object that it waits for; a field, where there is none."""
    if not draft.allows("fields"):
        return None
    if not draft.known("field"):
        return field(draft)
    value = specifiers.relative(draft)
    if draft.choices.chance(0.4):
        value = operation(value, draft.choices.pick(["+", "-"]), scalars.scalar(draft, -1, 1, 1))
    if draft.choices.chance(0.2):
        value = p.Subscript(value=p.ListDisplay(items=(value, constant(0))), index=constant(0))
    waiting = assign(draft.define(Variable(draft.fresh("w"), "waiting")).name, value)
    if not objects.may_create(draft) or draft.choices.chance(0.3):
        return (waiting,)
    return (waiting, *(thing(draft) or ()))


def random_list(draft: Draft) -> Block | None:
    """`xs = Uniform([...], [...])`, or `xs = filter(lambda v: v > c, ys)`: its length is random."""
    low, high = draft.choices.pick(INTERVALS[:4])
    target = draft.fresh("ls")
    known = draft.known("list", "lists")
    if known and draft.choices.chance(0.6):
        chosen = draft.choices.pick(known)
        test = p.Lambda(parameters=(p.Parameter(name="v"),), body=comparison(name("v"), ">", scalars.scalar_literal(draft, chosen.low, chosen.high)))
        value: Expression = call("filter", test, name(chosen.name))
        draft.define(Variable(target, "lists", chosen.low, chosen.high, size=0, most=chosen.most))
        return (assign(target, value),)
    if not draft.afford(2):
        return None
    sizes = [draft.choices.integer(1, draft.settings.max_loop) for _ in range(2)]
    value = call("Uniform", *(p.ListDisplay(items=tuple(scalars.scalar_literal(draft, low, high) for _ in range(size))) for size in sizes))
    draft.define(Variable(target, "lists", low, high, size=min(sizes), most=max(sizes)))
    return (assign(target, value),)


def random_pair(draft: Draft) -> Block | None:
    """`a, b = Uniform((E, E), (E, E))`."""
    low, high = draft.choices.pick(INTERVALS)
    if not draft.afford(2):
        return None
    pairs = (p.TupleDisplay(items=(scalars.scalar_literal(draft, low, high), scalars.scalar_literal(draft, low, high))) for _ in range(2))
    first, second = draft.fresh("x"), draft.fresh("x")
    for each in (first, second):
        draft.define(Variable(each, "scalar", low, high))
    target = p.TupleDisplay(items=(name(first), name(second)))
    return (s.Assignment(targets=(target,), value=call("Uniform", *pairs)),)


def appended(draft: Draft) -> Block | None:
    """`xs.append(E)`."""
    known = draft.known("list")
    if not known or draft.inside == "function" or draft.repeats > 1:
        return None
    chosen = draft.choices.pick(known)
    value = scalars.scalar(draft, chosen.low, chosen.high, 1)
    sure = draft.inside == "program"
    draft.define(Variable(chosen.name, "list", chosen.low, chosen.high, size=chosen.size + sure, most=chosen.most + 1))
    return (alone(call(attribute(name(chosen.name), "append"), value)),)


def dictionary(draft: Draft) -> Block:
    """`d = {'a': E, 'b': E}`."""
    items = tuple((constant(key), scalars.scalar(draft, 0, 4, 2)) for key in "ab")
    return (assign(draft.define(Variable(draft.fresh("d"), "dictionary")).name, p.DictDisplay(items=items)),)


def changed(draft: Draft) -> Block | None:
    """A variable assigned again, with the same kind of value."""
    known = [v for v in draft.known("scalar") if v.random and v.low > -FAR]
    if not known or draft.inside == "function":
        return None
    chosen = draft.choices.pick(known)
    if draft.choices.chance(0.3) and draft.inside == "program":
        value = scalars.scalar(draft, 0, 1, 1)
        draft.define(Variable(chosen.name, "scalar", chosen.low, chosen.high + 1))
        return (s.AugmentedAssignment(target=name(chosen.name), operator="+", value=value),)
    value = scalars.scalar(draft, chosen.low, chosen.high, 2)
    if draft.inside == "program":
        draft.define(Variable(chosen.name, "scalar", chosen.low, chosen.high, ways=distributions.ways_of(value)))
    return (assign(chosen.name, value),)


def moved(draft: Draft) -> Block | None:
    """`o.p = E`: a property of an object assigned after its creation."""
    known = [v for v in draft.known("object") if not v.ways]
    if not known:
        return None
    target = attribute(name(draft.choices.pick(known).name), draft.choices.pick(["speed", "width", "tag"]))
    return (s.Assignment(targets=(target,), value=assign("_", scalars.scalar(draft, 0.5, 2, 1)).value),)


def require(draft: Draft) -> Block:
    """`require B`."""
    return (s.Require(condition=booleans.condition(draft, 1)),)


def soft_require(draft: Draft) -> Block | None:
    """`require[p] B`."""
    if not draft.afford(2):
        return None
    return (s.SoftRequire(probability=number(draft.choices.pick(CHANCES)), condition=booleans.condition(draft, 1)),)


def mutate(draft: Draft) -> Block | None:
    """`mutate`, `mutate o by s`; in finite programs all standard deviations are 0."""
    known = [v for v in draft.known("object") if not v.ways]
    if not known:
        return None
    chosen = draft.choices.some(known, 0, 2)
    scale = scalars.scalar(draft, 0, 2, 1) if draft.choices.chance(0.5) else None
    return (s.Mutate(objects=tuple(name(v.name) for v in chosen), scale=scale),)


def printed(draft: Draft) -> Block | None:
    """`assert`, `pass`, `print`: statements that leave no trace in the scene."""
    match draft.choices.integer(0, 2):
        case 0:
            return (s.Pass(),)
        case 1:
            return (alone(call("print", constant("here"), scalars.scalar_literal(draft, 0, 5))),)
        case _:
            return (s.Assert(test=p.Comparison(left=number(1), operators=("<",), operands=(number(2),)), message=constant("never")),)


def param(draft: Draft) -> Block:
    """`param name = E`."""
    value = draft.choices.weighted([(3, scalar_value), (1, boolean_value), (1, text_value), (1, vector_value)])(draft)
    return (s.Param(assignments=(s.ParamAssignment(name=draft.fresh("q"), value=value),)),)


def scalar_value(draft: Draft) -> Expression:
    """A scalar for `param`."""
    return scalars.scalar(draft, -5, 5, 2)


def boolean_value(draft: Draft) -> Expression:
    """A boolean for `param`."""
    return booleans.value(draft, 1)


def vector_value(draft: Draft) -> Expression:
    """A vector for `param`."""
    return vectors.vector(draft, draft.settings.area, 2)


def text_value(draft: Draft) -> Expression:
    """An f-string."""
    layout = p.FString(parts=(".2f",)) if draft.choices.chance(0.5) else None
    return p.FString(parts=("at ", p.FormattedValue(value=scalars.scalar(draft, 0, 4, 1), format=layout), "!"))


def imported(draft: Draft) -> Block:
    """`import math` and a call of it."""
    target = draft.fresh("x")
    value = call(attribute(name("math"), draft.choices.pick(["floor", "sqrt"])), scalars.scalar(draft, 0, 4, 1))
    draft.define(Variable(target, "scalar", 0, 4))
    return (s.Import(names=(s.ImportedName(name="math"),)), assign(target, value))


def class_(draft: Draft) -> Block | None:
    """`class C(...): ...`."""
    if len(draft.classes) >= draft.settings.max_classes:
        return None
    node, made = objects.class_definition(draft)
    draft.classes.append(made)
    return (node,)


def function(draft: Draft) -> Block:
    """`def f(...): ...`."""
    block, variable = functions.definition(draft)
    draft.define(variable)
    return block


def workspace(draft: Draft) -> Block:
    """`workspace = Workspace(R)`, larger than where objects stand as a rule."""
    reach = draft.settings.area
    sides = number(draft.choices.pick([3 * reach, 4 * reach]))
    disc = call("CircularRegion", vectors.vector_literal(draft, 2), number(2 * reach))
    square = call("RectangularRegion", vectors.vector_literal(draft, 2), number(0), sides, sides)
    shape = draft.choices.pick([disc, square])
    return (assign("workspace", call("Workspace", shape)),)


def ego(draft: Draft) -> Block:
    """`ego = Object ...`."""
    reach = draft.settings.area
    if draft.choices.chance(0.7):
        value = objects.definition(draft, 2)
    else:
        draft.objects += 1
        found = [q.AtSpecifier(vector=vectors.vector(draft, reach / 2, 1))]
        found += [q.WithSpecifier(property=each, value=constant(0)) for each in ("positionStdDev", "headingStdDev")] if draft.settings.finite else []
        value = new_object("Object", found)
    draft.has_ego = True
    draft.define(Variable("ego", "object"))
    return (assign("ego", value),)


def closing(draft: Draft) -> Block:
    """`param` with the variables that a scene would not show otherwise."""
    known = [v for v in draft.variables if v.kind in ("scalar", "heading", "vector", "boolean", "list", "dictionary")]
    chosen = draft.choices.some(known, 0, 4) if known else []
    made = [s.ParamAssignment(name=f"_{v.name}".strip("_"), value=name(v.name)) for v in chosen]
    if draft.objects > 1 and draft.choices.chance(0.3):
        made.append(s.ParamAssignment(name="sum", value=operation(attribute(name("ego"), "width"), "+", number(1))))
    return (s.Param(assignments=tuple(made)),) if made else ()
