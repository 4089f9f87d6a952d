"""The work of `scenic-ref trace`: find the attempt to trace, and write the trace as text or as a page."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from importlib.resources import files
from itertools import islice
from typing import NamedTuple

from ..api import Scenario
from ..data.scene import in_json
from ..data.simulation import Simulated
from ..inference.rejection import sample
from ..inference.simulation_rejection import NextScene, attempts_at
from ..interpreter.runtime.answerers import from_stream
from ..interpreter.runtime.trace import Event, Trace, json_number
from ..sampling.program_source import Source
from ..sampling.scene_sampler import drawing_of
from ..semantics.rules import RULES
from ..semantics.store.errors import AttemptsExhausted, FuelExhausted, ScenicError, UsageError
from ..simulators.loop import Failed
from ..simulators.protocol import Simulator
from .error_messages import source_line, source_text
from .output_paths import write
from .session import escape_controls, tell


class WhichRun(NamedTuple):
    """Which run to trace; `attempt` counts from 1, None for the accepted one."""

    seed: int
    scene: int
    attempt: int | None
    max_attempts: int


class TracedRun(NamedTuple):
    """The trace of an attempt of a program, and the error that it ended with, if any; of a simulation, what came of it."""

    source: Source
    asked: WhichRun
    attempt: int
    trace: Trace
    error: ScenicError | None
    simulated: Simulated | Failed | None = None

    @property
    def title(self) -> str:
        """Which run this is."""
        what = "scene" if self.simulated is None else "simulation"
        return f"{self.source.file}, seed {self.asked.seed}, {what} {self.asked.scene}, attempt {self.attempt}"

    @property
    def ending(self) -> str:
        """How the run ended."""
        log_density = self.trace.log_density
        product = f"log density {log_density:.6g} (density {math.exp(log_density):.4g})" if log_density < 700 else f"log density {log_density:.6g}"
        if self.error is not None:
            return f"the program is wrong: {self.error.message}"
        if isinstance(self.simulated, Simulated):
            return f"accepted: {self.simulated.result}: {self.simulated.reason}; {product}"
        if isinstance(self.simulated, Failed):
            return f"discarded, with its scene: this fails {self.simulated.place}: {self.simulated.requirement.text}; up to there {product}"
        if self.trace.accepted:
            return f"accepted: the scene (π, O); {product}"
        return f"stuck: the run is discarded; up to there {product}"


BEFORE_THE_END = 20_000
"""Steps that are shown of a run which is known not to end within its fuel or time."""


def trace_attempt(source: Source, asked: WhichRun) -> TracedRun:
    """Run the requested attempt once more, and keep every rule that fires. Raises `AttemptsExhausted`, `UsageError`."""
    scenario = drawing_of(source).scenario

    def draw(count: Callable[[int], None]) -> int:
        return sample(
            scenario.start, asked.seed, asked.scene, max_attempts=asked.max_attempts, fuel=scenario.fuel, on_attempt=count
        ).scene.attempts

    attempt, known = (asked.attempt, None) if asked.attempt is not None else accepted_attempt(scenario, draw)
    found = Trace()
    try:
        fuel = min(scenario.fuel, BEFORE_THE_END) if isinstance(known, FuelExhausted) else scenario.fuel
        found.follow(scenario.start(), from_stream(asked.seed, asked.scene, attempt - 1), fuel=fuel)
    except ScenicError as error:
        return TracedRun(source, asked, attempt, found, known or error)
    return TracedRun(source, asked, attempt, found, known)


def traced_simulation(source: Source, asked: WhichRun, simulator: Simulator, steps: int) -> TracedRun:
    """As `trace_attempt`, for a simulation of at most `steps` time steps."""
    scenario = drawing_of(source).scenario

    def draw(count: Callable[[int], None]) -> int:
        return scenario.simulate(simulator, steps, asked.seed, asked.scene, max_attempts=asked.max_attempts, on_attempt=count).attempts

    attempt, known = (asked.attempt, None) if asked.attempt is not None else accepted_attempt(scenario, draw)
    found = Trace()
    fuel = min(scenario.fuel, BEFORE_THE_END) if isinstance(known, FuelExhausted) else scenario.fuel
    tried = attempts_at(
        scenario.start, simulator, steps, asked.seed, asked.scene, fuel=fuel,
        retry=scenario.readings["rejected-simulation"] == "retry", witnessed=lambda number: found.witness if number == attempt - 1 else None,
    )  # fmt: skip
    try:
        _, simulated, _ = next(islice(tried, attempt - 1, None))
        assert not isinstance(simulated, NextScene)  # nothing is skipped without a finder
    except ScenicError as error:
        return TracedRun(source, asked, attempt, found, known or error)
    return TracedRun(source, asked, attempt, found, known, simulated)


def accepted_attempt(scenario: Scenario, draw: Callable[[Callable[[int], None]], int]) -> tuple[int, ScenicError | None]:
    """The number of the first attempt that is accepted or fails, counting from 1; and the error if it is the rehearsal's.

    `draw` says which one is accepted; it calls what it is given with the number of those rejected so far.
    """
    stuck = 0

    def count(attempts: int) -> None:
        nonlocal stuck
        stuck = attempts

    try:
        scenario.rehearse()
    except UsageError:
        raise
    except ScenicError as error:
        return 1, error
    try:
        return draw(count), None
    except AttemptsExhausted:
        raise
    except ScenicError as error:
        return stuck + 1, error


def write_text(found: TracedRun, texts: Mapping[str, str], *, everything: bool) -> None:
    """Print the trace: source lines, and below each the rules that fired there."""
    print(escape_controls(found.title))
    place = None
    for event in shown_events(found.trace, everything=everything):
        if event.kind == "time":
            place = None
            print(escape_controls(f"\n{'':-<8} {event.change}"))
            continue
        here = (event.span.file, event.span.line)
        if here != place:
            place = here
            line = (source_line(event.span, texts) or "").strip()
            print(escape_controls(f"\n{event.span.file}:{event.span.line}: {line}" if event.span.line else "\n(no place in the source)"))
        print(escape_controls(event_line(event)))
    hidden = len(found.trace.events) - sum(1 for _ in shown_events(found.trace, everything=everything))
    print(escape_controls(f"\n{found.ending if found.error is None else 'the program is wrong, and the run ends here'}"))  # the error follows
    if hidden:
        print(f"{hidden:,} rules inherited from Python or for default values are hidden; --all shows them")
    sys.stdout.flush()


def event_line(event: Event) -> str:
    """One rule that fired: its number, id and name; its probability; what it changed."""
    name = f" ({event.name})" if event.name and event.name != event.rule else ""
    weight = ""
    if event.kind == "draw":
        weight = f"  {'density' if event.is_density else 'probability'} {math.exp(event.log_density):.4g}"
    return f"{event.number:>6}  {event.rule}{name}{weight}" + (f"\n{'':8}{event.change}" if event.change else "")


def shown_events(trace: Trace, *, everything: bool) -> Iterator[Event]:
    """All events, or those of the paper's rules outside default values; draws always."""
    for event in trace.events:
        is_default = event.in_default or event.rule == "P-Default"
        if everything or event.kind in ("draw", "stuck", "time", "done") or not (event.inherited or is_default):
            yield event


def page_of(found: TracedRun, texts: Mapping[str, str]) -> dict[str, object]:
    """Return the data of a page on which one steps through the run."""
    sources = {file: text for file in dict.fromkeys(e.span.file for e in found.trace.events) if (text := source_text(file, texts)) is not None}
    rules = {
        name: {"name": rule.name, "place": rule.place, "statement": rule.statement, "inherited": rule.inherited, "code": rule.code}
        for name in dict.fromkeys(e.rule for e in found.trace.events)
        if (rule := RULES.get(name)) is not None
    }
    return {
        "title": found.title, "ending": found.ending, "main": found.source.file, "sources": sources, "rules": rules,
        "events": [e.to_json() for e in found.trace.events], "logDensity": json_number(found.trace.log_density),
    }


def write_page(found: TracedRun, texts: Mapping[str, str], path: str) -> None:
    """Write a self-contained page to step through the run. Raises `UsageError`."""
    text = in_json(page_of(found, texts), allow_nan=True).replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    template = files("scenic_ref.cli").joinpath("trace.html").read_text(encoding="utf-8")
    page = template.replace("/*TRACE*/null", text)
    write(path, page)
    tell(f"{len(found.trace.events):,} rules: {path}")
