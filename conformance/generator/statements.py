"""Statements of generated programs: simple ones, functions, and compound statements with what may stand in their blocks."""

from __future__ import annotations

from collections.abc import Callable

from ...semantics.syntax import Block, Expression, Statement
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s
from . import expressions, objects
from .ast_builders import (
    alone,
    assign,
    attribute,
    call,
    clamp_call,
    comparison,
    constant_literal,
    give_back,
    name,
    new_object,
    number_literal,
    operation,
    pair,
    parameter,
)
from .program_draft import FAR, Draft, Variable

FunctionForm = Callable[[Draft], tuple[Block, Variable]]


def definition(draft: Draft) -> tuple[Block, Variable]:
    """A function of one of several forms, and the variable that is bound to it."""
    forms: list[tuple[int, FunctionForm]] = [
        (4, scalar_function_definition), (2, with_default), (2, variadic_definition), (1, lambda_definition), (2, closure), (1, counter)
    ]
    if objects.may_create(draft):
        forms.append((3, maker))
    return draft.choices.weighted(forms)(draft)


def function_body(draft: Draft, low: float, high: float) -> Block:
    """Statements of a function that returns a scalar in [low, high]."""
    draft.inside, before = "function", draft.inside
    found: list[Statement] = []
    if draft.choices.chance(0.5):
        local = draft.fresh("x")
        found.append(assign(local, expressions.scalar(draft, low, high, 2)))
        draft.define(Variable(local, "scalar", low, high))
    if draft.choices.chance(0.3):
        found.append(s.If(test=expressions.nonrandom_condition(draft, 1), then=(give_back(expressions.scalar(draft, low, high, 1)),)))
    found.append(give_back(expressions.scalar(draft, low, high, 2)))
    draft.inside = before
    return tuple(found)


def scalar_function_definition(draft: Draft) -> tuple[Block, Variable]:
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
    default = expressions.scalar(draft, 0, 1, 2)
    with draft.definition():
        draft.define(Variable(first, "scalar", 0, 1))
        draft.define(Variable(second, "scalar", 0, 1))
        statements = function_body(draft, 0, 2)
        cost = draft.cost_so_far()
    node = s.FunctionDefinition(name=function, parameters=(parameter(first), parameter(second, default)), body=statements)
    return (node,), Variable(function, "function", 0, 2, takes=((0.0, 1.0), (0.0, 1.0)), optional=1, cost=cost)


def variadic_definition(draft: Draft) -> tuple[Block, Variable]:
    """`def f(a, *rest, **named): return a + sum(rest) + ...`."""
    function, first = draft.fresh("g"), draft.fresh("a")
    result = operation(name(first), "+", call("sum", name("rest")))
    named = draft.choices.chance(0.5)
    if named:
        result = operation(result, "+", call(attribute(name("named"), "get"), constant_literal("extra"), number_literal(0)))
    parameters = [parameter(first), parameter("rest", kind="*args")]
    if draft.choices.chance(0.3):
        parameters.append(parameter("more", expressions.scalar_literal(draft, 0, 1), kind="keyword only"))
        result = operation(result, "+", name("more"))
    if named:
        parameters.append(parameter("named", kind="**kwargs"))
    node = s.FunctionDefinition(name=function, parameters=tuple(parameters), body=(give_back(clamp_call(result, 0, 5)),))
    return (node,), Variable(function, "function", 0, 5, takes=((0.0, 1.0),), spreads=True, named=named)


def lambda_definition(draft: Draft) -> tuple[Block, Variable]:
    """`f = lambda a: E`."""
    function, argument = draft.fresh("g"), draft.fresh("a")
    with draft.definition():
        draft.define(Variable(argument, "scalar", -1, 1))
        result = expressions.scalar(draft, -1, 1, 2)
        cost = draft.cost_so_far()
    value = p.Lambda(parameters=(parameter(argument),), body=result)
    return (assign(function, value),), Variable(function, "function", -1, 1, takes=((-1.0, 1.0),), cost=cost)


