"""Judging an implementation by a vector: `judge`."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .implementations.line_process import ImplementationFault
from .implementations.protocol import (
    SEED,
    Implementation,
    Refused,
    Task,
    Tracing,
    TracingSimulations,
    Unsupported,
)
from .vector import ConformanceVector
from .verdict import VectorVerdict, errored_verdict, failed_verdict, skipped_verdict


@dataclass(frozen=True, slots=True)
class Result:
    """The verdict of one vector, in the dialect in which it was run."""

    vector: ConformanceVector
    dialect: str
    verdict: VectorVerdict


def judge(implementation: Implementation, vector: ConformanceVector, dialect: str | None = None, *, seed: int = SEED) -> Result:
    """The verdict; `dialect` is the one to use, or the first of the implementation's in which the program is given."""
    wanted = implementation.dialects if dialect is None else (dialect,)
    known = [d for d in wanted if d in vector.texts and d in implementation.dialects]
    if not known:
        return Result(vector, dialect or "", skipped_verdict(f"the program is not given in {' or '.join(wanted)}"))
    for reading, alternative in vector.readings.items():
        if not implementation.follows(reading, alternative):
            return Result(vector, known[0], skipped_verdict(f"{implementation.name} does not follow {reading} = {alternative}"))
    return Result(vector, known[0], verdict_of(implementation, vector, replace(vector.task(known[0]), seed=seed)))


def verdict_of(implementation: Implementation, vector: ConformanceVector, task: Task) -> VectorVerdict:
    """The matcher's verdict, then that of the rules; a crash says nothing about the language."""
    try:
        verdict = vector.matcher.match(implementation, task)
        return verdict if verdict.status != "passed" else rules_verdict(implementation, vector, task, verdict)
    except Unsupported as cannot:
        return skipped_verdict(str(cannot))
    except ImplementationFault as fault:  # of a process on the other side
        return errored_verdict(str(fault))
    except Exception as crash:  # whatever the implementation or a matcher raises besides what the protocol names
        return errored_verdict(f"{type(crash).__name__}: {crash}")


def rules_verdict(implementation: Implementation, vector: ConformanceVector, task: Task, passed: VectorVerdict) -> VectorVerdict:
    """Whether the rules fire that must, and none that must not, if the implementation reports them."""
    if not (vector.fires or vector.avoids):
        return passed
    try:
        fired = fired_in(implementation, vector, task)
    except Refused as refused:
        return failed_verdict(f"{refused.when} while the rules were watched: {refused.message}")
    if fired is None:
        return passed
    missing, unwanted = vector.fires - fired, vector.avoids & fired
    if missing:
        return failed_verdict(f"these rules did not fire: {', '.join(sorted(missing))}")
    return failed_verdict(f"these rules fired and must not: {', '.join(sorted(unwanted))}") if unwanted else passed


def fired_in(implementation: Implementation, vector: ConformanceVector, task: Task) -> frozenset[str] | None:
    """The rules that fire in what the vector is about, scenes or simulations; None if the implementation does not report them."""
    if vector.steps is not None:
        traces = isinstance(implementation, TracingSimulations)
        return implementation.fired_in_simulations(task, vector.steps, vector.fires, seed=task.seed) if traces else None
    return implementation.fired(task, vector.fires, seed=task.seed) if isinstance(implementation, Tracing) else None
