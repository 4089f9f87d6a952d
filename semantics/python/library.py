"""Python's builtins and harmless modules as a program gets them: what is safe as it is, and ours where it is not.

Ours is what never ends, makes more than fits into memory by one call, or depends on more than the program. Functions that pay from the run's
budget are bound to it when a run begins (`bound`).
"""

from __future__ import annotations

import builtins as python
import collections
import enum
import functools
import hashlib
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from ..machine.sandbox_table import BUILTINS, MARK, OURS_OF_MATH, is_user_made, own_word
from ..machine.values import Bound, Hint, Native
from ..space.regions import PolygonalRegion, PolylineRegion
from ..store.budget import ITEM, Budget, Metered, as_whole_number, container_length, host_size, refuse_too_large, refuse_too_long
from ..store.containers import Counter, OrderedDict, deque
from ..store.generators import Generator
from ..store.sets import FrozenSet, Set
from ..store.undo_log import note_attribute, note_container
from .arithmetic import BINARY
from .call_costs import as_callback, check_exception, with_callbacks
from .string_methods import METHODS as OF_TEXTS
from .string_methods import addressless_format, addressless_repr, decode


def native(function: Callable[..., object], name: str = "") -> Native:
    """A function of ours under the name that programs use."""
    return Native(name or function.__name__, function)


def paying(function: Callable[..., object], name: str = "") -> Native:
    """A function of ours that pays from the run's budget, which is its first argument."""
    return Native(name or function.__name__, function, pays=True)


def bound(value: object, budget: Budget) -> object:
    """The value as a run gets it: a function that pays is bound to the budget."""
    return Bound(value.name, value.function, budget, (), value.members) if type(value) is Native and value.pays else value


# Builtins


def sum_of(budget: Budget, items: Iterable[Any], start: Any = 0) -> Any:
    """`sum(items, start)`."""
    if isinstance(start, (str, bytes)):
        raise TypeError("sum() does not join texts: use ''.join")
    if isinstance(start, (int, float)):
        return python.sum(items, start)
    total = start
    for item in items:
        total = BINARY["+"](total, item)
        budget.made(total)
    return total


def iterator(budget: Budget, subject: Any, *sentinel: object) -> Metered | Generator:
    """`iter(subject)`, `iter(function, sentinel)`."""
    if type(subject) in (Metered, Generator) and not sentinel:
        return subject
    return budget.metered(python.iter(as_callback(subject, budget) if sentinel else subject, *sentinel))  # type: ignore[call-overload]


def following(items: Any, *default: object) -> object:
    """`next(items, default)`."""
    return python.next(items, *default)


def power(base: object, exponent: object, modulus: object = None) -> object:
    """`pow(base, exponent, modulus)`."""
    if modulus is None:
        return BINARY["**"](base, exponent)
    if isinstance(base, int) and isinstance(exponent, int) and isinstance(modulus, int):
        base, exponent, modulus = as_whole_number(base), as_whole_number(exponent), as_whole_number(modulus)
        refuse_too_large(base.bit_length() / 16)
        refuse_too_large(exponent.bit_length() * 16)
        refuse_too_large(modulus.bit_length() * 16)
    return pow(base, exponent, modulus)  # type: ignore[call-overload]


def rounded(number: Any, digits: Any = None) -> object:
    """`round(number, digits)`."""
    if isinstance(digits, int) and isinstance(number, int):
        refuse_too_large(abs(as_whole_number(digits)) * 4)
    return python.round(number) if digits is None else python.round(number, digits)


def ascii_of(value: object) -> str:
    """`ascii(value)`."""
    return addressless_repr(value).encode("ascii", "backslashreplace").decode("ascii")


def hash_of(value: object) -> int:
    """`hash(value)`: one that depends on the value alone, not on the process. Raises `TypeError` for what has no such value."""
    match value:
        case bool() | int() | float() | complex() | None:
            return python.hash(value) if value is not None and value == value else 0  # NaN has that of its address
        case str() | bytes():
            data = value.encode("utf-8", "surrogatepass") if isinstance(value, str) else value
            return int.from_bytes(hashlib.blake2b(data, digest_size=7).digest())
        case tuple():
            return python.hash(tuple(map(hash_of, value)))
        case FrozenSet():
            return python.hash(frozenset(map(hash_of, value)))
        case _ if is_user_made(value) and any("__hash__" in c.__dict__ for c in type(value).__mro__ if MARK in c.__dict__):
            return python.hash(value)
        case _:
            raise TypeError(f"the hash of {addressless_repr(value)} depends on its address: compare it, or hash its parts")


