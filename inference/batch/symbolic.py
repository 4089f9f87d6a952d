"""The symbols that answer draws when a program is traced, and values with symbols inside: their nodes, and what they are in one row."""

from __future__ import annotations

import dataclasses
import operator
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from types import BuiltinFunctionType, MethodType
from typing import TYPE_CHECKING, Any

import numpy as np

from ...semantics.machine.operand_kinds import is_a
from ...semantics.machine.values import (
    Dynamic,
    Function,
    Instance,
    Method,
    Module,
    Pairs,
    Random,
    each,
    unwrap,
)
from ...semantics.space.fields import VectorField
from ...semantics.space.regions import Region
from ...semantics.space.symbol_seam import NotLifted, Symbol
from ...semantics.space.vectors import Vector
from ...semantics.store.budget import PLAIN
from ...semantics.store.scenic_classes import ScenicClass
from ...semantics.store.sets import FrozenSet, Set
from .graph import GraphNode, PartialRun, RowCall, RowDraw

if TYPE_CHECKING:
    from ...semantics.machine.outcome import Requirement
    from .graph_builder import Recorder


OPERATORS: dict[Callable[..., object], np.ufunc] = {
    operator.add: np.add, operator.sub: np.subtract, operator.mul: np.multiply, operator.truediv: np.true_divide, operator.mod: np.mod,
    operator.neg: np.negative, operator.pos: np.positive, operator.abs: np.absolute, operator.eq: np.equal, operator.ne: np.not_equal,
    operator.lt: np.less, operator.le: np.less_equal, operator.gt: np.greater, operator.ge: np.greater_equal,
    operator.and_: np.logical_and, operator.or_: np.logical_or, operator.xor: np.logical_xor, operator.invert: np.logical_not,
}
"""Python's operators as they act on floats and truth values."""


class Retry(BaseException):
    """The run that is traced got stuck where no value can go on: another run must be traced. No program can take it for an error of its own."""


class Mistaken(NotLifted):
    """The run that was traced ends with an error of the program, perhaps `late`, after a requirement has failed; others may not."""

    late = False


def _binary(operation: Callable[..., object], *, swapped: bool = False) -> Callable[[Any, object], object]:
    def method(self: Any, other: object) -> object:
        pair = (other, self) if swapped else (self, other)
        return self.trace.operate(operation, pair)

    return method


def _unary(operation: Callable[..., object]) -> Callable[[Any], object]:
    return lambda self: self.trace.operate(operation, (self,))


def _method(name: str) -> Callable[..., object]:
    """The method of that name, as a function."""

    def called(subject: object, *arguments: object) -> object:
        return getattr(subject, name)(*arguments)

    called.__qualname__ = name
    return called


METHODS: dict[str, tuple[Callable[..., object], type | None]] = {
    name: (_method(name), result)
    for name, result in {
        "contains_point": bool, "contains_box": bool, "distance_to": float, "at": float, "intersect": None, "union": None, "difference": None,
    }.items()
}
"""What rules ask regions and fields for; of one that differs from run to run it is asked row by row."""


def has_orientation(region: Region) -> bool:
    """Whether a region is oriented."""
    return region.orientation is not None


def _is_spatial(value: object) -> bool:
    return is_a(value, Region) or is_a(value, VectorField)


