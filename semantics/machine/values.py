"""The values of expressions: random values, instances, classes, functions (paper, Section "Data Types").

Booleans, scalars, strings, tuples, lists, ... are Python's own; vectors, fields and regions stand in
`vectors`, `fields` and `regions`.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

import operator
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from ..space.symbol_seam import Symbol
from ..store.budget import Budget, items_of, values_of
from ..store.errors import NeedsPosition, NotBegun, RunError
from ..store.postponed_values import Waiting, needs_position
from ..store.scenic_classes import ScenicClass, name_in_messages
from ..store.scopes import Names, Scope
from ..store.sets import FrozenSet, Set
from ..store.undo_log import SIMPLE
from ..syntax.nodes import NOWHERE, Node, Span
from ..syntax.python_expressions import Parameter
from ..syntax.statements import Block

if TYPE_CHECKING:
    from ..space.distributions import Distribution
    from .host_calls import Door


class Origin(NamedTuple):
    """The origin of a random value: the draw in the source and what was drawn; `distribution` if it is itself
    a draw.
    """

    span: Span
    text: str
    distribution: Distribution | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Random:
    """A value that some run would find different: `value` in this run, and the draw it stems from.

    The machine wraps the result of every draw and of every operation on wrapped values. Control flow outside behaviors
    may not look inside (reading `random-branch`); `resample` reads `origin.distribution` (reading `resample`).
    """

    value: object
    origin: Origin


def value_in_run(value: object) -> object:
    """The value in this run, random or not; containers are left as they are."""
    return value.value if type(value) is Random else value


def unwrap(value: object) -> tuple[object, Origin | None]:
    """The value with no `Random` anywhere inside lists, tuples, sets and dicts, and the origin of the first one found.

    An exception stays what it is, and is as random as its arguments. Raises `NeedsPosition` where one waits for a position.
    """
    if isinstance(value, Random):
        inner, _ = unwrap(value.value)
        return inner, value.origin
    if isinstance(value, HOLDING):
        return _unwrap_container(value, {})
    if type(value) is Waiting:
        raise needs_position(value)
    return value, None


def _unwrap_container(value: Any, seen: dict[int, tuple[object, Origin | None]]) -> tuple[object, Origin | None]:
    """`unwrap` of a container; what stands in several places is looked at once."""
    known = seen.get(id(value))
    if known is None:
        known = seen[id(value)] = _unwrapped_first(value, seen)
    return known


def _unwrapped_first(value: Any, seen: dict[int, tuple[object, Origin | None]]) -> tuple[object, Origin | None]:
    kind = type(value)
    if isinstance(value, BaseException):
        return value, _part(arguments_of(value), seen)[1]
    if isinstance(value, dict):
        if is_flat(items_of(value)) and is_flat(values_of(value)):
            return value, None
        pairs = [(_part(key, seen), _part(item, seen)) for key, item in dict.items(value)]
        origin = next((o for pair in pairs for _, o in pair if o is not None), None)
        return (value, None) if origin is None else (_refill_container(value, {k[0]: v[0] for k, v in pairs}), origin)
    if (isinstance(value, tuple) and kind is not tuple) or is_flat(items_of(value)):
        return value, None
    found = [_part(item, seen) for item in items_of(value)]
    origin = next((o for _, o in found if o is not None), None)
    if origin is None:
        return value, None
    items = [v for v, _ in found]
    return _refill_container(value, items) if isinstance(value, (list, deque)) else kind(items) if kind in PLAIN else items, origin


def _part(item: object, seen: dict[int, tuple[object, Origin | None]]) -> tuple[object, Origin | None]:
    if isinstance(item, Random):
        return _part(item.value, seen)[0], item.origin
    if type(item) is Waiting:
        raise needs_position(item)
    return _unwrap_container(item, seen) if isinstance(item, HOLDING) else (item, None)


def arguments_of(exception: BaseException) -> tuple[object, ...]:
    """The arguments of an exception, whatever a class of the program calls so."""
    return BaseException.args.__get__(exception)  # type: ignore[attr-defined]


def is_flat(items: Iterable[object]) -> bool:
    """Whether there is neither a random or waiting value nor a container or exception among the items."""
    return not any(kind is Random or kind is Waiting or issubclass(kind, HOLDING) for kind in set(map(type, items)))


PLAIN = (tuple, Set, FrozenSet, set, frozenset)
CONTAINERS = (list, tuple, set, frozenset, dict, deque, type({}.values()), type({}.items()))
HOLDING = (*CONTAINERS, BaseException)


def _refill_container(container: object, content: object) -> object:
    """The content in a container of the same type; a copy, where that is a subclass of list or dict, or a deque."""
    if type(container) in (list, dict):
        return content
    result = copy(container)
    result.clear()  # type: ignore[attr-defined]
    (dict.update if isinstance(result, dict) else type(result).extend)(result, content)  # type: ignore[attr-defined, call-arg]
    return result


def copy_containers(value: Any, seen: dict[int, tuple[object, object]]) -> Any:
    """The value as it is now: its containers are copied, so that later changes do not reach them.

    `seen` holds each container that was met, with its copy, by its `id`: what is shared stays shared. Dictionaries and sets are not copied where a
    class of the program says how their keys are compared.
    """
    kind: Any = type(value)
    if kind is Random:
        inner = copy_containers(value.value, seen)
        return value if inner is value.value else Random(inner, value.origin)
    if not isinstance(value, COPIED):
        return value
    if id(value) in seen:
        return seen[id(value)][1]
    if isinstance(value, (dict, Set)) and not all(map(is_hashed_by_python, items_of(value))):
        return value  # to put its keys into another one would call methods of the program
    if isinstance(value, tuple):
        parts = [copy_containers(part, seen) for part in items_of(value)]
        same = all(map(operator.is_, parts, items_of(value)))
        return seen.setdefault(id(value), (value, value if same else tuple.__new__(kind, parts)))[1]
    base = next(base for base in COPIED if isinstance(value, base))
    made = base.__new__(kind)  # whatever a class of the program says of it
    seen[id(value)] = value, made
    with suppress(AttributeError):
        object.__getattribute__(made, "__dict__").update(object.__getattribute__(value, "__dict__"))
    if isinstance(value, dict):
        dict.update(made, {key: copy_containers(item, seen) for key, item in dict.items(value)})
        if isinstance(value, defaultdict):
            made.default_factory = value.default_factory
    elif isinstance(value, Set):
        Set.renewed(made, dict(value.order))
    elif isinstance(value, deque):
        deque.__init__(made, (copy_containers(item, seen) for item in items_of(value)), value.maxlen)
    else:
        list.extend(made, [copy_containers(item, seen) for item in items_of(value)])
    return made


COPIED: tuple[Any, ...] = (list, tuple, dict, deque, Set)


def is_hashed_by_python(key: object) -> bool:
    """Whether a key of a dictionary, or an element of a set, is compared without a method of the program."""
    kind = type(key)
    if kind in SIMPLE:
        return True
    if kind is tuple:
        return all(map(is_hashed_by_python, key))  # type: ignore[arg-type]
    return kind.__hash__ is object.__hash__ and kind.__eq__ is object.__eq__


def wrap(value: object, origin: Origin | None) -> object:
    """`value` marked as stemming from `origin`; the distribution is dropped, since `value` is a result, not a draw."""
    if origin is None or type(value) is Random:
        return value
    return Random(value, origin if origin.distribution is None else origin._replace(distribution=None))


@name_in_messages("instance")
@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """A reference to an instance of a Scenic class, made at `span`; its properties stand in the state's O, under `number`."""

    number: int
    class_: ScenicClass
    span: Span = NOWHERE

    def __repr__(self) -> str:
        return f"<{self.class_.name} {self.number}>"