def listing(make: Callable[..., Iterable[object]]) -> Native:
    """A builtin of Python's that gives its elements when they are asked for, as library code calls it: it gives a list.

    Python frees a long chain of such iterators, and goes through it, by a recursion that it does not count.
    """
    return native(functools.partial(listed, make), make.__name__)


def listed(make: Callable[..., Iterable[object]], *arguments: object, **keywords: object) -> list[object]:
    """Return the elements of a lazy builtin as a list."""
    return list(make(*arguments, **keywords))


LISTING = {made.name: made for made in map(listing, (python.map, python.filter, python.zip, python.enumerate, python.reversed))}
"""Builtins that are lazy in Python, by name; called by the program they have rules (`specials`)."""

BUILTIN: Mapping[str, object] = {
    **LISTING,
    **{name: getattr(python, name) for name in BUILTINS},
    "set": Set, "frozenset": FrozenSet,
    "sum": paying(sum_of, "sum"),
    "iter": paying(iterator, "iter"),
    "next": native(following, "next"),
    "pow": native(power, "pow"),
    "round": native(rounded, "round"),
    "repr": native(addressless_repr, "repr"), "ascii": native(ascii_of, "ascii"),
    "format": native(addressless_format, "format"),
    "hash": native(hash_of, "hash"),
}
"""Python's builtins, by name; those that are rules of the machine stand in `specials`."""


# math


def factorial(n: int) -> int:
    """`math.factorial(n)`."""
    n = as_whole_number(n)
    if n > 1:
        refuse_too_large(n * math.log2(n))
    return math.factorial(n)


def comb(n: int, k: int) -> int:
    """`math.comb(n, k)`."""
    n, k = as_whole_number(n), as_whole_number(k)
    if 0 < k < n:
        refuse_too_large(min(k, n - k) * n.bit_length())
    return math.comb(n, k)


def perm(n: int, k: int | None = None) -> int:
    """`math.perm(n, k)`."""
    n, k = as_whole_number(n), None if k is None else as_whole_number(k)
    if n > 1:
        refuse_too_large((n if k is None else min(max(k, 0), n)) * n.bit_length())
    return math.perm(n, k)


def product_of(items: Iterable[Any], *, start: Any = 1) -> Any:
    """`math.prod(items, start=start)`."""
    total = start
    for item in items:
        total = BINARY["*"](total, item)
    return total


def least_common_multiple(*numbers: int) -> int:
    """`math.lcm(*numbers)`."""
    refuse_too_large(python.sum(as_whole_number(n).bit_length() for n in numbers))
    return math.lcm(*numbers)


OWN_MATH = {"factorial": factorial, "comb": comb, "perm": perm, "prod": product_of, "lcm": least_common_multiple}
MATH: Mapping[str, object] = {
    name: native(OWN_MATH[name], name) if name in OURS_OF_MATH else value for name, value in vars(math).items() if not name.startswith("_")
}


# itertools


CALLING = frozenset({"accumulate", "dropwhile", "filterfalse", "starmap", "takewhile"})
"""Functions of `itertools` that call what they are given."""


def metering(
    make: Callable[..., Iterator[object]], check: Callable[..., None] | None = None, members: Mapping[str, Native] | None = None
) -> Native:  # fmt: skip
    """A function of `itertools` whose items are paid for one by one; `check` refuses arguments that take too much at once."""
    return Native(make.__name__, functools.partial(metered_items, make, check), pays=True, members=members or {})


def metered_items(
    make: Callable[..., Iterator[object]], check: Callable[..., None] | None, budget: Budget, *arguments: object, **keywords: object
) -> Metered:  # fmt: skip
    """Return the elements of a function of `itertools`, paid for item by item. It is no closure, since the
    state of a run can be saved.
    """
    arguments = tuple(map(in_full, arguments))
    if check is not None:
        check(*arguments, **keywords)
    if make.__name__ in CALLING:
        arguments, keywords = tuple(with_callbacks(arguments, budget)), {k: as_callback(v, budget) for k, v in keywords.items()}
    return budget.metered(make(*arguments, **keywords))


