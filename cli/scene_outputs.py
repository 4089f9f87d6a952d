"""Destinations of scenes: a file of JSON Lines that survives interruption, a pipe, a table in a file, a
terminal.
"""

from __future__ import annotations

import errno
import json
import math
import os
import stat
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple

from ..sampling.scene_sampler import DrawnScene
from .session import console, escape_controls

if TYPE_CHECKING:
    from rich.table import Table

    from ..sampling.batch_sampler import Portion


try:
    import fcntl
except ImportError:  # not on this system
    fcntl = None

import numpy as np

from ..data.scene import SCHEMA
from ..data.simulation import SCHEMA as SIMULATION_SCHEMA
from ..data.table_files import SUFFIXES
from ..inference.batch.jobs.memory_files import LaidText
from ..inference.batch.jobs.worker_pools import delay_interrupts
from ..semantics.store.errors import UsageError

if TYPE_CHECKING:
    from ..sampling.batch_sampler import Form, Portion

BINARY = getattr(os, "O_BINARY", 0)
AT_ONCE, PIPED_AT_ONCE = 1 << 20, 1 << 16
"""Bytes of whole lines that are written at a time, which Ctrl-C waits for: into a file, and as much as a pipe holds."""
NEWLINE = ord("\n")
CANNOT_SEND = (errno.EINVAL, errno.ENOSYS)
"""What the system answers if it does not copy from file to file there."""
KNOWN = 32
"""For how many scenes of a resumed file the attempts are kept, for a picture of them."""


class Kind(NamedTuple):
    """The kind of a file's lines: their schema, the key of their number, and a word for one of them."""

    schema: str
    number: str
    word: str


SCENES = Kind(SCHEMA, "scene", "scene")
SIMULATIONS = Kind(SIMULATION_SCHEMA, "run", "simulation")


@dataclass(frozen=True)
class Earlier:
    """A scene or simulation that a resumed file holds already."""

    index: int
    attempts: int
    line: str


@dataclass(frozen=True)
class Resumed:
    """The contents of a resumed file: the number of scenes, the (index, attempts) of the first ones, and the
    last.
    """

    count: int = 0
    first: tuple[tuple[int, int], ...] = ()
    last: Earlier | None = None


class Output(ABC):
    """A place for scenes. Used in a `with`: leaving it without `finish` leaves nothing half-written."""

    @property
    def form(self) -> Form:
        """The form in which many scenes at a time are taken."""
        return "lines"

    written = 0
    """How many scenes are where they go; of a table none before it is complete."""

    def __enter__(self) -> Output:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def earlier(self, seed: int) -> Resumed:
        """The scenes of `seed` that the file holds already. Raises `UsageError` for anything else in it."""
        raise UsageError("only a file of JSON Lines can be resumed")

    @abstractmethod
    def write(self, drawn: DrawnScene) -> None:
        """Add a scene. Raises `UsageError` if there is no room."""

    @abstractmethod
    def write_many(self, portion: Portion) -> None:
        """Add scenes, in the form that this output wants. Raises `UsageError` if there is no room."""

    def finish(self) -> None:  # noqa: B027 (most outputs have nothing to do)
        """All scenes were written."""

    def close(self) -> None:  # noqa: B027
        """No more scenes come, finished or not."""


class LineByLine(Output):
    """JSON Lines, each written whole as soon as its scene is drawn; Ctrl-C comes before or after it."""

    at_once = AT_ONCE

    def write(self, drawn: DrawnScene) -> None:
        self._write(f"{drawn.line}\n".encode())

    def write_many(self, portion: Portion) -> None:
        for data in in_pieces(portion.lines, self.at_once):
            self._write(data)

    def _write(self, data: bytes | memoryview) -> None:
        with delay_interrupts():
            self.put(data)
            self.written += int(np.count_nonzero(np.frombuffer(data, np.uint8) == NEWLINE))

    @abstractmethod
    def put(self, data: bytes | memoryview) -> None:
        """Write whole lines. Raises `UsageError` if there is no room."""