def closure(draft: Draft) -> tuple[Block, Variable]:
    """A function that returns a function, called at once: `f = outer(E)`."""
    outer, outside = draft.fresh("g"), draft.fresh("a")
    argument = expressions.scalar(draft, 0, 2, 2)
    with draft.definition():
        draft.define(Variable(outside, "scalar", 0, 2))
        (inner, *_), variable = scalar_function_definition(draft)
        cost = variable.cost
    node = s.FunctionDefinition(name=outer, parameters=(parameter(outside),), body=(inner, give_back(name(variable.name))))
    function = draft.fresh("g")
    made = assign(function, call(outer, argument))
    return (node, made), Variable(function, "function", variable.low, variable.high, takes=variable.takes, cost=cost)


def counter(draft: Draft) -> tuple[Block, Variable]:
    """A function with a state of its own: `nonlocal`."""
    outer, inner, count = draft.fresh("g"), draft.fresh("g"), draft.fresh("n")
    step = s.AugmentedAssignment(target=name(count), operator="+", value=number_literal(1))
    result = give_back(call("min", operation(name(count), "*", name("a")), number_literal(5)))
    body_ = (s.Nonlocal(names=(count,)), step, result)
    nested = s.FunctionDefinition(name=inner, parameters=(parameter("a"),), body=body_)
    node = s.FunctionDefinition(name=outer, parameters=(), body=(assign(count, number_literal(0)), nested, give_back(name(inner))))
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


Form = Callable[[Draft], "Block | None"]

INTERVALS = ((0.0, 1.0), (0.0, 4.0), (-5.0, 5.0), (1.0, 3.0), (-20.0, 20.0))
CHANCES = (0.5, 0.75, 0.25)


def scalar(draft: Draft) -> Block:
    """`x = E`, random or not."""
    low, high = draft.choices.pick(INTERVALS)
    target = draft.fresh("x")
    if draft.choices.chance(0.3):
        with draft.without_randomness():
            value = expressions.scalar(draft, low, high, draft.settings.max_depth)
        draft.define(Variable(target, "scalar", low, high, random=False))
    else:
        value = None
        if draft.choices.chance(0.5):
            value = expressions.distribution(draft, low, high, draft.settings.max_depth)
        value = value or expressions.scalar(draft, low, high, draft.settings.max_depth)
        draft.define(Variable(target, "scalar", low, high, random=draft.is_random(value), ways=expressions.ways_of(value)))
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


def multiple_assignment(draft: Draft) -> Block:
    """`a, b = E, E`, or `a = b = E`."""
    low, high = draft.choices.pick(INTERVALS)
    first, second = draft.fresh("x"), draft.fresh("x")
    if draft.choices.chance(0.5):
        value = expressions.scalar(draft, low, high, 2)
        made = s.Assignment(targets=(name(first), name(second)), value=assign("_", value).value)
    else:
        values = p.TupleDisplay(items=(expressions.scalar(draft, low, high, 2), expressions.scalar(draft, low, high, 2)))
        made = s.Assignment(targets=(p.TupleDisplay(items=(name(first), name(second))),), value=values)
    for each in (first, second):
        draft.define(Variable(each, "scalar", low, high))
    return (made,)


def heading(draft: Draft) -> Block:
    """`h = H`."""
    value = expressions.heading(draft, draft.settings.max_depth)
    return (assign(draft.define(Variable(draft.fresh("h"), "heading")).name, value),)


def vector_assignment(draft: Draft) -> Block:
    """`v = V`."""
    reach = draft.settings.area * draft.choices.pick([0.5, 1, 0.25])
    value = expressions.vector_expression(draft, reach, draft.settings.max_depth)
    return (assign(draft.define(Variable(draft.fresh("v"), "vector", -reach, reach)).name, value),)


