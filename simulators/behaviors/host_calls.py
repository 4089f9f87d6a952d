"""Host code that compiled code calls without the machine: what changes nothing, cannot fail in another way, and gives a value of a known type.

Each form gives `SLOWLY` where it does not know a value, or where host code raises: then the rule of the machine concludes, with the same value, or
with the program's error. Nothing of it is taken off the run's budget: it goes through no container of the program's, and `turn` counts its calls.
"""

from __future__ import annotations

import builtins
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache, cached_property
from types import BuiltinFunctionType, FunctionType, MethodType, NoneType
from typing import Any, NamedTuple

from ...semantics.machine.config import State
from ...semantics.machine.operand_kinds import is_object, is_oriented
from ...semantics.machine.sandbox_table import may_ask
from ...semantics.machine.values import Bound, Instance, Random, value_in_run, wrap
from ...semantics.machine.world_queries import Clock
from ...semantics.python.builtin_rules import SPECIAL_VALUES
from ...semantics.python.library import BUILTIN, GIVEN
from ...semantics.python.library import METHODS as OURS
from ...semantics.scenes.operator_application import select
from ...semantics.scenes.operators import Equation
from ...semantics.space.fields import VectorField
from ...semantics.space.regions import Region
from ...semantics.space.vectors import Unchanging, Vector
from ...semantics.store.errors import OutOfTime, RunError
from ...semantics.store.scenic_classes import ScenicClass
from ...semantics.store.scopes import MISSING
from ...semantics.syntax.nodes import Node
from ..worlds.driving.arguments import check_arguments

SLOWLY: Any = object()
NUMBERS = frozenset({int, float})
FLOATS = frozenset({float})
SHORT_LIST = 1_000
"""Elements of lists that are gone through without a word to the run's budget."""
SMALL = 1 << 62
KNOWN = frozenset({float, int, bool, NoneType, Vector, str})
"""Types of arguments and values that host code is given and gives as they are."""


def is_known(value: object) -> bool:
    """Whether a value is one that host code gives as it is, whatever is in it."""
    return type(value) in KNOWN or isinstance(value, (Unchanging, Region)) or type(value) is tuple


class NativeMethod(NamedTuple):
    """A method of a class of maps."""

    name: str
    function: Callable[..., object]


# Operators


def equation(node: Node, equations: Sequence[Equation], operands: Sequence[object], state: State) -> Equation | None:
    """The equation for operands of the kinds that these have; None where their types do not tell these kinds."""
    kinds: list[object] = []
    for operand in operands:
        kind = type(operand)
        if kind is Instance:
            kinds.append("object" if is_object(operand) else "oriented point" if is_oriented(operand) else "point")  # type: ignore[arg-type]
        elif kind in (Vector, float, int) or isinstance(operand, (Region, VectorField)):
            kinds.append(kind)
        else:
            return None
    key = (equations[0].function, equations[-1].function, len(equations), *kinds)
    found = EQUATIONS.get(key, MISSING)
    if found is MISSING:
        try:
            found = select(node, equations, list(operands), state)
        except RunError:
            found = None
        EQUATIONS[key] = found = None if found is None or found.needs_self else found  # type: ignore[union-attr]
    return found  # type: ignore[return-value]


EQUATIONS: dict[tuple[object, ...], object] = {}


# Attributes


OPEN: set[tuple[type, str]] = set()
"""Classes of maps with names of what their objects hold, which compiled code reads by itself."""
METHODS: dict[tuple[type, str], NativeMethod] = {}
"""Their methods, which it calls by itself; both are filled when the first one is asked for (`learn`)."""


@cache
def is_open(class_: type, name: str) -> bool:
    """Whether a value of a class of maps has an attribute of this name for programs, which is that of Python."""
    renamed = any(name in GIVEN.get(kind, ()) or name in OURS.get(kind, ()) for kind in class_.__mro__)
    if renamed or not may_ask(object.__new__(class_), name):
        return False
    found = next((vars(kind)[name] for kind in class_.__mro__ if name in vars(kind)), None)
    if isinstance(found, FunctionType):
        METHODS[class_, name] = NativeMethod(name, found)
    elif not isinstance(found, (property, cached_property, classmethod, staticmethod)):
        OPEN.add((class_, name))
    return True


def attribute(subject: object, name: str) -> Any:
    """An attribute of a lane or another thing of a map."""
    if not isinstance(subject, Unchanging) or not is_open(type(subject), name):
        return SLOWLY
    try:
        found = getattr(subject, name)
    except OutOfTime:
        raise
    except Exception:
        return SLOWLY
    return found if type(found) is MethodType or is_known(found) else SLOWLY


# Calls


def host_argument(value: object, objects: Mapping[int, Mapping[str, object]]) -> Any:
    """An argument as host code of maps gets it: of an object its position; a list of places as it is."""
    if type(value) is Instance:
        value = objects[value.number].get("position")
        return value if type(value) is Vector else SLOWLY
    if type(value) in KNOWN or isinstance(value, (Unchanging, Region)):
        return value
    if type(value) in (list, tuple) and all(type(v) is Vector or isinstance(v, (Unchanging, Region)) for v in value):  # type: ignore[attr-defined]
        return value
    return SLOWLY


