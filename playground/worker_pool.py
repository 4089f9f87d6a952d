"""Processes that do one piece of work each, as the server sees them: they are started, heard, and ended whatever they do."""

from __future__ import annotations

import multiprocessing
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from typing import Any

from .request import PlayRequest
from .worker import MOST_BYTES, work

READY = f"{__package__}.forkserver_preload"
GRACE = 5.0
"""Seconds that a process which was killed may take to be gone."""


def process_context() -> BaseContext:
    """How processes are started: where the system can, from one that has loaded all that they need, which begins to do so now."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    from multiprocessing import forkserver

    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([READY])
    forkserver.ensure_running()
    return context


class WorkProcess:
    """A process that does a piece of work; `replaced` says that it was ended since another work took its place, `late` since its time was over."""

    def __init__(self, context: BaseContext, asked: PlayRequest) -> None:
        self.asked = asked
        self.replaced = False
        self.stopped = False
        self.late = False
        receiver, sender = context.Pipe(duplex=False)
        self.receiver: Connection = receiver  # type: ignore[assignment]
        self.sender: Connection = sender  # type: ignore[assignment]
        self.process: Any = context.Process(target=work, args=(asked, self.sender), daemon=True)  # type: ignore[attr-defined]

    def start(self) -> None:
        """Start the process, unless the work is not wanted any more."""
        if not self.stopped:
            self.process.start()
        self.sender.close()
        if self.stopped:
            self.stop()

    def receive(self) -> bytes:
        """The next message; empty if there is none. Blocks until then, or until the process is ended."""
        try:
            return self.receiver.recv_bytes(MOST_BYTES)
        except (EOFError, OSError):
            return b""

    def stop(self) -> None:
        """End the process now."""
        self.stopped = True
        with suppress(ValueError, AttributeError):  # it has not begun, or was closed
            if self.process.pid is not None:
                self.process.kill()

    def be_late(self) -> None:
        """The time for the work is over."""
        self.late = True
        self.stop()

    def wait(self) -> int | None:
        """The exit code of a process that has ended or was killed; negative: by that signal."""
        with suppress(AssertionError):  # it has not begun
            self.process.join(GRACE)
        code = self.process.exitcode
        self.receiver.close()
        return code
