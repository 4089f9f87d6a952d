"""Reports of other processes about the error that ended their work, and the division of work among them."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from typing import NamedTuple

from ....semantics.store.errors import ScenicError

LARGEST_CHUNK = 16


class FailedDraw(NamedTuple):
    """A program's error that ended a run of scenes, with what its attempt had printed; can be sent between processes."""

    kind: type[ScenicError]
    attributes: dict[str, object]
    printed: tuple[str, ...]

    @property
    def error(self) -> ScenicError:
        """The error, rebuilt with its attributes."""
        found = self.kind.__new__(self.kind, self.attributes["message"])
        found.__dict__.update(self.attributes)
        return found


def record_failed_draw(error: ScenicError, printed: list[str]) -> FailedDraw:
    """The error as a record; attributes that cannot be sent are described in words."""
    attributes: dict[str, object] = {name: value if _can_be_sent(value) else RuntimeError(repr(value)) for name, value in vars(error).items()}
    return FailedDraw(type(error), attributes, tuple(printed))


def _can_be_sent(value: object) -> bool:
    try:
        pickle.loads(pickle.dumps(value))
    except Exception:  # whatever a foreign object does when it is pickled, it then cannot be sent
        return False
    return True


def parts(start: int, stop: int, count: int) -> Iterator[tuple[int, int]]:
    """A range in parts for about `count` processes, in order."""
    chunk = max(1, min(LARGEST_CHUNK, (stop - start) // (4 * count)))
    return ((begin, min(begin + chunk, stop)) for begin in range(start, stop, chunk))
