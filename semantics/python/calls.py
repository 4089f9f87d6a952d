"""Calls: apply a function value, whether a distribution, a function of the program, a rule of the machine, or host code."""

from __future__ import annotations

import inspect
import re
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping
from types import BuiltinFunctionType, FunctionType, MethodType

from ..machine.conditions import random_branch
from ..machine.config import Stack, State, Value, value
from ..machine.draws import draw, of_nothing
from ..machine.host_calls import HostException, Misapplied, host, raw
from ..machine.implicit_positions import specified_object
from ..machine.operand_kinds import FLAT, always, in_the_plane, is_a, is_scalar, kind_name
from ..machine.outcome import Next, Outcome
from ..machine.premises import premises
from ..machine.sandbox_table import is_known, is_user_class, own_word
from ..machine.value_nesting import check_written
from ..machine.values import (
    Bound,
    Constructor,
    Described,
    Dynamic,
    Function,
    Instance,
    Method,
    Native,
    Origin,
    Random,
    Special,
    unwrap,
    value_in_run,
    wrap,
)
from ..machine.world_queries import Clock, Closest, check_running, distance_to_closest
from ..space.distributions import BadParameters
from ..space.fields import BadField, VectorField
from ..space.numeric_functions import to_floats
from ..space.regions import BadRegion, Region
from ..space.vectors import TakesObjects, TakesPoints, Vector
from ..store.errors import RunError
from ..store.postponed_values import refuse_waiting
from ..store.scenic_classes import ScenicClass
from ..store.scopes import Scope, function_names
from ..store.suggestions import meant_parameter
from ..store.undo_log import STORED, note_call
from ..syntax import python_expressions as p
from ..syntax.dynamics import ScenarioDefinition
from ..syntax.nodes import Node, Span
from .assignment import random_write
from .builtin_rules import HOST_RULES, SPECIALS, call_container_method, container_method, random_place
from .call_costs import as_callback, call_with_copies, check_arguments
from .elementwise_builtins import generator_rule
from .functions import bind, enter, return_host_result
from .iteration import elements, elements_in_this_run
from .library import initialise
from .released_members import Member, OperatorFunction, as_function, call_member


def call(node: p.Call, stack: Stack, state: State) -> Outcome:
    """`E(arguments)`: the function first, then the arguments from left to right."""
    arguments = [a.value if isinstance(a, p.Starred) else a for a in node.arguments]
    return premises(node, [node.function, *arguments, *(k.value for k in node.keywords)], conclude_call, stack, state)


def conclude_call(node: p.Call, values: list[object], stack: Stack, state: State) -> Outcome:
    """Spread starred arguments, then apply the function."""
    function, *rest = as_plain(values) if state.may_branch else values
    arguments: list[object] = []
    origin: Origin | None = None
    for expression, argument in zip(node.arguments, rest, strict=False):
        if isinstance(expression, p.Starred) and takes_any_number(function):
            chosen = isinstance(function, Constructor) and function.keeps_values
            spread, found = elements_in_this_run(value_in_run(argument) if state.may_branch else argument, expression, state, chosen)
            arguments.extend(spread)
            origin = origin or found
        elif isinstance(expression, p.Starred):
            arguments.extend(elements(value_in_run(argument) if state.may_branch else argument, expression, state))
        else:
            arguments.append(argument)
    keywords: dict[str, object] = {}
    for keyword, argument in zip(node.keywords, rest[len(node.arguments) :], strict=True):
        if keyword.name is not None:
            keywords[keyword.name] = argument
            continue
        if state.may_branch:
            argument = value_in_run(argument)
        if type(argument) is Random:
            raise random_branch(argument, node, "which arguments are given")
        if isinstance(argument, Mapping):
            keywords.update({str(k): v for k, v in argument.items()})
        else:
            raise HostException(TypeError(f"{kind_name(argument)} after ** is not a mapping"))
    if origin is not None and isinstance(function, Constructor) and not arguments:
        return of_nothing(function, node.span)
    try:
        outcome = apply(node, function, tuple(arguments), keywords, stack, state)
    except Misapplied as problem:
        problem.span = problem.span or place_of_argument(node, problem.argument)
        raise
    return outcome if origin is None else depending_on(origin, outcome)


