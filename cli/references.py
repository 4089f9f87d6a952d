"""The scenes that samples are compared with: drawn block by block, by one process or by several."""

from __future__ import annotations

import json
import shlex
from collections.abc import Generator, Iterator
from itertools import islice
from types import TracebackType

from .drawing import Drawn, drawing_of
from .options import DEFAULT_ATTEMPTS, DEFAULT_FUEL, Source
from .progress import Progress
from .workers import Failed, Job, draw_here, draw_in_processes


class References:
    """Draws scenes 0 to `total` - 1 of a program, in JSON, showing how far it is; used in a `with`.

    The processes stay between the blocks that are asked for, one after the other.
    """

    def __init__(self, source: Source, workers: int, total: int) -> None:
        self.source = source
        self.workers = workers
        self.total = total
        self.progress = Progress(total)
        self.drawn: Generator[Drawn | Failed] | None = None

    def __enter__(self) -> References:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.drawn is not None:
            self.drawn.close()
            self.progress.__exit__(kind, error, trace)

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[dict[str, object]]:
        """Scenes `start` to `start + n - 1` of `seed`, which must be the next ones. Raises the program's errors."""
        if self.drawn is None:
            self.progress.__enter__()
            job = Job(self.source, seed, start, self.total, DEFAULT_ATTEMPTS)
            self.drawn = draw_here(drawing_of(self.source), job, self.progress.stuck) if self.workers == 1 else draw_in_processes(job, self.workers)
        for drawn in islice(self.drawn, n):
            if isinstance(drawn, Failed):
                raise drawn.error
            self.progress.drawn(drawn.attempts)
            yield json.loads(drawn.line)


def replay_of(source: Source, samples: str, reference: str | None, alpha: float, detect_tv: float, seed: int) -> str:
    """The command that makes the same comparison again."""
    words = ["scenic-ref", "check", source.file, "--samples", samples, "--alpha", f"{alpha:g}", "--detect-tv", f"{detect_tv:g}", "--seed", str(seed)]
    words += ["--reference", reference] if reference is not None else []
    words += ["--profile", source.profile] if source.profile != "paper" else []
    words += [w for name, value in source.readings for w in ("--reading", f"{name}={value}")]
    words += ["--dialect", source.dialect] if source.dialect is not None else []
    words += ["--model", source.model] if source.model is not None else []
    words += [w for name, value in source.params for w in ("-p", f"{name}={value}")]
    words += ["--fuel", str(source.fuel)] if source.fuel != DEFAULT_FUEL else []
    words += ["--trust"] if source.trust else []
    return shlex.join(words)
