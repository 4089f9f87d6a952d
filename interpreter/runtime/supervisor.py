"""The clock of an untrusted program, looked at from outside of its process: what no program, and no call of a library, can hold up.

`scenic-ref run` and its like work in a child of the process that was started. The child writes into a page that both have when it must be done
with what it does for the program (`walls.timed`); the parent looks there ten times a second, and ends a child that is late, or tells that it died.
A child's own clock is a signal, which Python hears between two of its instructions only.
"""

from __future__ import annotations

import mmap
import os
import signal
import struct
import sys
import threading
import time
from types import FrameType
from typing import NoReturn

LAYOUT = struct.Struct("=dddd")
IDLE = bytes(LAYOUT.size)
PAGE = mmap.mmap(-1, LAYOUT.size)
"""The processor time of the child when it is due, its limit in seconds, the longest time on the clock, and which of its tasks this is (0: none)."""
LIMITED = mmap.mmap(-1, 1)
"""1 while the memory of the child is limited, 0 while it is not."""
NO_MEMORY = 127
"""The exit code with which the dynamic linker ends a process that has no memory for the variables of a thread, or for a library. No code of ours."""
PATIENCE = 0.7
"""Seconds of processor time for which a child is waited that is due: its own clock comes first, and gives the better message."""
ON_THE_CLOCK = 10.0
"""A task may take so many times its processor time on the clock, and half a minute: other processes take theirs."""
LOOK = 0.1
HEARD = mmap.mmap(-1, 1)
"""How many interrupts the child has heard of, modulo 256."""
HEARING = 0.3
"""Seconds in which a child hears an interrupt that its whole group got; after that, it is sent one."""
TOLD_ON = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2")
DEADLY = ("SIGSEGV", "SIGBUS", "SIGABRT", "SIGILL", "SIGFPE")
SUPERVISED = ("run", "simulate", "trace", "check")
"""Commands that run programs of others."""


def due_in(seconds: float, number: float) -> bytes:
    """Return the content of the page while a task of the child may take some seconds of processor time from
    now on.
    """
    return LAYOUT.pack(time.process_time() + seconds, seconds, ON_THE_CLOCK * seconds + 30, number)


def supervise(arguments: list[str]) -> None:
    """Go on in a child, if the command runs programs of others and the system can do that; the parent ends as the child does."""
    wanted = arguments[:1] and arguments[0] in SUPERVISED and "--trust" not in arguments
    if not wanted or not hasattr(signal, "sigtimedwait") or not sys.platform.startswith("linux") or threading.active_count() > 1:
        return
    heard = {getattr(signal, name) for name in (*TOLD_ON, "SIGCHLD")}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, heard)
    parent = os.getpid()
    child = os.fork()
    if child:
        watch(child, heard)
    import ctypes  # here, where it is needed: `--help` answers at once

    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: a child whose parent is killed does not go on
    if os.getppid() != parent:
        os._exit(1)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, handle_interrupt)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)


def handle_interrupt(number: int, frame: FrameType | None) -> None:
    """Count the interrupt, so that it does not come twice, and raise `KeyboardInterrupt`."""
    HEARD[0] = (HEARD[0] + 1) % 256
    signal.default_int_handler(number, frame)


def watch(child: int, heard: set[signal.Signals]) -> None:
    """Wait for the child, tell it what signals come, and end it when it is late; never returns."""
    begun, told = ChildTask(), 0
    while True:
        found = signal.sigtimedwait(heard, LOOK)
        if found is not None and found.si_signo != signal.SIGCHLD:
            if found.si_signo == signal.SIGINT and has_heard_since(told):
                told = HEARD[0]
                continue
            if found.si_code <= 0:  # somebody sent it to this process; what a terminal sends, the child gets as well
                os.kill(child, found.si_signo)
            told = (told + (found.si_signo == signal.SIGINT)) % 256
            continue
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            leave(os.waitstatus_to_exitcode(status))
        reason = begun.late(child)
        if reason:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            end(f"error: what the program does took {reason}", "  = hint: --limit-seconds allows more", 1)


def has_heard_since(told: int) -> bool:
    """Return whether the child has heard of an interrupt that it was not sent from here, as where its whole group got one."""
    ended = time.monotonic() + HEARING
    while not (ahead := 0 < (HEARD[0] - told) % 256 < 128) and time.monotonic() < ended:
        time.sleep(LOOK / 10)
    return ahead


class ChildTask:
    """The current task of the child, and how long it has taken, as far as this process was not stopped
    itself.
    """

    def __init__(self) -> None:
        self.number = 0.0
        self.waited = 0.0
        self.looked = time.monotonic()

    def late(self, child: int) -> str:
        """How much too long the child takes; "" while it does not."""
        now = time.monotonic()
        passed, self.looked = min(now - self.looked, 10 * LOOK), now
        due, seconds, longest, number = LAYOUT.unpack(PAGE[:])
        if not number or number != self.number:
            self.number, self.waited = number, 0.0
            return ""
        self.waited += passed
        try:
            spent = time.clock_gettime((~child << 3) | 2)  # the processor time of another process
        except OSError:
            return ""
        if spent > due + PATIENCE:
            return f"more than {seconds:g} seconds of processor time without ending"
        return f"{self.waited:.0f} seconds on the clock without ending, at a limit of {seconds:g} of processor time" if self.waited > longest else ""


def leave(code: int) -> None:
    """End as the child ended; what a fault of ours, or of a library, caused is an internal error, and a lack of memory one of the program."""
    limited = LIMITED[0] == 1
    if code == NO_MEMORY and limited:
        end("program error: the program needs more memory than it may have", "  = hint: --limit-memory allows more", 1)
    name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    if name in DEADLY or code == NO_MEMORY:
        advice = "\n  hint: if it died for want of memory, --limit-memory allows more" if limited else ""
        fault = "  This is a fault of scenic-ref, not of your program. Please report it."
        end(f"internal error: the process that ran the program died ({name})", fault + advice, 4)
    if code >= 0:
        os._exit(code)
    signal.signal(-code, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, ())
    os.kill(os.getpid(), -code)
    os._exit(128 - code)


def end(message: str, more: str, code: int) -> NoReturn:
    """Say why the child ended, and end with an exit code."""
    print(f"{message}\n{more}", file=sys.stderr, flush=True)
    os._exit(code)
