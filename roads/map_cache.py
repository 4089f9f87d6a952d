"""The data derived from maps, in files that are kept between processes, since making it takes much longer
than reading it.

A file has numbers, texts, coordinates and shapes only (a digest and an .npz: nothing that could be run), is
named by all that it depends on, and appears whole or not at all. What cannot be read is made again; where
nothing can be written, nothing is kept.
"""

from __future__ import annotations

import hashlib
import io
import os
import struct
import sys
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from ..interpreter.runtime.cache_folders import cache_folder, digest_of_code, forget, read_kept, write_kept
from ..semantics.space.fields import Cell

Arrays: TypeAlias = Mapping[str, NDArray[Any]]
SMALLEST = 1 << 16
"""Bytes of a map from which on something is kept of it; smaller ones are read as quickly."""
MOST, MOST_BYTES = 64, 1 << 29
"""Files that are kept, two of each map, and their size; those that were not used for longest go first."""
FAULTS = (
    ValueError, LookupError, TypeError, AttributeError, EOFError, RuntimeError, MemoryError, zlib.error, zipfile.BadZipFile,
    shapely.errors.ShapelyError,
)  # fmt: skip
"""What comes of a file that is whole but was not written by this."""
ENDING = ".map"


def code_there() -> bytes:
    """All code that what is made of a map may depend on, and the libraries that calculate; empty if it cannot be told."""
    return digest_of_code(("roads", "semantics"), f"{sys.version} {np.__version__} {shapely.__version__} {shapely.geos_version_string}")


CODE = code_there()
"""The code that runs: it is read when it is imported, since it may be changed later."""


def map_cache_path(what: str, source: bytes, tolerance: float) -> Path | None:
    """The file that keeps `what` of a map; None if that is small, or nothing can be kept."""
    folder = cache_folder() if len(source) >= SMALLEST and CODE else None
    if folder is None:
        return None
    key = hashlib.blake2b(CODE + f"{what} {tolerance!r} ".encode() + source, digest_size=20)
    return folder / "maps" / f"{key.hexdigest()}{ENDING}"


def arrays_in(place: Path | None) -> Arrays | None:
    """Return the arrays that a file keeps; None if there is none, or if it is damaged."""
    if place is None:
        return None
    data = read_kept(place, MOST_BYTES)
    if data is None:
        return None
    with suppress(OSError):
        os.utime(place)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except FAULTS:
        return None


def keep(place: Path, arrays: Arrays) -> None:
    """Write a file, if that is possible and this is still the code that runs, in place of what other processes may be reading or writing."""
    if code_there() != CODE:
        return
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # none is named allow_pickle
    if write_kept(place, buffer.getbuffer()):
        forget(place.parent, ENDING, MOST, MOST_BYTES)


# Shapes


def pack_shapes(shapes: Sequence[BaseGeometry]) -> dict[str, NDArray[Any]]:
    """Pack shapes into arrays: their WKB bytes and sizes."""
    each = shapely.to_wkb(np.array(shapes, dtype=object))
    return {"shapes": np.frombuffer(b"".join(each), dtype=np.uint8), "sizes": np.array([len(one) for one in each], dtype=np.int64)}


def unpack_shapes(arrays: Arrays) -> NDArray[Any]:
    """The shapes that `pack_shapes` was given."""
    ends = np.cumsum(arrays["sizes"]).tolist()
    data = arrays["shapes"].tobytes()
    each = [data[start:end] for start, end in zip([0, *ends], ends, strict=False)]
    if not all(map(is_shallow, each)):
        raise ValueError("a shape holds another one of its own kind")
    return shapely.from_wkb(np.array(each, dtype=object))


POINT, LINE, POLYGON = 1, 2, 3
"""Kinds of shapes in WKB; that of several is greater by 3."""


def is_shallow(data: bytes) -> bool:
    """Whether a shape in WKB is a point, line or polygon, or consists of some: GEOS reads what is nested deeper by a recursion that has no end."""
    try:
        order, kind = struct.unpack_from("<bI", data)
        if order != 1 or kind in (POINT, LINE, POLYGON):
            return order == 1
        place = 9
        for _ in range(struct.unpack_from("<I", data, 5)[0]):
            inner = struct.unpack_from("<bI", data, place)
            if inner != (1, kind - 3) or kind - 3 not in (POINT, LINE, POLYGON):
                return False
            place = end_of(kind - 3, data, place + 5)
    except struct.error:
        return False
    return kind - 3 in (POINT, LINE, POLYGON)


def end_of(kind: int, data: bytes, place: int) -> int:
    """Return the end of the shape whose numbers begin at a place. Raises `struct.error` if there are none."""
    if kind == POINT:
        return place + 16
    lines, place = (struct.unpack_from("<I", data, place)[0], place + 4) if kind == POLYGON else (1, place)
    for _ in range(lines):
        place += 4 + 16 * struct.unpack_from("<I", data, place)[0]
    return place


# The direction of traffic


def load_cells(source: bytes, tolerance: float) -> list[Cell] | None:
    """The parts of the field of a map's `roadDirection`, if they were kept."""
    arrays = arrays_in(map_cache_path("direction", source, tolerance))
    if arrays is None:
        return None
    try:
        return list(zip(unpack_shapes(arrays), arrays["headings"].tolist(), strict=True))
    except FAULTS:
        return None


def keep_cells(source: bytes, tolerance: float, cells: Sequence[Cell]) -> None:
    """Keep the parts of the field for the next process."""
    place = map_cache_path("direction", source, tolerance)
    if place is not None:
        keep(place, {"headings": np.array([heading for _, heading in cells], dtype=float), **pack_shapes([polygon for polygon, _ in cells])})