class LinesFile(LineByLine):
    """A file of JSON Lines, written in place."""

    def __init__(self, path: str, *, resume: bool, kind: Kind = SCENES) -> None:
        self.path = path
        self.kind = kind
        self.size = 0
        try:
            self.file = os.open(path, (os.O_RDWR if resume else os.O_WRONLY) | os.O_CREAT | BINARY, 0o666)
        except OSError as error:
            raise UsageError(f"{path} cannot be written: {error.strerror or error}") from None
        self.is_regular = stat.S_ISREG(os.fstat(self.file).st_mode)
        if resume and not self.is_regular:
            os.close(self.file)
            raise UsageError(f"{path} cannot be resumed: it is not an ordinary file")
        if self.is_regular and not lock_file(self.file):
            os.close(self.file)
            raise UsageError(f"{path} is being written by another process", hint="wait until that has ended, or write to another file")
        if not resume:
            self.cut()

    def earlier(self, seed: int) -> Resumed:
        """The whole lines of the file, read one by one; a torn last line is cut off."""
        count, first, last = 0, [], None
        with open(self.path, "rb") as file:
            for line in file:
                if not line.endswith(b"\n"):
                    self._check_torn(count, line)
                    break
                last = self._earlier(count, line[:-1], seed)
                count += 1
                self.size += len(line)
                if len(first) < KNOWN:
                    first.append((last.index, last.attempts))
        self.cut()
        return Resumed(count, tuple(first), last)

    def _check_torn(self, number: int, data: bytes) -> None:
        """Refuse to cut off what is no part of a line of ours. Raises `UsageError`."""
        wanted, _, word = self.kind
        begins = f'{{"schema": "{wanted}"'.encode()
        if not (begins.startswith(data) or data.startswith(begins)):
            raise UsageError(f"{self.path} cannot be resumed: its line {number + 1} is not a {word}")

    def _earlier(self, number: int, data: bytes, seed: int) -> Earlier:
        wanted, key, word = self.kind
        try:
            line = data.decode("utf-8")
            found = json.loads(line)
            schema, its_seed, index, attempts = (found[name] for name in ("schema", "seed", key, "attempts"))
        except (ValueError, KeyError, TypeError, RecursionError):
            raise UsageError(f"{self.path} cannot be resumed: its line {number + 1} is not a {word}") from None
        if schema != wanted or type(attempts) is not int or attempts < 1:
            raise UsageError(f"{self.path} cannot be resumed: its line {number + 1} is not a {word} of {wanted}")
        if its_seed != seed:
            raise UsageError(f"{self.path} cannot be resumed: it holds {word}s of seed {its_seed}, not {seed}", hint=f"give --seed {its_seed}")
        if index != number:
            raise UsageError(f"{self.path} cannot be resumed: its line {number + 1} is {word} {index}, not {number}")
        return Earlier(index, attempts, line)

    def write_many(self, portion: Portion) -> None:
        """Whole lines; where they lie in a file, the system copies them."""
        if not (isinstance(portion.lines, LaidText) and self.is_regular and self._sent(portion.lines, len(portion.attempts))):
            super().write_many(portion)

    def _sent(self, laid: LaidText, lines: int) -> bool:
        with delay_interrupts():
            try:
                laid.send(self.file)
            except OSError as error:
                self.cut()
                if error.errno in CANNOT_SEND:
                    return False
                raise self.unwritable(error) from None
            self.size += laid.size
            self.written += lines
        return True

    def put(self, data: bytes | memoryview) -> None:
        """In full or not at all."""
        try:
            write_all(self.file, data)
        except BrokenPipeError:
            raise
        except OSError as error:
            self.cut()
            raise self.unwritable(error) from None
        self.size += len(data)

    def unwritable(self, error: OSError) -> UsageError:
        """The error that says why the file cannot be written."""
        return UsageError(f"{self.path} cannot be written: {error.strerror or error}", hint=f"{self.path} holds whole lines only")

    def cut(self) -> None:
        """Cut off whatever follows the last whole line."""
        if self.is_regular:
            os.ftruncate(self.file, self.size)
            os.lseek(self.file, self.size, os.SEEK_SET)

    def close(self) -> None:
        os.close(self.file)


class Pipe(LineByLine):
    """Standard output, as JSON Lines."""

    at_once = PIPED_AT_ONCE

    def put(self, data: bytes | memoryview) -> None:
        """Write data to standard output at once. Raises `UsageError` if it cannot be written."""
        try:
            write_all(sys.stdout.fileno(), data)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise UsageError(f"standard output cannot be written: {error.strerror or error}") from None


class ArrowPipe(Output):
    """Standard output, as a stream of Arrow."""

    def __init__(self) -> None:
        from ..data.table_files import ArrowStream

        if sys.stdout.isatty():
            raise UsageError("a stream of Arrow is not shown on a terminal", hint="write it to a file or a pipe")
        self.stream = ArrowStream(sys.stdout.buffer)

    @property
    def form(self) -> Form:
        return "table"

    def write(self, drawn: DrawnScene) -> None:
        """The objects of a scene, soon."""
        self._sent(self.stream.add, json.loads(drawn.line), scenes=1)

    def write_many(self, portion: Portion) -> None:
        """The objects of all scenes, soon."""
        if portion.columns is not None:
            self._sent(self.stream.add_columns, portion.columns, scenes=len(portion.attempts))

    def finish(self) -> None:
        """Write the remaining rows and end the stream."""
        self._sent(self.stream.finish)

    def _sent(self, send: Callable[..., None], *what: object, scenes: int = 0) -> None:
        with delay_interrupts():
            try:
                send(*what)
                sys.stdout.buffer.flush()
                self.written += scenes
            except BrokenPipeError:
                raise
            except OSError as error:
                raise UsageError(f"standard output cannot be written: {error.strerror or error}") from None


class TableOutput(Output):
    """A table in a file, which appears only when it is complete."""

    def __init__(self, path: str) -> None:
        from ..data.table_files import open_table

        self.table = open_table(Path(path))

    @property
    def form(self) -> Form:
        return "table"

    def write(self, drawn: DrawnScene) -> None:
        """One row per object."""
        self.table.add(json.loads(drawn.line))

    def write_many(self, portion: Portion) -> None:
        """The rows of the objects of all scenes."""
        if portion.columns is not None:
            self.table.add_columns(portion.columns)

    def finish(self) -> None:
        """Give the table its name."""
        self.table.finish()

    def close(self) -> None:
        """Remove an unfinished table."""
        self.table.close()