def in_full(argument: Any) -> Any:
    """The elements of a generator in a list, since an iterator of Python's that keeps it cannot wait for the machine; anything else as it is."""
    return list(argument) if type(argument) is Generator else argument


def check_product(*pools: Any, repeat: int = 1) -> None:
    """Refuse more pools than fit into memory."""
    refuse_too_long(as_whole_number(repeat) * python.sum(max(1, container_length(pool)) for pool in pools))


def check_size(items: object, r: Any = None) -> None:
    """Refuse rows that do not fit into memory."""
    refuse_too_long(0 if r is None else r)


def tee(budget: Budget, items: Iterable[object], n: int = 2) -> tuple[Metered, ...]:
    """`itertools.tee(items, n)`."""
    refuse_too_long(n := as_whole_number(n))
    return tuple(budget.metered(copy) for copy in itertools.tee(in_full(items), n))


def grouped(budget: Budget, items: Iterable[object], key: Callable[[object], object] | None = None) -> Metered:
    """`itertools.groupby(items, key)`."""
    return budget.metered((k, budget.metered(iter(list(group)))) for k, group in itertools.groupby(in_full(items), as_callback(key, budget)))  # type: ignore[arg-type]


ITERTOOLS: Mapping[str, object] = {
    **{
        name: metering(getattr(itertools, name))
        for name in (
            "accumulate", "compress", "count", "cycle", "dropwhile", "filterfalse", "islice", "pairwise", "repeat", "starmap", "takewhile",
            "zip_longest",
        )
    },
    **{name: metering(getattr(itertools, name), check_size) for name in ("combinations", "combinations_with_replacement", "permutations")},
    "product": metering(itertools.product, check_product),
    "chain": metering(itertools.chain, members={"from_iterable": metering(itertools.chain.from_iterable)}),
    "tee": paying(tee),
    "groupby": paying(grouped, "groupby"),
}


# functools, collections, enum


def partial(budget: Budget, function: Callable[..., object], *arguments: object, **keywords: object) -> Bound:
    """`functools.partial(function, *arguments, **keywords)`."""
    if not callable(function):
        raise TypeError("partial() takes a function")
    return Bound(own_word(function, "name", "partial"), functools.partial(applied, function, arguments, keywords), budget)


def applied(
    function: Callable[..., object], first: tuple[object, ...], named: Mapping[str, object], budget: Budget, *rest: object, **others: object
) -> object:
    """`function(*first, *rest, **named, **others)`."""
    return as_callback(function, budget)(*first, *rest, **{**named, **others})  # type: ignore[operator]


def reduced(budget: Budget, function: Callable[[object, object], object], items: Iterable[object], *initial: object) -> object:
    """`functools.reduce(function, items, initial)`."""
    return functools.reduce(as_callback(function, budget), budget.metered(items), *initial)  # type: ignore[arg-type]


def comparing(budget: Budget, function: Callable[[object, object], object]) -> object:
    """`functools.cmp_to_key(function)`."""
    return functools.cmp_to_key(as_callback(function, budget))  # type: ignore[arg-type]


def record(name: str, fields: str | Sequence[str], *, rename: bool = False, defaults: Sequence[object] | None = None) -> type:
    """`collections.namedtuple(name, fields)`."""
    found = fields.replace(",", " ").split() if isinstance(fields, str) else list(fields)
    if len(found) > 255:
        raise ValueError("a named tuple has at most 255 fields")
    made = collections.namedtuple(name, found, rename=rename, defaults=defaults, module="scenic")  # type: ignore[misc]
    setattr(made, MARK, True)
    return made


def elements(budget: Budget, counter: Counter) -> Metered:
    """`counter.elements()`."""
    return budget.metered(counter.elements())


