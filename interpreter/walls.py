"""The second wall around an untrusted program: limits of the process, and a guard on what the process does while the program runs.

The first wall, `semantics.kernel.allowed`, lets a program meet nothing that could do harm; this one is for a hole in the first.
`resource` and timers of processor time exist on POSIX systems only; the guard exists everywhere. `docs/security.md` says what is promised.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from types import FrameType
from typing import ParamSpec, TypeVar

from ..semantics.kernel.errors import FuelExhausted, RunError
from .limits import Limits

try:
    import resource
except ImportError:  # a system without limits on processes
    resource = None

class Wall:
    """What is in force in this process, and whether a program is running; there is one wall, since limits belong to processes."""

    def __init__(self) -> None:
        self.limits = Limits(None, None)
        self.guarded = False
        self.running = 0
        self.hooked = False
        self.readable: tuple[str, ...] = ()
        self.before: tuple[int, int] | None = None

    def build(self, limits: Limits) -> None:
        """Put the limits and the guard into force, until `open`; does nothing if that is done, or in a thread (of a cluster's worker)."""
        if self.guarded or threading.current_thread() is not threading.main_thread():
            return
        self.limits, self.guarded = limits, True
        self.before = limit_memory(limits.memory)
        if limits.seconds is not None and hasattr(signal, "setitimer"):
            signal.signal(signal.SIGPROF, out_of_time)
        if not self.hooked:
            self.readable = tuple({str(Path(p).resolve()) for p in (sys.prefix, sys.base_prefix, sys.exec_prefix, str(HERE), *sys.path) if p})
            sys.addaudithook(self.hear)
            self.hooked = True

    def open(self) -> None:
        """Lift what was put into force."""
        self.guarded, self.limits = False, Limits(None, None)
        if resource is not None and self.before is not None:
            resource.setrlimit(resource.RLIMIT_AS, self.before)

    def hear(self, event: str, arguments: tuple[object, ...]) -> None:
        """Hear what Python reports of itself, and refuse what a running program must not do. Raises `PermissionError`."""
        if not self.running or not self.guarded or event in ORDINARY:
            return
        if event == "open":
            self.check_open(*arguments[:3])
        elif event in ("os.listdir", "os.scandir"):
            self.check_place(arguments[0])
        elif event.startswith(REFUSED):
            raise refused(event)

    def check_open(self, path: object, mode: object, flags: object) -> None:
        """Refuse to open a file for writing, or one that is not part of Python or of this package (which import modules when they need them)."""
        if (isinstance(mode, str) and set(mode) & set("wax+")) or (isinstance(flags, int) and flags & WRITING):
            raise refused(f"writing {path}")
        self.check_place(path)

    def check_place(self, path: object) -> None:
        """Refuse what is not part of Python or of this package."""
        if isinstance(path, (str, bytes)) and not str(Path(path.decode() if isinstance(path, bytes) else path).resolve()).startswith(self.readable):
            raise refused(f"reading {path!r}")


HERE = Path(__file__).parent.parent
ORDINARY = frozenset({
    "object.__getattr__", "object.__setattr__", "object.__delattr__", "builtins.id", "sys._getframe", "compile", "exec", "import", "marshal.loads",
})  # fmt: skip
"""Events that say nothing, and are frequent."""
REFUSED = (
    "os.", "subprocess.", "socket.", "ctypes.", "shutil.", "tempfile.", "pty.", "webbrowser.", "mmap.", "sqlite3.", "winreg.", "_winapi.",
    "msvcrt.", "ftplib.", "http.", "urllib.", "smtplib.", "poplib.", "imaplib.", "fcntl.", "pathlib.", "glob.", "signal.", "syslog.", "resource.",
    "code.__new__", "function.__new__", "sys.addaudithook", "sys.settrace", "sys.setprofile", "cpython.run_", "pickle.find_class", "builtins.input",
)  # fmt: skip
"""The beginnings of events that a running program must not cause."""
WRITING = 0x1 | 0x2 | 0x40 | 0x100 | 0x200 | 0x400
"""O_WRONLY, O_RDWR, and the flags by which files are made, cut off or added to, of all systems."""


def refused(what: str) -> PermissionError:
    """The error for something that a program must not do; it is our fault that it could try."""
    return PermissionError(f"a program that runs without --trust was kept from {what}; please report the program")


WALL = Wall()
P = ParamSpec("P")
R = TypeVar("R")
AGAIN = 1.0
"""Seconds after which a run that is out of time is interrupted again, in case library code caught the first exception."""


def within(run: Callable[P, R]) -> Callable[P, R]:
    """A run of the machine: the guard listens, the clock of processor time begins anew, and the limit of memory is an error of the program.

    However it ends, the guard is as before. Python hears signals after calls, at the start of functions and where loops go back: there is none of
    these between what is changed and `try`, or between `finally` and what is restored; `contextmanager`, made of calls, would leave the guard behind.
    """

    @wraps(run)
    def guarded(*arguments: P.args, **options: P.kwargs) -> R:
        if not WALL.guarded:
            return run(*arguments, **options)
        before = WALL.running
        timed = WALL.limits.seconds is not None and hasattr(signal, "setitimer") and not before
        try:
            WALL.running = before + 1
            if timed:
                signal.setitimer(signal.ITIMER_PROF, WALL.limits.seconds or 0, AGAIN)
            return run(*arguments, **options)
        except MemoryError:
            raise RunError("the program needs more memory than it may have", hint="--limit-memory allows more") from None
        finally:
            WALL.running = before
            if timed:
                signal.setitimer(signal.ITIMER_PROF, 0)

    return guarded


def out_of_time(number: int, frame: FrameType | None) -> None:
    """The processor time of a run is over. Raises `FuelExhausted`."""
    if WALL.running:
        raise FuelExhausted(
            f"one run of the program took {WALL.limits.seconds:g} seconds of processor time without ending", hint="--limit-seconds allows more"
        )


def limit_memory(more: int | None) -> tuple[int, int] | None:
    """Limit how many more bytes this process may take, and give the limits from before; a stricter limit that it was given stays."""
    if resource is None or more is None:
        return None
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = taken() + more
    for limit in (soft, hard):
        wanted = wanted if limit == resource.RLIM_INFINITY else min(wanted, limit)
    resource.setrlimit(resource.RLIMIT_AS, (wanted, hard))
    return soft, hard


def taken() -> int:
    """The bytes of address space that this process has; 0 where the system does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError):
        return 0
    return pages * (resource.getpagesize() if resource is not None else 4096)
