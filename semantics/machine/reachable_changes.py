"""Whether a function of the program changed what existed before it was called, rather than what it made itself.

Something existed before the call, and can be changed by the function, if the function reaches it: by a variable of a scope around, an argument, an
attribute, an element. The first thing on such a path that the call changed is reached after the call as well, since all before it is as it
was; and nothing that the call made is reached without such a change. So it is enough to look after the call: did it change something that is
reached from where it began?
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

import gc
from collections import deque
from collections.abc import Collection, Iterable, Iterator
from functools import partial
from types import BuiltinFunctionType, MappingProxyType, MethodType
from typing import Any

from ..store.budget import ITEM, Budget, Metered, Place
from ..store.errors import RunError
from ..store.generators import Generator
from ..store.scenic_classes import ScenicClass
from ..store.scopes import Scope
from ..store.sets import FrozenSet, Set
from ..store.undo_log import Version, notes_since
from .sandbox_table import is_user_made
from .values import HOLDING, Bound, Dynamic, Function, Method, Module, Random

HOLDERS = (
    *HOLDING, Set, FrozenSet, deque, Random, Scope, Function, Method, Bound, Dynamic, Module, ScenicClass, Generator, Metered, Place,
    partial, property, staticmethod, classmethod, MethodType, BuiltinFunctionType, MappingProxyType,
    Iterator,
)  # fmt: skip
"""What may lead on to something that a program can change. Library objects are left out: a program cannot change what is in them."""


def changed_since(version: Version, local: Collection[int], door: object) -> list[object]:
    """Return what changed since the version, but for variables of scopes that were made since: `local` has the numbers (`id`) of their bindings."""
    changed = [note.subject for note in notes_since(version) if getattr(note, "subject", door) is not door]
    if any(type(subject) is Generator for subject in changed):  # it goes on in the scope in which it was made, perhaps before
        return changed
    return [subject for subject in changed if id(subject) not in local]


def is_reached(changed: Iterable[object], roots: Iterable[object], seen: dict[int, object], budget: Budget) -> bool:
    """Return whether one of the things that changed is reached from the roots or among those `seen` (by number), which grows."""
    numbers = {id(subject) for subject in changed}
    level: list[Any] = list(roots)
    if not numbers.isdisjoint(seen):
        return True
    while level:
        if any(id(one) in numbers for one in level):
            return True
        found = {id(one): one for one in level if id(one) not in seen}
        seen.update(found)
        budget.spend(ITEM * len(found))
        level = [part for one in found.values() if isinstance(one, HOLDERS) or is_user_made(one) for part in held_values(one)]
    return False


def lost_change(name: str) -> RunError:
    """Return the error where a function changes what existed before a call that is made with the values of one run."""
    return RunError(
        f"{name} changes something outside of it while library code calls it with values that a draw decides", rule="E-Call-Host",
        hint=f"let {name} only return a value: what is kept elsewhere would no longer be random",
    )


def held_values(value: Any) -> Iterator[object]:
    """Yield what a value holds directly, the dictionary of its attributes included."""
    if is_user_made(value) and not isinstance(value, type):
        yield getattr(value, "__dict__", None)
    yield from gc.get_referents(value)
