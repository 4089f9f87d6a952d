"""Compound statements: loops, branches, exceptions, and which statements may stand in their blocks."""

from __future__ import annotations

from ...semantics.syntax import Block, Statement
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s
from . import booleans, objects, scalars, statements
from .draft import Draft, Variable
from .statements import Form
from .tree import assign, call, clamped, comparison, constant, name, new_object, number, operation, pair

FORMS: tuple[tuple[int, str, Form], ...] = (
    (6, "", statements.scalar),
    (2, "resample", statements.again),
    (2, "", statements.vector),
    (2, "", statements.heading),
    (1, "", statements.boolean),
    (2, "", statements.param),
    (1, "", statements.changed),
    (1, "", statements.moved),
    (1, "", statements.printed),
    (7, "", statements.thing),
    (1, "containers", statements.unpacking),
    (2, "containers", statements.listed),
    (1, "containers", statements.appended),
    (1, "containers", statements.dictionary),
    (1, "containers", statements.imported),
    (3, "points", statements.point),
    (3, "regions", statements.region),
    (3, "fields", statements.field),
    (12, "waiting", statements.delayed),
    (5, "random_length", statements.random_list),
    (2, "random_length", statements.random_pair),
    (3, "choice_of_objects", statements.chosen_object),
    (5, "requirements", statements.require),
    (5, "soft", statements.soft_require),
    (2, "mutate", statements.mutate),
    (3, "functions", statements.made_by_function),
)
"""The simple statements with their weights and the features that allow them."""


def simple(draft: Draft) -> Block:
    """One simple statement, or what it takes in its place."""
    options = [(weight, form) for weight, feature, form in FORMS if not feature or draft.allows(feature)]
    return draft.choices.weighted(options)(draft) or statements.scalar(draft)


def block_body(draft: Draft, count: int) -> Block:
    """Some simple statements as the body of a loop or branch."""
    before, draft.inside = draft.inside, "loop"
    found: list[Statement] = []
    for _ in range(count):
        found += simple(draft)
    draft.inside = before
    return tuple(found)


def statement(draft: Draft) -> Block:
    """A statement of the top level."""
    options: list[tuple[int, Form]] = [(8, simple)]
    if draft.allows("classes"):
        options.append((2, statements.class_))
    if draft.allows("functions"):
        options.append((2, statements.function))
    if draft.allows("branches"):
        options += [(1, branch), (1, attempt)]
    if draft.allows("loops"):
        options += [(2, counted), (1, waiting), (1, accumulating), (1, comprehended), (1, row)]
    return draft.choices.weighted(options)(draft) or simple(draft)


def branch(draft: Draft) -> Block:
    """`if B: ... elif B: ... else: ...`, B not random."""
    with draft.block():
        then = block_body(draft, draft.choices.integer(1, 2))
    otherwise: Block = ()
    if draft.choices.chance(0.5):
        with draft.block():
            otherwise = block_body(draft, 1)
        if draft.choices.chance(0.3):
            otherwise = (s.If(test=booleans.settled(draft, 1), then=otherwise, otherwise=(s.Pass(),)),)
    return (s.If(test=booleans.settled(draft, 2), then=then, otherwise=otherwise),)


def attempt(draft: Draft) -> Block:
    """`try: ... except ...: ... finally: ...`; the exception is not random."""
    target = draft.fresh("x")
    first, second = scalars.scalar(draft, 0, 4, 1), scalars.scalar(draft, 0, 4, 1)
    index = number(draft.choices.integer(0, 2))
    risky = assign(target, p.Subscript(value=p.ListDisplay(items=(first,)), index=index))
    handler = s.Handler(type=name("IndexError"), name=draft.choices.pick([None, "problem"]), body=(assign(target, second),))
    final: Block = (s.Pass(),) if draft.choices.chance(0.3) else ()
    draft.define(Variable(target, "scalar", 0, 4))
    return (s.Try(body=(risky,), handlers=(handler,), final=final),)


def counted(draft: Draft) -> Block:
    """`for i in range(n): ...`, perhaps with `break` or `continue`."""
    turns, index = draft.choices.integer(1, draft.settings.max_loop), draft.fresh("i")
    with draft.block(turns):
        draft.define(Variable(index, "scalar", 0, turns - 1, random=False))
        found = list(block_body(draft, draft.choices.integer(1, 2)))
    if draft.choices.chance(0.3):
        leave = draft.choices.pick([s.Break(), s.Continue()])
        test = comparison(name(index), "==", number(draft.choices.integer(0, turns)))
        found.insert(draft.choices.integer(0, 1), s.If(test=test, then=(leave,)))
    otherwise: Block = (s.Pass(),) if draft.choices.chance(0.1) else ()
    return (s.For(target=name(index), iterable=call("range", number(turns)), body=tuple(found), otherwise=otherwise),)


