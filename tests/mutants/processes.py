"""Work in processes of its own: forked from one that has the libraries loaded, with limits on processor time and memory."""

from __future__ import annotations

import faulthandler
import json
import os
import resource
import selectors
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

MEMORY = 4 << 30
"""Bytes of address space that a process may have."""
IDLE = 900
"""Seconds after which a process is ended that is silent, and so waits for something that does not come."""

Tell = Callable[..., None]
"""Tells the parent: the fields of a JSON object."""
Work = Callable[[Any, Tell], None]
"""What a process does with its task."""


@dataclass(slots=True)
class Child:
    """A process at work: what it told, one JSON object a line."""

    task: object
    number: int
    pipe: int
    text: bytes = b""
    heard: float = field(default_factory=time.monotonic)

    def told(self) -> list[dict[str, Any]]:
        """What it told, in order; a line that its end cut off is left out."""
        return [json.loads(line) for line in self.text.splitlines(keepends=True) if line.endswith(b"\n")]


def allow(seconds: float) -> None:
    """Let this process take so many more seconds of processor time; then it ends by SIGXCPU."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime + seconds) + 1, resource.RLIM_INFINITY))


def start(task: object, work: Work) -> Child:
    """A process that does the work; what it prints is lost, what it raises is told as `crash`."""
    reading, writing = os.pipe()
    sys.stdout.flush()
    number = os.fork()
    if number:
        os.close(writing)
        return Child(task, number, reading)
    try:
        os.close(reading)
        os.setpgid(0, 0)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        faulthandler.disable()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)

        def tell(**fields: object) -> None:
            text = memoryview(json.dumps(fields).encode() + b"\n")
            while text:
                text = text[os.write(writing, text) :]

        try:
            work(task, tell)
        except BaseException:
            tell(crash=traceback.format_exc()[-2000:])
    finally:
        os._exit(0)


def each(tasks: Iterable[object], work: Work, jobs: int) -> Iterator[tuple[Any, list[dict[str, Any]], int]]:
    """Every task with what its process told and with how that ended (`waitpid`), as they end; so many processes at a time."""
    waiting, running = iter(tasks), selectors.DefaultSelector()
    try:
        while True:
            while len(running.get_map()) < jobs and (task := next(waiting, None)) is not None:
                child = start(task, work)
                running.register(child.pipe, selectors.EVENT_READ, child)
            if not running.get_map():
                return
            for key, _ in running.select(timeout=5):
                child: Child = key.data
                more = os.read(child.pipe, 1 << 20)
                child.text, child.heard = child.text + more, time.monotonic()
                if not more:
                    running.unregister(child.pipe)
                    yield child.task, child.told(), ended(child)
            for key in list(running.get_map().values()):
                if time.monotonic() - key.data.heard > IDLE:
                    kill(key.data)
    finally:
        for key in list(running.get_map().values()):
            kill(key.data)
            ended(key.data)


def kill(child: Child) -> None:
    """End a process, and what it started."""
    with suppress(ProcessLookupError):
        os.killpg(child.number, signal.SIGKILL)


def ended(child: Child) -> int:
    """How a process ended; what it left behind is ended too."""
    os.close(child.pipe)
    _, status = os.waitpid(child.number, 0)
    kill(child)
    return status
