"""What `scenic-ref simulate --replay` does: it plays recorded simulations again, and compares the results with the recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from ..formats.recorded import Recording, recording_from
from ..inference.simulation import SampledRun
from ..scenario import Scenario
from ..semantics.kernel.errors import SimulatorError, UsageError
from ..simulators import by_name
from ..simulators.replays import Difference, difference_of


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


class Replays:
    """Replays the simulations of a file in a simulator, and remembers what differs."""

    def __init__(self, path: str, scenario: Scenario, simulator: str, timestep: float | None) -> None:
        self.path, self.scenario, self.simulator, self.timestep = path, scenario, simulator, timestep
        self.equal = 0
        self.different: list[tuple[int, Difference]] = []

    def __iter__(self) -> Iterator[SampledRun]:
        """The replays, one after the other. Raises `UsageError` with the line of the recording, and the simulator's errors."""
        for number, recording in recordings_in(self.path):
            simulator = by_name(self.simulator, recording.timestep if self.timestep is None else self.timestep)
            try:
                simulation = self.scenario.replay(recording, simulator)
            except UsageError as problem:
                raise at_line(problem, self.path, number) from None
            except SimulatorError as problem:
                raise SimulatorError(f"{self.path}, line {number}: {problem.message}", problem.span) from problem
            difference = difference_of(recording, simulation)
            if difference is None:
                self.equal += 1
            else:
                self.different.append((number, difference))
            yield SampledRun(simulation, recording.attempts, Counter())

    def lines(self, seconds: float) -> list[str]:
        """How many were equal, and which differs most."""
        count = self.equal + len(self.different)
        runs = "1 simulation" if count == 1 else f"{count:,} simulations"
        found = [f"{runs} of {self.path} replayed in {self.simulator}, {seconds:.1f} s"]
        if not self.different:
            return [*found, "all states are equal to the recorded ones"]
        number, worst = max(self.different, key=lambda one: one[1].distance)
        where = f"object {worst.object} in line {number}, which differs from time step {worst.first} on"
        return [*found, f"the states of {self.equal:,} are equal to the recorded ones", f"the largest distance is {worst.distance:.3g} m ({where})"]
