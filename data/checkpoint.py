"""Saving a run between two time steps, to resume it later or more than once.

The state is a value, but for variables and containers, which are updated in place as in Python: a state from which a run went on is no longer
what it was. A saved state stays.
"""

from __future__ import annotations

import copyreg
import io
import pickle
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from ..interpreter.language.nesting import room
from ..semantics.machine.config import State
from ..semantics.machine.sandbox_table import MARK, is_user_class
from ..semantics.store.errors import UsageError


def of_property(found: property) -> tuple[object, ...]:
    """How a property that a class of the program has is made anew."""
    return property, (found.fget, found.fset, found.fdel)


class StatePickler(pickle.Pickler):
    """Pickles what a run of a program has: its Python classes and their properties among it."""

    dispatch_table: ClassVar[Mapping[type, Callable[..., tuple[object, ...]]]] = {**copyreg.dispatch_table, property: of_property}  # type: ignore[misc]

    def reducer_override(self, obj: object) -> Any:
        """A class of the program as its name and bases, and then, since its functions may know it, its members."""
        if not (is_user_class(obj) and type(obj) is type):
            return NotImplemented
        members = {name: member for name, member in vars(obj).items() if name not in OF_EVERY_CLASS}
        return empty_class, (obj.__name__, obj.__bases__), members, None, None, give_members


OF_EVERY_CLASS = frozenset({"__module__", "__dict__", "__weakref__", MARK})


def empty_class(name: str, bases: tuple[type, ...]) -> type:
    """A class of a program, before it has members."""
    return type(name, bases, {"__module__": "scenic", MARK: True})


def give_members(class_: type, members: Mapping[str, object]) -> None:
    """Let a class have its members."""
    for name, member in members.items():
        setattr(class_, name, member)


@room()
def save(state: State) -> bytes:
    """The state of a run, with what its coroutines still have to do, for the same version on the same machine.

    Raises `UsageError` for values of imported Python modules that cannot be saved.
    """
    try:
        with io.BytesIO() as written:
            StatePickler(written, protocol=pickle.HIGHEST_PROTOCOL).dump(state)
            return written.getvalue()
    except (pickle.PicklingError, TypeError, AttributeError) as problem:
        raise UsageError(f"this run cannot be saved: {problem}") from None


@room()
def resume(saved: bytes) -> State:
    """The state that was saved; `saved` can be used again. Only for what `save` gave: pickled data can run any code."""
    state = pickle.loads(saved)
    assert isinstance(state, State)
    return state