def boolean(draft: Draft) -> Block:
    """`b = B`."""
    value = expressions.value(draft, 1)
    return (assign(draft.define(Variable(draft.fresh("b"), "boolean")).name, value),)


def point(draft: Draft) -> Block:
    """`spot = OrientedPoint ...`, or a derived point."""
    value = expressions.oriented_point(draft, 2)
    return (assign(draft.define(Variable(draft.fresh("spot"), "point")).name, value),)


def region(draft: Draft) -> Block:
    """`r = R`."""
    value = expressions.region(draft, 1)
    return (assign(draft.define(Variable(draft.fresh("r"), "region")).name, value),)


def field(draft: Draft) -> Block:
    """`f = VectorField(...)`."""
    value = expressions.field(draft)
    return (assign(draft.define(expressions.defined_field(draft)).name, value),)


def object_statement(draft: Draft) -> Block | None:
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
    value = call(chosen.name, expressions.scalar(draft, *chosen.takes[0], 1))
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


def list_assignment(draft: Draft) -> Block:
    """`xs = [E, ...]`, a slice or a sorted copy of it."""
    low, high = draft.choices.pick(INTERVALS[:4])
    size = draft.choices.integer(1, draft.settings.max_loop)
    value: Expression = p.ListDisplay(items=tuple(expressions.scalar(draft, low, high, 2) for _ in range(size)))
    if draft.choices.chance(0.2):
        value = p.Subscript(value=value, index=p.Slice(step=number_literal(-1)))
    return (assign(draft.define(Variable(draft.fresh("xs"), "list", low, high, size=size, most=size)).name, value),)


def delayed_assignment(draft: Draft) -> Block | None:
    """`w = H relative to F`, or a list of such values, and perhaps an object that it waits for; a field, where there is none."""
    if not draft.allows("fields"):
        return None
    if not draft.known("field"):
        return field(draft)
    value = objects.relative(draft)
    if draft.choices.chance(0.4):
        value = operation(value, draft.choices.pick(["+", "-"]), expressions.scalar(draft, -1, 1, 1))
    if draft.choices.chance(0.2):
        value = p.Subscript(value=p.ListDisplay(items=(value, constant_literal(0))), index=constant_literal(0))
    waiting = assign(draft.define(Variable(draft.fresh("w"), "waiting")).name, value)
    if not objects.may_create(draft) or draft.choices.chance(0.3):
        return (waiting,)
    return (waiting, *(object_statement(draft) or ()))


def random_list(draft: Draft) -> Block | None:
    """`xs = Uniform([...], [...])`, or `xs = filter(lambda v: v > c, ys)`: its length is random."""
    low, high = draft.choices.pick(INTERVALS[:4])
    target = draft.fresh("ls")
    known = draft.known("list", "lists")
    if known and draft.choices.chance(0.6):
        chosen = draft.choices.pick(known)
        test = p.Lambda(
            parameters=(p.Parameter(name="v"),), body=comparison(name("v"), ">", expressions.scalar_literal(draft, chosen.low, chosen.high))
        )
        value: Expression = call("filter", test, name(chosen.name))
        draft.define(Variable(target, "lists", chosen.low, chosen.high, size=0, most=chosen.most))
        return (assign(target, value),)
    if not draft.afford(2):
        return None
    sizes = [draft.choices.integer(1, draft.settings.max_loop) for _ in range(2)]
    value = call("Uniform", *(p.ListDisplay(items=tuple(expressions.scalar_literal(draft, low, high) for _ in range(size))) for size in sizes))
    draft.define(Variable(target, "lists", low, high, size=min(sizes), most=max(sizes)))
    return (assign(target, value),)


