"""Drawing scenes one by one: each as a line of JSON, with what happened on the way to it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from functools import cache, cached_property
from threading import get_ident
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from ..data.scene import Scene, scene_of
from ..inference.batch.jobs.failures import FailedDraw, parts, record_failed_draw
from ..inference.batch.jobs.worker_pools import Workers, processes
from ..inference.rejection import patiently
from ..interpreter.runtime.program_run import Accepted, Witness
from ..semantics.machine.conditions import bool_of
from ..semantics.machine.config import Config, Value
from ..semantics.machine.host_calls import HostException
from ..semantics.machine.outcome import Draw, Next, Outcome, Requirement
from ..semantics.machine.run_loop import Arrived, drive_machine
from ..semantics.machine.values import value_in_run
from ..semantics.step import step
from ..semantics.store.errors import AttemptsExhausted, ScenicError
from ..semantics.store.scopes import descendants
from ..semantics.syntax import Program
from ..semantics.syntax.dynamics import (
    MonitorDefinition,
    RequireAlways,
    RequireEventually,
    RequireMonitor,
    TerminateWhen,
)
from ..semantics.syntax.nodes import Node, Span
from ..semantics.syntax.python_expressions import Name
from ..semantics.syntax.statements import SoftRequire
from .program_source import Source

if TYPE_CHECKING:
    from ..api import Scenario
    from ..inference.batch import Batch, Block
    from ..inference.batch.jobs.block_tables import Tables
    from ..inference.batch.jobs.scene_lines import Lines

MOST_PRINTED = 10_000
ASIDE_STEPS = 100_000

AnyJob = TypeVar("AnyJob")
Found = TypeVar("Found")
Listener = Callable[[int], None]


class Softness(NamedTuple):
    """How often the condition of the soft requirement at `span` held, of how often that is known, and its probability."""

    span: Span
    probability: float
    held: int
    known: int

    def plus(self, other: Softness) -> Softness:
        """Return the sum of both counts."""
        return self._replace(held=self.held + other.held, known=self.known + other.known)


@dataclass(frozen=True)
class DrawnScene:
    """A scene as its line of JSON, the requirements at which attempts got stuck, and what the accepted attempt printed."""

    index: int
    attempts: int
    line: str
    stuck: Counter[Requirement]
    printed: tuple[str, ...]
    soft: tuple[Softness, ...]


@dataclass(frozen=True)
class Drawing:
    """A scenario from which scenes are drawn."""

    scenario: Scenario

    @cached_property
    def lines(self) -> Lines:
        """The writer of JSON lines for scenes drawn many at a time; the program must have a graph."""
        from ..inference.batch.jobs.scene_lines import Lines

        return Lines(self.batch.template)

    @cached_property
    def tables(self) -> Tables:
        """The writer of tables for scenes drawn many at a time; the program must have a graph."""
        from ..inference.batch.jobs.block_tables import Tables

        return Tables(self.batch.template)

    @property
    def batch(self) -> Batch:
        """The graph of a program that is known to have one."""
        batch = self.scenario.batch
        assert batch is not None, self.scenario.not_lifted
        return batch

    @cached_property
    def prints(self) -> bool:
        """Whether the program or one of its modules mentions `print`."""
        return any(isinstance(node, Name) and node.name == "print" for node in self._nodes())

    @cached_property
    def has_soft_requirements(self) -> bool:
        """Whether there are soft requirements that may hold less often than they say (reading `soft=run`)."""
        return self.scenario.readings["soft"] == "run" and self._is_soft

    @property
    def throws_coins_for_scenes(self) -> bool:
        """Whether there are soft requirements whose coins are thrown once for all attempts at a scene (reading `soft=scene`)."""
        return self.scenario.readings["soft"] == "scene" and self._is_soft

    @cached_property
    def _is_soft(self) -> bool:
        return any(isinstance(node, SoftRequire) for node in self._nodes())

    @cached_property
    def about_time(self) -> tuple[str, ...]:
        """The statements of the program that concern time, each with its line: they have no effect on a scene."""
        kinds = {
            RequireAlways: "require always", RequireEventually: "require eventually", RequireMonitor: "require monitor",
            TerminateWhen: "terminate when", MonitorDefinition: "monitor",
        }  # fmt: skip
        return tuple(f"`{kinds[type(s)]}` on line {s.span.line}" for s in self.scenario.program.statements if type(s) in kinds)

    def _nodes(self) -> Iterator[Node]:
        modules = [m for m in self.scenario.settings.library.values() if isinstance(m, Program)]
        return (node for program in (self.scenario.program, *modules) for statement in program.statements for node in descendants(statement))

    def rehearse(self, printed: list[str]) -> None:
        """Find the program's errors before the first scene; `printed` gets what it printed before one."""
        self.scenario.rehearse((lambda outcome, _: listen(outcome, printed)) if self.prints else None)

    def draw(
        self, seed: int, index: int, max_attempts: int, printed: list[str], on_attempt: Callable[[int], None] | None = None
    ) -> DrawnScene:
        """Scene number `index` of `seed`. `printed` gets what the latest attempt printed, also if that ends with an error."""

        def listening(attempt: int) -> Witness:
            printed.clear()
            return lambda outcome, drawn: listen(outcome, printed)

        self.rehearse(printed)
        scenario = self.scenario
        printed.clear()
        witnessed = listening if self.prints else None
        found = scenario.sampled(seed, index, max_attempts=max_attempts, on_attempt=on_attempt, witnessed=witnessed)
        attempts = found.scene.attempts
        soft = self.softness(seed, index, attempts) if self.has_soft_requirements else ()
        return DrawnScene(index, attempts, found.scene.to_line(), found.stuck, tuple(printed), soft)

    def again(self, seed: int, index: int, attempts: int) -> Scene | None:
        """The scene that is known to need `attempts` attempts, by the last of them alone; None if that attempt gets stuck."""
        if self.scenario.in_parts:
            with suppress(AttemptsExhausted):
                return self.scenario.sample(seed, index, max_attempts=attempts)
            return None
        result = self.scenario.last_run(seed, index, attempts)
        return scene_of(result.state, seed, index, attempts, pruned=bool(self.scenario.draws)) if isinstance(result, Accepted) else None

    def softness(self, seed: int, index: int, attempts: int, block: Block | None = None) -> tuple[Softness, ...]:
        """How often each soft requirement held in the last attempt at a scene, which is run once more, so that looking disturbs nothing.

        `block` is a drawing that has the scene, if there is one.
        """
        found: dict[Span, Softness] = {}

        def look(outcome: Outcome, drawn: object) -> None:
            if isinstance(outcome, Draw) and outcome.otherwise and isinstance(outcome.node, SoftRequire):
                held = True if drawn else holds_aside(outcome.node.condition, outcome.resume(False))
                if held is not None:
                    probability = float(outcome.distribution.parameters["probability"])  # type: ignore[arg-type]
                    one = Softness(outcome.node.span, probability, int(held), 1)
                    found[one.span] = found[one.span].plus(one) if one.span in found else one

        try:
            self.scenario.last_run(seed, index, attempts, block, witness=look)
        except ScenicError:
            return ()
        return tuple(found.values())