class Traced(Symbol):
    """A symbol of a trace; `example` is its value in the run that was traced."""

    __slots__ = ("example", "node", "trace")

    def __init__(self, trace: Recorder, node: GraphNode, example: object) -> None:
        self.trace = trace
        self.node = node
        self.example = example

    def apply(self, function: Callable[..., object], arguments: tuple[object, ...], result: type | None = None) -> Any:
        return self.trace.apply(function, arguments, result)

    def __array_ufunc__(self, function: np.ufunc, method: str, *arguments: object, **options: object) -> object:
        if method != "__call__" or options:
            raise NotLifted(f"{function.__name__}.{method} of random values")
        return self.trace.apply_ufunc(function, arguments)

    def __bool__(self) -> bool:
        return self.trace.guard(self)

    def met(self, requirement: Requirement) -> bool:
        return self.trace.require(requirement, self)

    def where(self, expected: bool, end: object) -> None:
        self.trace.partial = PartialRun(self.node, expected, end)

    def _say_nothing(self, *ignored: object) -> str:
        raise NotLifted("the text of a random value is needed")

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        if name in METHODS and self.always(_is_spatial):
            function, result = METHODS[name]
            return lambda *arguments: self.trace.call(function, (self, *arguments), {}, result)
        if name == "orientation" and is_a(self, Region):
            return self.oriented() if each(has_orientation, self) else None
        raise NotLifted(f"the attribute {name} of a random value")

    def oriented(self) -> object:
        """The orientation of a region that is oriented in the traced run; of others, which are left to the interpreter, that one as well."""
        traced: Region = self.example  # type: ignore[assignment]
        return each(lambda region: region.orientation or traced.orientation, self)

    __hash__ = Symbol.__hash__
    __str__ = __repr__ = __format__ = _say_nothing
    __add__, __radd__ = _binary(operator.add), _binary(operator.add, swapped=True)
    __sub__, __rsub__ = _binary(operator.sub), _binary(operator.sub, swapped=True)
    __mul__, __rmul__ = _binary(operator.mul), _binary(operator.mul, swapped=True)
    __truediv__, __rtruediv__ = _binary(operator.truediv), _binary(operator.truediv, swapped=True)
    __mod__, __rmod__ = _binary(operator.mod), _binary(operator.mod, swapped=True)
    __and__, __rand__ = _binary(operator.and_), _binary(operator.and_, swapped=True)
    __or__, __ror__ = _binary(operator.or_), _binary(operator.or_, swapped=True)
    __xor__, __rxor__ = _binary(operator.xor), _binary(operator.xor, swapped=True)
    __lt__, __le__, __gt__, __ge__ = (_binary(o) for o in (operator.lt, operator.le, operator.gt, operator.ge))
    __eq__, __ne__ = _binary(operator.eq), _binary(operator.ne)  # type: ignore[assignment]
    __neg__, __pos__, __abs__, __invert__ = (_unary(o) for o in (operator.neg, operator.pos, operator.abs, operator.invert))

    def cases(self) -> Sequence[tuple[Any, object]]:
        raise NotLifted("which values this may have is known only row by row")

    def of_cases(self, results: Sequence[object]) -> Any:
        raise NotLifted("which values this may have is known only row by row")


class Scalar(Traced):
    """A float or a truth value."""

    __slots__ = ()

    def always(self, predicate: Callable[[Any], bool]) -> bool:
        return predicate(self.example)

    def each(self, function: Callable[[Any], object]) -> Any:
        raise NotLifted("a function of the values of a random number")

    def number(self) -> Any:
        return self.trace.as_float(self)

    def pick(self, values: Sequence[object]) -> Any:
        return self.trace.pick(self, values)


def is_there(value: object) -> bool:
    """Whether a value is not None."""
    return value is not None


def of_nothing(predicate: Callable[[Any], bool]) -> bool | None:
    """Whether the predicate holds of None; None if it cannot be asked of it."""
    try:
        return predicate(None)
    except Exception:
        return None


