"""Seeds keep their meaning: every vector and 300 invented programs give the rules, scenes and simulations that were recorded of them.

Vectors are judged by what the paper says, which leaves much open: the number that a seed gives, the order of the rules. Here a digest of that is
compared; of an error, its class and place. The words of messages have tests of their own. A change that is meant is recorded anew by
`python tests/semantics/test_recorded.py`, and belongs into the changelog; the lines of `recorded.json` that change say which programs it is about.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from scenic_ref.api import loads
from scenic_ref.conformance import load_vectors
from scenic_ref.conformance.generator import ProgramSettings, random_programs
from scenic_ref.conformance.implementations.protocol import NeverAccepted, Refused
from scenic_ref.conformance.implementations.reference import Ourselves, load_task, load_unless_refused, trace_first_run
from scenic_ref.conformance.vector import ConformanceVector
from scenic_ref.interpreter.language.printer import to_source
from scenic_ref.interpreter.runtime import trace
from scenic_ref.semantics import step
from scenic_ref.semantics.space.distributions import families
from scenic_ref.semantics.store.errors import ScenicError

RECORDED = Path(__file__).with_name("recorded.json")
STEPS = 6
INVENTED = 300
NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?|\b0x[0-9a-f]{6,}\b")
"""Numbers that rounding may change, and addresses."""
EVENTS = 400
"""So many of a trace: the longest have a million."""


def plain(value: object) -> str:
    """A text of a value with six digits of each number."""
    return NUMBER.sub(lambda found: "address" if "x" in found[0] else f"{float(found[0]):.5e}".replace("-0.00000e+00", "0.00000e+00"), str(value))


def digest(*parts: Callable[[], object]) -> str:
    """Eight digits for each part, or for its error: class and place."""
    return " ".join(hashlib.sha256(plain(said(part)).encode()).hexdigest()[:8] for part in parts)


def said(part: Callable[[], object]) -> object:
    """What a part gives."""
    try:
        return part()
    except (ScenicError, NeverAccepted, Refused) as problem:
        inner = problem.__cause__ or problem
        return type(inner).__name__, str(getattr(inner, "span", ""))


def of_vector(vector: ConformanceVector) -> str:
    """Of a vector: the rules of its first run, scenes, and a simulation where it is about one."""
    ours = Ourselves()
    task = vector.task(next(d for d in ours.dialects if d in vector.texts))
    scenario = load_unless_refused(task)
    if scenario is None:
        return digest(lambda: load_task(task))
    parts: list[Callable[[], object]] = [
        lambda: [(e.rule, e.kind, e.span.line, e.span.column, e.change, e.log_density) for e in trace_first_run(scenario, 0, 0).events[:EVENTS]],
        lambda: list(ours.scenes(task, 2, seed=0, attempts=20)),
    ]
    if vector.steps is not None:
        parts.append(lambda: list(ours.simulations(task, STEPS, 1, seed=0, attempts=5)))
    return digest(*parts)


def of_text(text: str) -> str:
    """Of an invented program: the rules of its first run, and scenes."""
    scenario = loads(text)
    return digest(
        lambda: [(e.rule, e.kind, e.span.line, e.span.column, e.change, e.log_density) for e in trace_first_run(scenario, 0, 0).events[:EVENTS]],
        lambda: [scene.to_json() for scene in scenario.sample_many(2, 0, max_attempts=20)],
    )


def programs() -> Iterator[tuple[str, Callable[[], str]]]:
    """All programs, by name, with what gives their digests."""
    for vector in load_vectors():
        if not vector.name.startswith("too-m"):  # they use up a budget, and take long
            yield vector.name, lambda v=vector: of_vector(v)
    for i, program in enumerate(random_programs(INVENTED, 20261126, ProgramSettings())):
        yield f"invented {i}", lambda p=program: of_text(to_source(p))


@cache
def recorded() -> dict[str, str]:
    """The digests by program; under "python" the version that they are of, since Python's own messages change."""
    return json.loads(RECORDED.read_text("utf-8"))


def test_something_is_recorded_of_every_program() -> None:
    assert set(recorded()) == {"python", *(name for name, _ in programs())}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "found"), [pytest.param(*p, id=p[0]) for p in programs()])
def test_the_program_gives_what_it_gave(name: str, found: Callable[[], str]) -> None:
    if recorded()["python"] != f"{sys.version_info[0]}.{sys.version_info[1]}":
        pytest.skip(f"recorded with Python {recorded()['python']}")
    assert found() == recorded()[name]


@pytest.mark.parametrize("rival", ["another number", "other rules"])
def test_what_is_given_otherwise_is_noticed(rival: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "ego = Object at (Range(0, 1), 1 + 2)\n"
    before = of_text(text)
    assert before == of_text(text)
    if rival == "another number":
        monkeypatch.setattr(families.Range, "sample", lambda self, uniform: self.low + (self.high - self.low) * uniform() ** 2)
    else:
        monkeypatch.setattr(trace.Trace, "witness", lambda self, outcome, drawn: None)
    assert of_text(text) != before


def test_an_error_is_recorded_by_its_place_and_not_its_words(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "ego = Object at (Range(0, 1), 1 + 2)\nx = [1][5]\n"
    before = of_text(text)
    monkeypatch.setattr(step, "exception_text", lambda exception: "something else")
    assert of_text(text) == before
    assert of_text("\n" + text) != before


if __name__ == "__main__":
    lines = [("python", f"{sys.version_info[0]}.{sys.version_info[1]}"), *((name, found()) for name, found in programs())]
    RECORDED.write_text("{\n" + ",\n".join(f"{json.dumps(n)}: {json.dumps(d)}" for n, d in lines) + "\n}\n", "utf-8")
