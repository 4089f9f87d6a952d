"""`serve`: an implementation in Python, behind the harness protocol. `python -m scenic_ref.conformance.implementations.harness_server` serves
scenic-ref itself.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from inspect import signature
from typing import Any, TextIO

from ...semantics.readings import READINGS
from .harness_client import PROTOCOL, Answer
from .protocol import CountingAttempts, Implementation, NeverAccepted, Refused, Simulating, Task, Unsupported
from .reference import Ourselves


def serve(implementation: Implementation, requests: Iterable[str] | None = None, answers: TextIO | None = None) -> None:
    """Answer requests, a line each, until `stop` or the end of the input; by default from stdin to stdout.

    What the program under test prints meanwhile goes to stderr.
    """
    if answers is None:
        answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
        os.dup2(2, 1)
    task: Task | None = None
    for line in sys.stdin if requests is None else requests:
        asked = json.loads(line)
        if asked["request"] == "compile":
            task = Task(asked["program"], asked["dialect"], asked["readings"], files=asked["files"], prune=asked.get("prune", True))
        for answer in answers_to(implementation, asked, task):
            answers.write(json.dumps({"id": asked["id"], **answer}, allow_nan=False) + "\n")
            answers.flush()
        if asked["request"] == "stop":
            return


def answers_to(implementation: Implementation, asked: Mapping[str, Any], task: Task | None) -> Iterator[Answer]:
    """The answers to a request."""
    try:
        yield from ANSWERS[asked["request"]](implementation, asked, task)
    except Refused as refused:
        told = {"phase": refused.phase, "message": refused.message, "class": refused.class_name, "rule": refused.rule, "line": refused.line}
        yield {"answer": "error", **told}
    except NeverAccepted as never:
        yield {"answer": "rejected", "requirements": None if never.requirements is None else sorted(never.requirements)}
    except Unsupported as cannot:
        yield {"answer": "skipped", "reason": str(cannot)}
    except Exception as crash:  # whatever it raises besides: it goes on with the next request
        yield {"answer": "crashed", "message": f"{type(crash).__name__}: {crash}"}


def answer_start(implementation: Implementation, asked: Mapping[str, Any], task: Task | None) -> Iterator[Answer]:
    """Answer with the implementation's name, its dialects, its capabilities, and the readings that it can be
    made to follow.
    """
    name, _, version = implementation.name.rpartition(" ")
    followed = {id: [a for a in reading.alternatives if implementation.follows(id, a)] for id, reading in READINGS.items()}
    counts = isinstance(implementation, CountingAttempts) and implementation.counts_attempts
    capabilities = ["scenes", *(["attempts"] if counts else []), *(["simulations"] if isinstance(implementation, Simulating) else [])]
    yield {
        "answer": "started", "protocol": PROTOCOL, "name": name or version, "version": version if name else "",
        "dialects": list(implementation.dialects), "capabilities": capabilities,
        "readings": {id: alternatives for id, alternatives in followed.items() if alternatives}, "isolated": True,
    }  # fmt: skip


def answer_compile(implementation: Implementation, asked: Mapping[str, Any], task: Task | None) -> Iterator[Answer]:
    """The program is kept: the protocol of Python implementations compiles when it draws."""
    yield {"answer": "compiled"}


def answer_sample(implementation: Implementation, asked: Mapping[str, Any], task: Task | None) -> Iterator[Answer]:
    """Answer with the scenes that were asked for."""
    for scene in implementation.scenes(require_task(task), asked["count"], seed=asked["seed"], attempts=asked["attempts"]):
        yield {"answer": "scene", "scene": scene}
    yield {"answer": "done"}


def answer_simulate(implementation: Implementation, asked: Mapping[str, Any], task: Task | None) -> Iterator[Answer]:
    """Answer with the simulations that were asked for. Raises `Unsupported`."""
    if not isinstance(implementation, Simulating):
        raise Unsupported(f"{implementation.name} does not simulate")
    recorded = {} if asked["world"] is None else {"world": asked["world"]}
    if recorded and "world" not in signature(implementation.simulations).parameters:
        raise Unsupported(f"{implementation.name} does not simulate in a recorded world")
    for run in implementation.simulations(
        require_task(task), asked["steps"], asked["count"], seed=asked["seed"], attempts=asked["attempts"], **recorded
    ):
        yield {"answer": "simulation", "simulation": run}
    yield {"answer": "done"}


def answer_stop(implementation: Implementation, asked: Mapping[str, Any], task: Task | None) -> Iterator[Answer]:
    """Answer that the server stops."""
    yield {"answer": "stopped"}


def require_task(task: Task | None) -> Task:
    """The program that was compiled."""
    if task is None:
        raise Unsupported("no program was compiled")
    return task


ANSWERS: Mapping[str, Callable[[Implementation, Mapping[str, Any], Task | None], Iterator[Answer]]] = {
    "start": answer_start, "compile": answer_compile, "sample": answer_sample, "simulate": answer_simulate, "stop": answer_stop,
}  # fmt: skip


if __name__ == "__main__":
    serve(Ourselves())
