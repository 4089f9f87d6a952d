"""scenic-ref by its other backends as an implementation under test: by columns, compiled by numba, over time by compiled behaviors.

    scenic-ref fuzz --impl "python $PWD/tests/conformance/other_backends.py" --seconds 60 --time 2h -o campaign

is a campaign against ourselves. What these draw is also compared with what the readable machine draws of the same seed, and with the exact
distribution where there is one; a difference is a crash, in its own words.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from zlib import crc32

from scenic_ref.api import Scenario
from scenic_ref.conformance import Ourselves
from scenic_ref.conformance.implementations.harness_server import serve
from scenic_ref.conformance.implementations.protocol import SceneRecord, SimulationRecord, Task
from scenic_ref.conformance.implementations.reference import load_task, translate_errors
from scenic_ref.conformance.recorded_world import RecordedWorld, World
from scenic_ref.data.simulation import to_json
from scenic_ref.inference.batch import block_rejection
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.testing import same_distribution
from scenic_ref.testing.judge import enumerate_if_small

COMPILED = 4
"""One program of so many is compiled by numba, at once; the others are drawn on columns."""
REPLAYED = 12
FOR_LAW = 600
ALPHA = 1e-9
"""The risk of a false alarm in each program."""


class Differs(Exception):
    """Two of our backends do not say the same."""


class OtherBackends(Ourselves):
    """What does not come from the readable machine; it keeps the last program, and whether its scenes were compared."""

    name = Ourselves.name.replace(" ", " by other backends ", 1)

    def __init__(self) -> None:
        self.last: tuple[str, Scenario, bool] | None = None

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        """By the batch backend, where it can; as soon as many are asked for, some are compared."""
        block_rejection.COMPILE_LEAST = -1e9 if crc32(task.program.encode()) % COMPILED == 0 else 1e9
        with translate_errors():
            if self.last is None or self.last[0] != repr(task):
                self.last = repr(task), load_task(task), False
            name, scenario, compared = self.last
            found = [scene.to_json() for scene in scenario.sample_many(count, seed, max_attempts=attempts, backend="batch")]
            if count >= REPLAYED and not compared:
                self.last = name, scenario, True
                same_scenes(load_task(task), found[:REPLAYED], seed, attempts)
                same_law(scenario, seed + 1, attempts)
            yield from found

    def simulations(
        self, task: Task, steps: int, count: int, *, seed: int, attempts: int, world: World | None = None
    ) -> Iterator[SimulationRecord]:  # fmt: skip
        """With compiled behaviors; the first ones are compared."""
        with translate_errors():
            scenario, machine = load_task(task), load_task(task)
            for index in range(count):
                compiled = scenario.simulate(RecordedWorld(world or ()), steps, seed, index, max_attempts=attempts)
                found = to_json(compiled.simulation, compiled.attempts)
                if index < REPLAYED:
                    run = machine.simulate(RecordedWorld(world or ()), steps, seed, index, max_attempts=attempts, backend="interpreter")
                    if repr(to_json(run.simulation, run.attempts)) != repr(found):
                        raise Differs(f"simulation {index} of seed {seed} is another one than the machine's")
                yield found


def same_scenes(machine: Scenario, found: Sequence[SceneRecord], seed: int, attempts: int) -> None:
    """Raises `Differs` where the readable machine draws other scenes."""
    for index, scene in enumerate(found):
        try:
            drawn = machine.sample(seed, index, max_attempts=attempts).to_json()
        except AttemptsExhausted:
            drawn = None
        if repr(drawn) != repr(scene):
            raise Differs(f"scene {index} of seed {seed} is another one than the machine's")


def same_law(scenario: Scenario, seed: int, attempts: int) -> None:
    """Raises `Differs` where scenes of the batch backend are not distributed as enumeration says, of a program that both can do."""
    if scenario.not_lifted is not None or enumerate_if_small(scenario) is None:
        return
    with suppress(AttemptsExhausted):
        scenes = scenario.sample_many(FOR_LAW, seed, max_attempts=attempts, backend="batch")
        verdict = same_distribution(scenes, scenario, alpha=ALPHA)
        if verdict.kind == "different":
            raise Differs(f"scenes are not distributed as enumeration says: {verdict.worst}")


if __name__ == "__main__":
    serve(OtherBackends())