def listen(outcome: Outcome, printed: list[str]) -> None:
    """Keep what the program prints."""
    if type(outcome) is Next and outcome.change is not None and outcome.change.where == "print" and len(printed) < MOST_PRINTED:
        printed.append(str(outcome.change.value))


def holds_aside(condition: Node, place: Config) -> bool | None:
    """Whether `condition` holds in the state of `place`; None if that cannot be said without a draw, or at all."""
    try:
        end, _ = drive_machine(step, Config(condition, (), place.state), raise_unknown, ASIDE_STEPS, until=is_value)
        return bool(bool_of(value_in_run(end.config.control.value), condition, end.config.state)) if isinstance(end, Arrived) else None  # type: ignore[union-attr]
    except (Unknown, ScenicError, HostException):
        return None


class Unknown(Exception):
    """Something hangs on a draw."""


def raise_unknown(draw: Draw) -> object:
    """Answers no draw. Raises `Unknown`."""
    raise Unknown


def is_value(config: Config) -> bool:
    """Whether the whole was reduced to a value."""
    return isinstance(config.control, Value) and not config.stack


def drawing_of(source: Source) -> Drawing:
    """The drawing of a program, loaded once per process, and once per thread where a cluster has several: they share no program."""
    return _drawing_of(source, get_ident())


@cache
def _drawing_of(source: Source, thread: int) -> Drawing:
    return Drawing(source.load())


# Several processes: results come in the order of the scenes, whatever the number of processes


class Job(NamedTuple):
    """Scenes `start` to `stop - 1` of `seed`, for one process."""

    source: Source
    seed: int
    start: int
    stop: int
    max_attempts: int


def work(job: Job) -> list[DrawnScene | FailedDraw]:
    """The scenes of a job; a program's error is the last."""
    return list(draw_here(drawing_of(job.source), job))


def draw_here(
    drawing: Drawing, job: Job, on_attempt: Listener | None = None, *, patient: bool = True
) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, in this process; a program's error is the last. Raises `OutOfPatience`, unless it is `patient`."""
    printed: list[str] = []
    for index in range(job.start, job.stop):
        try:
            yield drawing.draw(job.seed, index, job.max_attempts, printed, on_attempt if patient else patiently(job.max_attempts, on_attempt))
        except ScenicError as error:
            yield record_failed_draw(error, printed)
            return


def drawn_by(workers: AbstractContextManager[Workers], job: Job, count: int) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, drawn by about `count` processes."""
    jobs = (job._replace(start=start, stop=stop) for start, stop in parts(job.start, job.stop, count))
    yield from done_by(workers, work, jobs)


def done_by(workers: AbstractContextManager[Workers], work: Callable[[AnyJob], list[Found]], jobs: Iterable[AnyJob]) -> Generator[Found]:
    """Yield the results of the jobs in the order of the jobs, whichever process does them."""
    with workers as several:
        for found in several.draw(work, jobs):
            yield from found


def draw_in_processes(job: Job, count: int) -> Generator[DrawnScene | FailedDraw]:
    """The scenes of a job, drawn by `count` processes of this machine."""
    return drawn_by(processes(count), job, count)
