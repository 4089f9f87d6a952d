"""Programs that are checked while they are typed: when, by which process, and for how long."""

from __future__ import annotations

import asyncio
import json
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from .module_library import LONGEST

DELAY = 0.3
"""Seconds without a change after which a program is checked."""
PATIENCE = 1.0
"""Seconds that a check of a text which has changed since may still take, before its process is ended."""
MEMORY = 2 << 30
SLOWNESS, LEAST_WAIT = 12, 60
"""A check may take so many times its limit of processor time on the clock, and so many seconds: parsing counts, and so do other processes."""
LONGEST_ANSWER = 1 << 26

Records = list[dict[str, object]]


class Revision(NamedTuple):
    """A text as it was at one moment: the document, its version, the name of its file and the folder of that, if it is a file."""

    uri: str
    version: int | None
    text: str
    file: str
    folder: str | None


Publish = Callable[[Revision, Records], None]


class CheckingProcess:
    """A process that checks programs, one after another; it is started when it is needed, and ended when a check takes too long."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.wait = max(LEAST_WAIT, seconds * SLOWNESS)
        self.process: Process | None = None
        self.killed: Process | None = None
        self.busy = False
        self.starting: asyncio.Future[Process] | None = None

    async def check(self, text: Revision) -> Records:
        """The diagnostics of a text. If this is cancelled, the next check waits for the answer a little, or ends the process."""
        try:
            process = await self.ready()
            assert process.stdin is not None and process.stdout is not None
            self.busy = True
            request = {"file": text.file, "folder": text.folder, "text": text.text, "seconds": self.seconds, "memory": MEMORY}
            process.stdin.write(json.dumps(request).encode() + b"\n")
            await process.stdin.drain()
            line = await asyncio.wait_for(process.stdout.readline(), self.wait)
        except TimeoutError:
            await self.end()
            return [whole_file_diagnostic(text.file, f"checking the program took more than {self.wait:g} seconds, and was given up")]
        except (OSError, ValueError):
            line = b""
        if not line.endswith(b"\n"):
            await self.end()
            return [
                whole_file_diagnostic(
                    text.file, "the process that checks programs ended unexpectedly: does the program need more memory than there is?"
                )
            ]
        self.busy = False
        found = json.loads(line)
        if "failure" in found:
            return [
                whole_file_diagnostic(
                    text.file, f"internal error: {found['failure']}; this is a fault of scenic-ref, please report it with the program"
                )
            ]
        return found["diagnostics"]

    async def ready(self) -> Process:
        """A process that is doing nothing."""
        if self.process is not None and self.busy:
            assert self.process.stdout is not None
            with suppress(TimeoutError, OSError, ValueError):
                self.busy = not (await asyncio.wait_for(self.process.stdout.readline(), PATIENCE)).endswith(b"\n")
            if self.busy:
                await self.end()
        if self.starting is None or (self.starting.done() and (self.process is None or self.process.returncode is not None)):
            self.starting = asyncio.ensure_future(self.launch())
        return await asyncio.shield(self.starting)

    async def launch(self) -> Process:
        """Start a process, and wait until it listens, which takes seconds on a slow machine and is no part of any check."""
        arguments = ("-P", "-m", f"{__package__}.check_worker")
        self.process = await asyncio.create_subprocess_exec(sys.executable, *arguments, stdin=PIPE, stdout=PIPE, limit=LONGEST_ANSWER)
        assert self.process.stdout is not None
        await self.process.stdout.readline()
        return self.process

    def kill(self) -> None:
        """Let the process end, and the one that is starting.

        It gets one signal: a second could take from asyncio how it ended, and asyncio would complain of that.
        """
        if self.starting is not None:
            self.starting.cancel()
        if self.process is not None and self.process is not self.killed:
            self.killed = self.process
            with suppress(ProcessLookupError):
                self.process.kill()

    async def end(self) -> None:
        """End the process, and wait for it; one that is ending by itself has a moment for that, since asyncio would miss how it ended."""
        if self.process is not None and self.process.stdout is not None and self.process.stdout.at_eof():
            with suppress(TimeoutError):
                await asyncio.wait_for(self.process.wait(), PATIENCE)
        self.kill()
        if self.starting is not None:
            await asyncio.wait([self.starting])
        process, self.process, self.starting, self.busy = self.process, None, None, False
        if process is not None:
            with suppress(OSError):
                await process.communicate()  # closes its pipes, too: asyncio would complain of them when the loop is closed


class CheckingQueue:
    """Checks each text a moment after its last change, one at a time; what was found of an older text is never published."""

    def __init__(self, seconds: float, publish: Publish) -> None:
        self.publish = publish
        self.process = CheckingProcess(seconds)
        self.turn = asyncio.Lock()
        self.tasks: dict[str, asyncio.Task[None]] = {}

    def begin(self) -> None:
        """Start the process before there is anything to check."""
        if self.process.starting is None:
            self.process.starting = asyncio.ensure_future(self.process.launch())

    def changed(self, text: Revision, delay: float = DELAY) -> None:
        """Check a text soon, in place of an older one."""
        self.dropped(text.uri)
        self.tasks[text.uri] = asyncio.get_running_loop().create_task(self.check(text, delay))

    def dropped(self, uri: str) -> None:
        """Do not check a text any more."""
        task = self.tasks.pop(uri, None)
        if task is not None:
            task.cancel()

    async def check(self, text: Revision, delay: float) -> None:
        """Check a text after a delay, and publish what was found."""
        await asyncio.sleep(delay)
        async with self.turn:
            if len(text.text) > LONGEST:
                found = [
                    whole_file_diagnostic(
                        text.file, f"programs of more than {LONGEST:,} characters are not checked while they are typed", "information"
                    )
                ]
            else:
                found = await self.process.check(text)
        self.publish(text, found)

    def stop(self) -> list[asyncio.Task[None]]:
        """Drop all texts, and let the process end; the tasks that end, too."""
        tasks = list(self.tasks.values())
        for uri in list(self.tasks):
            self.dropped(uri)
        self.process.kill()
        return tasks

    async def end(self) -> None:
        """Stop all work and wait until none of it is left."""
        if tasks := self.stop():
            await asyncio.wait(tasks)
        await self.process.end()


def whole_file_diagnostic(file: str, message: str, severity: str = "error") -> dict[str, object]:
    """A diagnostic of a whole file."""
    return {"severity": severity, "kind": "not checked", "message": message, "file": file, "hint": "", "rule": "", "expected": []}
