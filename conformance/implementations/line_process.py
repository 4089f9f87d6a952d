"""A process that answers in lines, of which nothing good is assumed: it may crash, hang, print garbage or fill its folder."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from queue import Empty, Full, Queue
from tempfile import TemporaryDirectory
from typing import IO, Literal

FaultKind = Literal["crashed", "timed out", "garbled"]

LONGEST_LINE = 64 << 20
"""Bytes of one answer."""
LARGEST_FOLDER = 1 << 30
"""Bytes that it may write to its folder, and to any one file."""
LARGEST_MEMORY = 8 << 30
"""Bytes of address space, where the system can hold a process to it."""
WAITING_LINES = 1000
KEPT_WORDS = 40
"""Lines of what it says on stderr."""
PATIENCE = 5.0
"""Seconds that a process which was killed may take to end."""
GUARD = "(while kill -0 $PPID; do sleep 1; done; kill -KILL 0) </dev/null >/dev/null 2>&1 &"
"""Ends the process group when this process is gone, however it ended."""
LOOK = 0.5
"""Seconds between two looks at its folder."""


class ImplementationFault(Exception):
    """The other side did not answer, or not in the words of the protocol: this says nothing about the language."""

    def __init__(self, kind: FaultKind, what: str) -> None:
        super().__init__(f"{kind}: {what}")
        self.kind = kind


class AnsweringProcess:
    """A process in a folder and a process group of its own; `ask` and `answer` are a line each."""

    def __init__(self, command: Sequence[str]) -> None:
        self.folder = TemporaryDirectory(prefix="scenic-ref-", ignore_cleanup_errors=True)
        self.lines: Queue[bytes | None] = Queue(WAITING_LINES)
        self.words: deque[str] = deque(maxlen=KEPT_WORDS)
        self.too_long = self.ended = False
        surroundings = {**os.environ, "TMPDIR": self.folder.name, "TMP": self.folder.name, "TEMP": self.folder.name, "PYTHONUNBUFFERED": "1"}
        try:
            self.child = subprocess.Popen(
                limit_command(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=self.folder.name, env=surroundings,
                start_new_session=True,
            )  # fmt: skip
        except OSError as error:
            self.folder.cleanup()
            raise ImplementationFault("crashed", f"{command[0]} could not be started: {error.strerror or error}") from error
        assert self.child.stdout is not None and self.child.stderr is not None
        in_background(self.read_lines, self.child.stdout)
        self.hearing = in_background(self.read_words, self.child.stderr)

    def read_lines(self, stream: IO[bytes]) -> None:
        """Each line of stdout, None behind the last."""
        with suppress(OSError), stream:
            while (line := stream.readline(LONGEST_LINE)) and not self.ended:
                self.too_long = len(line) >= LONGEST_LINE
                self.put(None if self.too_long else line)
                if self.too_long:
                    return
        self.put(None)

    def put(self, line: bytes | None) -> None:
        """Hand a line over, as soon as there is room; what comes after the end is nobody's."""
        while not self.ended:
            with suppress(Full):
                self.lines.put(line, timeout=LOOK)
                return

    def read_words(self, stream: IO[bytes]) -> None:
        """The last lines of stderr."""
        with suppress(OSError), stream:
            while line := stream.readline(4096):
                self.words.append(line.decode("utf-8", "replace").rstrip())

    def ask(self, line: str) -> None:
        """Write a line. If it reads no more, that shows when it does not answer."""
        assert self.child.stdin is not None
        in_background(write, self.child.stdin, line.encode() + b"\n")

    def answer(self, seconds: float) -> bytes:
        """Return the next line. Raises `ImplementationFault` if none comes in time, or none can come."""
        deadline = time.monotonic() + seconds
        while True:
            with suppress(Empty):
                line = self.lines.get(timeout=min(LOOK, max(0.0, deadline - time.monotonic())))
                if line is not None:
                    return line
                raise ImplementationFault("garbled", f"a line of more than {LONGEST_LINE >> 20} MiB") if self.too_long else self.crash()
            if folder_size(self.folder.name) > LARGEST_FOLDER:
                raise ImplementationFault("crashed", f"it wrote more than {LARGEST_FOLDER >> 30} GiB to its folder")
            if time.monotonic() >= deadline:
                raise ImplementationFault("timed out", f"no answer within {seconds:g} s")

    def crash(self) -> ImplementationFault:
        """How it ended, with its last words."""
        with suppress(subprocess.TimeoutExpired):
            self.child.wait(PATIENCE)
        self.hearing.join(PATIENCE)  # a process that it left behind may hold stderr for longer
        code = self.child.returncode
        how = "it closed its output" if code is None else f"signal {-code}" if code < 0 else f"exit code {code}"
        last = next((word for word in reversed(self.words) if word.strip()), "")
        return ImplementationFault("crashed", f"{how}: {last}" if last else how)

    def close(self) -> None:
        """End it with all that it started, and delete its folder. What it left its pipes to cannot hold this up."""
        self.ended = True
        kill(self.child)
        for pid in strays(self.folder.name):
            with suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        self.folder.cleanup()


def in_background(work: Callable[..., None], *arguments: object) -> threading.Thread:
    """A thread that does this, and that nobody waits for at the end."""
    thread = threading.Thread(target=work, args=arguments, daemon=True)
    thread.start()
    return thread


def write(stream: IO[bytes], line: bytes) -> None:
    """Write a line to one who may not read it."""
    with suppress(OSError, ValueError):  # ValueError: it was closed
        stream.write(line)
        stream.flush()


def limit_command(command: Sequence[str]) -> list[str]:
    """The command under limits of the size of its files and of its memory, and guarded, where there is a shell that does it."""
    if sys.platform == "win32":
        return [*command]
    limits = f"ulimit -c 0; ulimit -f {LARGEST_FOLDER >> 9}; ulimit -v {LARGEST_MEMORY >> 10}"
    return ["/bin/sh", "-c", f'{limits}; {GUARD} exec "$0" "$@"', *command]


def kill(child: subprocess.Popen[bytes]) -> None:
    """End a process and its group."""
    with suppress(OSError):
        if sys.platform == "win32":
            child.kill()
        else:
            os.killpg(child.pid, signal.SIGKILL)  # its group is there as long as one of it is
    with suppress(subprocess.TimeoutExpired):
        child.wait(PATIENCE)


def strays(folder: str) -> Iterator[int]:
    """Processes that were started from that folder's and left their group, where the system tells the surroundings of a process."""
    for place in Path("/proc").glob("[0-9]*/environ"):
        with suppress(OSError):
            if f"TMPDIR={folder}\0".encode() in place.read_bytes():
                yield int(place.parent.name)


def folder_size(folder: str) -> int:
    """Bytes in the files of a folder; what vanishes meanwhile counts nothing."""
    total = 0
    for at, _, names in os.walk(folder):
        for name in names:
            with suppress(OSError):
                total += Path(at, name).lstat().st_size
    return total
