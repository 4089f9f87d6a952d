"""The second wall around an untrusted program: limits of the process, and a guard on what the process does while the program runs.

The first wall, `semantics.machine.sandbox_table`, lets a program meet nothing that could do harm; this one is for a hole in the first.
`resource` and timers of processor time exist on POSIX systems only; the guard exists everywhere. `docs/security.md` says what is promised.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from types import FrameType
from typing import ParamSpec, TypeVar

from ...semantics.store.errors import OutOfTime, RunError
from ...semantics.store.memory_errors import is_out_of_memory
from .limits import Limits
from .supervisor import IDLE, LIMITED, PAGE, due_in

try:
    import resource
except ImportError:  # a system without limits on processes
    resource = None



class RunDepth(threading.local):
    """How many runs of programs the thread is in: what another thread does meanwhile, no program of this one did."""

    depth = 0


RUNNING = RunDepth()


class Wall:
    """The limits in force in this process; there is one wall, since limits belong to processes."""

    def __init__(self) -> None:
        self.limits = Limits(None, None)
        self.guarded = False
        self.timing = ""
        self.tasks = 0
        self.hooked = False
        self.readable: tuple[str, ...] = ()
        self.before: tuple[int, int] | None = None

    def build(self, limits: Limits) -> None:
        """Put the limits and the guard into force, until `open`; does nothing if that is done, or in a thread (of a cluster's worker)."""
        if self.guarded or threading.current_thread() is not threading.main_thread():
            return
        self.limits, self.guarded = limits, True
        self.before = limit_memory(limits.memory)
        LIMITED[0] = self.before is not None
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
        LIMITED[0] = False

    @contextmanager
    def room(self, bytes: int) -> Iterator[None]:
        """Allow so many bytes more in the block, for a library that ends the process where it gets none: no program runs there.

        What the library says of a lack of memory is the program's error.
        """
        if not self.guarded or resource is None or self.before is None:
            yield
            return
        soft, hard = resource.getrlimit(resource.RLIMIT_AS)
        try:
            resource.setrlimit(resource.RLIMIT_AS, (at_most(soft + bytes, self.before), hard))
            yield
        except Exception as problem:
            if is_out_of_memory(problem):
                raise out_of_memory() from None
            raise
        finally:
            resource.setrlimit(resource.RLIMIT_AS, (soft, hard))

    def hear(self, event: str, arguments: tuple[object, ...]) -> None:
        """Hear what Python reports of itself, and refuse what a running program must not do. Raises `PermissionError`."""
        if not RUNNING.depth or not self.guarded or event in ORDINARY:
            return
        if event == "open":
            self.check_open(*arguments[:3])
        elif event in ("os.listdir", "os.scandir"):
            self.check_place(arguments[0])
        elif event.startswith(REFUSED):
            raise forbidden_action_error(event)

    def check_open(self, path: object, mode: object, flags: object) -> None:
        """Refuse to open a file for writing, or one that is not part of Python or of this package (which import modules when they need them)."""
        if (isinstance(mode, str) and set(mode) & set("wax+")) or (isinstance(flags, int) and flags & WRITING):
            raise forbidden_action_error(f"writing {path}")
        self.check_place(path)

    def check_place(self, path: object) -> None:
        """Refuse what is not part of Python or of this package."""
        if isinstance(path, (str, bytes)) and not str(Path(path.decode() if isinstance(path, bytes) else path).resolve()).startswith(self.readable):
            raise forbidden_action_error(f"reading {path!r}")


HERE = Path(__file__).parents[2]
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


def forbidden_action_error(what: str) -> PermissionError:
    """The error for something that a program must not do; it is our fault that it could try."""
    return PermissionError(f"a program that runs without --trust was kept from {what}; please report the program")


WALL = Wall()
P = ParamSpec("P")
R = TypeVar("R")
AGAIN = 1.0
"""Seconds after which a run that is out of time is interrupted again, in case library code caught the first exception."""


LEAST = 1.0
"""Seconds that parsing and writing may always take: some of it is the same for every program."""


def limit_time(what: str, least: float = LEAST) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Make a function one for which the clock of processor time begins anew, unless it runs already; `what` says in messages what takes the time.

    Whatever a program causes is in one: parsing, runs, the reading of its maps, and what is written of its scenes. However it ends, the clock is
    stopped. Python hears signals after calls, at the start of functions and where loops go back: there is none of these between what is changed
    and `try`, or between `finally` and what is restored; `contextmanager`, made of calls, would leave the clock behind.
    """

    def around(run: Callable[P, R]) -> Callable[P, R]:
        @wraps(run)
        def clocked(*arguments: P.args, **options: P.kwargs) -> R:
            seconds = WALL.limits.seconds
            if not WALL.guarded or WALL.timing or seconds is None or not hasattr(signal, "setitimer"):
                return run(*arguments, **options)
            seconds = max(seconds, least)
            WALL.tasks += 1
            due = due_in(seconds, WALL.tasks)
            try:
                WALL.timing = f"{what} took {seconds:g}"
                PAGE[:] = due
                signal.setitimer(signal.ITIMER_PROF, seconds, AGAIN)
                return run(*arguments, **options)
            except Exception as problem:
                if is_out_of_memory(problem):
                    raise out_of_memory() from None
                raise
            finally:
                PAGE[:] = IDLE
                WALL.timing = ""
                signal.setitimer(signal.ITIMER_PROF, 0)

        return clocked

    return around


def guard_run(run: Callable[P, R]) -> Callable[P, R]:
    """A run of the machine: the guard listens, its time is limited (`limit_time`), and the limit of memory is an error of the program."""

    @wraps(run)
    def guarded(*arguments: P.args, **options: P.kwargs) -> R:
        if not WALL.guarded:
            return run(*arguments, **options)
        before = RUNNING.depth
        try:
            RUNNING.depth = before + 1
            return run(*arguments, **options)
        except Exception as problem:
            if is_out_of_memory(problem):
                raise out_of_memory() from None
            raise
        finally:
            RUNNING.depth = before

    return limit_time("one run of the program", 0)(guarded)


def out_of_memory() -> RunError:
    """The error where the limit of memory is reached."""
    return RunError("the program needs more memory than it may have", hint="--limit-memory allows more")


def out_of_time(number: int, frame: FrameType | None) -> None:
    """The processor time is over. Raises `OutOfTime`."""
    if WALL.timing:
        raise OutOfTime(
            f"{WALL.timing} seconds of processor time without ending", hint="--limit-seconds allows more"
        )


def limit_memory(more: int | None) -> tuple[int, int] | None:
    """Limit how many more bytes this process may take, and give the limits from before; a stricter limit that it was given stays."""
    if resource is None or more is None:
        return None
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (at_most(used_address_space() + more, (soft, hard)), hard))
    return soft, hard


def at_most(wanted: int, limits: tuple[int, int]) -> int:
    """So many bytes, or the smallest of the limits if that is less."""
    assert resource is not None
    return min([wanted, *(limit for limit in limits if limit != resource.RLIM_INFINITY)])


def used_address_space() -> int:
    """The bytes of address space that this process has; 0 where the system does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError):
        return 0
    return pages * (resource.getpagesize() if resource is not None else 4096)