def random_pair(draft: Draft) -> Block | None:
    """`a, b = Uniform((E, E), (E, E))`."""
    low, high = draft.choices.pick(INTERVALS)
    if not draft.afford(2):
        return None
    pairs = (p.TupleDisplay(items=(expressions.scalar_literal(draft, low, high), expressions.scalar_literal(draft, low, high))) for _ in range(2))
    first, second = draft.fresh("x"), draft.fresh("x")
    for each in (first, second):
        draft.define(Variable(each, "scalar", low, high))
    target = p.TupleDisplay(items=(name(first), name(second)))
    return (s.Assignment(targets=(target,), value=call("Uniform", *pairs)),)


def append_statement(draft: Draft) -> Block | None:
    """`xs.append(E)`."""
    known = draft.known("list")
    if not known or draft.inside == "function" or draft.repeats > 1:
        return None
    chosen = draft.choices.pick(known)
    value = expressions.scalar(draft, chosen.low, chosen.high, 1)
    sure = draft.inside == "program"
    draft.define(Variable(chosen.name, "list", chosen.low, chosen.high, size=chosen.size + sure, most=chosen.most + 1))
    return (alone(call(attribute(name(chosen.name), "append"), value)),)


def dictionary(draft: Draft) -> Block:
    """`d = {'a': E, 'b': E}`."""
    items = tuple((constant_literal(key), expressions.scalar(draft, 0, 4, 2)) for key in "ab")
    return (assign(draft.define(Variable(draft.fresh("d"), "dictionary")).name, p.DictDisplay(items=items)),)


def variable_reassignment(draft: Draft) -> Block | None:
    """A variable assigned again, with the same kind of value."""
    known = [v for v in draft.known("scalar") if v.random and v.low > -FAR]
    if not known or draft.inside == "function":
        return None
    chosen = draft.choices.pick(known)
    if draft.choices.chance(0.3) and draft.inside == "program":
        value = expressions.scalar(draft, 0, 1, 1)
        draft.define(Variable(chosen.name, "scalar", chosen.low, chosen.high + 1))
        return (s.AugmentedAssignment(target=name(chosen.name), operator="+", value=value),)
    value = expressions.scalar(draft, chosen.low, chosen.high, 2)
    if draft.inside == "program":
        draft.define(Variable(chosen.name, "scalar", chosen.low, chosen.high, ways=expressions.ways_of(value)))
    return (assign(chosen.name, value),)


def property_assignment(draft: Draft) -> Block | None:
    """`o.p = E`: a property of an object assigned after its creation."""
    known = [v for v in draft.known("object") if not v.ways]
    if not known:
        return None
    target = attribute(name(draft.choices.pick(known).name), draft.choices.pick(["speed", "width", "tag"]))
    return (s.Assignment(targets=(target,), value=assign("_", expressions.scalar(draft, 0.5, 2, 1)).value),)


def require(draft: Draft) -> Block:
    """`require B`."""
    return (s.Require(condition=expressions.condition(draft, 1)),)


def soft_require(draft: Draft) -> Block | None:
    """`require[p] B`."""
    if not draft.afford(2):
        return None
    return (s.SoftRequire(probability=number_literal(draft.choices.pick(CHANCES)), condition=expressions.condition(draft, 1)),)


def mutate(draft: Draft) -> Block | None:
    """`mutate`, `mutate o by s`; in finite programs all standard deviations are 0."""
    known = [v for v in draft.known("object") if not v.ways]
    if not known:
        return None
    chosen = draft.choices.some(known, 0, 2)
    scale = expressions.scalar(draft, 0, 2, 1) if draft.choices.chance(0.5) else None
    return (s.Mutate(objects=tuple(name(v.name) for v in chosen), scale=scale),)


def traceless_statement(draft: Draft) -> Block | None:
    """`assert`, `pass`, `print`: statements that leave no trace in the scene."""
    match draft.choices.integer(0, 2):
        case 0:
            return (s.Pass(),)
        case 1:
            return (alone(call("print", constant_literal("here"), expressions.scalar_literal(draft, 0, 5))),)
        case _:
            return (
                s.Assert(
                    test=p.Comparison(left=number_literal(1), operators=("<",), operands=(number_literal(2),)), message=constant_literal("never")
                ),
            )


