"""Machine code that is kept between processes, so that a second one compiles nothing that a first one has.

What numba makes of a function is kept under a key of our own: the text that it was made from, the sources of all that it may call, the versions of
Python and of the compiler, and the processor. Files are written whole, so that two processes may write the same one. They hold code that is run: they
are kept, and read, only where nobody but the user can write.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import platform
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numba
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from ...interpreter.runtime.cache_folders import cache_folder, digest_of_code, forget, read_kept, write_kept

ENDING = ".code"
LARGEST = 1 << 26
MOST, MOST_BYTES = 512, 1 << 29
"""So many files are kept, and so many bytes; those that were not used for the longest time go first."""


def code_there() -> bytes:
    """All code that may be compiled, or built into what is, with the versions of Python and of the compiler; empty if it cannot be told."""
    versions = f"{sys.version} {platform.machine()} {numba.__version__} {version('llvmlite')}"
    return digest_of_code(("inference", "semantics", "interpreter"), versions)


CODE = code_there()
"""The code that runs: it is read when it is imported, since it may be changed later."""


def private_folder() -> Path | None:
    """The folder of kept code; None where there is none, or where somebody else could write."""
    above = cache_folder()
    if above is None:
        return None
    folder = above / "compiled"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        return folder if is_private(above) and is_private(folder) else None
    except OSError:
        return None


def is_private(folder: Path) -> bool:
    """Whether only the user can write in a folder."""
    if not hasattr(os, "getuid"):
        return True  # the user's own folders are, on Windows
    found = folder.lstat()
    return found.st_uid == os.getuid() and not found.st_mode & 0o022 and folder.is_dir()


class CodeCache:
    """The kept forms of one function, in place of numba's own cache. What cannot be read or written is compiled anew."""

    def __init__(self, text: bytes) -> None:
        self.text = text
        self.cache_path = ""

    def place(self, signature: object, codegen: Any) -> Path | None:
        """Return the path of the compiled form for arguments of some types; None if nothing can be kept."""
        folder = private_folder()
        if folder is None or not CODE:
            return None
        what = repr((signature, codegen.magic_tuple())).encode()
        return folder / f"{hashlib.blake2b(b' '.join((CODE, self.text, what)), digest_size=16).hexdigest()}{ENDING}"

    def load_overload(self, signature: object, target: Any) -> object | None:
        """The kept form for arguments of some types; None if there is none."""
        target.refresh()
        place = self.place(signature, target.codegen())
        data = None if place is None else read_kept(place, LARGEST)
        if place is None or data is None:
            return None
        own = place.name.encode()
        if data[: len(own)] != own:  # of another function, under this name
            return None
        try:
            os.utime(place)
            return CompileResult._rebuild(target, *pickle.loads(data[len(own) :]))
        except Exception:  # of whatever a file from elsewhere makes the compiler say
            return None

    def save_overload(self, signature: object, result: Any) -> None:
        """Keep a form, if that is possible."""
        place = self.place(signature, result.codegen)
        if place is None or result.library.has_dynamic_globals or any(not one.can_cache for one in result.lifted):
            return
        try:
            data = place.name.encode() + dumps(result._reduce())
        except Exception:  # whatever cannot be pickled is not kept
            return
        if code_there() == CODE and write_kept(place, data):
            forget(place.parent, ENDING, MOST, MOST_BYTES)

    def enable(self) -> None:
        """Do nothing; numba's interface of caches asks for the method."""

    disable = flush = enable


def keep_code(dispatcher: Any, text: str) -> Callable[..., Any]:
    """A function that numba compiles, whose forms are kept under its text."""
    dispatcher._cache = CodeCache(text.encode())
    return dispatcher
