"""Keys of dictionaries and members of sets: what Python's hashing of them would take, which it does in one call that nothing interrupts."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Sequence
from typing import Any

from ..kernel.allowed import MARK, is_user_made, own_word
from ..kernel.budget import LARGEST_WORK, items_of
from ..kernel.errors import FuelExhausted, RunError
from ..kernel.nesting import check_written

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
