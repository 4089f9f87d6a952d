"""Files that appear under their names when they are complete: whoever looks finds the whole file, what was there before, or nothing.

On Linux the bytes go into a file without a name (`O_TMPFILE`), which vanishes with its process, however that ends. The complete file gets its name
by `linkat`; in place of an older one it gets the name `.NAME.PROCESS.unfinished` first, since only a rename replaces a file in one step.
Systems and file systems without nameless files have it under that other name from the beginning. It is removed when the block ends, or a signal
ends the process. Of a process that was killed meanwhile it is left, until the next one writes the file of that name (`remove_unfinished`).
"""

from __future__ import annotations

import os
import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path
from types import FrameType
from typing import IO

NAMELESS = getattr(os, "O_TMPFILE", 0)
"""The flag by which Linux opens a file without a name; 0 elsewhere."""
ENDING_SIGNALS = ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2")
"""Signals that end a process unless it handles them. Ctrl-C is an exception of Python's already."""


@contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """Open a file for writing that gets its name when the block ends. Raises `OSError`.

    An exception in the block leaves what was there before.
    """
    remove_unfinished(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.unfinished")
    file = nameless_file(path.parent)
    if file is None:
        with removed_at_end(unfinished), closed_at_end(new_file(unfinished)) as file:
            yield file
            file.close()
            unfinished.replace(path)
        return
    with closed_at_end(file):
        yield file
        file.flush()
        give_name(file, path, unfinished)


def nameless_file(folder: Path) -> IO[bytes] | None:
    """Open a file without a name, to which one in `folder` can be given; None where the system cannot do that, or not there."""
    if not NAMELESS:
        return None
    try:
        file = os.fdopen(os.open(folder, NAMELESS | os.O_RDWR, 0o666), "w+b")
    except OSError:  # the other way tells what is wrong, if it does not work either
        return None
    if Path(by_number(file)).exists():
        return file
    file.close()
    return None


def by_number(file: IO[bytes]) -> str:
    """Return the path under /proc by which Linux shows an open file of this process."""
    return f"/proc/self/fd/{file.fileno()}"


def give_name(file: IO[bytes], path: Path, unfinished: Path) -> None:
    """Give a file without a name the name `path`, in place of whatever has it. Raises `OSError`."""
    try:
        link(file, path)
    except FileExistsError:
        pass
    except OSError:  # some file systems have such files, and no names for them
        copy(file, path, unfinished)
        return
    else:
        return
    with removed_at_end(unfinished):
        unfinished.unlink(missing_ok=True)
        link(file, unfinished)
        unfinished.replace(path)


def link(file: IO[bytes], path: Path) -> None:
    """Give a file without a name a name that nothing has. Raises `OSError`."""
    folder = os.open(path.parent, os.O_PATH | os.O_DIRECTORY)
    try:
        # With a folder given for the source, Python calls `linkat`, which follows the link in /proc to the file; `link` would not
        os.link(by_number(file), path.name, src_dir_fd=folder, dst_dir_fd=folder)
    finally:
        os.close(folder)


def copy(file: IO[bytes], path: Path, unfinished: Path) -> None:
    """Copy a file without a name to `path`. Raises `OSError`."""
    with removed_at_end(unfinished):
        file.seek(0)
        with new_file(unfinished) as target:
            shutil.copyfileobj(file, target)
        unfinished.replace(path)


def new_file(path: Path) -> IO[bytes]:
    """Make a file, in place of one that a process of the same number left. Raises `OSError`."""
    path.unlink(missing_ok=True)
    return path.open("xb")


@contextmanager
def closed_at_end(file: IO[bytes]) -> Iterator[IO[bytes]]:
    """Close a file. What its buffer still holds is of no use then: that it cannot be written hides no earlier exception."""
    try:
        yield file
    finally:
        with suppress(OSError):
            file.close()


@contextmanager
def removed_at_end(path: Path) -> Iterator[None]:
    """Remove a file, if it is still there, when the block ends, or when a signal that nobody handles ends the process."""

    def end(number: int, frame: FrameType | None) -> None:
        with suppress(OSError):
            path.unlink()
        signal.signal(number, signal.SIG_DFL)
        signal.raise_signal(number)

    here = threading.current_thread() is threading.main_thread()  # handlers of signals can be set there only
    numbers = [getattr(signal, name) for name in ENDING_SIGNALS if here and hasattr(signal, name)]
    handled = [number for number in numbers if signal.getsignal(number) == signal.SIG_DFL]
    try:
        for number in handled:
            signal.signal(number, end)
        yield
    finally:
        with suppress(OSError):  # it has its own name by now, or was never made
            path.unlink()
        for number in handled:
            signal.signal(number, signal.SIG_DFL)


def write_whole(path: Path, data: bytes) -> None:
    """Write a file that appears when it is complete; a device or pipe is written to. Raises `OSError`."""
    if path.exists() and not path.is_file():
        with path.open("wb") as device:
            device.write(data)
        return
    with whole_file(path) as file:
        file.write(data)


# What killed processes left


def remove_unfinished(path: Path) -> None:
    """Remove what processes that were killed left of the file of that name: they had no time to do so themselves."""
    for left in path.parent.glob(f".{escape(path.name)}.*.unfinished"):
        number = left.name.removesuffix(".unfinished").rpartition(".")[2]
        if number.isdecimal() and not is_running(int(number)):
            with suppress(OSError):  # another process has removed it
                left.unlink()


def is_running(process: int) -> bool:
    """Whether there is a process of that number; it is said of every one where that cannot be asked without harm."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True