class Choice(Traced):
    """One of some values, which may hold symbols themselves; the node says which."""

    __slots__ = ("values",)

    def __init__(self, trace: Recorder, node: GraphNode, values: Sequence[object]) -> None:
        self.values = tuple(values)
        chosen = self.values[node.example]  # type: ignore[index]
        super().__init__(trace, node, chosen.example if isinstance(chosen, Traced) else chosen)

    def always(self, predicate: Callable[[Any], bool]) -> bool:
        nothing = [v for v in self.values if v is None or (isinstance(v, Opaque) and v.example is None)]
        for value in nothing:
            if value is not None:
                self.trace.settle(value)
        answers = {predicate(v.example if isinstance(v, Opaque) else v) for v in self.values if all(v is not n for n in nothing)}
        if len(answers) > 1:
            raise NotLifted("a choice among values of different types is used as one of them")
        answer = answers.pop() if answers else predicate(None)
        perhaps = nothing or any(isinstance(v, Opaque) for v in self.values)
        if perhaps and answer is not of_nothing(predicate):
            self.trace.need(self)
        return answer

    def there(self) -> Any:
        """Whether it is not None."""
        if any(isinstance(v, Traced) for v in self.values):
            return self.trace.call(is_there, (self,), {}, bool)
        return self.trace.table(self.node, np.array([v is not None for v in self.values]))

    def each(self, function: Callable[[Any], object]) -> Any:
        found = self.trace.tabulate(self.node, [partial(function, value) for value in self.values], function)
        return self.trace.call(function, (self,), {}) if found is NotImplemented else found

    def cases(self) -> Sequence[tuple[Any, object]]:
        found: list[tuple[Any, object]] = []
        for position, value in enumerate(self.values):
            here = self.trace.table(self.node, np.arange(len(self.values)) == position)
            inner = value.cases() if isinstance(value, Traced) else [(True, value)]
            found += [(here if condition is True else here & condition, one) for condition, one in inner]
        return found

    def of_cases(self, results: Sequence[object]) -> Any:
        rest, merged = list(results), []
        for value in self.values:
            count = len(value.cases()) if isinstance(value, Choice) else 1
            merged.append(value.of_cases(rest[:count]) if isinstance(value, Choice) else rest[0])
            rest = rest[count:]
        return self.trace.merge(self.node, merged)

    def number(self) -> Any:
        return self.trace.as_float(self)

    def pick(self, values: Sequence[object]) -> Any:
        return self.each(lambda position: values[int(position)])

    def __iter__(self) -> Iterator[object]:
        lengths = {len(v) if isinstance(v, (tuple, list)) else -1 for v in self.values}
        if len(lengths) != 1 or -1 in lengths:
            raise NotLifted("a choice among values with different numbers of elements")
        return iter([self.each(operator.itemgetter(i)) for i in range(lengths.pop())])

    def __getitem__(self, index: object) -> object:
        if isinstance(index, Traced):
            return self.trace.call(operator.getitem, (self, index), {})
        return self.each(operator.itemgetter(index))


class Opaque(Traced):
    """Anything, computed row by row; every row's value is of the example's type, or None."""

    __slots__ = ()

    def always(self, predicate: Callable[[Any], bool]) -> bool:
        answer = predicate(self.example)
        if self.example is None or answer is not of_nothing(predicate):
            self.trace.need(self)
        return answer

    def there(self) -> Any:
        """Whether it is not None."""
        return self.trace.call(is_there, (self,), {}, bool)

    def each(self, function: Callable[[Any], object]) -> Any:
        return self.trace.call(function, (self,), {})

    def number(self) -> Any:
        return self.trace.call(float, (self,), {})

    def __getitem__(self, index: object) -> object:
        return self.trace.call(operator.getitem, (self, index), {})

    def pick(self, values: Sequence[object]) -> Any:
        raise NotLifted("a random position is computed row by row")


Resolve = Callable[[GraphNode], object]


def symbols_in(value: object) -> list[Traced]:
    """The symbols in a value, however deep."""
    found: list[Traced] = []
    _collect(value, found, 0)
    return found


def nodes_in(value: object) -> list[GraphNode]:
    """The nodes of these symbols."""
    return [symbol.node for symbol in symbols_in(value)]