def place_of_argument(node: p.Call, argument: str | int | None) -> Span | None:
    """Return the place of an argument of a call, by its name or number; None if it is not written in the
    call.
    """
    one_by_one = not any(isinstance(a, p.Starred) for a in node.arguments)
    if isinstance(argument, int) and argument < len(node.arguments) and one_by_one:
        return node.arguments[argument].span
    return next((k.span for k in node.keywords if k.name == argument and k.name is not None), None)


def takes_any_number(function: object) -> bool:
    """Whether a function may be given a random number of arguments: a distribution, or one of the library, since nothing branches on it."""
    return isinstance(function, (Constructor, Native, Bound, BuiltinFunctionType)) or function in (str, int, float, Vector)


def depending_on(origin: Origin, outcome: Outcome) -> Outcome:
    """The outcome of a call, a draw apart, whose value depends on a draw: how many arguments there were."""
    if isinstance(outcome, Next) and isinstance(outcome.config.control, Value):
        result = wrap(unwrap(outcome.config.control.value)[0], origin)
        return outcome._replace(config=outcome.config._replace(control=Value(result)))
    return outcome


def as_plain(values: list[object]) -> list[object]:
    """A function and its arguments where control flow may depend on what is drawn: only functions and behaviors of the program, and `resample`,
    get more than plain values.
    """
    function, *rest = values
    function = value_in_run(function)
    passed_on = isinstance(function, (Function, Method, Dynamic)) or (isinstance(function, Special) and function.name == "resample")
    return [function, *(rest if passed_on else map(value_in_run, rest))]


