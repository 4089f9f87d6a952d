"""What a call of library code costs and may not be given, whether the program makes it or library code itself (a key for `sorted`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..kernel.allowed import KEY, is_user_class, may_make, names, own_word
from ..kernel.budget import ITEM, LARGEST_SEQUENCE, Budget, length_of, refuse_too_large, refuse_too_long, size_of, whole
from ..kernel.containers import apart
from ..kernel.errors import RunError
from ..kernel.reachability import lost_change
from ..kernel.values import Bound, Function, Method, Special
from ..kernel.versions import changes_its_owner, note_call
from .keys import check_hashed
from .texts import check_encoding

HOLDERS: tuple[type[Any], ...] = (slice, staticmethod, classmethod, property, KEY)
"""Types whose values may not hold each other: Python frees such a chain by a recursion that it does not count, and dies of a long one."""
NAMING = (AttributeError, ImportError, NameError, OSError, SyntaxError)
"""Exceptions that hold more than their arguments."""


def check_arguments(function: object, arguments: Sequence[object], keywords: Mapping[str, object], budget: Budget) -> None:
    """Pay for what library code goes through, and refuse what it would make of a single number, a long range or a chain."""
    given = [*arguments, *keywords.values()]
    if function is not range and any(isinstance(a, range) and size_of(a) > ITEM * LARGEST_SEQUENCE for a in given):
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
        refuse_too_large(4 * length_of(first))
    if function in (str, bytes):
        for encoding in (*arguments[1:2], *(v for k, v in keywords.items() if k == "encoding")):
            check_encoding(encoding)


def check_exception(class_: type, arguments: Sequence[Any]) -> None:
    """Refuse a place outside of its text in an exception, whose text Python would make of the memory beside it. Raises `RunError`."""
    if not issubclass(class_, (UnicodeDecodeError, UnicodeEncodeError, UnicodeTranslateError)):
        return
    text, *places = (None, *arguments)[0 if issubclass(class_, UnicodeTranslateError) else 1 :][1:4] or (None,)
    if isinstance(text, (str, bytes)) and not all(isinstance(p, int) and 0 <= whole(p) <= length_of(text) for p in places):
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
    result = called(function, *arguments, **keywords)
    budget.spend(ITEM)
    budget.made(result)
    return result


def called(function: Callable[..., object], *arguments: Any, **keywords: Any) -> object:
    """`function(*arguments, **keywords)`; what orders elements gets lists among them as copies (`apart`)."""
    if any(function is one for one in ORDERING) or (own_word(function, "__name__") == "sort" and isinstance(own_word(function, "__self__"), list)):
        key = keywords.get("key")
        keywords["key"] = apart if key is None else lambda item: apart(key(item))
    return function(*arguments, **keywords)


ORDERING = (sorted, min, max, list.sort)
"""Functions that order the elements that they are given; `xs.sort` is another."""


def with_callbacks(arguments: Sequence[object], budget: Budget) -> list[object]:
    """Arguments among which there may be functions that will be called."""
    return [as_callback(a, budget) for a in arguments]