def call(function: Any, arguments: tuple[Any, ...], named: Mapping[str, Any], objects: Mapping[int, Mapping[str, object]]) -> Any:
    """The value of a call of host code; it is random if one of the arguments is."""
    kind = type(function)
    if kind is MethodType:
        if not isinstance(function.__self__, Unchanging):
            return SLOWLY
        if not named and KNOWN.issuperset(map(type, arguments)):
            return attempt_host_call(function, arguments, named)
    elif kind is BuiltinFunctionType:
        quick = BUILTINS.get(function)
        if quick is None or named:
            return SLOWLY
        if NUMBERS.issuperset(map(type, arguments)):
            return quick(function, arguments)
    elif kind is Bound:
        return total(arguments) if function.function is SUM and not named else SLOWLY
    elif kind is Clock:
        return SLOWLY if arguments or named else function
    elif function is not check_arguments and function is not ISINSTANCE and not (kind is type and issubclass(function, Unchanging)):
        return SLOWLY
    every = (*arguments, *named.values())
    origin = next((a.origin for a in every if type(a) is Random), None)
    if origin is None:
        return known_call(function, arguments, named, objects)
    found = known_call(function, tuple(map(value_in_run, arguments)), {name: value_in_run(a) for name, a in named.items()}, objects)
    return found if found is SLOWLY else wrap(found, origin)


def known_call(function: Any, arguments: tuple[Any, ...], named: Mapping[str, Any], objects: Mapping[int, Mapping[str, object]]) -> Any:
    """The value of a call of one of these functions, with plain arguments."""
    if type(function) is BuiltinFunctionType:
        return BUILTINS[function](function, arguments)
    if function is ISINSTANCE:
        return SLOWLY if named else is_instance(arguments)
    if function is check_arguments:
        known = not named and all(type(a) in KNOWN or type(a) is Instance or isinstance(a, Unchanging) for a in arguments)
        return attempt_host_call(function, arguments, named) if known else SLOWLY
    taken = [host_argument(a, objects) for a in arguments]
    by_name = {name: host_argument(a, objects) for name, a in named.items()}
    return SLOWLY if any(a is SLOWLY for a in (*taken, *by_name.values())) else attempt_host_call(function, taken, by_name)


def attempt_host_call(function: Callable[..., object], arguments: Any, named: Mapping[str, Any]) -> Any:
    """Return the result of host code, or `SLOWLY` if it raises or gives a value that is not known."""
    try:
        found = function(*arguments, **named)
    except OutOfTime:
        raise
    except Exception:
        return SLOWLY
    return found if is_known(found) else SLOWLY


def of_numbers(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """A function of numbers that are not large."""
    for a in arguments:
        if type(a) is not float and (type(a) is not int or not -SMALL < a < SMALL):
            return SLOWLY
    try:
        found = function(*arguments)
    except Exception:
        return SLOWLY
    return found if type(found) in NUMBERS else SLOWLY


def least_or_most(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """`min(a, b, ...)`, `max(a, b, ...)` of numbers, or of those in a list."""
    if len(arguments) == 1 and type(arguments[0]) in (list, tuple) and 0 < len(arguments[0]) < SHORT_LIST:
        arguments = tuple(arguments[0])
        return arguments[0] if len(arguments) == 1 and type(arguments[0]) in NUMBERS else least_or_most(function, arguments)
    return of_numbers(function, arguments) if len(arguments) > 1 else SLOWLY


def total(arguments: tuple[Any, ...]) -> Any:
    """`sum(xs)` of numbers."""
    numbers = arguments[0] if len(arguments) == 1 and type(arguments[0]) in (list, tuple) else ()
    return sum(numbers) if 0 < len(numbers) < SHORT_LIST and FLOATS.issuperset(map(type, numbers)) else SLOWLY


def length(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """`len(xs)`."""
    known = len(arguments) == 1 and type(arguments[0]) in (list, tuple) and len(arguments[0]) < SHORT_LIST
    return len(arguments[0]) if known else SLOWLY


def quantify_truths(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """`any(xs)`, `all(xs)` of truth values."""
    known = len(arguments) == 1 and type(arguments[0]) in (list, tuple) and len(arguments[0]) < SHORT_LIST
    known = known and all(type(a) is bool for a in arguments[0])
    return function(arguments[0]) if known else SLOWLY


def is_instance(arguments: tuple[Any, ...]) -> Any:
    """`isinstance(o, C)` for a Scenic class C."""
    if len(arguments) == 2 and type(arguments[0]) is Instance and type(arguments[1]) is ScenicClass:
        return arguments[1] in arguments[0].class_.lineage
    return SLOWLY


BUILTINS: Mapping[Callable[..., object], Callable[[Callable[..., Any], tuple[Any, ...]], Any]] = {
    **dict.fromkeys((builtins.abs, *(getattr(math, name) for name in (
        "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot", "exp", "log", "degrees", "radians", "floor", "ceil", "fabs", "isinf",
        "isnan", "copysign", "fmod",
    ))), of_numbers),
    min: least_or_most, max: least_or_most, len: length, any: quantify_truths, all: quantify_truths,
}  # fmt: skip
SUM = BUILTIN["sum"].function  # type: ignore[attr-defined]
ISINSTANCE = SPECIAL_VALUES["isinstance"]
