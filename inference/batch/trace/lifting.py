"""Operations of Python on symbols: the ones on numbers become nodes, those on choices among few values are done for each, others row by row."""

from __future__ import annotations

import builtins
import operator
from collections.abc import Callable, Iterator
from functools import partial, reduce

from ....semantics.kernel.scenic_classes import ScenicClass
from ....semantics.kernel.values import Bound, Dynamic, Function, Instance, Method, Module, Random
from ....semantics.kernel.versions import STORED
from ....semantics.python.arithmetic import BINARY, UNARY
from ....semantics.python.calls import invoke, vector
from ....semantics.python.specials import container_method
from ....semantics.space.numeric import negation
from ....semantics.space.regions import CircularRegion, RectangularRegion, Region, SectorRegion, Workspace
from ....semantics.space.symbols import NotLifted
from ....semantics.space.vectors import Vector
from .recording import Recorder
from .structures import symbols_in
from .symbols import OPERATORS, Choice, Scalar, Traced

LIFTED: dict[Callable[..., object], Callable[..., object]] = {
    **{f: f for f in OPERATORS if f is not operator.invert},
    BINARY["+"]: operator.add,
    BINARY["-"]: operator.sub,
    BINARY["&"]: operator.and_,
    BINARY["|"]: operator.or_,
    BINARY["^"]: operator.xor,
    BINARY["*"]: operator.mul,
    BINARY["%"]: operator.mod,
    builtins.abs: operator.abs,
}
"""Operations of the machine, and the operators that they are on floats; `~` is left out on truth values, which it takes for whole numbers."""
EXAMINES = (operator.is_, operator.is_not, operator.eq, operator.ne, bool, UNARY["not"])
"""Operations by which a program asks, among other things, whether a value is None."""
ZERO_DIVIDES = (operator.truediv, operator.mod)
FEW_CASES, MANY_CASES = 64, 1 << 14
"""What is done for every combination of values of several choices, or for every value of one, is done for no more than these."""
DIRECT = (CircularRegion, SectorRegion, RectangularRegion, Workspace)
STATEFUL = (Function, Method, Dynamic, Module, Instance, ScenicClass, BaseException)


def lift(trace: Recorder, operation: Callable[..., object], arguments: list[object], keywords: dict[str, object]) -> object:
    """`operation(*arguments, **keywords)` where there are symbols in the arguments."""
    found = symbols_in((arguments, keywords))
    if not found:
        return operation(*arguments, **keywords)
    if operation in EXAMINES:
        trace.examined.update(symbol.node.number for symbol in found)
    if operation is invoke:
        check_method(arguments[0])
        if not symbols_in(arguments[0]) or is_direct(arguments[0]):
            operation, *arguments = arguments  # type: ignore[assignment]
    if isinstance(operation, Bound):
        operation = operation.afresh
    keywords = {name: value.afresh if isinstance(value, Bound) else value for name, value in keywords.items()}
    if operation in (bool, UNARY["not"]) and isinstance(arguments[0], Traced):
        return trace.truth(arguments[0]) if operation is bool else negation(trace.truth(arguments[0]))
    basic = LIFTED.get(operation)
    if basic is not None and _numeric(basic, arguments):
        return _operator(trace, basic, arguments)
    if is_direct(operation):
        return operation(*arguments, **keywords)
    if operation in (min, max) and not keywords:
        compared = list(arguments[0]) if len(arguments) == 1 and isinstance(arguments[0], (list, tuple)) else arguments
        if all(map(_is_number_or_choice, compared)):
            return reduce(partial(extreme, trace, operation), compared)
    if basic is not None and all(map(_is_number_or_choice, arguments)) and not (basic in ZERO_DIVIDES and symbols_in(list(_entries(arguments[1])))):
        mapped = trace.over_choices(basic, arguments)
        if mapped is not NotImplemented:
            return mapped
    choices = {s.node.number: s for s in found if isinstance(s, Choice)}
    only_choices = choices and len(choices) == len({s.node.number for s in found}) and _few(choices)
    if only_choices and not keywords and all(isinstance(a, Choice) or not symbols_in(a) for a in arguments):
        mapped = trace.over_choices(operation, arguments)
        if mapped is not NotImplemented:
            return mapped
    if basic is not None and all(isinstance(a, Vector) or _is_number(a) for a in arguments) and any(isinstance(a, Vector) for a in arguments):
        return operation(*arguments)
    if _stateful((arguments, keywords)):
        raise NotLifted(f"{getattr(operation, '__name__', operation)} of functions or objects and random values")
    return trace.call(operation, tuple(arguments), keywords)


