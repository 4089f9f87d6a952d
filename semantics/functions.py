"""Functions, lambdas, calls and comprehensions: as in Python, except that arguments keep their randomness."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from .config import Abrupt, Config, Stack, State, Value, reduce, value
from .distributions import BadParameters, Distribution, Range
from .errors import RunError
from .expressions import elements, host_container, random_branch, truth
from .host import LARGEST_SEQUENCE, HostException, host
from .kinds import has_kind, kind_name
from .outcome import Change, Draw, Next, Outcome
from .premises import premises
from .fields import VectorField
from .regions import BadRegion, Region
from .scopes import Scope, function_names
from .specials import SPECIALS, STRUCTURAL_METHODS, call_raw
from .syntax import expressions as e
from .syntax import python_expressions as p
from .syntax import statements as s
from .syntax.nodes import NOWHERE, Node, Span
from .values import Constructor, Dynamic, Function, Instance, Method, Origin, Random, ScenicClass, Special, plain, unwrap
from .vectors import Vector

LARGEST_DEPTH = 400


class Called(NamedTuple):
    """Frame of a call: what comes below it runs in the callee's scope; `caller` is restored when it ends."""

    caller: Scope
    node: Node
    constructed: object = None


class InScope(NamedTuple):
    """Frame that restores σ to `outer` when what stands above it ends."""

    outer: Scope


def lambda_rule(node: p.Lambda, stack: Stack, state: State) -> Outcome:
    """`lambda parameters: E`."""
    return define(node, "<lambda>", node.parameters, node.body, stack, state)


def define(node: Node, name: str, parameters: tuple[p.Parameter, ...], body: object, stack: Stack, state: State) -> Outcome:
    """Evaluate the default values now, once (reading `default-arguments`), then close over σ."""
    return premises(node, [q.default for q in parameters], conclude_define, stack, state)


def conclude_define(node: Node, values: list[object], stack: Stack, state: State) -> Outcome:
    """The function as a value."""
    function = make_function(node, values, state)
    return value("E-Lambda", function, stack, state, node)


def make_function(node: p.Lambda | s.FunctionDefinition, values: list[object], state: State) -> Function:
    """A function closed over the current σ."""
    defaults = {q.name: v for q, v in zip(node.parameters, values, strict=False) if q.default is not None}
    name = node.name if isinstance(node, s.FunctionDefinition) else "<lambda>"
    return Function(name, node.parameters, node.body, state.sigma, defaults, function_names(node), state.settings.door, node.span)


def bind(
    name: str, parameters: tuple[p.Parameter, ...], defaults: Mapping[str, object], arguments: tuple[object, ...], keywords: Mapping[str, object]
) -> dict[str, object]:
    """The variables of a call; TypeError (the program's) when the arguments do not fit the parameters."""
    bound: dict[str, object] = {}
    rest = dict(keywords)
    positional = [q for q in parameters if q.kind in ("positional", "positional only")]
    star = next((q for q in parameters if q.kind == "*args"), None)
    if len(arguments) > len(positional) and star is None:
        raise HostException(TypeError(f"{name}() takes {len(positional)} positional arguments but {len(arguments)} were given"))
    for parameter, argument in zip(positional, arguments, strict=False):
        bound[parameter.name] = argument
        if parameter.kind == "positional" and parameter.name in rest:
            raise HostException(TypeError(f"{name}() got two values for {parameter.name}"))
    if star is not None and star.name:
        bound[star.name] = tuple(arguments[len(positional) :])
    for parameter in parameters:
        if parameter.kind in ("*args", "**kwargs") or parameter.name in bound:
            continue
        if parameter.kind != "positional only" and parameter.name in rest:
            bound[parameter.name] = rest.pop(parameter.name)
        elif parameter.name in defaults:
            bound[parameter.name] = defaults[parameter.name]
        else:
            raise HostException(TypeError(f"{name}() needs a value for {parameter.name}"))
    extra = next((q for q in parameters if q.kind == "**kwargs"), None)
    if extra is not None:
        bound[extra.name] = rest
    elif rest:
        raise HostException(TypeError(f"{name}() has no parameter {next(iter(rest))}"))
    return bound


def call(node: p.Call, stack: Stack, state: State) -> Outcome:
    """`E(arguments)`: the function first, then the arguments from left to right."""
    arguments = [a.value if isinstance(a, p.Starred) else a for a in node.arguments]
    return premises(node, [node.function, *arguments, *(k.value for k in node.keywords)], conclude_call, stack, state)


