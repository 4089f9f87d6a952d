"""Scalars: every expression that is written here has its values in the interval that was asked for."""

from __future__ import annotations

from math import ceil, floor

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from . import booleans, distributions, headings, vectors
from .draft import Draft, Option, Variable, first_that_works
from .tree import attribute, call, clamped, comparison, constant, name, number, operation


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
    return number(literal_value(draft, low, high))


def scalar(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """An expression with values in [low, high]."""
    options: list[Option] = [(4, lambda: scalar_literal(draft, low, high))]
    if draft.may_draw():
        options.append((5, lambda: distributions.distribution(draft, low, high, depth)))
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
        (1, lambda: scaled(draft, low, high, depth)),
        (1, lambda: call(draft.choices.pick(["min", "max"]), scalar(draft, low, high, depth), scalar(draft, low, high, depth))),
    ]
    if low <= -2 and high >= -1:
        options.append((1, lambda: p.UnaryOperation(operator="~", operand=booleans.drawn(draft))))  # True is 1 to it
    if low == -high:
        options.append((1, lambda: p.UnaryOperation(operator="-", operand=scalar(draft, low, high, depth))))
        options.append((1, lambda: operation(scalar(draft, low, high, depth), "*", scalar(draft, 0, 1, depth))))
    if draft.known("scalar"):
        options.append((2, lambda: clamped(name(draft.choices.pick(draft.known("scalar")).name), low, high)))
    if draft.allows("branches"):
        options.append((1, lambda: conditional(draft, low, high, depth)))
    if draft.known("list"):
        options.append((2, lambda: from_list(draft, low, high, depth)))
    if draft.known("lists") and not (draft.settled or draft.drawless):
        options.append((3, lambda: from_random_list(draft, low, high)))
    if draft.known("dictionary"):
        options.append((2, lambda: from_dictionary(draft, low, high)))
    if callable_here(draft, low, high):
        options.append((4, lambda: called(draft, low, high, depth)))
    if draft.known("object", "point") and not draft.settled:
        options.append((3, lambda: clamped(measured(draft, depth), low, high)))
    if draft.may_draw() and draft.allows("resample"):
        options.append((5, lambda: distributions.resampled(draft, low, high)))
    if draft.allows("functions") and depth > 0:
        options.append((1, lambda: applied_lambda(draft, low, high, depth)))
    return options


