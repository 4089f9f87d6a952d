"""The costs of calls of library code, and the arguments that they refuse: elements that are gone through,
keys that are hashed and compared.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..machine.reachable_changes import lost_change
from ..machine.sandbox_table import KEY, MARK, is_user_class, is_user_made, may_make, names, own_word
from ..machine.value_nesting import check_written
from ..machine.values import Bound, Function, Method, Special
from ..store.budget import (
    ITEM,
    LARGEST_SEQUENCE,
    LARGEST_WORK,
    Budget,
    as_whole_number,
    container_length,
    host_size,
    items_of,
    refuse_too_large,
    refuse_too_long,
)
from ..store.containers import copy_inner_lists
from ..store.errors import FuelExhausted, RunError
from ..store.undo_log import changes_its_owner, note_call
from .string_methods import check_encoding

CROWD = 4096
"""So many keys of one hash take no time worth speaking of."""
MODULUS = (1 << 61) - 1
"""Whole numbers that differ by a multiple of this have one hash."""
HASHING = (dict, set, frozenset)
HOLDING = (list, tuple, dict, set, frozenset, deque, type({}.keys()), type({}.values()), type({}.items()))
SPREAD = (str, bytes, bool, type(None))
"""Types whose values hardly ever have the same hash, whatever a program does."""
PROBE = 8
"""What it costs to find that a key is not the one that is there."""


def check_key(key: object) -> None:
    """Refuse a key that would take too long to hash. Raises `RunError`."""
    if isinstance(key, (tuple, frozenset)):
        check_written(key)


def check_keys(keys: Sequence[Any]) -> None:
    """Refuse keys that are hashed together if too many of them have the same hash, so that each is compared with all. Raises `RunError`."""
    kinds = set(map(type, keys))
    if kinds & {tuple, frozenset} or not kinds.isdisjoint(frozenset.__subclasses__()):
        for key in keys:
            check_key(key)
    if len(keys) <= CROWD or kinds.issubset(SPREAD) or (kinds == {int} and min(keys) > -MODULUS and max(keys) < MODULUS):
        return
    if PROBE * sum(crowd * crowd for crowd in crowds(keys)) > LARGEST_WORK:
        raise RunError("too many keys, or members of a set, have the same hash", rule="E-Call-Host")


def check_hashed(function: object, arguments: Sequence[object]) -> None:
    """Refuse arguments of a call that makes a dictionary or set of them, or looks for them in one, as `check_keys` does. Raises `RunError`."""
    owner = own_word(function, "__self__")
    if not (isinstance(function, type) and issubclass(function, HASHING)) and not isinstance(owner, HASHING) and not (
        isinstance(owner, type) and issubclass(owner, HASHING)
    ):
        return
    for argument in arguments:
        check_key(argument)
        if isinstance(argument, HOLDING):
            items = [*items_of(argument)]
            check_keys(items)
            if all(type(item) in (tuple, list) and len(item) == 2 for item in items):
                check_keys([item[0] for item in items])


def crowds(keys: Sequence[Any]) -> list[int]:
    """How many keys of each hash differ from the first that has it. Those with a hash of the program's own count as one crowd of a third as many."""
    first: dict[int, Any] = {}
    found: Counter[int] = Counter()
    own = 0
    for key in keys:
        if is_user_made(key) and any("__hash__" in c.__dict__ for c in type(key).__mro__ if MARK in c.__dict__):
            own += 1
            continue
        try:
            code = hash(key)
            if first.setdefault(code, key) is not key and first[code] != key:
                found[code] += 1
        except FuelExhausted:
            raise
        except Exception:  # it will be said where it is used as a key
            continue
    return [*found.values(), own // 3]


HOLDERS: tuple[type[Any], ...] = (slice, staticmethod, classmethod, property, KEY)
"""Types whose values may not hold each other: Python frees such a chain by a recursion that it does not count, and dies of a long one."""
NAMING = (AttributeError, ImportError, NameError, OSError, SyntaxError)
"""Exceptions that hold more than their arguments."""


def check_arguments(function: object, arguments: Sequence[object], keywords: Mapping[str, object], budget: Budget) -> None:
    """Pay for what library code goes through, and refuse what it would make of a single number, a long range or a chain."""
    given = [*arguments, *keywords.values()]
    if function is not range and any(isinstance(a, range) and host_size(a) > ITEM * LARGEST_SEQUENCE for a in given):
        raise RunError("a range with so many elements cannot be turned into a collection", rule="E-Call-Host")
    owner = own_word(function, "__self__")
    budget.go_through(given if owner is None or own_word(function, "__name__", "") in QUICK else [*given, owner])
    check_hashed(function, given)
    if isinstance(function, type):
        check_construction(function, arguments, keywords)
    if (isinstance(function, type) or type(function) is KEY or isinstance(owner, property)) and not is_user_class(function):
        check_chain(function, arguments, keywords)


QUICK = names("append appendleft pop popleft get add discard setdefault keys values items extend update")
"""Methods that do not go through what they belong to."""


def check_construction(function: type, arguments: Sequence[Any], keywords: Mapping[str, object]) -> None:
    """Refuse a class whose values the machine alone makes, and what a class of Python would make of one number or text."""
    if not may_make(function):
        raise RunError(f"a program cannot call {function.__name__}, the class of what the reference makes itself", rule="E-Call-Host")
    first = arguments[0] if arguments else None
    check_exception(function, arguments)
    if function is bytes and first is not None and hasattr(type(first), "__index__"):
        refuse_too_long(first)
    if function is int and isinstance(first, (str, bytes)):
        refuse_too_large(4 * container_length(first))
    if function in (str, bytes):
        for encoding in (*arguments[1:2], *(v for k, v in keywords.items() if k == "encoding")):
            check_encoding(encoding)


def check_exception(class_: type, arguments: Sequence[Any]) -> None:
    """Refuse a place outside of its text in an exception, whose text Python would make of the memory beside it. Raises `RunError`."""
    if not issubclass(class_, (UnicodeDecodeError, UnicodeEncodeError, UnicodeTranslateError)):
        return
    text, *places = (None, *arguments)[0 if issubclass(class_, UnicodeTranslateError) else 1 :][1:4] or (None,)
    if isinstance(text, (str, bytes)) and not all(isinstance(p, int) and 0 <= as_whole_number(p) <= container_length(text) for p in places):
        raise RunError(f"the start and the end in {class_.__name__} lie within its text", rule="E-Call-Host")


def is_holder(value: object) -> bool:
    """Whether a chain could go on with the value."""
    return isinstance(value, (*HOLDERS, BaseException))


def check_chain(function: object, arguments: Sequence[object], keywords: Mapping[str, object]) -> None:
    """Refuse a value that would hold another of its kind. Raises `RunError`."""
    if isinstance(function, type) and issubclass(function, NAMING):
        chained = any(map(is_holder, (*arguments[2:], *keywords.values())))
    else:
        holds = type(function) is KEY or not isinstance(function, type) or function in HOLDERS
        chained = holds and any(map(is_holder, (*arguments, *keywords.values())))
    if chained:
        name = own_word(function, "__name__", "this")
        raise RunError(f"{name} does not hold another of its kind", rule="E-Call-Host")


def as_callback(function: object, budget: Budget) -> object:
    """A function as library code may call it: one that is not the program's own pays as in a call by the program."""
    if not callable(function) or isinstance(function, (Function, Method, Special)) or is_user_class(function):
        return function
    return Bound("function", paid_call, budget, (function,))


def paid_call(budget: Budget, function: Callable[..., object], *arguments: object, **keywords: object) -> object:
    """`function(*arguments, **keywords)`, and the price of it paid."""
    check_arguments(function, arguments, keywords, budget)
    if budget.versions.given is not None and changes_its_owner(function):
        raise lost_change(function.__name__)
    note_call(budget, function, arguments)
    result = call_with_copies(function, *arguments, **keywords)
    budget.spend(ITEM)
    budget.made(result)
    return result


def call_with_copies(function: Callable[..., object], *arguments: Any, **keywords: Any) -> object:
    """`function(*arguments, **keywords)`; what orders elements gets lists among them as copies (`copy_inner_lists`)."""
    if any(function is one for one in ORDERING) or (own_word(function, "__name__") == "sort" and isinstance(own_word(function, "__self__"), list)):
        key = keywords.get("key")
        keywords["key"] = copy_inner_lists if key is None else lambda item: copy_inner_lists(key(item))
    return function(*arguments, **keywords)


ORDERING = (sorted, min, max, list.sort)
"""Functions that order the elements that they are given; `xs.sort` is another."""


def with_callbacks(arguments: Sequence[object], budget: Budget) -> list[object]:
    """Arguments among which there may be functions that will be called."""
    return [as_callback(a, budget) for a in arguments]