def param(draft: Draft) -> Block:
    """`param name = E`."""
    value = draft.choices.weighted([(3, scalar_value), (1, boolean_value), (1, text_value), (1, vector_value)])(draft)
    return (s.Param(assignments=(s.ParamAssignment(name=draft.fresh("q"), value=value),)),)


def scalar_value(draft: Draft) -> Expression:
    """A scalar for `param`."""
    return expressions.scalar(draft, -5, 5, 2)


def boolean_value(draft: Draft) -> Expression:
    """A boolean for `param`."""
    return expressions.value(draft, 1)


def vector_value(draft: Draft) -> Expression:
    """A vector for `param`."""
    return expressions.vector_expression(draft, draft.settings.area, 2)


def text_value(draft: Draft) -> Expression:
    """Generate an f-string with a number in it."""
    layout = p.FString(parts=(".2f",)) if draft.choices.chance(0.5) else None
    return p.FString(parts=("at ", p.FormattedValue(value=expressions.scalar(draft, 0, 4, 1), format=layout), "!"))


def math_import(draft: Draft) -> Block:
    """`import math` and a call of it."""
    target = draft.fresh("x")
    value = call(attribute(name("math"), draft.choices.pick(["floor", "sqrt"])), expressions.scalar(draft, 0, 4, 1))
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
    block, variable = definition(draft)
    draft.define(variable)
    return block


def workspace(draft: Draft) -> Block:
    """`workspace = Workspace(R)`, larger than where objects stand as a rule."""
    reach = draft.settings.area
    sides = number_literal(draft.choices.pick([3 * reach, 4 * reach]))
    disc = call("CircularRegion", expressions.vector_literal(draft, 2), number_literal(2 * reach))
    square = call("RectangularRegion", expressions.vector_literal(draft, 2), number_literal(0), sides, sides)
    shape = draft.choices.pick([disc, square])
    return (assign("workspace", call("Workspace", shape)),)


def ego(draft: Draft) -> Block:
    """`ego = Object ...`."""
    reach = draft.settings.area
    if draft.choices.chance(0.7):
        value = objects.definition(draft, 2)
    else:
        draft.objects += 1
        found = [q.AtSpecifier(vector=expressions.vector_expression(draft, reach / 2, 1))]
        found += [
            q.WithSpecifier(property=each, value=constant_literal(0)) for each in ("positionStdDev", "headingStdDev")
        ] if draft.settings.finite else []
        value = new_object("Object", found)
    draft.has_ego = True
    draft.define(Variable("ego", "object"))
    return (assign("ego", value),)


def closing_param(draft: Draft) -> Block:
    """`param` with the variables that a scene would not show otherwise."""
    known = [v for v in draft.variables if v.kind in ("scalar", "heading", "vector", "boolean", "list", "dictionary")]
    chosen = draft.choices.some(known, 0, 4) if known else []
    made = [s.ParamAssignment(name=f"_{v.name}".strip("_"), value=name(v.name)) for v in chosen]
    if draft.objects > 1 and draft.choices.chance(0.3):
        made.append(s.ParamAssignment(name="sum", value=operation(attribute(name("ego"), "width"), "+", number_literal(1))))
    return (s.Param(assignments=tuple(made)),) if made else ()


