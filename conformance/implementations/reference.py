"""scenic-ref itself as an implementation under test."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from ... import __version__
from ...api import Scenario, loads
from ...data.simulation import Simulated, to_json
from ...inference.rejection import watch_first_draw
from ...interpreter.language.dialects import DIALECTS
from ...interpreter.runtime.answerers import from_stream
from ...interpreter.runtime.program_run import DEFAULT_FUEL, generate_scene
from ...interpreter.runtime.trace import Trace
from ...semantics.machine.outcome import Draw, Outcome, Requirement, Stuck
from ...semantics.space.vectors import Vector
from ...semantics.store.errors import AttemptsExhausted, ProgramError, RunsExhausted, ScenicError, UsageError
from ...semantics.syntax.nodes import NOWHERE
from ...simulators.loop import simulate_once
from ...simulators.still import Still
from ..recorded_world import RecordedWorld, World
from .protocol import Enumerated, NeverAccepted, Refused, SceneRecord, SimulationRecord, Task

TRACED_RUNS = 60
"""The most runs that are traced in search of a rule; one that fires in half of the runs is missed with probability 2^-60."""

NO_LINE = 0
REJECTING = frozenset({"D-Eventually", "D-Guard"})
"""Rules that only reject a simulation: they fire where others are stuck."""


class Ourselves:
    """The readable machine with rejection sampling and enumeration; or the batch backend, where it can draw a vector's scenes."""

    name = f"scenic-ref {__version__}"
    dialects = tuple(DIALECTS)

    counts_attempts = True
    backend: Literal["interpreter", "batch"] = "interpreter"

    @classmethod
    def by_batch(cls) -> Ourselves:
        """Ourselves with the batch backend."""
        found = cls()
        found.backend = "batch"
        return found

    def follows(self, reading: str, alternative: str) -> bool:
        """All alternatives of all readings can be followed."""
        return True

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        """Scenes 0 to `count - 1` of the seed."""
        with translate_errors():
            for scene in load_task(task).sample_many(count, seed, max_attempts=attempts, backend=self.backend):
                yield scene.to_json()

    def enumerated(self, task: Task) -> Enumerated | None:
        """The exact distribution, unless a draw has infinitely many values."""
        with translate_errors():
            scenario = load_task(task)
            try:
                found = scenario.enumerate()
            except (UsageError, RunsExhausted):
                return None
        return Enumerated(tuple((outcome.probability, outcome.scene.to_json()) for outcome in found.outcomes), found.acceptance)

    def density(self, task: Task, draws: Sequence[object]) -> float:
        """Return the density of the run in which these values are drawn. Raises `ValueError` if the run draws
        more or fewer.
        """
        logarithms: list[float] = []

        def given(draw: Draw) -> object:
            if len(logarithms) == len(draws):
                raise ValueError(f"the run draws more than {len(draws)} values")
            value = draws[len(logarithms)]
            value = Vector(*value) if isinstance(value, list) else value
            logarithms.append(draw.distribution.log_density(value))
            if logarithms[-1] == -math.inf:
                raise NeverDrawn
            return value

        with translate_errors(), suppress(NeverDrawn):
            generate_scene(load_task(task).start(), given)
            if len(logarithms) < len(draws):
                raise ValueError(f"the run draws {len(logarithms)} values, and not {len(draws)}")
        return math.exp(sum(logarithms))

    def fired(self, task: Task, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        """Return the rules that fired in the first runs of several scenes, until all wanted rules were seen
        and a run was accepted.
        """
        scenario = load_unless_refused(task)
        if scenario is None:
            return frozenset()
        found: set[str] = set()
        accepted = False
        for index in range(TRACED_RUNS):
            trace = trace_first_run(scenario, seed, index)
            accepted = accepted or trace.accepted
            found |= {event.rule for event in trace.events if event.kind != "stuck"}
            if (accepted and wanted <= found) or trace.run is None:
                break
        return frozenset(found)

    def simulations(
        self, task: Task, steps: int, count: int, *, seed: int, attempts: int, world: World | None = None
    ) -> Iterator[SimulationRecord]:  # fmt: skip
        """Simulations 0 to `count - 1` of the seed."""
        with translate_errors():
            scenario = load_task(task)
            for index in range(count):
                run = scenario.simulate(RecordedWorld(world or ()), steps, seed, index, max_attempts=attempts, backend="interpreter")
                yield to_json(run.simulation, run.attempts)

    def enumerated_simulations(self, task: Task, steps: int) -> Enumerated | None:
        """The exact distribution, unless a draw has infinitely many values, or scenes are tried again after a rejection."""
        with translate_errors():
            scenario = load_task(task)
            if scenario.readings["rejected-simulation"] == "retry":
                return None
            try:
                found = scenario.enumerate_simulations(Still(), steps)
            except (UsageError, RunsExhausted):
                return None
        return Enumerated(tuple((probability, to_json(simulation, 1)) for probability, simulation in found.outcomes), found.acceptance)

    def fired_in_simulations(self, task: Task, steps: int, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        """Return the rules that fired in the first runs of several simulations, until all wanted rules were
        seen and a run was accepted.
        """
        scenario = load_unless_refused(task)
        if scenario is None:
            return frozenset()
        found: set[str] = set()

        def look(outcome: Outcome, drawn: object) -> None:
            rule: str = outcome.fires(drawn) if isinstance(outcome, Draw) else getattr(outcome, "rule", "")
            if rule and (rule in REJECTING or not isinstance(outcome, Stuck)):
                found.add(rule)

        accepted = False
        for index in range(TRACED_RUNS):
            chooser, drawn = watch_first_draw(from_stream(seed, index, 0))
            with suppress(ProgramError):  # what fired before it is kept
                ended = simulate_once(scenario.start(), chooser, Still(), steps, seed=seed, index=index, fuel=scenario.fuel, witness=look)
                accepted = accepted or isinstance(ended, Simulated)
            if (accepted and wanted <= found) or not drawn:
                break
        return frozenset(found)


class NeverDrawn(Exception):
    """No run draws such a value."""


def load_unless_refused(task: Task) -> Scenario | None:
    """The scenario of a task, None for a program that is refused."""
    try:
        with translate_errors():
            return load_task(task)
    except Refused:
        return None


def load_task(task: Task) -> Scenario:
    """The scenario of a task; the modules beside its program are read here."""
    with folder_with_files(task.files) as directory:
        scenario = loads(task.program, dialect=task.dialect, profile="paper", readings=task.readings, directory=directory)
        _ = scenario.settings  # the modules are read here, while the folder is there
        return scenario


@contextmanager
def folder_with_files(files: Mapping[str, str]) -> Iterator[Path | None]:
    """A folder with these files for as long as it is needed, None if there are none."""
    if not files:
        yield None
        return
    with TemporaryDirectory() as folder:
        for path, text in files.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, "utf-8")
        yield Path(folder)


def trace_first_run(scenario: Scenario, seed: int, index: int) -> Trace:
    """The first run of a scene, up to its end or to the program's error."""
    trace = Trace()
    with suppress(ProgramError):  # the events before it are kept
        trace.follow(scenario.start(), from_stream(seed, index, 0), fuel=DEFAULT_FUEL)
    return trace


@contextmanager
def translate_errors() -> Iterator[None]:
    """Our errors in the words of the protocol; any other error goes through."""
    try:
        yield
    except ProgramError as error:
        raise refusal(error, error.phase) from error
    except AttemptsExhausted as exhausted:
        raise NeverAccepted(frozenset(r.kind for r, _ in exhausted.stuck if isinstance(r, Requirement))) from exhausted


def refusal(error: ScenicError, phase: str) -> Refused:
    """An error of the program."""
    line = error.span.line if error.span != NOWHERE and error.span.line > NO_LINE else None
    return Refused(phase, error.message, class_name=type(error).__name__, rule=error.rule or None, line=line)