def extreme(trace: Recorder, operation: Callable[..., object], first: object, second: object) -> object:
    """The smaller or larger of two numbers, the first of equal ones: itself, so that a whole number stays one."""
    replaces: object = second < first if operation is min else second > first  # type: ignore[operator]
    replaces = replaces.number() if isinstance(replaces, Traced) else replaces
    return trace.pick(trace.as_float_node(replaces.node), (first, second)) if isinstance(replaces, Traced) else second if replaces else first


def _entries(value: object) -> Iterator[object]:
    """The values that a choice is among, those of choices among them included."""
    if isinstance(value, Choice):
        for entry in value.values:
            yield from _entries(entry)
    else:
        yield value


def _is_number_or_choice(value: object) -> bool:
    return all(map(_is_number_or_choice, value.values)) if isinstance(value, Choice) else _is_number(value)


def is_direct(function: object) -> bool:
    """Whether a function of the library is made of liftable operations itself: constructors of vectors and closed forms, methods of regions."""
    if isinstance(function, type):
        return function in DIRECT
    owner = function if isinstance(function, Traced) else getattr(function, "__self__", None)
    return function is vector or (isinstance(owner, Region) and hasattr(Region, function.__name__))  # type: ignore[attr-defined]


def check_method(function: object) -> None:
    """Refuse a function that differs from run to run if what it does is the program's, or changes something."""
    for value in _entries(function) if isinstance(function, Choice) else (function.example,) if isinstance(function, Traced) else ():
        if isinstance(value, STATEFUL):
            raise NotLifted("which function is called differs from run to run")
        if container_method(value) and value.__name__ in STORED:  # type: ignore[attr-defined]
            raise NotLifted("which container is changed differs from run to run")


def _few(choices: dict[int, Choice]) -> bool:
    total = 1
    for choice in choices.values():
        total *= len(choice.values)
    return total <= (MANY_CASES if len(choices) == 1 else FEW_CASES)


def _is_number(value: object) -> bool:
    if isinstance(value, Scalar):
        return value.node.kind == "float"
    return isinstance(value, (int, float)) and not isinstance(value, bool) and (isinstance(value, float) or abs(value) <= 2**53)


def _is_truth(value: object) -> bool:
    return isinstance(value, bool) or (isinstance(value, Scalar) and value.node.kind == "bool")


def _numeric(operation: Callable[..., object], arguments: list[object]) -> bool:
    """Whether the operation is one on floats (at least one of them a symbol), or a logical one on truth values."""
    if operation in (operator.and_, operator.or_, operator.xor):
        return all(map(_is_truth, arguments))
    if not any(isinstance(a, Scalar) for a in arguments):
        return False
    return all(_is_number(a) or (isinstance(a, Choice) and all(map(_is_float, a.values))) for a in arguments)


def _is_float(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _operator(trace: Recorder, operation: Callable[..., object], arguments: list[object]) -> object:
    if operation in ZERO_DIVIDES and bool(trace.operate(operator.eq, (arguments[1], 0.0))):
        raise ZeroDivisionError("float division by zero" if operation is operator.truediv else "float modulo")
    return trace.operate(operation, tuple(arguments))


def _stateful(value: object) -> bool:
    """Whether functions, modules, classes or instances of the program are in a value: what they give depends on the state."""
    match value:
        case Choice():
            return any(map(_stateful, value.values))
        case Random():
            return _stateful(value.value)
        case list() | tuple() | set() | frozenset():
            return any(map(_stateful, value))
        case dict():
            return any(map(_stateful, value.items()))
        case _:
            return isinstance(value, STATEFUL)
