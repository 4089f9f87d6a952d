"""Saving a run between two time steps, to resume it later or more than once.

The state is a value, but for variables and containers, which are updated in place as in Python: a state from which a run went on is no longer
what it was. A saved state stays.
"""

from __future__ import annotations

import copyreg
import io
import pickle

from ..interpreter.nesting import room
from ..semantics.kernel.config import State
from ..semantics.kernel.errors import UsageError


@room()
def save(state: State) -> bytes:
    """The state of a run, with what its coroutines still have to do, for the same version on the same machine.

    Raises `UsageError` for values of imported Python modules that cannot be saved.
    """
    try:
        with io.BytesIO() as written:
            pickler = pickle.Pickler(written, protocol=pickle.HIGHEST_PROTOCOL)
            pickler.dispatch_table = {**copyreg.dispatch_table, property: of_property}  # type: ignore[assignment]
            pickler.dump(state)
            return written.getvalue()
    except (pickle.PicklingError, TypeError, AttributeError) as problem:
        raise UsageError(f"this run cannot be saved: {problem}") from None


def of_property(found: property) -> tuple[object, ...]:
    """How a property that a class of the program has is made anew."""
    return property, (found.fget, found.fset, found.fdel)


@room()
def resume(saved: bytes) -> State:
    """The state that was saved; `saved` can be used again. Only for what `save` gave: pickled data can run any code."""
    state = pickle.loads(saved)
    assert isinstance(state, State)
    return state