def index_in(budget: Budget, items: Any, value: Any, *limits: int) -> int:
    """`items.index(value)`."""
    if isinstance(items, range) and not isinstance(value, int):
        refuse_too_long(host_size(items) // ITEM)
    return items.index(value, *limits)


def count_in(budget: Budget, items: Any, value: Any) -> int:
    """`items.count(value)`."""
    if isinstance(items, range) and not isinstance(value, int):
        refuse_too_long(host_size(items) // ITEM)
    return items.count(value)


HINTS = (
    "AbstractSet Annotated Any AnyStr Callable ClassVar Collection Container Counter DefaultDict Deque Dict Final FrozenSet Generator "
    "Generic Hashable Iterable Iterator List Literal Mapping MutableMapping MutableSequence MutableSet NoReturn Optional OrderedDict Reversible Self "
    "Sequence Set Sized SupportsFloat SupportsInt Text Tuple Type Union"
)
"""What of `typing` a program may name: it is for annotations, and none of it is a class."""


def type_variable(name: str, *bounds: object, **options: object) -> Hint:
    """`typing.TypeVar(name)`."""
    if type(name) is not str:
        raise TypeError("TypeVar() takes a text as its name")
    return Hint(name)


MODULES: Mapping[str, Mapping[str, object]] = {
    "math": MATH,
    "itertools": ITERTOOLS,
    "functools": {"partial": paying(partial), "reduce": paying(reduced, "reduce"), "cmp_to_key": paying(comparing, "cmp_to_key")},
    "collections": {
        "namedtuple": native(record, "namedtuple"),
        **{c.__name__: c for c in (Counter, OrderedDict, collections.defaultdict, deque)},
    },
    "enum": {c.__name__: c for c in (enum.Enum, enum.IntEnum, enum.Flag, enum.auto)},
    "typing": {**{name: Hint(name) for name in HINTS.split()}, "TypeVar": native(type_variable, "TypeVar"), "TYPE_CHECKING": False},
}
"""The harmless standard modules, by name."""


def initialise(budget: Budget, subject: object, *arguments: object, **keywords: object) -> None:
    """`C.__init__(subject, ...)` for a class C of Python below which the class of `subject` stands."""
    if not is_user_made(subject) or isinstance(subject, type):
        raise TypeError("__init__ is called for instances of classes of the program")
    ancestor = next(c for c in type(subject).__mro__ if MARK not in c.__dict__)
    check_exception(ancestor, arguments)
    note_attribute(budget, subject, "args") if isinstance(subject, BaseException) else note_container(budget, subject)
    ancestor.__init__(subject, *arguments, **keywords)  # type: ignore[misc]


METHODS: Mapping[type, Mapping[str, Callable[..., object]]] = {
    object: {"__init__": initialise},
    str: OF_TEXTS,
    bytes: {"decode": decode},
    Counter: {"elements": elements},
    range: {"index": index_in, "count": count_in},
}
"""Methods of Python's types that are ours: functions of the budget, the subject and the arguments."""


def method_of(subject: object, name: str, budget: Budget) -> object | None:
    """A method that is ours, bound to its subject; that of a class takes the subject first; None if it is Python's own."""
    class_ = subject if isinstance(subject, type) else type(subject)
    for ancestor in class_.__mro__:
        if MARK in ancestor.__dict__ and name in ancestor.__dict__:
            return None
        function = METHODS.get(ancestor, {}).get(name)
        if function is not None:
            return Bound(name, function, budget) if isinstance(subject, type) else Bound(name, function, budget, (subject,))
    return None


def name_of_class(class_: type) -> str:
    """`C.__name__`: sets are ours under Python's name."""
    return {Set: "set", FrozenSet: "frozenset"}.get(class_, class_.__name__)


GIVEN: Mapping[type, Mapping[str, Callable[[Any], object]]] = {
    PolygonalRegion: {"polygon": lambda region: region.plane_shape, "polygons": lambda region: region.plane_shape.together},
    PolylineRegion: {"lineString": lambda line: line.plane_shape},
    type: {"__name__": name_of_class},
}  # fmt: skip
"""Attributes whose value is not Python's."""


def attribute_of(subject: object, name: str, budget: Budget) -> object:
    """An attribute that a program may ask for (`allowed.may_ask`)."""
    kinds = type(subject).__mro__ if name in ("polygon", "polygons", "lineString") else (type(subject),)
    given = next((GIVEN[kind][name] for kind in kinds if name in GIVEN.get(kind, ())), None)
    if given is not None:
        return given(subject)
    ours = method_of(subject, name, budget)
    return getattr(subject, name) if ours is None else ours