def lock_file(file: int) -> bool:
    """Whether this process, and no other, may write the file from now on; the system takes the lock back when the process ends, however it does.

    Where there are no such locks (Windows, some network drives) everyone may.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def in_pieces(lines: Iterable[bytes | memoryview], at_once: int) -> Iterator[memoryview]:
    """Lines with their ends, as many at a time as so many bytes hold, or one that is longer."""
    for several in lines:
        rest = memoryview(several)
        while rest:
            size = whole_lines(rest, at_once)
            yield rest[:size]
            rest = rest[size:]


def whole_lines(text: memoryview, at_once: int) -> int:
    """How many bytes are written at a time: of whole lines, as many as there is room for, or of the first one."""
    most = at_once
    while not (end := bytes(text[:most]).rfind(b"\n") + 1) and most < len(text):
        most *= 2
    return end or len(text)


def write_all(file: int, data: bytes | memoryview) -> None:
    """Write all bytes to a file descriptor."""
    view = memoryview(data)
    while view:
        view = view[os.write(file, view) :]


STREAMS = ("jsonl", "arrow")
"""The formats of standard output."""


def prepare_output(path: str | None, stream: str = "jsonl") -> None:
    """Load the library that writes the output, before the memory of the process is limited."""
    if stream == "arrow" or (path is not None and path.lower().endswith((".parquet", ".arrow"))):
        from ..data.table_files import prepare_arrow

        prepare_arrow()


def open_output(path: str | None, *, resume: bool, stream: str = "jsonl", kind: Kind = SCENES) -> Output:
    """The output that the command line asks for; `stream` is the format of standard output. Raises `UsageError` if it cannot be written."""
    if stream not in STREAMS:
        raise UsageError(f"there is no format {stream}", hint=f"the formats of standard output are {' and '.join(STREAMS)}")
    if stream == "arrow":
        if path is not None and path != "-":
            raise UsageError("--format is about standard output; the format of a file is told by its ending", hint="write -o PATH.arrow, or -o -")
        return ArrowPipe()
    if path is None and sys.stdout.isatty():
        return Terminal()
    if path is None or path == "-":
        return Pipe()
    if path.lower().endswith(SUFFIXES):
        if resume:
            raise UsageError("a table cannot be resumed, since it appears only when it is complete", hint="write JSON Lines: -o PATH.jsonl")
        return TableOutput(path)
    return LinesFile(path, resume=resume, kind=kind)


MOST_SHOWN = 5


class Terminal(Output):
    """The objects of the first scenes, shown when all are drawn."""

    def __init__(self) -> None:
        self.scenes: list[dict[str, Any]] = []
        self.more = 0

    def write(self, drawn: DrawnScene) -> None:
        """Keep the scene if it is to be shown."""
        self._keep([drawn.line])

    def write_many(self, portion: Portion) -> None:
        """Keep the scenes that are to be shown."""
        self._keep(b"".join(map(bytes, portion.lines)).splitlines())

    def _keep(self, lines: Sequence[str | bytes]) -> None:
        room = MOST_SHOWN - len(self.scenes)
        self.scenes += map(json.loads, lines[:room])
        self.more += len(lines[room:])
        self.written += len(lines)

    def close(self) -> None:
        """Show the scenes that were drawn."""
        shown_on = console(sys.stdout)
        for scene in self.scenes:
            shown_on.print(table_of(scene))
        if self.more:
            shown_on.print(f"... and {self.more:,} more; -o PATH writes all of them", style="dim")


def table_of(scene: dict[str, Any]) -> Table:
    """The objects of a scene in the scene format."""
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    params = ", ".join(f"{name} = {format_parameter(value)}" for name, value in scene["params"].items())
    title = f"seed {scene['seed']}, scene {scene['scene']} (metres, degrees)"
    table = Table(
        title=title, title_justify="left", title_style="bold", caption=escape(escape_controls(params)) or None, caption_justify="left",
        caption_style="dim",
        box=SIMPLE_HEAD,
    )
    for name in ("", "name", "class"):
        table.add_column(name)
    for name in ("x", "y", "heading", "width", "length"):
        table.add_column(name, justify="right", no_wrap=True)
    for o in scene["objects"]:
        x, y = o["position"]
        numbers = (f"{x:.2f}", f"{y:.2f}", f"{math.degrees(o['heading']):.1f}", f"{o['width']:.2f}", f"{o['length']:.2f}")
        named = (escape(escape_controls(o["name"] or "")), escape(escape_controls(o["class"])))
        table.add_row(str(o["id"]), *named, *numbers, style="bold" if o["id"] == scene["ego"] else None)
    return table


def format_parameter(value: object) -> str:
    """Return a short text for the value of a parameter."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict) and set(value) == {"repr"}:
        return str(value["repr"])
    return str(value)