def waiting(draft: Draft) -> Block:
    """`n = 0`, `while n < k: ...; n += 1`."""
    turns, count = draft.choices.integer(1, draft.settings.max_loop), draft.fresh("n")
    with draft.block(turns):
        draft.define(Variable(count, "scalar", 0, turns, random=False))
        found = block_body(draft, 1)
    step = s.AugmentedAssignment(target=name(count), operator="+", value=number(1))
    loop = s.While(test=comparison(name(count), "<", number(turns)), body=(*found, step))
    draft.define(Variable(count, "scalar", 0, turns, random=False))
    return (assign(count, number(0)), loop)


def accumulating(draft: Draft) -> Block:
    """`total = 0`, `for each in [...]: total += E`."""
    total, each = draft.fresh("x"), draft.fresh("i")
    elements = tuple(scalars.scalar(draft, 0, 1, 1) for _ in range(draft.choices.integer(1, draft.settings.max_loop)))
    with draft.block(len(elements)):
        draft.define(Variable(each, "scalar", 0, 1))
        value = operation(name(each), "*", scalars.scalar(draft, 0, 1, 1))
    step = s.AugmentedAssignment(target=name(total), operator="+", value=value)
    draft.define(Variable(total, "scalar", 0, len(elements)))
    return (assign(total, number(0)), s.For(target=name(each), iterable=p.ListDisplay(items=elements), body=(step,)))


def comprehended(draft: Draft) -> Block:
    """`xs = [E for i in range(n)]`, with a condition that is not random or without, or from pairs of `enumerate`."""
    turns, index = draft.choices.integer(1, draft.settings.max_loop), draft.fresh("i")
    low, high = draft.choices.pick(statements.INTERVALS[:4])
    conditions = (comparison(name(index), ">=", number(draft.choices.integer(0, turns - 1))),) if draft.choices.chance(0.3) else ()
    size = turns if not conditions else 1
    with draft.block(turns):
        draft.define(Variable(index, "scalar", 0, turns - 1, random=False))
        element = scalars.scalar(draft, low, high, 2)
    clause = p.ComprehensionClause(target=name(index), iterable=call("range", number(turns)), conditions=conditions)
    target = draft.define(Variable(draft.fresh("xs"), "list", low, high, size=size, most=turns)).name
    value = p.Comprehension(kind="list", element=element, clauses=(clause,))
    if draft.choices.chance(0.2):
        return (assign(target, value), *unpacked(draft, target))
    return (assign(target, value),)


def unpacked(draft: Draft, xs: str) -> Block:
    """`for i, x in enumerate(xs): ...` over a list: the pairs are taken apart."""
    total = draft.fresh("x")
    target = p.TupleDisplay(items=(name("place"), name("entry")))
    step = assign(total, clamped(operation(name("entry"), "-", name("place")), -5, 5))
    draft.define(Variable(total, "scalar", -5, 5))
    return (s.For(target=target, iterable=call("enumerate", name(xs)), body=(step,)),)


def row(draft: Draft) -> Block | None:
    """`things = [Object at (i * 4, E) for i in range(n)]`: objects in a row, and one of them."""
    count, index = draft.choices.integer(2, draft.settings.max_loop) if draft.settings.max_loop > 1 else 1, draft.fresh("i")
    with draft.block(count):
        if not objects.may_create(draft):
            return None
        draft.define(Variable(index, "scalar", 0, count - 1, random=False))
        across = operation(operation(name(index), "*", number(5)), "+", scalars.scalar_literal(draft, -10, 5))
        place = q.AtSpecifier(vector=pair(across, scalars.scalar(draft, -10, 10, 1)))
        made = new_object("Object", [place, *frozen(draft)])
    draft.objects += count
    clause = p.ComprehensionClause(target=name(index), iterable=call("range", number(count)))
    things = draft.fresh("things")
    chosen = draft.fresh("o")
    draft.define(Variable(chosen, "object"))
    take = assign(chosen, p.Subscript(value=name(things), index=number(draft.choices.integer(-1, count - 1))))
    return (assign(things, p.Comprehension(kind="list", element=made, clauses=(clause,))), take)


def frozen(draft: Draft) -> list[q.WithSpecifier]:
    """No noise under `mutate` in finite programs; else, sometimes, a larger noise."""
    if draft.settings.finite:
        return [q.WithSpecifier(property=each, value=constant(0)) for each in ("positionStdDev", "headingStdDev")] if draft.allows("mutate") else []
    return [q.WithSpecifier(property="positionStdDev", value=number(2))] if draft.choices.chance(0.2) else []


