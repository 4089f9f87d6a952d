"""The command `scenic-ref simulate --replay`: it replays recorded simulations and compares the results with
the recording.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ..api import Scenario
from ..data.recording_reader import Recording, recording_from
from ..inference.simulation_rejection import SampledRun
from ..semantics.store.errors import AttemptsExhausted, SimulatorError, UsageError
from ..simulators import by_name
from ..simulators.protocol import Simulator
from ..simulators.replay import Difference, difference_of


def recordings_in(path: str) -> Iterator[tuple[int, Recording]]:
    """The simulations of a file, each with its line number. Raises `UsageError` with the line that is not one."""
    try:
        with open(path, "rb") as file:
            for number, line in enumerate(file, 1):
                try:
                    yield number, recording_from(line)
                except UsageError as problem:
                    raise at_line(problem, path, number) from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None


def check_recordings(path: str) -> int:
    """How many simulations are in a file; all are checked before anything is written. Raises `UsageError`."""
    if Path(path).exists() and not Path(path).is_file():
        raise UsageError(f"{path} cannot be replayed: it is not an ordinary file")
    count = sum(1 for _ in recordings_in(path))
    if not count:
        raise UsageError(f"{path} holds no simulations")
    return count


def at_line(problem: UsageError, path: str, number: int) -> UsageError:
    """The problem with its place."""
    return UsageError(f"{path}, line {number}: {problem.message}", hint=problem.hint)


class NotPlayed(NamedTuple):
    """The line of a recording whose replay ended otherwise than the recording, in which time step, and why."""

    line: int
    step: int | None
    reason: str


class Replays:
    """Replays the simulations of a file in a simulator, and remembers what differs, and what the simulator rejected or ended before its time."""

    def __init__(self, path: str, scenario: Scenario, name: str, timestep: float | None, simulator: Simulator) -> None:
        self.path, self.scenario, self.name, self.timestep, self.simulator = path, scenario, name, timestep, simulator
        self.equal = 0
        self.different: list[tuple[int, Difference]] = []
        self.rejected: list[NotPlayed] = []
        self.ended: list[NotPlayed] = []

    def __iter__(self) -> Iterator[SampledRun]:
        """The replays, one after the other. Raises `UsageError` with the line of the recording, and the simulator's errors."""
        for number, recording in recordings_in(self.path):
            try:
                simulation = self.scenario.replay(recording, self.simulator_for(recording))
            except AttemptsExhausted as problem:
                self.rejected.append(NotPlayed(number, None, problem.message))
                continue
            except UsageError as problem:
                raise at_line(problem, self.path, number) from None
            except SimulatorError as problem:
                raise SimulatorError(f"{self.path}, line {number}: {problem.message}", problem.span) from problem
            difference = difference_of(recording, simulation)
            steps = len(simulation.moments) - 1
            if steps < len(recording.steps) - 1:
                self.ended.append(NotPlayed(number, steps, simulation.reason))
            if difference is not None:
                self.different.append((number, difference))
            elif steps == len(recording.steps) - 1:
                self.equal += 1
            yield SampledRun(simulation, recording.attempts, Counter())

    def simulator_for(self, recording: Recording) -> Simulator:
        """The simulator, with the time step of the recording unless another was asked for. Raises `UsageError`."""
        if self.timestep is None and self.simulator.timestep != recording.timestep:
            self.simulator = by_name(self.name, recording.timestep)
        return self.simulator

    def check_any(self) -> None:
        """Raise `AttemptsExhausted` if the simulator rejected all."""
        if self.rejected and not self.equal and not self.different and not self.ended:
            first = self.rejected[0]
            raise AttemptsExhausted(f"{self.name} rejected all simulations of {self.path}: {first.reason}", attempts=len(self.rejected), stuck=())

    def lines(self, seconds: float) -> list[str]:
        """How many were equal, and which differs most."""
        count = len(self.rejected) + len({*(one.line for one in self.ended), *(line for line, _ in self.different)}) + self.equal
        runs = "1 simulation" if count == 1 else f"{count:,} simulations"
        found = [f"{runs} of {self.path} replayed in {self.name}, {seconds:.1f} s"]
        if self.rejected:
            found.append(f"rejected, and left out: {len(self.rejected):,}, first that of line {self.rejected[0].line}: {self.rejected[0].reason}")
        if self.ended:
            first = self.ended[0]
            found.append(
                f"ended by the simulator before the recording: {len(self.ended):,}, "
                f"first that of line {first.line}, after {first.step} time steps: {first.reason}"
            )
        if self.equal == count:
            return [*found, "all states are equal to the recorded ones"]
        found.append(f"with the recorded states in all time steps: {self.equal:,} of {count:,}")
        if not self.different:
            return found
        number, worst = max(self.different, key=lambda one: one[1].distance)
        where = f"object {worst.object} in line {number}, which differs from time step {worst.first} on"
        return [*found, f"the largest distance is {worst.distance:.3g} m ({where})"]
