"""Simulations of a `Scenario`: one or many of them, those that are played again, and the exact distribution of all."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from ..data.recording_reader import Recording
from ..data.simulation import Simulated
from ..inference.enumeration import DEFAULT_RUNS, Histories, enumerate_simulations
from ..inference.rejection import DEFAULT_ATTEMPTS
from ..inference.simulation_rejection import NextScene, SampledRun, sample_simulation
from ..interpreter.runtime.program_run import Witness
from ..semantics.kernel.errors import AttemptsExhausted
from ..simulators import by_name
from ..simulators.behaviors.compiled_library import Library
from ..simulators.loop import Failed, Settled
from ..simulators.protocol import Simulator
from .checking import check_whole
from .simulating import SimulationBackend, SimulationRange, Told, check_simulation_backend, replayed, simulate_many

if TYPE_CHECKING:
    from ..inference.batch import Batch
    from ..semantics.kernel.config import Config


class OverTime:
    """What makes a `Scenario` one that can be simulated."""

    readings: Mapping[str, str]
    fuel: int
    if TYPE_CHECKING:

        def start(self) -> Config: ...
        def rehearse(self) -> None: ...
        @property
        def impossible(self) -> AttemptsExhausted | None: ...
        @property
        def batch(self) -> Batch | None: ...
        @property
        def in_parts(self) -> bool: ...

    def simulate(
        self, simulator: str | Simulator = "still", steps: int = 100, seed: int = 0, index: int = 0, *, timestep: float | None = None,
        max_attempts: int = DEFAULT_ATTEMPTS, on_attempt: Callable[[int], None] | None = None,
        on_failed: Callable[[Failed], None] | None = None, witnessed: Callable[[int], Witness | None] | None = None,
        backend: SimulationBackend = "compiled", settled: Settled | None = None,
    ) -> SampledRun:  # fmt: skip
        """Simulation number `index` of `seed`, of at most `steps` time steps; rejected runs are discarded as a whole (reading `rejected-simulation`).

        `simulator` is one of `simulators.SIMULATORS` by name, or "package.module:Class" (`timestep`, in seconds, is then that of the simulation),
        or a simulator itself. The `backend` "compiled" runs behaviors as Python code, where that can be, "interpreter" by the machine; the
        simulations are the same.

        `settled` is shown each time step (a `Moment`: poses, actions, events) when it has passed; a text that it gives ends the simulation in the
        next one, with the result "settled" and the text as its reason, if nothing else ends it. Requirements over time are judged as they stand
        then.
        """
        check_simulation_backend(backend)
        check_whole(("steps", steps, 0), ("seed", seed, None), ("index", index, 0), ("max_attempts", max_attempts, 1))
        self.rehearse()
        found = by_name(simulator, timestep) if isinstance(simulator, str) else simulator
        return sample_simulation(
            self.start, found, steps, seed, index, max_attempts=max_attempts, fuel=self.fuel,
            retry=self.readings["rejected-simulation"] == "retry", on_attempt=on_attempt, on_failed=on_failed, witnessed=witnessed,
            library=self.compiled if backend == "compiled" else None,
            next_scene=lambda first: self.next_scene(seed, index, first, max_attempts), settled=settled,
        )  # fmt: skip

    def next_scene(self, seed: int, index: int, first: int, max_attempts: int) -> NextScene | None:
        """Return the first attempt from number `first` on that gives scene `index`, by the batch backend; None if it cannot draw from the program.

        Raises the program's errors, and `AttemptsExhausted` if it is known that no scene is possible.
        """
        if self.impossible is not None:
            raise self.impossible
        if self.batch is None or self.in_parts:
            return None
        block = self.batch.block(seed, index, index + 1, max_attempts=max_attempts, first=first)
        if block.error is None:
            return NextScene(int(block.attempts[0]), block.stuck)
        if isinstance(block.error, AttemptsExhausted):
            return NextScene(max_attempts, block.stuck)
        raise block.error

    @cached_property
    def compiled(self) -> Library:
        """What is compiled of the behaviors so far."""
        return Library(self.readings)

    def simulate_many(
        self, n: int, *, simulator: str | Simulator = "still", steps: int = 100, seed: int = 0, start: int = 0, timestep: float | None = None,
        max_attempts: int = DEFAULT_ATTEMPTS, workers: int = 1, progress: Told | None = None, backend: SimulationBackend = "compiled",
    ) -> Iterator[SampledRun]:  # fmt: skip
        """Simulations `start` to `start + n - 1` of `seed`, in order: those of `simulate`, and of `scenic-ref simulate -n`, whoever runs them.

        `workers` processes run them (a script needs `if __name__ == "__main__":` then), each with a simulator of its own, which is given by its
        name. `progress(simulations, attempts)` is told how many there are so far. Errors are raised where one process would raise them.
        """
        check_whole(("n", n, 0), ("steps", steps, 0), ("seed", seed, None), ("start", start, 0))
        check_whole(("max_attempts", max_attempts, 1), ("workers", workers, 1))
        check_simulation_backend(backend)
        self.rehearse()
        which = SimulationRange(start, start + n, seed, steps, timestep, max_attempts, backend)
        return simulate_many(self, which, simulator, workers, progress)  # type: ignore[arg-type]

    def replay(
        self, record: Mapping[str, object] | Recording, simulator: str | Simulator = "still", *, timestep: float | None = None
    ) -> Simulated:
        """A simulation whose actions are those of `record`, a line of the simulation format as JSON; its time step is the recorded one by default.

        Raises `UsageError` if the record is not one of this program, or if its actions cannot be taken, `AttemptsExhausted` if it is rejected.
        """
        self.rehearse()
        return replayed(self, record, simulator, timestep)  # type: ignore[arg-type]

    def enumerate_simulations(
        self, simulator: str | Simulator = "still", steps: int = 10, *, timestep: float | None = None, max_runs: int = DEFAULT_RUNS
    ) -> Histories:  # fmt: skip
        """The exact distribution of simulations of at most `steps` time steps; see `inference.histories.enumerate_simulations`."""
        check_whole(("steps", steps, 0), ("max_runs", max_runs, 1))
        self.rehearse()
        found = by_name(simulator, timestep) if isinstance(simulator, str) else simulator
        return enumerate_simulations(self.start, found, steps, max_runs=max_runs, fuel=self.fuel)