class Described(NamedTuple):
    """An instance as methods of a library meet it (`TakesObjects`): the name of its class, and its properties."""

    class_name: str
    properties: Mapping[str, object]


@name_in_messages("function")
@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A function of the program: closed over its scope, its default values evaluated when `def` ran."""

    name: str
    parameters: tuple[Parameter, ...]
    body: Block | Node
    scope: Scope
    defaults: Mapping[str, object]
    names: Names
    door: Door
    span: Span = NOWHERE
    looks: bool = False
    """Whether it is a method that Python calls while it looks through containers."""

    def __call__(self, *arguments: object, **keywords: object) -> object:
        """Called by host code: through the door."""
        return self.door.call(self, arguments, keywords)

    def __get__(self, instance: object, owner: type | None = None) -> Function | Method:
        """A method, where Python looks this function up on an instance of a class of the program."""
        return self if instance is None else Method(self, instance, self.door)

    def __repr__(self) -> str:
        return f"<function {self.name}>"


@name_in_messages("method")
@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """A function of the program bound to its first argument."""

    function: Function
    instance: object
    door: Door

    def __repr__(self) -> str:
        return f"<method {self.function.name}>"  # pyright: ignore[reportAttributeAccessIssue]

    def __call__(self, *arguments: object, **keywords: object) -> object:
        """Called by host code: through the door."""
        return self.door.call(self.function, (self.instance, *arguments), keywords)  # pyright: ignore[reportArgumentType]


@name_in_messages("distribution")
@dataclass(frozen=True, slots=True, eq=False)
class Constructor:
    """A distribution's name as a value: `make(arguments)` checks the parameters θ and gives baseDist(θ).

    `takes` names its parameters, for messages, and `renamed` those that the releases name otherwise, by their names. `keeps_values`: the
    arguments are values to choose among, not parameters; they may be random. `unordered` makes it where its bounds may stand in either order
    (reading `reversed-range`).
    """

    name: str
    make: Callable[..., Distribution]
    keeps_values: bool
    takes: str = ""
    unordered: Callable[..., Distribution] | None = None
    renamed: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<distribution {self.name}>"


@name_in_messages("built-in function")
@dataclass(frozen=True, slots=True, eq=False)
class Special:
    """A builtin that is a rule of the machine rather than a host function: `resample`, `print`, ..."""

    name: str

    def __call__(self, *arguments: object, **keywords: object) -> object:
        """Called by host code, which the machine's rules cannot follow."""
        raise RunError(
            f"library code cannot call {self.name} by itself", rule="E-Call-Host", hint=f"give it a function: lambda x: {self.name}(x)"
        )

    def __repr__(self) -> str:
        return f"<built-in {self.name}>"