def conclude_call(node: p.Call, values: list[object], stack: Stack, state: State) -> Outcome:
    """Spread starred arguments, then apply the function."""
    function, *rest = values
    arguments: list[object] = []
    for expression, argument in zip(node.arguments, rest, strict=False):
        if isinstance(expression, p.Starred):
            arguments.extend(elements(argument, expression, state))
        else:
            arguments.append(argument)
    keywords: dict[str, object] = {}
    for keyword, argument in zip(node.keywords, rest[len(node.arguments) :], strict=True):
        if keyword.name is not None:
            keywords[keyword.name] = argument
        elif isinstance(plain(argument), Mapping):
            keywords.update({str(k): v for k, v in plain(argument).items()})  # type: ignore[attr-defined]
        else:
            raise HostException(TypeError(f"{kind_name(argument)} after ** is not a mapping"))
    return apply(node, function, tuple(arguments), keywords, stack, state)


def apply(node: Node, function: object, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """Apply a function value: a distribution, a function of the program, a rule of the machine, or host code."""
    match function:
        case Constructor():
            return draw(node, function, arguments, keywords, stack, state)
        case Function():
            return Next("E-Call", enter(function, arguments, keywords, state, stack, node), node)
        case Method():
            return Next("E-Call", enter(function.function, (function.instance, *arguments), keywords, state, stack, node), node)
        case Special():
            return SPECIALS[function.name](node, arguments, keywords, stack, state)
        case ScenicClass():
            raise RunError(
                f"{function.name} is a Scenic class: its objects are made with specifiers, not with parentheses", node.span,
                rule="E-ObjectDefinition", hint=f"write {function.name} at ..., or {function.name} alone",
            )
        case Dynamic():
            return value("E-Call-Dynamic", invocation(function, arguments, keywords), stack, state, node)
        case Instance():
            raise HostException(TypeError(f"an instance of {function.class_.name} is not callable"))
        case Random() if isinstance(function.value, (Function, Method, Constructor, Special)):
            raise random_branch(function, node, "which function is called")
        case type() if "__scenic_user_class__" in function.__dict__:
            return instantiate(node, function, arguments, keywords, stack, state)
        case _:
            return call_host(node, function, arguments, keywords, stack, state)


def invocation(dynamic: Dynamic, arguments: tuple[object, ...], keywords: Mapping[str, object]) -> Dynamic:
    """A behavior, monitor or scenario with its arguments, checked against its parameters."""
    bind(dynamic.definition.name, dynamic.definition.parameters, dynamic.defaults, arguments, keywords)  # type: ignore[attr-defined]
    return Dynamic(dynamic.definition, dynamic.scope, dynamic.defaults, (arguments, dict(keywords)))


def enter(
    function: Function, arguments: tuple[object, ...], keywords: Mapping[str, object], state: State, stack: Stack = (), node: Node | None = None
) -> Config:
    """The configuration that runs a function's body; it ends in the frame `Called`."""
    if state.depth >= LARGEST_DEPTH:
        raise RunError(f"{function.name} calls itself too deeply ({LARGEST_DEPTH} calls are open)", function.span, rule="E-Call")
    bindings = bind(function.name, function.parameters, function.defaults, arguments, keywords)
    scope = Scope("function", function.scope, function.names, bindings)
    frame = Called(state.sigma, node if node is not None else p.Constant(value=None, span=function.span))
    inner = state._replace(sigma=scope, depth=state.depth + 1)
    control = s_block(function.body) if isinstance(function.body, tuple) else function.body
    return Config(control, (frame, stack), inner)


def s_block(body: s.Block) -> Node:
    """A function's body as one statement."""
    return s.If(test=p.Constant(value=True), then=body, span=body[0].span if body else NOWHERE)


def resume_called(frame: Called, result: object, stack: Stack, state: State) -> Outcome:
    """The body ended: a lambda with its value, a function without `return` with None."""
    outcome = frame.constructed if frame.constructed is not None else result
    return value("E-Return", outcome, stack, leave(frame, state), frame.node)


def leave(frame: Called, state: State) -> State:
    """Back in the caller's scope."""
    return state._replace(sigma=frame.caller, depth=state.depth - 1)


def unwind_called(frame: Called, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """`return v` ends the call with v; an exception goes on to the caller."""
    if abrupt.kind == "return":
        return resume_called(frame, abrupt.value, stack, state)
    return Next("", Config(abrupt, stack, leave(frame, state)))


def resume_in_scope(frame: InScope, result: object, stack: Stack, state: State) -> Outcome:
    """Restore σ and hand the value on."""
    return value("", result, stack, state._replace(sigma=frame.outer))


def unwind_in_scope(frame: InScope, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Restore σ and go on unwinding."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


# Distributions


def draw(node: Node, constructor: Constructor, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """⟨params⟩ → θ and v ∈ dom baseDist(θ) give ⟨baseDist(params)⟩ →^{P_θ(v)} v (Figure "expression-semantics", Distributions)."""
    try:
        if constructor.keeps_values:
            distribution = constructor.make(*arguments, **keywords)
        else:
            distribution = constructor.make(*(unwrap(a)[0] for a in arguments), **{k: unwrap(v)[0] for k, v in keywords.items()})
    except BadParameters as bad:
        raise RunError(str(bad), node.span, rule="E-Distributions") from None
    except TypeError as problem:
        raise RunError(f"{constructor.name}: {problem}", node.span, rule="E-Distributions") from None
    return ask(node, distribution, "E-Distributions", stack, state, f"{constructor.name}(...)")


def ask(node: Node, distribution: Distribution, rule: str, stack: Stack, state: State, text: str) -> Draw:
    """A draw whose result is the value of the expression."""
    origin = Origin(node.span, text, distribution)
    after = state._replace(draws=state.draws + 1)

    def resume(drawn: object) -> Config:
        return Config(Value(Random(unwrap(drawn)[0], origin)), stack, after)

    return Draw(rule, state.address, distribution, node, resume)


# Host functions and classes of the program


def call_host(node: Node, function: object, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """Call library code with plain values; the result is random if anything that went in was."""
    if not callable(plain(function)):
        raise HostException(TypeError(f"{kind_name(function)} is not callable"))
    if any(isinstance(a, range) and len(a) > LARGEST_SEQUENCE for a in arguments):
        raise RunError("a range with so many elements cannot be turned into a collection", node.span, rule="E-Call-Host")
    guard_format(plain(function), arguments, node)
    if is_structural(function):
        return value("E-Call-Host", call_raw(function, arguments, keywords, state), stack, state, node)
    function = on_plain_elements(function, node)
    if is_geometric(plain(function)):
        arguments = tuple(as_positions(a, state) for a in arguments)
        keywords = {k: as_positions(v, state) for k, v in keywords.items()}

    def invoke(f: object, *rest: object, **named: object) -> object:
        return f(*rest, **named)  # type: ignore[operator]

    try:
        result = host(state.settings.door, state, invoke, function, *arguments, **keywords)
    except HostException as problem:
        if isinstance(problem.exception, (BadRegion, BadParameters)):
            raise RunError(str(problem.exception), node.span, rule="E-Call-Host") from None
        raise
    return value("E-Call-Host", result, stack, state, node)


def is_structural(function: object) -> bool:
    """Whether this is a method of a Python container that does not look at the elements, such as `list.append`."""
    owner = getattr(function, "__self__", None)
    return type(owner) in (list, dict, set) and getattr(function, "__name__", "") in STRUCTURAL_METHODS


def on_plain_elements(function: object, node: Node) -> object:
    """A method of a container with random elements, as a method of the container of their values in this run."""
    owner = getattr(function, "__self__", None)
    if type(owner) not in (list, dict, set, tuple):
        return function
    values, origin = unwrap(owner)
    if origin is None:
        return function
    name = getattr(function, "__name__", "")
    if name in ("sort", "remove", "discard"):
        raise RunError(
            f"{name}() would make which element stands where random", node.span, rule="E-Call-Host", hint="make a new list, with sorted(...) for instance"
        )
    return Random(getattr(values, name), origin._replace(distribution=None))


def is_geometric(function: object) -> bool:
    """Whether this constructs a region or field, or is a method of one: it takes vectors, and Points count as such."""
    if isinstance(function, type):
        return issubclass(function, (Region, VectorField))
    return isinstance(getattr(function, "__self__", None), (Region, VectorField, Vector))


def as_positions(argument: object, state: State) -> object:
    """Points replaced by their positions, in lists and tuples as well."""
    match argument:
        case Instance():
            return state.objects[argument.number]["position"]
        case Random(value=Instance() as instance, origin=origin):
            return Random(unwrap(state.objects[instance.number]["position"])[0], origin)
        case list() | tuple() if any(isinstance(a, (Instance, Random, list, tuple)) for a in argument):
            return type(argument)(as_positions(a, state) for a in argument)
        case _:
            return argument


def guard_format(function: object, arguments: tuple[object, ...], node: Node) -> None:
    """`"{0._x}".format(v)` would read private names, and a width could ask for gigabytes: refuse both."""
    subject = getattr(function, "__self__", None)
    name = getattr(function, "__name__", "")
    if isinstance(subject, str) and name in ("format", "format_map") and ("._" in subject or "[_" in subject):
        raise RunError("format strings may not read private names", node.span, rule="E-Call-Host")
    if isinstance(subject, (str, bytes)) and name in ("ljust", "rjust", "center", "zfill", "expandtabs"):
        width = plain(arguments[0]) if arguments else 0
        if isinstance(width, int) and width > LARGEST_SEQUENCE:
            raise RunError("a string of this width is too large", node.span, rule="E-Call-Host")


def instantiate(node: Node, class_: type, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """An instance of a Python class of the program; `__init__` runs in the machine, so that it may draw."""
    initializer = getattr(class_, "__init__", None)
    if not isinstance(initializer, Function):
        return call_host(node, class_, arguments, keywords, stack, state)
    instance = class_.__new__(class_, *arguments) if issubclass(class_, BaseException) else class_.__new__(class_)
    config = enter(initializer, (instance, *arguments), keywords, state, stack, node)
    frame, rest = config.stack
    return Next("E-Call", config._replace(stack=(frame._replace(constructed=instance), rest)), node)


# Comprehensions


class Comprehending(NamedTuple):
    """Frame of a comprehension: `iterators` of the open clauses, the elements found so far, what is being reduced."""

    node: p.Comprehension
    iterators: tuple[Iterator[object], ...]
    found: list[object]
    phase: tuple[str, int, int]
    key: object = None


def comprehension(node: p.Comprehension, stack: Stack, state: State) -> Outcome:
    """`[E for x in I if B]`: the first iterable in the scope around it, the rest in a scope of its own."""
    outer = InScope(state.sigma)
    names = frozenset(n for clause in node.clauses for n in _targets(clause.target))
    inner = Scope("comprehension", state.sigma, function_names(node)._replace(local=names))
    frame = Comprehending(node, (), [], ("iterable", 0, 0))
    return Next("", Config(node.clauses[0].iterable, (frame, (outer, stack)), state._replace(sigma=inner)))


def _targets(target: Node) -> Iterator[str]:
    from .scopes import target_names

    return target_names(target)


def resume_comprehension(frame: Comprehending, result: object, stack: Stack, state: State) -> Outcome:
    """Go on where the frame's phase says."""
    phase, clause, condition = frame.phase
    node = frame.node
    if phase == "iterable":
        source = elements(result, node.clauses[clause].iterable, state)
        return advance(frame._replace(iterators=(*frame.iterators, iter(source))), stack, state)
    if phase == "condition":
        test = node.clauses[clause].conditions[condition]
        if not truth(result, test, state, "the condition of this comprehension"):
            return advance(frame, stack, state)
        return check_conditions(frame, clause, condition + 1, stack, state)
    if phase == "key":
        return reduce(node.element, frame._replace(phase=("element", 0, 0), key=result), stack, state)
    frame.found.append((frame.key, result) if node.kind == "dict" else result)
    return advance(frame, stack, state)


def advance(frame: Comprehending, stack: Stack, state: State) -> Outcome:
    """Take the next element of the innermost iterator; an exhausted one gives way to the one around it."""
    from .assignment import bind_target

    iterators = frame.iterators
    while iterators:
        index = len(iterators) - 1
        try:
            item = next(iterators[-1])
        except StopIteration:
            iterators = iterators[:-1]
            continue
        bind_target(frame.node.clauses[index].target, item, state)
        return check_conditions(frame._replace(iterators=iterators), index, 0, stack, state)
    kinds = {"list": list, "generator": list, "set": set, "dict": dict}
    return value("E-Comprehension", host_container(kinds[frame.node.kind], frame.found), stack, state, frame.node)


def check_conditions(frame: Comprehending, clause: int, condition: int, stack: Stack, state: State) -> Outcome:
    """Reduce the next condition, or open the next clause, or reduce the element."""
    node = frame.node
    if condition < len(node.clauses[clause].conditions):
        return reduce(node.clauses[clause].conditions[condition], frame._replace(phase=("condition", clause, condition)), stack, state)
    if clause + 1 < len(node.clauses):
        return reduce(node.clauses[clause + 1].iterable, frame._replace(phase=("iterable", clause + 1, 0)), stack, state)
    if node.key is not None:
        return reduce(node.key, frame._replace(phase=("key", 0, 0)), stack, state)
    return reduce(node.element, frame._replace(phase=("element", 0, 0)), stack, state)


def interval_or_pair(node: e.IntervalOrPair, stack: Stack, state: State) -> Outcome:
    """`(low, high)` of dialect `pldi19` (reading `intervals`)."""
    return premises(node, [node.low, node.high], conclude_interval, stack, state)


def conclude_interval(node: e.IntervalOrPair, values: list[object], stack: Stack, state: State) -> Outcome:
    """Uniform on the interval if both ends are scalars, otherwise a pair."""
    if all(has_kind(plain(v), "scalar") for v in values):
        return draw(node, RANGE, tuple(values), {}, stack, state)
    return value("E-Display", tuple(values), stack, state, node)


RANGE = Constructor("Range", Range, keeps_values=False)