def difference(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`a - b` with a in the upper half and b no more than half of the interval."""
    half = (high - low) / 2
    return operation(scalar(draft, low + half, high, depth), "-", scalar(draft, 0, half, depth))


def scaled(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`a * k` or `a / k`."""
    if draft.choices.chance(0.5):
        return operation(scalar(draft, low * 2, high * 2, depth), "/", number(2))
    return operation(scalar(draft, low / 2, high / 2, depth), "*", number(2))


def conditional(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """`a if B else b`, B not random."""
    then, otherwise = scalar(draft, low, high, depth), scalar(draft, low, high, depth)
    return p.Conditional(test=booleans.settled(draft, 1), then=then, otherwise=otherwise)


def own_property(draft: Draft, low: float, high: float) -> Expression:
    """`self.name`, as it is if its values fit."""
    chosen = draft.choices.pick(draft.own)
    read = attribute(name("self"), chosen.name)
    return read if low <= chosen.low and chosen.high <= high else clamped(read, low, high)


def from_list(draft: Draft, low: float, high: float, depth: int) -> Expression:
    """An element of a list, or something that all elements give."""
    chosen = draft.choices.pick(draft.known("list"))
    xs = name(chosen.name)
    whole = call(draft.choices.pick(["sum", "max", "min", "len"]), xs)
    place = number(draft.choices.integer(-chosen.size, chosen.size - 1))
    if draft.choices.chance(0.3):
        return clamped(gone_through(draft, xs), low, high)
    if draft.choices.chance(0.5):
        return clamped(whole, low, high)
    element = p.Subscript(value=xs, index=place)
    return element if low <= chosen.low and chosen.high <= high else clamped(element, low, high)


def gone_through(draft: Draft, xs: Expression) -> Expression:
    """What a generator over a list gives: its first element, or all of them together."""
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
        (1, lambda: call(draft.choices.pick(["max", "min"]), p.Starred(value=xs), number(chosen.low), number(chosen.low))),
    ]
    if chosen.size:
        options.append((2, lambda: p.Subscript(value=xs, index=number(draft.choices.pick([0, -1])))))
        if draft.may_draw():
            options.append((3, lambda: call("Uniform", p.Starred(value=xs)) if draft.afford(chosen.most) else None))
    value = draft.choices.weighted(options)()
    return None if value is None else clamped(value, low, high)


def from_dictionary(draft: Draft, low: float, high: float) -> Expression:
    """`d['a']`."""
    chosen = draft.choices.pick(draft.known("dictionary"))
    return clamped(p.Subscript(value=name(chosen.name), index=constant("a")), low, high)


def callable_here(draft: Draft, low: float, high: float) -> list[Variable]:
    """The functions that may be called."""
    return [v for v in draft.known("function") if v.low >= low and v.high <= high and (not draft.drawless or v.cost == 1)]


def called(draft: Draft, low: float, high: float, depth: int) -> Expression | None:
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


def measured(draft: Draft, depth: int) -> Expression:
    """A scalar operator of the paper, or a property of an object: without limits."""
    return first_that_works(draft, measures(draft, depth))


def measures(draft: Draft, depth: int) -> list[Option]:
    """The scalar operators that can be written here."""
    someone = name(draft.choices.pick(draft.known("object", "point")).name)
    options: list[Option] = [
        (2, lambda: attribute(someone, "heading")),
        (1, lambda: attribute(someone, "position", draft.choices.pick(["x", "y"]))),
        (2, lambda: e.Distance(origin=vectors.vector_argument(draft, depth), target=vectors.vector_argument(draft, depth))),
        (1, lambda: e.Angle(origin=vectors.vector_argument(draft, depth), target=vectors.vector_argument(draft, depth))),
        (1, lambda: e.RelativeHeading(heading=headings.heading_argument(draft, depth), origin=headings.heading_argument(draft, depth))),
        (1, lambda: e.ApparentHeading(oriented_point=someone, origin=vectors.vector_argument(draft, depth))),
        (1, lambda: e.DistancePast(oriented_point=someone, vector=vectors.vector_argument(draft, depth))),
    ]
    if draft.allows("released"):
        options += [
            (1, lambda: attribute(someone, draft.choices.pick(["x", "y"]))),
            (1, lambda: call(attribute(someone, "distanceTo"), vectors.vector_argument(draft, depth))),
            (1, lambda: call(attribute(someone, "angleTo"), vectors.vector_argument(draft, depth))),
        ]
    if draft.known("object"):
        thing = name(draft.choices.pick(draft.known("object")).name)
        options.append((2, lambda: attribute(thing, draft.choices.pick(["width", "length", draft.view_distance]))))
    if draft.known("region"):
        region = name(draft.choices.pick(draft.known("region")).name)
        options.append((1, lambda: e.Distance(origin=vectors.vector_argument(draft, depth), target=region)))
    if draft.has_ego:
        options += [
            (1, lambda: e.Distance(target=vectors.vector_argument(draft, depth))),
            (1, lambda: e.Distance(origin=vectors.vector_argument(draft, depth))),
            (1, lambda: e.Angle(target=vectors.vector_argument(draft, depth))),
            (1, lambda: e.RelativeHeading(heading=headings.heading_argument(draft, depth))),
            (1, lambda: e.ApparentHeading(oriented_point=someone)),
            (1, lambda: e.DistancePast(vector=vectors.vector_argument(draft, depth))),
        ]
    return options


def between(draft: Draft, subject: Expression, low: float, high: float) -> Expression:
    """`low < subject < high`, or one side of it."""
    if draft.choices.chance(0.3):
        return p.Comparison(left=number(low), operators=("<=", "<"), operands=(subject, number(high)))
    return comparison(subject, ">", number(low)) if draft.choices.chance(0.5) else comparison(subject, "<=", number(high))
