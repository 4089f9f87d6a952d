"""Files that are kept between processes."""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from .regular_file import read_regular_file

DIGEST = hashlib.blake2b().digest_size
"""Bytes at the beginning of a kept file that tell whether the others are as they were written."""
PART = ".part"
SKEW = 60.0
"""Seconds by which clocks differ; what was used later than that was used by a wrong clock, and goes first."""


def digest_of_code(folders: Sequence[str], versions: str) -> bytes:
    """A digest of the modules below some folders of the package, and of the versions of what they use; empty if it cannot be told."""
    package = Path(__file__).parents[2]
    found = hashlib.blake2b(versions.encode())
    try:
        sources = sorted(file for folder in folders for file in (package / folder).rglob("*.py") if not file.name.startswith("."))
        for file in sources:
            found.update(file.read_bytes())
    except OSError:
        return b""
    return found.digest() if sources else b""


def cache_place() -> Path:
    """The folder of this project in the user's cache directory, there or not. Raises `RuntimeError` where the user has no home."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local", "scenic-ref")
    chosen = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (chosen if chosen.is_absolute() else Path.home() / ".cache") / "scenic-ref"


def cache_folder() -> Path | None:
    """Return the folder for kept files, made if need be; None if nothing can be written."""
    try:
        folder = cache_place()
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):
        return None
    return folder if os.access(folder, os.W_OK) else None


def read_kept(place: Path, largest: int) -> memoryview | None:
    """Return what `write_kept` wrote; None if there is no such file, or a damaged one."""
    try:
        written = read_regular_file(place, largest)
    except OSError:
        return None
    data = memoryview(written)[DIGEST:]
    return data if written[:DIGEST] == hashlib.blake2b(data).digest() else None


def write_kept(place: Path, data: bytes | memoryview) -> bool:
    """Write a file whole, in place of what other processes may be reading or writing; return whether that was possible."""
    temporary = None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=place.parent, suffix=PART, delete=False) as file:
            temporary = file.name
            file.write(hashlib.blake2b(data).digest())
            file.write(data)
        os.replace(temporary, place)
        temporary = None
    except OSError:
        return False
    finally:
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)
    return True


def forget(folder: Path, ending: str, most: int, most_bytes: int) -> None:
    """Delete the files with an ending that were not used for longest, until no more is kept than is wanted."""
    found, size = list[tuple[float, int, str]](), 0
    for entry in os.scandir(folder):
        if entry.name.endswith((ending, PART)):
            with suppress(OSError):  # another process has deleted it
                known = entry.stat(follow_symlinks=False)
                used = known.st_mtime if known.st_mtime < time.time() + SKEW else 0.0
                found.append((used, known.st_size, entry.path))
    for number, (_, bytes_of_it, path) in enumerate(sorted(found, reverse=True)):
        if number < most and size + bytes_of_it <= most_bytes:
            size += bytes_of_it
            continue
        with suppress(OSError):
            os.unlink(path)