FORMS: tuple[tuple[int, str, Form], ...] = (
    (6, "", scalar),
    (2, "resample", again),
    (2, "", vector_assignment),
    (2, "", heading),
    (1, "", boolean),
    (2, "", param),
    (1, "", variable_reassignment),
    (1, "", property_assignment),
    (1, "", traceless_statement),
    (7, "", object_statement),
    (1, "containers", multiple_assignment),
    (2, "containers", list_assignment),
    (1, "containers", append_statement),
    (1, "containers", dictionary),
    (1, "containers", math_import),
    (3, "points", point),
    (3, "regions", region),
    (3, "fields", field),
    (12, "waiting", delayed_assignment),
    (5, "random_length", random_list),
    (2, "random_length", random_pair),
    (3, "choice_of_objects", chosen_object),
    (5, "requirements", require),
    (5, "soft", soft_require),
    (2, "mutate", mutate),
    (3, "functions", made_by_function),
)
"""The simple statements with their weights and the features that allow them."""


def simple(draft: Draft) -> Block:
    """One simple statement, or what it takes in its place."""
    options = [(weight, form) for weight, feature, form in FORMS if not feature or draft.allows(feature)]
    return draft.choices.weighted(options)(draft) or scalar(draft)


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
        options.append((2, class_))
    if draft.allows("functions"):
        options.append((2, function))
    if draft.allows("branches"):
        options += [(1, branch), (1, attempt)]
    if draft.allows("loops"):
        options += [(2, range_loop), (1, while_loop), (1, sum_loop), (1, list_comprehension), (1, row)]
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
            otherwise = (s.If(test=expressions.nonrandom_condition(draft, 1), then=otherwise, otherwise=(s.Pass(),)),)
    return (s.If(test=expressions.nonrandom_condition(draft, 2), then=then, otherwise=otherwise),)


def attempt(draft: Draft) -> Block:
    """`try: ... except ...: ... finally: ...`; the exception is not random."""
    target = draft.fresh("x")
    first, second = expressions.scalar(draft, 0, 4, 1), expressions.scalar(draft, 0, 4, 1)
    index = number_literal(draft.choices.integer(0, 2))
    risky = assign(target, p.Subscript(value=p.ListDisplay(items=(first,)), index=index))
    handler = s.Handler(type=name("IndexError"), name=draft.choices.pick([None, "problem"]), body=(assign(target, second),))
    final: Block = (s.Pass(),) if draft.choices.chance(0.3) else ()
    draft.define(Variable(target, "scalar", 0, 4))
    return (s.Try(body=(risky,), handlers=(handler,), final=final),)


def range_loop(draft: Draft) -> Block:
    """`for i in range(n): ...`, perhaps with `break` or `continue`."""
    turns, index = draft.choices.integer(1, draft.settings.max_loop), draft.fresh("i")
    with draft.block(turns):
        draft.define(Variable(index, "scalar", 0, turns - 1, random=False))
        found = list(block_body(draft, draft.choices.integer(1, 2)))
    if draft.choices.chance(0.3):
        leave = draft.choices.pick([s.Break(), s.Continue()])
        test = comparison(name(index), "==", number_literal(draft.choices.integer(0, turns)))
        found.insert(draft.choices.integer(0, 1), s.If(test=test, then=(leave,)))
    otherwise: Block = (s.Pass(),) if draft.choices.chance(0.1) else ()
    return (s.For(target=name(index), iterable=call("range", number_literal(turns)), body=tuple(found), otherwise=otherwise),)


def while_loop(draft: Draft) -> Block:
    """`n = 0`, `while n < k: ...; n += 1`."""
    turns, count = draft.choices.integer(1, draft.settings.max_loop), draft.fresh("n")
    with draft.block(turns):
        draft.define(Variable(count, "scalar", 0, turns, random=False))
        found = block_body(draft, 1)
    step = s.AugmentedAssignment(target=name(count), operator="+", value=number_literal(1))
    loop = s.While(test=comparison(name(count), "<", number_literal(turns)), body=(*found, step))
    draft.define(Variable(count, "scalar", 0, turns, random=False))
    return (assign(count, number_literal(0)), loop)