def apply(node: Node, function: object, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """If ⟨E_i⟩ → v_i then ⟨f(E_1, ..., E_n), σ⟩ → ⟨s, σ_f[x_i / v_i]⟩ for a function f of the program with the body s, closed over σ_f.

    Any other function value is applied by its own rule: a distribution, a rule of the machine, host code.
    """
    match function:
        case Constructor():
            return draw(node, function, arguments, keywords, stack, state)
        case Function():
            return Next("E-Call", enter(function, arguments, keywords, state, stack, node), node)
        case Method():
            code: Function = function.function  # pyright: ignore[reportAssignmentType]: not a class attribute, so no descriptor
            return Next("E-Call", enter(code, (function.instance, *arguments), keywords, state, stack, node), node)
        case Special():
            refuse_waiting(arguments)
            return SPECIALS[function.name](node, arguments, keywords, stack, state)
        case ScenicClass():
            raise RunError(
                f"{function.name} is a Scenic class: its objects are made with specifiers, not with parentheses", node.span,
                rule="E-ObjectDefinition", hint=f"write {function.name} at ..., or {function.name} alone",
            )
        case Dynamic():
            if specified_object(state) is not None:
                refuse_waiting((*arguments, *keywords.values()))
            return value("E-Call-Dynamic", invocation(function, arguments, keywords), stack, state, node)
        case Clock():
            check_running(node, state)
            return value("E-Call", function, stack, state, node)
        case Closest():
            return value("E-Call", distance_to_closest(function, arguments, node, state), stack, state, node)
        case Member() | OperatorFunction():
            return call_member(node, function, arguments, keywords, stack, state)
        case Instance():
            raise HostException(TypeError(f"an instance of {function.class_.name} is not callable"))
        case Random() if any(is_a(function.value, kind) for kind in (Function, Method, Constructor, Special)):
            raise random_branch(function, node, "which function is called")
        case type() if is_user_class(function):
            return instantiate(node, function, arguments, keywords, stack, state)
        case MethodType(__func__=Function() as code):
            return Next("E-Call", enter(code, (function.__self__, *arguments), keywords, state, stack, node), node)
        case type() | BuiltinFunctionType() | Native() if function in HOST_RULES:
            check_call(function, arguments, keywords, state)
            return HOST_RULES[function](node, arguments, keywords, stack, state)
        case _:
            lazily = generator_rule(function, arguments)
            return lazily(node, arguments, keywords, stack, state) if lazily else call_host(node, function, arguments, keywords, stack, state)


def invocation(dynamic: Dynamic, arguments: tuple[object, ...], keywords: Mapping[str, object]) -> Dynamic:
    """If ⟨E_i⟩ → v_i then ⟨B(E_1, ..., E_n)⟩ → B with the arguments v_i, checked against its parameters, for a behavior, monitor or scenario B."""
    definition = dynamic.definition
    bound = bind(definition.name, definition.parameters, dynamic.defaults, arguments, keywords)  # type: ignore[attr-defined]
    space = Scope("function", dynamic.scope, function_names(definition), bound) if isinstance(definition, ScenarioDefinition) else None
    return Dynamic(definition, dynamic.scope, dynamic.defaults, (arguments, dict(keywords)), space)


def call_host(node: Node, function: object, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """Call library code with plain values; the result is random if anything that went in was."""
    if not always(callable, value_in_run(function)):
        raise HostException(TypeError(f"{kind_name(function)} is not callable"))
    arguments = tuple(as_function(argument, state) for argument in arguments)
    if function is Vector and len(arguments) == 3:
        arguments = in_the_plane(arguments, state)  # type: ignore[assignment]
    keywords = {name: as_function(argument, state) for name, argument in keywords.items()}
    check_call(value_in_run(function), arguments, keywords, state)
    note_call(state.settings.door.budget, value_in_run(function), arguments)
    if "key" in keywords and type(keywords["key"]) is not Random:
        keywords = {**keywords, "key": as_callback(keywords["key"], state.settings.door.budget)}
    if isinstance(function, Bound) and function.function is initialise and function.subject:
        return return_host_result(node, initialise_above(node, function, arguments, keywords, state), stack, state)
    if container_method(value_in_run(function)):
        if type(function) is Random and function.value.__name__ in STORED:  # type: ignore[attr-defined]
            raise random_write(Random(function.value.__self__, function.origin), node)  # type: ignore[attr-defined]
        if type(function) is not Random:
            return return_host_result(node, call_container_method(node, function, arguments, keywords, state), stack, state)  # type: ignore[arg-type]
    function = on_plain_elements(function)
    if isinstance(own_word(value_in_run(function), "__self__"), TakesObjects):
        arguments = tuple(describe_instance(a, state) for a in arguments)
        keywords = {k: describe_instance(v, state) for k, v in keywords.items()}
    elif always(is_geometric, value_in_run(function)):
        arguments = tuple(as_positions(a, state) for a in arguments)
        keywords = {k: as_positions(v, state) for k, v in keywords.items()}

    try:
        result = host(state.settings.door, state, invoke, vector if function is Vector else function, *arguments, **keywords)
    except HostException as problem:
        if isinstance(problem.exception, (BadField, BadRegion, BadParameters)):
            hint = swapped_arguments_hint(function, arguments) or split_vector_hint(function, arguments)
            place = node.arguments[0].span if hint and isinstance(node, p.Call) and node.arguments else node.span
            raise RunError(str(problem.exception), place, rule="E-Call-Host", hint=hint) from None
        class_ = value_in_run(function)
        if isinstance(problem.exception, TypeError) and isinstance(class_, type) and issubclass(class_, NAMED):
            raise misapplied_class(class_, keywords, problem) from None
        if class_ is range and any(type(argument) is Random for argument in arguments):
            problem.exception.add_note("how often a loop runs may not be random; a whole number is drawn by DiscreteRange(low, high)")
        raise
    return return_host_result(node, result, stack, state)


def initialise_above(node: Node, function: Bound, arguments: tuple[object, ...], keywords: Mapping[str, object], state: State) -> object:
    """`super().__init__(...)` of a Python class: what it stores keeps its randomness, but where that stands may not be random."""
    [subject] = function.subject
    if not isinstance(subject, BaseException):  # what comes out of an iterator is known once it has come
        arguments = tuple(raw(state.settings.door, state, list, a) if isinstance(a, Iterator) else a for a in arguments)
    met = unwrap([*arguments, *keywords.values()])[1] is not None
    if met and isinstance(subject, list):
        arguments = tuple(elements(a, node, state) for a in arguments)
    elif met and isinstance(subject, dict) and not isinstance(subject, Counter) and not any(type(a) is Random for a in arguments):
        arguments = tuple(raw(state.settings.door, state, dict, a) for a in arguments)
        if unwrap([key for a in arguments for key in a])[1] is not None:  # type: ignore[attr-defined]
            raise random_place("__init__", node)
    elif met and not isinstance(subject, BaseException):
        raise random_place("__init__", node)
    return raw(state.settings.door, state, function, *arguments, **keywords)


def check_call(function: object, arguments: tuple[object, ...], keywords: Mapping[str, object], state: State) -> None:
    """Pay for what library code goes through, and refuse what it must not be given (`prices`), or what is none of a program's classes."""
    inner, named = list(map(value_in_run, arguments)), {name: value_in_run(a) for name, a in keywords.items()}
    check_arguments(function, inner, named, state.settings.door.budget)
    if any(function is comparing for comparing in COMPARING):
        check_written(*inner, *named.values())
    if function is Vector and not all(is_scalar(unwrap(a)[0]) for a in (*arguments, *keywords.values())):
        raise RunError(f"Vector(x, y) takes two scalars, not {', '.join(map(kind_name, (*inner, *named.values())))}", rule="E-Call-Host")
    if isinstance(function, type) and not state.settings.trusted and not is_known(function):
        raise RunError(f"{function.__name__} is not a class of this language", rule="E-Call-Host")


COMPARING = (sorted, min, max)
"""Functions that compare what they go through."""


def swapped_arguments_hint(function: object, arguments: tuple[object, ...]) -> str:
    """How a region is called whose first argument, a vector, seems to stand behind a number."""
    class_, first = value_in_run(function), [value_in_run(a) for a in arguments[:2]]
    if isinstance(class_, type) and issubclass(class_, Region) and len(first) > 1 and is_scalar(first[0]) and not is_scalar(first[1]):
        return f"write {class_.__name__}({', '.join(inspect.signature(class_).parameters)})"
    return ""


def split_vector_hint(function: object, arguments: tuple[object, ...]) -> str:
    """How a region is called whose first argument, a vector, seems to be given as two numbers."""
    class_, values = value_in_run(function), [value_in_run(a) for a in arguments]
    if not (isinstance(class_, type) and issubclass(class_, Region)) or len(values) < 2 or not all(map(is_scalar, values)):
        return ""
    parameters = inspect.signature(class_).parameters.values()
    first, *others = [one.name for one in parameters if one.default is one.empty and one.kind is one.POSITIONAL_OR_KEYWORD] or [""]
    if first not in ("center", "position"):
        return ""
    short = not any(isinstance(a, Random) for a in arguments) and all(-1e6 < value < 1e6 for value in values)  # type: ignore[operator]
    x, y, *rest = map(str, values) if short and len(others) == len(values) - 2 else ("x", "y", *others)
    pair = f"({x}, {y})"
    return f"write {class_.__name__}({', '.join([pair, *rest])})"


MISSING_ARGUMENTS = re.compile(r"missing \d+ required (?:positional|keyword-only) arguments?: (.+)")


def misapplied_class(class_: type, keywords: Mapping[str, object], problem: HostException) -> HostException:
    """The error in the arguments of a class of the library: the keyword that it does not have, else how it is called."""
    parameters = inspect.signature(class_).parameters
    unknown = next((name for name in keywords if name not in parameters), None)
    if unknown is None or any(one.kind is one.VAR_KEYWORD for one in parameters.values()):
        missing = MISSING_ARGUMENTS.search(str(problem.exception))
        if missing is not None:
            names = " and ".join(re.findall(r"'(\w+)'", missing[1]))
            problem = Misapplied(TypeError(f"{class_.__name__}() needs a value for {names}"))
        problem.exception.add_note(f"write {class_.__name__}({', '.join(parameters)})")
        return problem
    error = TypeError(f"{class_.__name__}() has no parameter {unknown}")
    error.add_note(meant_parameter(unknown, list(parameters)))
    return Misapplied(error, unknown)


def vector(x: float, y: float, *more: float) -> Vector:
    """Vector(x, y): its coordinates are floats, as those of any vector of the language."""
    if more:
        raise TypeError(f"a Vector has two coordinates; one of {2 + len(more)} {FLAT if len(more) == 1 else 'is none'}")
    return Vector(to_floats(x), to_floats(y))


def invoke(function: Callable[..., object], *arguments: object, **keywords: object) -> object:
    """The operation of a call of library code."""
    return call_with_copies(function, *arguments, **keywords)


def on_plain_elements(function: object) -> object:
    """A method of a container with random elements, as a method of the container of their values in this run."""
    owner = own_word(function, "__self__")
    of_python = isinstance(function, BuiltinFunctionType) or isinstance(own_word(function, "__func__"), FunctionType)
    if not of_python or not isinstance(owner, (list, dict, set, tuple, deque)):
        return function
    values, origin = unwrap(owner)
    return function if origin is None else wrap(getattr(values, own_word(function, "__name__")), origin)


NAMED = (Region, VectorField, TakesObjects)
"""Classes of which an error in the arguments says what they are called."""


def is_geometric(function: object) -> bool:
    """Whether this constructs a region, a field or the like, or is a method of one: it takes vectors, and Points count as such."""
    if isinstance(function, type):
        return issubclass(function, (Region, VectorField, TakesPoints))
    return isinstance(own_word(function, "__self__"), (Region, VectorField, Vector, TakesPoints))


def as_positions(argument: object, state: State) -> object:
    """Points replaced by their positions, in lists and tuples as well."""
    match argument:
        case Instance():
            return state.objects[argument.number]["position"]
        case Random(value=Instance() as instance, origin=origin):
            return Random(unwrap(state.objects[instance.number]["position"])[0], origin)
        case list() | tuple() if any(isinstance(a, (Instance, Random, list, tuple)) for a in argument):
            return type(argument)(in_the_plane(as_positions(a, state), state) if isinstance(a, tuple) else as_positions(a, state) for a in argument)
        case _:
            return argument


def describe_instance(argument: object, state: State) -> object:
    """An object as what it is now."""
    if not isinstance(value_in_run(argument), Instance):
        return argument
    instance, origin = unwrap(argument)
    properties = {name: unwrap(v)[0] for name, v in state.objects[instance.number].items()}  # type: ignore[attr-defined]
    return wrap(Described(instance.class_.name, properties), origin)  # type: ignore[attr-defined]


def instantiate(
    node: Node, class_: type, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State
) -> Outcome:
    """An instance of a Python class of the program; `__init__` runs in the machine, so that it may draw."""
    initializer = getattr(class_, "__init__", None)
    if not isinstance(initializer, Function):
        return call_host(node, class_, arguments, keywords, stack, state)
    rest = arguments if issubclass(class_, BaseException) else ()
    instance = raw(state.settings.door, state, class_.__new__, class_, *rest)
    config = enter(initializer, (instance, *arguments), keywords, state, stack, node)
    frame, below = config.stack
    return Next("E-Call", config._replace(stack=(frame._replace(constructed=instance), below)), node)
