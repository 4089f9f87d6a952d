"""A lack of memory, by whichever name a library tells of it."""

from __future__ import annotations

from shapely.errors import ShapelyError

from ..syntax.nodes import NOWHERE, Span
from .errors import RunError

BAD_ALLOC = "std::bad_alloc"
"""The name of what C++ throws: all that GEOS, and pyarrow where it writes a file, pass on of it."""


def is_out_of_memory(error: BaseException) -> bool:
    """Return whether an exception says that there was no memory left."""
    of_library = isinstance(error, ShapelyError) or (isinstance(error, OSError) and error.errno is None)
    return isinstance(error, MemoryError) or (of_library and BAD_ALLOC in str(error))


def short_of_memory(span: Span = NOWHERE) -> RunError:
    """Return the error of a program for an operation that gets no memory."""
    return RunError("this operation needs more memory than there is", span)