def sum_loop(draft: Draft) -> Block:
    """`total = 0`, `for each in [...]: total += E`."""
    total, each = draft.fresh("x"), draft.fresh("i")
    elements = tuple(expressions.scalar(draft, 0, 1, 1) for _ in range(draft.choices.integer(1, draft.settings.max_loop)))
    with draft.block(len(elements)):
        draft.define(Variable(each, "scalar", 0, 1))
        value = operation(name(each), "*", expressions.scalar(draft, 0, 1, 1))
    step = s.AugmentedAssignment(target=name(total), operator="+", value=value)
    draft.define(Variable(total, "scalar", 0, len(elements)))
    return (assign(total, number_literal(0)), s.For(target=name(each), iterable=p.ListDisplay(items=elements), body=(step,)))


def list_comprehension(draft: Draft) -> Block:
    """`xs = [E for i in range(n)]`, with a condition that is not random or without, or from pairs of `enumerate`."""
    turns, index = draft.choices.integer(1, draft.settings.max_loop), draft.fresh("i")
    low, high = draft.choices.pick(INTERVALS[:4])
    conditions = (comparison(name(index), ">=", number_literal(draft.choices.integer(0, turns - 1))),) if draft.choices.chance(0.3) else ()
    size = turns if not conditions else 1
    with draft.block(turns):
        draft.define(Variable(index, "scalar", 0, turns - 1, random=False))
        element = expressions.scalar(draft, low, high, 2)
    clause = p.ComprehensionClause(target=name(index), iterable=call("range", number_literal(turns)), conditions=conditions)
    target = draft.define(Variable(draft.fresh("xs"), "list", low, high, size=size, most=turns)).name
    value = p.Comprehension(kind="list", element=element, clauses=(clause,))
    if draft.choices.chance(0.2):
        return (assign(target, value), *enumerate_loop(draft, target))
    return (assign(target, value),)


def enumerate_loop(draft: Draft, xs: str) -> Block:
    """`for i, x in enumerate(xs): ...` over a list: the pairs are taken apart."""
    total = draft.fresh("x")
    target = p.TupleDisplay(items=(name("place"), name("entry")))
    step = assign(total, clamp_call(operation(name("entry"), "-", name("place")), -5, 5))
    draft.define(Variable(total, "scalar", -5, 5))
    return (s.For(target=target, iterable=call("enumerate", name(xs)), body=(step,)),)


def row(draft: Draft) -> Block | None:
    """`things = [Object at (i * 4, E) for i in range(n)]`: objects in a row, and one of them."""
    count, index = draft.choices.integer(2, draft.settings.max_loop) if draft.settings.max_loop > 1 else 1, draft.fresh("i")
    with draft.block(count):
        if not objects.may_create(draft):
            return None
        draft.define(Variable(index, "scalar", 0, count - 1, random=False))
        across = operation(operation(name(index), "*", number_literal(5)), "+", expressions.scalar_literal(draft, -10, 5))
        place = q.AtSpecifier(vector=pair(across, expressions.scalar(draft, -10, 10, 1)))
        made = new_object("Object", [place, *frozen(draft)])
    draft.objects += count
    clause = p.ComprehensionClause(target=name(index), iterable=call("range", number_literal(count)))
    things = draft.fresh("things")
    chosen = draft.fresh("o")
    draft.define(Variable(chosen, "object"))
    take = assign(chosen, p.Subscript(value=name(things), index=number_literal(draft.choices.integer(-1, count - 1))))
    return (assign(things, p.Comprehension(kind="list", element=made, clauses=(clause,))), take)


def frozen(draft: Draft) -> list[q.WithSpecifier]:
    """No noise under `mutate` in finite programs; else, sometimes, a larger noise."""
    if draft.settings.finite:
        return [
            q.WithSpecifier(property=each, value=constant_literal(0)) for each in ("positionStdDev", "headingStdDev")
        ] if draft.allows("mutate") else []
    return [q.WithSpecifier(property="positionStdDev", value=number_literal(2))] if draft.choices.chance(0.2) else []

