"""Texts that processes of one machine hand over without a pipe: in files in memory, which have no names and leave nothing behind."""

from __future__ import annotations

import mmap
import os
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from types import TracebackType

OPEN_FILES = "/proc/{}/fd"
"""Where the system (Linux) shows the open files of a process to others of the same user."""


@dataclass(frozen=True, slots=True)
class LaidText:
    """A text of `size` bytes at the beginning of a file in memory, in one piece."""

    file: int
    size: int

    def __iter__(self) -> Iterator[memoryview]:
        if self.size:
            yield memoryview(mmap.mmap(self.file, self.size, access=mmap.ACCESS_READ))

    def send(self, target: int) -> None:
        """Write it to another file, without reading it into this process. Raises `OSError`."""
        sent = 0
        while sent < self.size:
            sent += os.sendfile(target, self.file, sent, self.size - sent)


class Shelf:
    """Files in memory, lent one after the other to processes that lay a text there, and read in that order.

    The system takes them back when this process ends, however it does.
    """

    def __init__(self) -> None:
        self.lent: deque[int] = deque()
        self.free: list[int] = []

    def __enter__(self) -> Shelf:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        while self.lent or self.free:
            os.close(self.lent.pop() if self.lent else self.free.pop())

    def lend(self) -> str | None:
        """The path of a file; None where the system has no such files."""
        if not hasattr(os, "memfd_create") or not os.path.isdir(OPEN_FILES.format("self")):
            return None
        self.lent.append(self.free.pop() if self.free else os.memfd_create("scenes"))
        return f"{OPEN_FILES.format(os.getpid())}/{self.lent[-1]}"

    def read(self, size: int) -> LaidText:
        """Return the text in the first of the lent files; it stands until the file is put back."""
        return LaidText(self.lent[0], size)

    def put_back(self) -> None:
        """The first of the files that are lent may be lent again."""
        if self.lent:
            self.free.append(self.lent.popleft())


def lay(path: str, texts: Iterable[bytes | memoryview]) -> int | None:
    """Lay texts into a lent file, one behind the other; how many bytes. None if it cannot be opened, when none was asked for."""
    try:
        file = os.open(path, os.O_WRONLY)
    except OSError:
        return None
    try:
        return sum(write_all_bytes(file, text) for text in texts)
    finally:
        os.close(file)


def write_all_bytes(file: int, text: bytes | memoryview) -> int:
    """Write all bytes to a file; how many."""
    rest = memoryview(text)
    while rest:
        rest = rest[os.write(file, rest) :]
    return len(text)


__all__ = ["LaidText", "Shelf", "lay"]
