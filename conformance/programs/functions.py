"""Functions: with defaults that are drawn once, spread arguments, closures; functions that create objects."""

from __future__ import annotations

from collections.abc import Callable

from ...semantics.syntax import Block, Statement
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import statements as s
from . import booleans, objects, scalars
from .draft import Draft, Variable
from .tree import alone, assign, attribute, call, clamped, constant, give_back, name, number, operation, parameter

FunctionForm = Callable[[Draft], tuple[Block, Variable]]


def definition(draft: Draft) -> tuple[Block, Variable]:
    """A function of one of several forms, and the variable that is bound to it."""
    forms: list[tuple[int, FunctionForm]] = [(4, plain), (2, with_default), (2, spreading), (1, short), (2, closure), (1, counter)]
    if objects.may_create(draft):
        forms.append((3, maker))
    return draft.choices.weighted(forms)(draft)


def function_body(draft: Draft, low: float, high: float) -> Block:
    """Statements of a function that returns a scalar in [low, high]."""
    draft.inside, before = "function", draft.inside
    found: list[Statement] = []
    if draft.choices.chance(0.5):
        local = draft.fresh("x")
        found.append(assign(local, scalars.scalar(draft, low, high, 2)))
        draft.define(Variable(local, "scalar", low, high))
    if draft.choices.chance(0.3):
        found.append(s.If(test=booleans.settled(draft, 1), then=(give_back(scalars.scalar(draft, low, high, 1)),)))
    found.append(give_back(scalars.scalar(draft, low, high, 2)))
    draft.inside = before
    return tuple(found)


def plain(draft: Draft) -> tuple[Block, Variable]:
    """`def f(a, b): return E`."""
    takes = tuple(draft.choices.pick([(0.0, 1.0), (-5.0, 5.0), (1.0, 3.0)]) for _ in range(draft.choices.integer(1, 2)))
    low, high = draft.choices.pick([(0.0, 4.0), (-5.0, 5.0), (1.0, 2.0)])
    function = draft.fresh("g")
    names = [draft.fresh("a") for _ in takes]
    with draft.definition():
        for each, (least, most) in zip(names, takes, strict=True):
            draft.define(Variable(each, "scalar", least, most))
        statements = function_body(draft, low, high)
        cost = draft.cost_so_far()
    node = s.FunctionDefinition(name=function, parameters=tuple(map(parameter, names)), body=statements)
    return (node,), Variable(function, "function", low, high, takes=takes, cost=cost)


def with_default(draft: Draft) -> tuple[Block, Variable]:
    """`def f(a, b=Range(0, 1)): return a + b`: the default is drawn once, when `def` runs."""
    function, first, second = draft.fresh("g"), draft.fresh("a"), draft.fresh("a")
    default = scalars.scalar(draft, 0, 1, 2)
    with draft.definition():
        draft.define(Variable(first, "scalar", 0, 1))
        draft.define(Variable(second, "scalar", 0, 1))
        statements = function_body(draft, 0, 2)
        cost = draft.cost_so_far()
    node = s.FunctionDefinition(name=function, parameters=(parameter(first), parameter(second, default)), body=statements)
    return (node,), Variable(function, "function", 0, 2, takes=((0.0, 1.0), (0.0, 1.0)), optional=1, cost=cost)


def spreading(draft: Draft) -> tuple[Block, Variable]:
    """`def f(a, *rest, **named): return a + sum(rest) + ...`."""
    function, first = draft.fresh("g"), draft.fresh("a")
    result = operation(name(first), "+", call("sum", name("rest")))
    named = draft.choices.chance(0.5)
    if named:
        result = operation(result, "+", call(attribute(name("named"), "get"), constant("extra"), number(0)))
    parameters = [parameter(first), parameter("rest", kind="*args")]
    if draft.choices.chance(0.3):
        parameters.append(parameter("more", scalars.scalar_literal(draft, 0, 1), kind="keyword only"))
        result = operation(result, "+", name("more"))
    if named:
        parameters.append(parameter("named", kind="**kwargs"))
    node = s.FunctionDefinition(name=function, parameters=tuple(parameters), body=(give_back(clamped(result, 0, 5)),))
    return (node,), Variable(function, "function", 0, 5, takes=((0.0, 1.0),), spreads=True, named=named)


def short(draft: Draft) -> tuple[Block, Variable]:
    """`f = lambda a: E`."""
    function, argument = draft.fresh("g"), draft.fresh("a")
    with draft.definition():
        draft.define(Variable(argument, "scalar", -1, 1))
        result = scalars.scalar(draft, -1, 1, 2)
        cost = draft.cost_so_far()
    value = p.Lambda(parameters=(parameter(argument),), body=result)
    return (assign(function, value),), Variable(function, "function", -1, 1, takes=((-1.0, 1.0),), cost=cost)


def closure(draft: Draft) -> tuple[Block, Variable]:
    """A function that returns a function, called at once: `f = outer(E)`."""
    outer, outside = draft.fresh("g"), draft.fresh("a")
    argument = scalars.scalar(draft, 0, 2, 2)
    with draft.definition():
        draft.define(Variable(outside, "scalar", 0, 2))
        (inner, *_), variable = plain(draft)
        cost = variable.cost
    node = s.FunctionDefinition(name=outer, parameters=(parameter(outside),), body=(inner, give_back(name(variable.name))))
    function = draft.fresh("g")
    made = assign(function, call(outer, argument))
    return (node, made), Variable(function, "function", variable.low, variable.high, takes=variable.takes, cost=cost)


def counter(draft: Draft) -> tuple[Block, Variable]:
    """A function with a state of its own: `nonlocal`."""
    outer, inner, count = draft.fresh("g"), draft.fresh("g"), draft.fresh("n")
    step = s.AugmentedAssignment(target=name(count), operator="+", value=number(1))
    result = give_back(call("min", operation(name(count), "*", name("a")), number(5)))
    body_ = (s.Nonlocal(names=(count,)), step, result)
    nested = s.FunctionDefinition(name=inner, parameters=(parameter("a"),), body=body_)
    node = s.FunctionDefinition(name=outer, parameters=(), body=(assign(count, number(0)), nested, give_back(name(inner))))
    function = draft.fresh("g")
    return (node, assign(function, call(outer))), Variable(function, "function", 0, 5, takes=((0.0, 2.0),))


def maker(draft: Draft) -> tuple[Block, Variable]:
    """`def make(a): return Object at (a, ...), ...`."""
    function, argument, reach = draft.fresh("make"), draft.fresh("a"), draft.settings.area
    before = draft.objects
    with draft.definition():
        draft.inside, outside = "function", draft.inside
        draft.define(Variable(argument, "scalar", -reach, reach))
        result = objects.definition(draft, 1)
        draft.inside = outside
        cost = draft.cost_so_far()
    draft.objects = before
    keep = draft.choices.chance(0.8)
    node = s.FunctionDefinition(name=function, parameters=(parameter(argument),), body=(give_back(result) if keep else alone(result),))
    return (node,), Variable(function, "maker", takes=((-reach, reach),), cost=cost, makes=1, named=keep)
