"""Booleans: conditions that control flow may depend on, and conditions for requirements."""

from __future__ import annotations

from ...semantics.syntax import Expression
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from . import distributions, regions, scalars, vectors
from .draft import FAR, Draft, Option, Variable, first_that_works
from .tree import Link, call, comparison, constant, degrees, is_in, name, number, operation

Side = tuple[float, tuple[Link, ...]]
SIDES: tuple[tuple[int, Side], ...] = ((3, (0.25, (">", ">="))), (3, (0.75, ("<", "<="))), (1, (0.5, ("<", "<=", ">", ">="))))
"""Where a variable's values are cut, as a share of their interval, and the comparisons that leave the larger part (weights first)."""


def settled(draft: Draft, depth: int) -> Expression:
    """A condition that is not random."""
    with draft.without_randomness():
        options: list[Option] = [
            (1, lambda: constant(draft.choices.chance(0.5))),
            (3, lambda: comparison(scalars.scalar(draft, 0, 3, depth), draft.choices.pick(["<", ">=", "==", "!="]), scalars.scalar_literal(draft, 0, 3))),
        ]
        if bounded(draft, random=False):
            options.append((4, lambda: threshold(draft, random=False)))
        if depth > 0:
            options.append((1, lambda: p.UnaryOperation(operator="not", operand=settled(draft, depth - 1))))
            options.append((1, lambda: joined(draft, [settled(draft, depth - 1), settled(draft, depth - 1)])))
        return first_that_works(draft, options)


def joined(draft: Draft, operands: list[Expression]) -> Expression:
    """`a and b`, `a or b`."""
    return p.BooleanOperation(operator=draft.choices.pick(["and", "or"]), operands=tuple(operands))


def bounded(draft: Draft, *, random: bool) -> list[Variable]:
    """The scalar variables with known limits that are random, or that are not."""
    return [v for v in draft.known("scalar") if v.low > -FAR and v.random is random]


def threshold(draft: Draft, *, random: bool) -> Expression:
    """A variable compared with something in the middle of its values."""
    chosen = draft.choices.pick(bounded(draft, random=random))
    share, operators = draft.choices.weighted(SIDES)
    middle = round((chosen.low + share * (chosen.high - chosen.low)) * 4) / 4
    return comparison(name(chosen.name), draft.choices.pick(operators), number(middle))


def guarded(draft: Draft) -> Expression:
    """`v != m and 1 / (v - m) < c`, `v == m or ...`: the second operand fails where the first decides."""
    chosen = draft.choices.pick(bounded(draft, random=True))
    middle = number(round((chosen.low + chosen.high) * 2) / 4)
    inverse = operation(number(1), "/", operation(name(chosen.name), "-", middle))
    hopeful = comparison(inverse, draft.choices.pick(["<", ">"]), number(draft.choices.pick([0, 4, -4])))
    if draft.choices.chance(0.5):
        return p.BooleanOperation(operator="and", operands=(comparison(name(chosen.name), "!=", middle), hopeful))
    return p.BooleanOperation(operator="or", operands=(comparison(name(chosen.name), "==", middle), hopeful))


def flag(draft: Draft, chance: float) -> Expression:
    """A truth value that a property may have: True so often, or drawn."""
    if draft.may_draw() and draft.choices.chance(0.3) and draft.afford(2):
        return call("Uniform", constant(True), constant(False))
    return constant(draft.choices.chance(chance))


def drawn(draft: Draft) -> Expression:
    """A condition on a draw of its own; on nothing where that cannot be afforded."""
    value = distributions.distribution(draft, 0, 4, 1) if draft.may_draw() else None
    if value is None:
        return constant(True)
    hopeful = call("Uniform", scalars.scalar_literal(draft, 0, 1.75), value)
    return comparison(hopeful, draft.choices.pick(["<=", "<"]), number(2)) if draft.afford(2) else comparison(value, ">=", number(0))


def untrue(draft: Draft) -> Expression:
    """`not E` for a whole number, which is untrue where it is 0."""
    if not (draft.may_draw() and draft.afford(3)):
        return p.UnaryOperation(operator="not", operand=constant(False))
    return p.UnaryOperation(operator="not", operand=call("Uniform", constant(0), constant(0), scalars.scalar_literal(draft, 0, 3)))


def condition(draft: Draft, depth: int) -> Expression:
    """A condition for `require`, that holds often enough."""
    options: list[Option] = [(2, lambda: drawn(draft))]
    if bounded(draft, random=True):
        options.append((8, lambda: threshold(draft, random=True)))
        options.append((2, lambda: guarded(draft)))
    if draft.known("boolean"):
        options.append((2, lambda: name(draft.choices.pick(draft.known("boolean")).name)))
    others = [v for v in draft.known("object") if v.name != "ego"]
    if others and draft.has_ego:
        options += spatial(draft, name(draft.choices.pick(others).name))
    options.append((1, lambda: untrue(draft)))
    if depth > 0:
        options.append((1, lambda: p.UnaryOperation(operator="not", operand=drawn(draft))))
        options.append((2, lambda: joined(draft, [condition(draft, depth - 1), condition(draft, depth - 1)])))
    return first_that_works(draft, options)


def spatial(draft: Draft, other: Expression) -> list[Option]:
    """Conditions on where another object is, seen from ego."""
    reach = draft.settings.area
    far = number(draft.choices.pick([reach, reach / 2, 1.5 * reach]))
    options: list[Option] = [
        (2, lambda: comparison(e.Distance(target=other), draft.choices.pick(["<", "<="]), far)),
        (1, lambda: comparison(e.Distance(origin=other, target=vectors.vector_argument(draft, 1)), ">", number(draft.choices.pick([2, 1, 4])))),
        (1, lambda: comparison(call("abs", e.Angle(target=other)), "<", degrees(draft.choices.pick([120, 90, 170])))),
        (1, lambda: comparison(call("abs", e.RelativeHeading(heading=other)), ">", degrees(draft.choices.pick([5, 30, 0])))),
        (1, lambda: comparison(e.ApparentHeading(oriented_point=other), draft.choices.pick(["<", ">"]), degrees(draft.choices.pick([30, 0])))),
        (1, lambda: comparison(e.DistancePast(vector=other), "<", far)),
    ]
    if draft.allows("visibility"):
        options.append((4, lambda: e.CanSee(viewer=name("ego"), target=draft.choices.pick([other, vectors.vector_argument(draft, 1)]))))
    if draft.allows("regions"):
        subject = draft.choices.pick([other, vectors.vector_argument(draft, 1)])
        options.append((3, lambda: is_in(subject, regions.region_argument(draft))))
        if draft.allows("released"):
            options.append((6, lambda: is_in(subject, e.NotVisible(region=regions.region_argument(draft)))))
    if draft.allows("released"):
        options.append((6, lambda: p.UnaryOperation(operator="not", operand=e.Intersects(left=name("ego"), right=other))))
    return options


def value(draft: Draft, depth: int) -> Expression:
    """A boolean for a variable or `param`: random or not."""
    if draft.choices.chance(0.1):
        return untrue(draft)
    return condition(draft, depth) if draft.choices.chance(0.7) else settled(draft, depth)
