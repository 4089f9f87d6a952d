"""Files that a command writes: wrong paths are found before the work begins, and a file is there whole or not at all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..semantics.errors import UsageError


def check_place(path: str, read: Mapping[str, str | None]) -> None:
    """Raise `UsageError` unless `path` can be written; `read` are the files that the command reads, by what they are."""
    for what, other in read.items():
        if other is not None and Path(path).exists() and Path(other).exists() and Path(path).samefile(other):
            raise UsageError(f"{path} is {what}")
    if not Path(path).parent.is_dir():
        raise UsageError(f"{path} cannot be written: there is no directory {Path(path).parent}")
    if Path(path).is_dir():
        raise UsageError(f"{path} cannot be written: it is a directory")


def write(path: str, content: str | bytes) -> None:
    """Write a whole file, or leave what was there. Raises `UsageError`."""
    part = Path(f"{path}.part")
    try:
        part.write_bytes(content.encode() if isinstance(content, str) else content)
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise UsageError(f"{path} cannot be written: {error.strerror or error}") from None
