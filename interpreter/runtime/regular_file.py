"""Files that a program names: they are read if they are ordinary ones, up to a size."""

from __future__ import annotations

import os
import stat
from pathlib import Path

SMALLEST_PIECE = 1 << 12
"""Bytes that are read at a time of a file that says it is empty."""


def read_regular_file(path: Path | str, largest: int) -> bytes:
    """Return what is in a file of at most so many bytes. Raises `OSError`, for a pipe, a device and a larger file as well, without waiting for it."""
    with open(path, "rb", opener=at_once) as file:
        found = os.fstat(file.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise OSError(0, "it is no ordinary file", str(path))
        piece = min(max(found.st_size, SMALLEST_PIECE), largest) + 1  # `read` takes memory for all that it is asked for
        data = file.read(piece)
        while len(data) <= largest and (more := file.read(piece)):  # it has grown, or does not say its size
            data += more
    if len(data) > largest:
        raise OSError(0, f"it is too large, at most {largest >> 20} MiB", str(path))
    return data


def at_once(path: str, flags: int) -> int:
    """Open a file without waiting for one who writes to a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def name_and_folder(path: Path | str) -> str:
    """The name of a file that there is not, and the folder that it was looked for in, from the root on."""
    name, folder = Path(path).name, Path(path).absolute().parent
    return f"{name} in {folder}" if folder.is_dir() else f"{name}, nor a folder {folder}"
