"""Files that a command writes: wrong paths are found before the work begins, and a file is written completely or not at all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ..interpreter.runtime.atomic_files import write_whole
from ..semantics.store.errors import UsageError

LINES = (".jsonl", ".ndjson", "")
"""The endings of files of JSON Lines."""
PICTURES = (".png", ".pdf", ".svg")
"""The endings of pictures."""


def check_place(path: str, read: Mapping[str, str | None]) -> None:
    """Raise `UsageError` unless `path` can be written; `read` are the files that the command reads, by what they are."""
    for what, other in read.items():
        if other is not None and same(path, other):
            raise UsageError(f"{path} is {what}")
    if not Path(path).parent.is_dir():
        raise UsageError(f"{path} cannot be written: there is no directory {Path(path).parent}")
    if Path(path).is_dir():
        raise UsageError(f"{path} cannot be written: it is a directory")


def check_ending(option: str, path: str, what: str, endings: Sequence[str]) -> None:
    """Raise `UsageError` unless the ending of `path` is known; devices and standard output (-) need none, except for a picture."""
    is_stream = path == "-" or (Path(path).exists() and not Path(path).is_file())
    if Path(path).suffix.lower() in endings or (is_stream and endings != PICTURES):
        return
    *others, last = (ending or "a name without an ending" for ending in endings)
    raise UsageError(f"{option} {path}: {what} are written as {', '.join(others)}{' or ' if others else ''}{last}")


def check_file(option: str, path: str | None, what: str, endings: Sequence[str]) -> None:
    """Check the path of a file that cannot go to standard output, if a path is given. Raises `UsageError`."""
    if path == "-":
        raise UsageError(f"{option} -: {what} are written to a file, not to standard output")
    if path is not None:
        check_ending(option, path, what, endings)


def same(path: str, other: str) -> bool:
    """Whether two paths lead to one file, which need not be there yet."""
    if Path(path).exists() and Path(other).exists():
        return Path(path).samefile(other)
    try:
        return Path(path).absolute() == Path(other).absolute()
    except FileNotFoundError:  # the current folder was deleted: nothing relative can be written there
        return path == other


def write(path: str, content: str | bytes) -> None:
    """Write a whole file, or leave what was there; a device or pipe is written to. Raises `UsageError`."""
    data = content.encode() if isinstance(content, str) else content
    try:
        write_whole(Path(path), data)
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror or error}") from None