@name_in_messages("behavior or scenario")
@dataclass(frozen=True, slots=True, eq=False)
class Dynamic:
    """A behavior, monitor or scenario class as a value, or (with arguments) one ready to run."""

    definition: Node
    scope: Scope
    defaults: Mapping[str, object]
    arguments: tuple[tuple[object, ...], Mapping[str, object]] | None = None
    space: Scope | None = None
    """The variables of a scenario with arguments: it is one instance, which others can refer to."""

    def __repr__(self) -> str:
        name = getattr(self.definition, "name", "")
        if self.arguments is None:
            return name
        positional, keywords = self.arguments
        shown = [repr(shown_value(v)) for v in positional] + [f"{k}={shown_value(v)!r}" for k, v in keywords.items()]
        return f"{name}({', '.join(shown)})"


def shown_value(value: object) -> object:
    """The value in this run, as messages show it; what waits is shown as that."""
    try:
        return unwrap(value)[0]
    except (NeedsPosition, NotBegun):
        return value


@name_in_messages("module")
@dataclass(frozen=True, slots=True, eq=False)
class Module:
    """An imported module's namespace."""

    name: str
    scope: Scope

    def __repr__(self) -> str:
        return f"<module {self.name}>"


@name_in_messages("built-in function")
@dataclass(frozen=True, slots=True, eq=False)
class Native:
    """A function of the reference in place of one of Python's; one that `pays` gets the run's budget first, and is bound to it when a run begins."""

    name: str
    function: Callable[..., object]
    pays: bool = False
    members: Mapping[str, Native] = field(default_factory=dict)

    def __call__(self, *arguments: object, **keywords: object) -> object:
        """The function of the arguments."""
        return self.function(*arguments, **keywords)

    def __repr__(self) -> str:
        return f"<built-in function {self.name}>"


@name_in_messages("built-in function")
@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """A function of the reference with the budget that it pays from, and for a method with its subject."""

    name: str
    function: Callable[..., object]
    budget: Budget
    subject: tuple[object, ...] = ()
    members: Mapping[str, Native] = field(default_factory=dict)

    def __call__(self, *arguments: object, **keywords: object) -> object:
        """The function of the budget, the subject and the arguments."""
        return self.function(self.budget, *self.subject, *arguments, **keywords)

    def afresh(self, *arguments: object, **keywords: object) -> object:
        """Call the function with a budget of its own, for one call of many rows."""
        return self.function(Budget(), *self.subject, *arguments, **keywords)

    def __repr__(self) -> str:
        return f"<built-in function {self.name}>"


@dataclass(frozen=True, slots=True)
class Hint:
    """A name of `typing`, with or without arguments: it stands in annotations, which say nothing to the machine."""

    name: str

    __iter__ = None  # else `__getitem__` would make it endless

    def __getitem__(self, arguments: object) -> Hint:
        return self

    def __or__(self, other: object) -> Hint:
        return self

    __ror__ = __or__

    def __repr__(self) -> str:
        return f"typing.{self.name}"


class Applicable:
    """A value that can be called, by rules of the machine, and has no truth of its own."""

    __slots__ = ()


class Entries(dict[Any, Any]):
    """A dictionary with random keys, as it is in this run; `pairs` are its entries before equal keys became one."""

    pairs: list[tuple[object, object]]


class Pairs(NamedTuple):
    """The entries of a dictionary with random keys, where no run is looked at: weights of `Discrete`, and
    nothing else.
    """

    pairs: list[tuple[object, object]]


def with_random_keys(pairs: list[tuple[object, object]]) -> Entries | Pairs:
    """The dictionary of the pairs, some of whose keys are random. Raises TypeError for keys that are unhashable."""
    symbols = [key for key, _ in pairs if isinstance(key, Symbol)]
    if symbols:
        if not all(key.always(is_hashable) for key in symbols):
            raise TypeError("unhashable key")
        return Pairs(pairs)
    result = Entries(pairs)
    result.pairs = pairs
    return result


def is_hashable(value: object) -> bool:
    """Whether the value can be a key."""
    try:
        hash(value)
    except TypeError:
        return False
    return True


def each(function: Callable[..., Any], value: object, *arguments: object) -> Any:
    """`function(value, *arguments)` for the value of something random; where that stands for many, of every one, as such a value again."""
    if not isinstance(value, Symbol):
        return function(value, *arguments)

    def of_one(one: object) -> object:
        return each(function, one, *arguments)

    of_one.__qualname__ = getattr(function, "__qualname__", of_one.__qualname__)
    return value.each(of_one)
