"""Expressions of generated programs by their kinds: scalars, distributions, headings, vectors, regions, booleans."""

from __future__ import annotations

from math import ceil, floor
from typing import get_args

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import specifiers as q
from .ast_builders import (
    Link,
    attribute,
    call,
    clamp_call,
    comparison,
    constant_literal,
    degrees,
    field_at,
    is_in,
    name,
    new_object,
    number_literal,
    offset_along,
    offset_by,
    operation,
    pair,
    visible_from,
)
from .program_draft import FAR, Draft, Option, Variable, first_that_works


def literal_value(draft: Draft, low: float, high: float) -> float:
    """A number in the interval, a multiple of 1/4 where there is one."""
    first, last = ceil(low * 4), floor(high * 4)
    if first > last:
        return (low + high) / 2
    coarse = draft.choices.chance(0.5)
    least, most = (ceil(first / 4), floor(last / 4)) if coarse else (first, last)
    if least > most:
        least, most, coarse = first, last, False
    chosen = draft.choices.integer(least, most)
    return chosen if coarse else chosen / 4


def scalar_literal(draft: Draft, low: float, high: float) -> Expression:
    """A number in the interval as a literal."""
    return number_literal(literal_value(draft, low, high))


def scalar(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """An expression with values in [low, high]."""
    options: list[Option] = [(4, lambda: scalar_literal(draft, low, high))]
    if draft.may_draw():
        options.append((5, lambda: distribution(draft, low, high, depth)))
    fitting = [v for v in draft.known("scalar") if low <= v.low and v.high <= high]
    if fitting:
        options.append((6, lambda: name(draft.choices.pick(fitting).name)))
    if draft.own and not draft.settled:
        options.append((8, lambda: own_property(draft, low, high)))
    if depth > 0:
        options += composed_scalar(draft, low, high, depth - 1)
    return first_that_works(draft, options)


def composed_scalar(draft: Draft, low: float, high: float, depth: int) -> list[Option]:
    """The ways to put smaller expressions together."""
    options: list[Option] = [
        (2, lambda: operation(scalar(draft, low / 2, high / 2, depth), "+", scalar(draft, low / 2, high / 2, depth))),
        (1, lambda: difference(draft, low, high, depth)),
        (1, lambda: scaled_scalar(draft, low, high, depth)),
        (1, lambda: call(draft.choices.pick(["min", "max"]), scalar(draft, low, high, depth), scalar(draft, low, high, depth))),
    ]
    if low <= -2 and high >= -1:
        options.append((1, lambda: p.UnaryOperation(operator="~", operand=drawn_condition(draft))))  # True is 1 to it
    if low == -high:
        options.append((1, lambda: p.UnaryOperation(operator="-", operand=scalar(draft, low, high, depth))))
        options.append((1, lambda: operation(scalar(draft, low, high, depth), "*", scalar(draft, 0, 1, depth))))
    if draft.known("scalar"):
        options.append((2, lambda: clamp_call(name(draft.choices.pick(draft.known("scalar")).name), low, high)))
    if draft.allows("branches"):
        options.append((1, lambda: conditional(draft, low, high, depth)))
    if draft.known("list"):
        options.append((2, lambda: from_list(draft, low, high, depth)))
    if draft.known("lists") and not (draft.settled or draft.drawless):
        options.append((3, lambda: from_random_list(draft, low, high)))
    if draft.known("dictionary"):
        options.append((2, lambda: from_dictionary(draft, low, high)))
    if callable_here(draft, low, high):
        options.append((4, lambda: function_call(draft, low, high, depth)))
    if draft.known("object", "point") and not draft.settled:
        options.append((3, lambda: clamp_call(scalar_measure(draft, depth), low, high)))
    if draft.may_draw() and draft.allows("resample"):
        options.append((5, lambda: resample_call(draft, low, high)))
    if draft.allows("functions") and depth > 0:
        options.append((1, lambda: applied_lambda(draft, low, high, depth)))
    return options


def difference(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`a - b` with a in the upper half and b no more than half of the interval."""
    half = (high - low) / 2
    return operation(scalar(draft, low + half, high, depth), "-", scalar(draft, 0, half, depth))


def scaled_scalar(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`a * k` or `a / k`."""
    if draft.choices.chance(0.5):
        return operation(scalar(draft, low * 2, high * 2, depth), "/", number_literal(2))
    return operation(scalar(draft, low / 2, high / 2, depth), "*", number_literal(2))


def conditional(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`a if B else b`, B not random."""
    then, otherwise = scalar(draft, low, high, depth), scalar(draft, low, high, depth)
    return p.Conditional(test=nonrandom_condition(draft, 1), then=then, otherwise=otherwise)


def own_property(draft: Draft, low: float, high: float) -> Expression:
    """`self.name`, as it is if its values fit."""
    chosen = draft.choices.pick(draft.own)
    read = attribute(name("self"), chosen.name)
    return read if low <= chosen.low and chosen.high <= high else clamp_call(read, low, high)


def from_list(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """An element of a list, or something that all elements give."""
    chosen = draft.choices.pick(draft.known("list"))
    xs = name(chosen.name)
    whole = call(draft.choices.pick(["sum", "max", "min", "len"]), xs)
    place = number_literal(draft.choices.integer(-chosen.size, chosen.size - 1))
    if draft.choices.chance(0.3):
        return clamp_call(gone_through(draft, xs), low, high)
    if draft.choices.chance(0.5):
        return clamp_call(whole, low, high)
    element = p.Subscript(value=xs, index=place)
    return element if low <= chosen.low and chosen.high <= high else clamp_call(element, low, high)


def gone_through(draft: Draft, xs: Expression) -> Expression:
    """An expression of the elements of a generator over a list: the first one, or all of them together."""
    one, other = draft.fresh("y"), draft.fresh("y")
    if draft.choices.chance(0.5):
        target, source, element = name(one), draft.choices.pick([xs, call("reversed", xs)]), operation(name(one), "+", scalar_literal(draft, 0, 2))
    else:
        target, source = p.TupleDisplay(items=(name(one), name(other))), call("zip", xs, call("reversed", xs))
        element = operation(name(one), "-", name(other))
    generator = p.Comprehension(kind="generator", element=element, clauses=(p.ComprehensionClause(target=target, iterable=source),))
    return call(draft.choices.pick(["next", "sum", "max"]), generator)


def from_random_list(draft: Draft, low: float, high: float) -> Expression | None:
    """The length of a list of random length, or something that its elements give; one of them, where there is one for sure."""
    chosen = draft.choices.pick(draft.known("lists"))
    xs = name(chosen.name)
    options: list[Option] = [
        (2, lambda: call(draft.choices.pick(["len", "sum"]), xs)),
        (1, lambda: call(draft.choices.pick(["max", "min"]), p.Starred(value=xs), number_literal(chosen.low), number_literal(chosen.low))),
    ]
    if chosen.size:
        options.append((2, lambda: p.Subscript(value=xs, index=number_literal(draft.choices.pick([0, -1])))))
        if draft.may_draw():
            options.append((3, lambda: call("Uniform", p.Starred(value=xs)) if draft.afford(chosen.most) else None))
    value = draft.choices.weighted(options)()
    return None if value is None else clamp_call(value, low, high)


def from_dictionary(draft: Draft, low: float, high: float) -> Expression:
    """`d['a']`."""
    chosen = draft.choices.pick(draft.known("dictionary"))
    return clamp_call(p.Subscript(value=name(chosen.name), index=constant_literal("a")), low, high)


def callable_here(draft: Draft, low: float, high: float) -> list[Variable]:
    """The functions that may be called."""
    return [v for v in draft.known("function") if v.low >= low and v.high <= high and (not draft.drawless or v.cost == 1)]


def function_call(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """`f(a, b)`."""
    chosen = draft.choices.pick(callable_here(draft, low, high))
    if draft.drawless or not draft.afford(chosen.cost):
        return None
    return invocation(draft, chosen, depth)


def invocation(draft: Draft, function: Variable, depth: int) -> p.Call:
    """A call with arguments of every form that the function takes."""
    required = len(function.takes) - function.optional
    count = draft.choices.integer(required, len(function.takes))
    arguments = [scalar(draft, low, high, depth) for low, high in function.takes[:count]]
    if function.spreads and count == len(function.takes):
        arguments += [scalar(draft, 0, 1, depth) for _ in range(draft.choices.integer(0, 2))]
        if draft.known("list") and draft.choices.chance(0.3):
            arguments.append(p.Starred(value=name(draft.choices.pick(draft.known("list")).name)))
    keywords = (p.Keyword(name="extra", value=scalar(draft, 0, 1, depth)),) if function.named and draft.choices.chance(0.5) else ()
    return p.Call(function=name(function.name), arguments=tuple(arguments), keywords=keywords)


def applied_lambda(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`(lambda a: E)(b)`."""
    parameter, argument = draft.fresh("a"), scalar(draft, low, high, depth)
    with draft.block():
        draft.define(Variable(parameter, "scalar", low, high))
        body = scalar(draft, low, high, depth)
    return call(p.Lambda(parameters=(p.Parameter(name=parameter),), body=body), argument)


def scalar_measure(draft: Draft, depth: int) -> Expression:
    """A scalar operator of the paper, or a property of an object: without limits."""
    return first_that_works(draft, measures(draft, depth))


def measures(draft: Draft, depth: int) -> list[Option]:
    """The scalar operators that can be written here."""
    someone = name(draft.choices.pick(draft.known("object", "point")).name)
    options: list[Option] = [
        (2, lambda: attribute(someone, "heading")),
        (1, lambda: attribute(someone, "position", draft.choices.pick(["x", "y"]))),
        (2, lambda: e.Distance(origin=vector_argument(draft, depth), target=vector_argument(draft, depth))),
        (1, lambda: e.Angle(origin=vector_argument(draft, depth), target=vector_argument(draft, depth))),
        (1, lambda: e.RelativeHeading(heading=heading_argument(draft, depth), origin=heading_argument(draft, depth))),
        (1, lambda: e.ApparentHeading(oriented_point=someone, origin=vector_argument(draft, depth))),
        (1, lambda: e.DistancePast(oriented_point=someone, vector=vector_argument(draft, depth))),
    ]
    if draft.allows("released"):
        options += [
            (1, lambda: attribute(someone, draft.choices.pick(["x", "y"]))),
            (1, lambda: call(attribute(someone, "distanceTo"), vector_argument(draft, depth))),
            (1, lambda: call(attribute(someone, "angleTo"), vector_argument(draft, depth))),
        ]
    if draft.known("object"):
        thing = name(draft.choices.pick(draft.known("object")).name)
        options.append((2, lambda: attribute(thing, draft.choices.pick(["width", "length", draft.view_distance]))))
    if draft.known("region"):
        region = name(draft.choices.pick(draft.known("region")).name)
        options.append((1, lambda: e.Distance(origin=vector_argument(draft, depth), target=region)))
    if draft.has_ego:
        options += [
            (1, lambda: e.Distance(target=vector_argument(draft, depth))),
            (1, lambda: e.Distance(origin=vector_argument(draft, depth))),
            (1, lambda: e.Angle(target=vector_argument(draft, depth))),
            (1, lambda: e.RelativeHeading(heading=heading_argument(draft, depth))),
            (1, lambda: e.ApparentHeading(oriented_point=someone)),
            (1, lambda: e.DistancePast(vector=vector_argument(draft, depth))),
        ]
    return options


def range_check(draft: Draft, subject: Expression, low: float, high: float) -> Expression:
    """`low < subject < high`, or one side of it."""
    if draft.choices.chance(0.3):
        return p.Comparison(left=number_literal(low), operators=("<=", "<"), operands=(subject, number_literal(high)))
    return comparison(subject, ">", number_literal(low)) if draft.choices.chance(0.5) else comparison(subject, "<=", number_literal(high))


def distribution(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """A draw with values in [low, high]; None if it cannot be afforded."""
    options: list[Option] = [(3, lambda: uniform(draft, low, high, depth)), (2, lambda: discrete(draft, low, high, depth))]
    if draft.allows("released") and high - low >= 1:
        options.append((2, lambda: discrete_range(draft, low, high)))
    if not draft.settings.finite:
        options += [
            (5, lambda: interval(draft, low, high, depth)), (2, lambda: truncated_normal_call(draft, low, high)),
            (1, lambda: normal(draft, low, high))
        ]
    elif draft.choices.chance(0.05):
        return point_mass(draft, low, high)
    return draft.choices.weighted(options)()


def inner(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """A value or parameter of a distribution, which may itself be drawn."""
    if depth > 0 and draft.allows("nested") and draft.choices.chance(0.4):
        return scalar(draft, low, high, depth - 1)
    return scalar_literal(draft, low, high)


def uniform(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """`Uniform(a, b)`, or `Uniform(*list)`."""
    lists = [v for v in draft.known("list") if low <= v.low and v.high <= high]
    if lists and draft.choices.chance(0.3):
        chosen = draft.choices.pick(lists)
        return call("Uniform", p.Starred(value=name(chosen.name))) if draft.afford(chosen.most) else None
    count = draft.choices.integer(2, 3)
    if not draft.afford(count):
        return None
    return call("Uniform", *(inner(draft, low, high, depth) for _ in range(count)))


def discrete_range(draft: Draft, low: float, high: float) -> Expression | None:
    """`DiscreteRange(a, b)`."""
    first = ceil(low)
    last = min(floor(high), first + draft.choices.integer(0, 2))
    return call("DiscreteRange", number_literal(first), number_literal(last)) if draft.afford(last - first + 1) else None


def discrete(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
    """`Discrete({a: 1, b: 2})`; the weights need not add up to 1."""
    count = draft.choices.integer(2, 3)
    if not draft.afford(count):
        return None
    values = [inner(draft, low, high, depth) for _ in range(count)]
    return call("Discrete", p.DictDisplay(items=tuple((value, weight(draft)) for value in values)))


def weight(draft: Draft) -> Expression:
    """A weight: a number, or one that is computed."""
    if draft.allows("nested") and draft.choices.chance(0.2):
        with draft.without_randomness():
            return operation(scalar(draft, 0, 2, 0), "+", number_literal(1))
    return number_literal(draft.choices.pick([1, 2, 3, 0.5, 0.25]))


def halves(draft: Draft, low: float, high: float, depth: int) -> tuple[Expression, Expression]:
    """Two parameters in order; random ones only if the program may chain draws."""
    middle = literal_value(draft, low, high)
    if depth > 0 and draft.allows("chained_draws"):
        return scalar(draft, low, middle, depth - 1), scalar(draft, middle, high, depth - 1)
    return scalar_literal(draft, low, middle), scalar_literal(draft, middle, high)


def interval(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`Range(a, b)`."""
    return call("Range", *halves(draft, low, high, depth))


def truncated_normal_call(draft: Draft, low: float, high: float) -> Expression:
    """`TruncatedNormal(mean, stdDev, low, high)`; the mean may lie outside of the window."""
    first = literal_value(draft, low, (low + high) / 2)
    last = literal_value(draft, (low + high) / 2, high)
    if first >= last:
        return call("Range", number_literal(first), number_literal(first))
    mean = draft.choices.pick([(first + last) / 2, first, last + 1])
    return call("TruncatedNormal", number_literal(mean), number_literal(draft.choices.pick([0.5, 1, 2])), number_literal(first), number_literal(last))


def normal(draft: Draft, low: float, high: float) -> Expression:
    """`min(max(Normal(mean, stdDev), low), high)`: an atom at each end."""
    mean, deviation = scalar_literal(draft, low, high), number_literal(draft.choices.pick([1, 0.5, 0]))
    return call("min", call("max", call("Normal", mean, deviation), number_literal(low)), number_literal(high))


def point_mass(draft: Draft, low: float, high: float) -> Expression:
    """A continuous distribution of zero width: finite as well."""
    value = scalar_literal(draft, low, high)
    return call("Range", value, value) if draft.choices.chance(0.5) else call("Normal", value, constant_literal(0))


def resample_call(draft: Draft, low: float, high: float) -> Expression | None:
    """`resample(x)`."""
    fitting = [v for v in draft.known("scalar") if v.ways and low <= v.low and v.high <= high]
    if not fitting:
        return None
    chosen = draft.choices.pick(fitting)
    return call("resample", name(chosen.name)) if draft.afford(chosen.ways) else None


def ways_of(node: Expression) -> int:
    """The number of values of a draw, if the expression is one; 0 for any other expression."""
    match node:
        case p.Call(function=p.Name(name="Uniform"), arguments=arguments) if not any(isinstance(a, p.Starred) for a in arguments):
            return len(arguments)
        case p.Call(function=p.Name(name="Discrete"), arguments=(p.DictDisplay(items=items),)):
            return len(items)
        case p.Call(function=p.Name(name="DiscreteRange")):
            return 3
        case p.Call(function=p.Name(name="Range" | "TruncatedNormal" | "Normal")):
            return 1
        case _:
            return 0


def choice(draft: Draft, options: list[Option], count: int = 2) -> Expression | None:
    """`Uniform` over values of any kind, of which `options` can write one."""
    if not (draft.may_draw() and draft.afford(count)):
        return None
    return call("Uniform", *(first_that_works(draft, options) for _ in range(count)))


NOTABLE = (0, 90, 45, -30, 180, 170, -190, 270, 360, -90, 10, 720)
"""Degrees that go round the circle, or nearly so."""


def heading_literal(draft: Draft) -> Expression:
    """`170 deg`."""
    return degrees(draft.choices.pick(NOTABLE)) if draft.choices.chance(0.7) else scalar_literal(draft, -3, 3)


def heading(draft: Draft, depth: int) -> Expression:
    """Generate an expression for a heading."""
    options: list[Option] = [(4, lambda: heading_literal(draft))]
    if draft.may_draw():
        options += [(2, lambda: choice(draft, [(1, lambda: heading_literal(draft))])), (2, lambda: random_angle(draft, depth))]
    if draft.known("heading"):
        options.append((4, lambda: name(draft.choices.pick(draft.known("heading")).name)))
    if depth > 0:
        options += composed_heading(draft, depth - 1)
    return first_that_works(draft, options)


def random_angle(draft: Draft, depth: int) -> Expression:
    """`Range(a, b) deg`, or `Uniform(a, b) deg`: also across the half turn."""
    low = draft.choices.pick([0, -90, 100, 170, -190])
    return degrees(scalar(draft, low, low + draft.choices.pick([10, 45, 90]), min(depth, 1)))


def composed_heading(draft: Draft, depth: int) -> list[Option]:
    """The ways to put headings together."""
    options: list[Option] = [
        (2, lambda: e.RelativeTo(left=heading(draft, depth), right=heading_argument(draft, depth))),
        (1, lambda: operation(heading(draft, depth), draft.choices.pick(["+", "-"]), heading(draft, 0))),
        (1, lambda: e.Angle(origin=vector_argument(draft, depth), target=vector_argument(draft, depth))),
        (1, lambda: e.RelativeHeading(heading=heading(draft, depth), origin=heading_argument(draft, depth))),
        (1, lambda: call("abs", heading(draft, depth))),
    ]
    if draft.known("field"):
        options.append((3, lambda: field_at(name(draft.choices.pick(draft.known("field")).name), vector_argument(draft, depth))))
    if draft.known("object", "point"):
        options.append((2, lambda: attribute(name(draft.choices.pick(draft.known("object", "point")).name), "heading")))
    return options


def heading_argument(draft: Draft, depth: int) -> Expression:
    """A heading where an operator or specifier takes one: an OrientedPoint or Object will do."""
    options: list[Option] = [(3, lambda: heading(draft, depth))]
    if draft.known("object", "point"):
        options.append((1, lambda: name(draft.choices.pick(draft.known("object", "point")).name)))
    return first_that_works(draft, options)


VECTOR_SIDES = get_args(e.Side)


def vector_expression(draft: Draft, reach: float, depth: int) -> Expression:
    """A vector, as a rule within `reach` of the origin along both axes."""
    options: list[Option] = [(5, lambda: coordinates(draft, reach, min(depth, 1)))]
    fitting = [v for v in draft.known("vector") if v.high <= reach]
    if fitting:
        options.append((3, lambda: name(draft.choices.pick(fitting).name)))
    options.append((1, lambda: e.VectorOf(x=scalar(draft, -reach, reach, 0), y=scalar(draft, -reach, reach, 0))))
    options.append((1, lambda: call("Vector", scalar_literal(draft, -reach, reach), scalar(draft, -reach, reach, 0))))
    if depth > 0:
        options += composed_vector(draft, reach, depth - 1)
    return first_that_works(draft, options)


def coordinates(draft: Draft, reach: float, depth: int) -> Expression:
    """`(x, y)`."""
    return pair(scalar(draft, -reach, reach, depth), scalar(draft, -reach, reach, depth))


def vector_literal(draft: Draft, reach: float) -> Expression:
    """A pair of numbers."""
    return pair(scalar_literal(draft, -reach, reach), scalar_literal(draft, -reach, reach))


def composed_vector(draft: Draft, reach: float, depth: int) -> list[Option]:
    """The vector operators, and choices among vectors."""
    half = reach / 2
    options: list[Option] = [
        (1, lambda: offset_by(vector_expression(draft, half, depth), vector_expression(draft, half, depth))),
        (1, lambda: offset_along(vector_expression(draft, half, depth), direction(draft, depth), vector_expression(draft, half, 0))),
        (1, lambda: e.RelativeTo(left=vector_expression(draft, half, depth), right=vector_expression(draft, half, depth))),
    ]
    if draft.may_draw():
        options.append((1, lambda: choice(draft, [(1, lambda: vector_literal(draft, reach))])))
    if draft.known("object", "point") and draft.has_ego:
        options.append((2, lambda: attribute(name(draft.choices.pick(draft.known("object", "point")).name), "position")))
        options.append((1, lambda: offset_by(attribute(name("ego"), "position"), vector_expression(draft, half, depth))))
        if draft.allows("released"):
            options.append((3, lambda: e.RelativePosition(target=vector_argument(draft, depth), origin=vector_argument(draft, depth))))
            options.append((1, lambda: e.RelativePosition(target=vector_argument(draft, depth))))
    return options


def direction(draft: Draft, depth: int) -> Expression:
    """The direction of `offset along`: a heading or a field."""
    options: list[Option] = [(3, lambda: heading_argument(draft, depth))]
    if draft.known("field"):
        options.append((3, lambda: name(draft.choices.pick(draft.known("field")).name)))
    return first_that_works(draft, options)


def vector_argument(draft: Draft, depth: int) -> Expression:
    """A vector where an operator or specifier takes one: a Point will do."""
    options: list[Option] = [(3, lambda: vector_expression(draft, draft.settings.area, depth))]
    if draft.known("object", "point"):
        options.append((2, lambda: name(draft.choices.pick(draft.known("object", "point")).name)))
    return first_that_works(draft, options)


def oriented_point(draft: Draft, depth: int) -> Expression:
    """An OrientedPoint: one made by specifiers, or derived from an object."""
    reach = draft.settings.area
    options: list[Option] = [(3, lambda: new_object("OrientedPoint", position_specifiers(draft, reach, depth)))]
    known = draft.known("object", "point")
    if known:
        options += [
            (2, lambda: offset_by(name(draft.choices.pick(known).name), vector_expression(draft, reach / 4, depth))),
            (2, lambda: e.RelativeTo(left=vector_expression(draft, reach / 4, depth), right=name(draft.choices.pick(known).name))),
        ]
    if draft.known("object"):
        options.append((4, lambda: e.SideOf(side=draft.choices.pick(VECTOR_SIDES), object=name(draft.choices.pick(draft.known("object")).name))))
    if draft.known("field"):
        options.append((6, lambda: follow_expression(draft, depth)))
    return first_that_works(draft, options)


def position_specifiers(draft: Draft, reach: float, depth: int) -> list[q.AtSpecifier | q.FacingSpecifier]:
    """`at V, facing H`."""
    found: list[q.AtSpecifier | q.FacingSpecifier] = [q.AtSpecifier(vector=vector_expression(draft, reach, depth))]
    if draft.choices.chance(0.7):
        found.append(q.FacingSpecifier(direction=heading_argument(draft, depth)))
    return found


def follow_expression(draft: Draft, depth: int) -> Expression:
    """`follow F [from V] for S`."""
    field, distance = name(draft.choices.pick(draft.known("field")).name), scalar(draft, 0, 10, 0)
    if draft.has_ego and draft.choices.chance(0.4):
        return e.Follow(field=field, distance=distance)
    return e.Follow(field=field, distance=distance, origin=vector_argument(draft, depth))


ANGLES = (90, 180, 270, 360, 40)
"""Degrees of sectors."""


def region(draft: Draft, depth: int) -> Expression:
    """A region; its measure is not 0."""
    options: list[Option] = [
        (3, lambda: call("CircularRegion", centre(draft), radius(draft))),
        (2, lambda: call("RectangularRegion", centre(draft), heading(draft, 0), radius(draft), radius(draft))),
        (2, lambda: call("SectorRegion", centre(draft), radius(draft), heading(draft, 0), degrees(draft.choices.pick(ANGLES)))),
        (1, lambda: call("PolygonalRegion", corners(draft))),
        (1, lambda: polyline(draft)),
        (1, lambda: call("PointSetRegion", constant_literal("spots"), spots(draft))),
    ]
    if depth > 0 and draft.allows("visibility") and draft.has_ego:
        options.append((2, lambda: visible_region_expression(draft)))
    return first_that_works(draft, options)


def centre(draft: Draft) -> Expression:
    """The centre of a region, not far from the origin."""
    return vector_expression(draft, draft.settings.area / 4, 1)


def radius(draft: Draft) -> Expression:
    """A length that is not small."""
    reach = draft.settings.area
    return scalar(draft, reach / 2, 1.5 * reach, 1)


def corners(draft: Draft) -> Expression:
    """The corners of a convex polygon around the origin, anticlockwise."""
    reach = draft.settings.area
    east, north, west, south = (number_literal(draft.choices.pick([reach, reach / 2])) for _ in range(4))
    return p.ListDisplay(
        items=(
            pair(east, number_literal(0)), pair(number_literal(0), north), pair(negative(west), number_literal(1)),
            pair(number_literal(0), negative(south))
        )
    )


def negative(node: Expression) -> Expression:
    """`-a`."""
    return p.UnaryOperation(operator="-", operand=node)


def polyline(draft: Draft) -> Expression:
    """A curve, which orients what stands on it, or not."""
    reach = draft.settings.area
    ends = [pair(number_literal(k * reach / 2 - reach), scalar_literal(draft, -reach, reach)) for k in range(draft.choices.integer(2, 4))]
    points = p.ListDisplay(items=tuple(ends))
    return call("PolylineRegion", points) if draft.choices.chance(0.7) else call("PolylineRegion", points, orientation=constant_literal(False))


def spots(draft: Draft) -> Expression:
    """Some points: as many draws as points are counted, even where no draw follows."""
    reach = draft.settings.area
    return p.ListDisplay(items=tuple(pair(number_literal(k * 5 - 10), scalar_literal(draft, -reach, reach)) for k in range(3)))


def visible_region_expression(draft: Draft) -> Expression:
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
            (2, lambda: heading_literal(draft)),
            (3, lambda: operation(attribute(name(at), draft.choices.pick(["x", "y"])), "*", degrees(draft.choices.pick([2, 5, -3])))),
            (1, lambda: operation(attribute(name(at), "x"), "/", number_literal(10))),
            (1, lambda: e.Angle(origin=name(at), target=vector_literal(draft, draft.settings.area))),
        ]
        if draft.known("heading"):
            options.append((2, lambda: name(draft.choices.pick(draft.known("heading")).name)))
        body = first_that_works(draft, options)
    function = p.Lambda(parameters=(p.Parameter(name=at),), body=body)
    return call("VectorField", constant_literal("field"), function)


def defined_field(draft: Draft) -> Variable:
    """The variable that a field is bound to."""
    return Variable(draft.fresh("f"), "field")


Side = tuple[float, tuple[Link, ...]]
SIDES: tuple[tuple[int, Side], ...] = ((3, (0.25, (">", ">="))), (3, (0.75, ("<", "<="))), (1, (0.5, ("<", "<=", ">", ">="))))
"""Where a variable's values are cut, as a share of their interval, and the comparisons that leave the larger part (weights first)."""


def nonrandom_condition(draft: Draft, depth: int) -> Expression:
    """A condition that is not random."""
    with draft.without_randomness():
        options: list[Option] = [
            (1, lambda: constant_literal(draft.choices.chance(0.5))),
            (3, lambda: comparison(scalar(draft, 0, 3, depth), draft.choices.pick(["<", ">=", "==", "!="]), scalar_literal(draft, 0, 3))),
        ]
        if bounded_scalars(draft, random=False):
            options.append((4, lambda: threshold(draft, random=False)))
        if depth > 0:
            options.append((1, lambda: p.UnaryOperation(operator="not", operand=nonrandom_condition(draft, depth - 1))))
            options.append((1, lambda: join_conditions(draft, [nonrandom_condition(draft, depth - 1), nonrandom_condition(draft, depth - 1)])))
        return first_that_works(draft, options)


def join_conditions(draft: Draft, operands: list[Expression]) -> Expression:
    """`a and b`, `a or b`."""
    return p.BooleanOperation(operator=draft.choices.pick(["and", "or"]), operands=tuple(operands))


def bounded_scalars(draft: Draft, *, random: bool) -> list[Variable]:
    """The scalar variables with known limits that are random, or that are not."""
    return [v for v in draft.known("scalar") if v.low > -FAR and v.random is random]


def threshold(draft: Draft, *, random: bool) -> Expression:
    """A variable compared with something in the middle of its values."""
    chosen = draft.choices.pick(bounded_scalars(draft, random=random))
    share, operators = draft.choices.weighted(SIDES)
    middle = round((chosen.low + share * (chosen.high - chosen.low)) * 4) / 4
    return comparison(name(chosen.name), draft.choices.pick(operators), number_literal(middle))


def guarded_division(draft: Draft) -> Expression:
    """`v != m and 1 / (v - m) < c`, `v == m or ...`: the second operand fails where the first decides."""
    chosen = draft.choices.pick(bounded_scalars(draft, random=True))
    middle = number_literal(round((chosen.low + chosen.high) * 2) / 4)
    inverse = operation(number_literal(1), "/", operation(name(chosen.name), "-", middle))
    hopeful = comparison(inverse, draft.choices.pick(["<", ">"]), number_literal(draft.choices.pick([0, 4, -4])))
    if draft.choices.chance(0.5):
        return p.BooleanOperation(operator="and", operands=(comparison(name(chosen.name), "!=", middle), hopeful))
    return p.BooleanOperation(operator="or", operands=(comparison(name(chosen.name), "==", middle), hopeful))


def flag(draft: Draft, chance: float) -> Expression:
    """A truth value that a property may have: True so often, or drawn."""
    if draft.may_draw() and draft.choices.chance(0.3) and draft.afford(2):
        return call("Uniform", constant_literal(True), constant_literal(False))
    return constant_literal(draft.choices.chance(chance))


def drawn_condition(draft: Draft) -> Expression:
    """A condition on a draw of its own; on nothing where that cannot be afforded."""
    value = distribution(draft, 0, 4, 1) if draft.may_draw() else None
    if value is None:
        return constant_literal(True)
    hopeful = call("Uniform", scalar_literal(draft, 0, 1.75), value)
    return comparison(hopeful, draft.choices.pick(["<=", "<"]), number_literal(2)) if draft.afford(2) else comparison(value, ">=", number_literal(0))


def untrue(draft: Draft) -> Expression:
    """`not E` for a whole number, which is untrue where it is 0."""
    if not (draft.may_draw() and draft.afford(3)):
        return p.UnaryOperation(operator="not", operand=constant_literal(False))
    return p.UnaryOperation(operator="not", operand=call("Uniform", constant_literal(0), constant_literal(0), scalar_literal(draft, 0, 3)))


def condition(draft: Draft, depth: int) -> Expression:
    """A condition for `require`, that holds often enough."""
    options: list[Option] = [(2, lambda: drawn_condition(draft))]
    if bounded_scalars(draft, random=True):
        options.append((8, lambda: threshold(draft, random=True)))
        options.append((2, lambda: guarded_division(draft)))
    if draft.known("boolean"):
        options.append((2, lambda: name(draft.choices.pick(draft.known("boolean")).name)))
    others = [v for v in draft.known("object") if v.name != "ego"]
    if others and draft.has_ego:
        options += spatial(draft, name(draft.choices.pick(others).name))
    options.append((1, lambda: untrue(draft)))
    if depth > 0:
        options.append((1, lambda: p.UnaryOperation(operator="not", operand=drawn_condition(draft))))
        options.append((2, lambda: join_conditions(draft, [condition(draft, depth - 1), condition(draft, depth - 1)])))
    return first_that_works(draft, options)


def spatial(draft: Draft, other: Expression) -> list[Option]:
    """Conditions on where another object is, seen from ego."""
    reach = draft.settings.area
    far = number_literal(draft.choices.pick([reach, reach / 2, 1.5 * reach]))
    options: list[Option] = [
        (2, lambda: comparison(e.Distance(target=other), draft.choices.pick(["<", "<="]), far)),
        (1, lambda: comparison(e.Distance(origin=other, target=vector_argument(draft, 1)), ">", number_literal(draft.choices.pick([2, 1, 4])))),
        (1, lambda: comparison(call("abs", e.Angle(target=other)), "<", degrees(draft.choices.pick([120, 90, 170])))),
        (1, lambda: comparison(call("abs", e.RelativeHeading(heading=other)), ">", degrees(draft.choices.pick([5, 30, 0])))),
        (1, lambda: comparison(e.ApparentHeading(oriented_point=other), draft.choices.pick(["<", ">"]), degrees(draft.choices.pick([30, 0])))),
        (1, lambda: comparison(e.DistancePast(vector=other), "<", far)),
    ]
    if draft.allows("visibility"):
        options.append((4, lambda: e.CanSee(viewer=name("ego"), target=draft.choices.pick([other, vector_argument(draft, 1)]))))
    if draft.allows("regions"):
        subject = draft.choices.pick([other, vector_argument(draft, 1)])
        options.append((3, lambda: is_in(subject, region_argument(draft))))
        if draft.allows("released"):
            options.append((6, lambda: is_in(subject, e.NotVisible(region=region_argument(draft)))))
    if draft.allows("released"):
        options.append((6, lambda: p.UnaryOperation(operator="not", operand=e.Intersects(left=name("ego"), right=other))))
    return options


def value(draft: Draft, depth: int) -> Expression:
    """A boolean for a variable or `param`: random or not."""
    if draft.choices.chance(0.1):
        return untrue(draft)
    return condition(draft, depth) if draft.choices.chance(0.7) else nonrandom_condition(draft, depth)

