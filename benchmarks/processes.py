"""The processes that a benchmark asks for scenes: one for each program and implementation, each in its own environment."""

from __future__ import annotations

import contextlib
import json
import subprocess
import tempfile
from types import TracebackType
from typing import IO, Any

from .implementations import Contender, MeasuredProgram


def end(running: subprocess.Popen[str], errors: IO[str]) -> None:
    """End a process, with its streams."""
    running.kill()
    for stream in (running.stdin, running.stdout, errors):
        if stream is not None:
            with contextlib.suppress(OSError):  # what it did not read before it ended is still to be written
                stream.close()
    running.wait()


class Process:
    """A program in the hands of one implementation; used in a `with`. `ready` tells what preparing took, or why it is skipped."""

    def __init__(self, contender: Contender, program: MeasuredProgram, seed: int) -> None:
        self.errors = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115 (closed with the process)
        self.running = subprocess.Popen(
            contender.command(program, seed), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, text=True,
            env=contender.environment(),
        )
        try:
            self.ready = self.answer()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Process:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """End the measured process."""
        end(self.running, self.errors)

    def sample(self, seconds: float) -> dict[str, Any]:
        """Draw for about `seconds` seconds of the processor, and return the measurement."""
        assert self.running.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            print(seconds, file=self.running.stdin, flush=True)
        return self.answer()

    def answer(self) -> dict[str, Any]:
        """The next line that it prints; if it ended instead, why."""
        assert self.running.stdout is not None
        line = self.running.stdout.readline()
        try:
            found = json.loads(line)
            return found if isinstance(found, dict) else {"skipped": f"its answer was {line.strip()!r}"}
        except ValueError:
            return {"skipped": self.why(line)}

    def why(self, line: str) -> str:
        """The end of what it said before it ended."""
        self.errors.seek(0)
        said = [text.strip() for text in self.errors.read().splitlines() if text.strip()]
        return line.strip() or (said[-1][:300] if said else "its process ended without an answer")