def _collect(value: object, found: list[Traced], depth: int) -> None:
    if type(value) in PLAIN or (type(value) is Vector and type(value.x) is float and type(value.y) is float):
        return
    if depth > 50:
        raise NotLifted("a value is nested too deeply")
    match value:
        case Choice():
            found.append(value)
            for entry in value.values:
                _collect(entry, found, depth + 1)
        case Traced():
            found.append(value)
        case Pairs():
            raise NotLifted("a dictionary with random keys")
        case Random():
            _collect(value.value, found, depth + 1)
        case BaseException() if unwrap(value)[1] is not None:
            raise NotLifted("an exception is made of something random")
        case Vector():
            _collect(value.x, found, depth + 1)
            _collect(value.y, found, depth + 1)
        case dict():
            for pair in value.items():
                _collect(pair, found, depth + 1)
        case list() | tuple() | set() | frozenset() | deque():
            for item in value:
                _collect(item, found, depth + 1)
        case BuiltinFunctionType() | MethodType():
            _collect(value.__self__, found, depth + 1)
        case _ if not isinstance(value, type) and dataclasses.is_dataclass(value) and not isinstance(value, ATOMS):
            for field in dataclasses.fields(value):
                _collect(getattr(value, field.name), found, depth + 1)
        case Dynamic(arguments=arguments) if arguments is not None:
            _collect(arguments, found, depth + 1)


ATOMS = (Instance, ScenicClass, Function, Method, Module, Dynamic)


def in_row(value: object, resolve: Resolve) -> Any:
    """The value in a row, of which `resolve` gives the value of a node."""
    return row_maker(value)(resolve)


def row_maker(value: object) -> Callable[[Resolve], Any]:
    """Return a function that gives the value in each row; the places of its symbols are found once."""
    if not symbols_in(value):
        return lambda resolve: value
    match value:
        case Choice(node=node):
            among = [row_maker(v) for v in value.values]
            return lambda resolve: among[resolve(node)](resolve)  # type: ignore[index]
        case Traced(node=node):
            return lambda resolve: resolve(node)
        case Random():
            return row_maker(value.value)
        case Vector():
            x, y = row_maker(value.x), row_maker(value.y)
            return lambda resolve: Vector(x(resolve), y(resolve))
        case dict():
            pairs = [(row_maker(k), row_maker(v)) for k, v in value.items()]
            return _like(value, lambda resolve: {k(resolve): v(resolve) for k, v in pairs})
        case tuple() if hasattr(value, "_fields"):
            parts = [row_maker(v) for v in value]
            return lambda resolve: type(value)(*[v(resolve) for v in parts])  # pyright: ignore[reportArgumentType]
        case list() | tuple() | set() | frozenset() | deque():
            items = [row_maker(v) for v in value]
            return _like(value, lambda resolve: [v(resolve) for v in items])
        case BuiltinFunctionType() | MethodType():
            subject = row_maker(value.__self__)
            return lambda resolve: getattr(subject(resolve), value.__name__)
        case Dynamic():
            arguments = row_maker(value.arguments)
            return lambda resolve: dataclasses.replace(value, arguments=arguments(resolve))
        case _:
            fields = {f.name: row_maker(getattr(value, f.name)) for f in dataclasses.fields(value)}  # type: ignore[arg-type]
            return lambda resolve: dataclasses.replace(value, **{name: made(resolve) for name, made in fields.items()})  # type: ignore[type-var]


def _like(container: object, content: Callable[[Resolve], Any]) -> Callable[[Resolve], Any]:
    """The content in a container of the same type."""
    if type(container) not in (list, tuple, Set, FrozenSet, dict):
        raise NotLifted(f"a {type(container).__name__} holds random values")
    kind: Any = type(container)
    return lambda resolve: kind(content(resolve))



def children(node: GraphNode) -> list[GraphNode]:
    """The nodes that a node is computed from."""
    if isinstance(node.function, (RowCall, RowDraw)):
        called = node.function
        return nodes_in((called.structure, called.keywords) if isinstance(called, RowCall) else called.distribution)
    return [a for a in node.arguments if isinstance(a, GraphNode)]

