"""Runs that are driven with another step function, one that watches or compares."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from scenic_ref.interpreter.runtime import program_run
from scenic_ref.semantics.machine.config import Config
from scenic_ref.semantics.machine.outcome import Outcome

Step = Callable[[Config], Outcome]


@contextmanager
def stepping(instead: Step) -> Iterator[None]:
    """Every run is driven with another step function."""
    before = program_run.step
    program_run.step = instead  # type: ignore[assignment]
    try:
        yield
    finally:
        program_run.step = before  # type: ignore[assignment]
