"""`simulate_many`: the simulations of `scenic-ref simulate -n`, by one process or several."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.cli import run_command_line
from scenic_ref.data.simulation import to_line
from scenic_ref.errors import AttemptsExhausted, UncaughtException, UsageError
from scenic_ref.inference import simulation_rejection
from scenic_ref.simulators import by_name

PROGRAM = """from scenic.domains.driving.actions import *
behavior Drive():
    take SetThrottleAction(Uniform(0.25, 0.5, 1))
    while True:
        wait
ego = Object at 0 @ Range(0, 10), with behavior Drive, with drives True
require always ego.position.y < 12
record ego.speed as speed
"""
FAILING = f"""{PROGRAM}behavior Stop(when):
    while simulation().currentTime < when:
        wait
    x = 1 / 0
    wait
Object at 50 @ 0, with behavior Stop(Uniform(*range(3, 40))), with drives True, with requireVisible False
"""


def scenario(text: str = PROGRAM, **more: object) -> scenic_ref.Scenario:
    return scenic_ref.loads(text, dialect="scenic-2.1", profile="scenic-2.1", **more)  # type: ignore[arg-type]


@pytest.mark.slow
def test_they_are_those_of_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same lines, byte for byte, with rejected attempts on the way; and the same ones by two processes."""
    monkeypatch.chdir(tmp_path)
    Path("p.scenic").write_text(PROGRAM)
    options = ("--simulator", "kinematic", "--steps", "20", "--seed", "4", "--dialect", "scenic-2.1", "--profile", "scenic-2.1")
    assert run_command_line(["simulate", "p.scenic", "-n", "7", "-o", "runs.jsonl", *options]) == 0
    written = Path("runs.jsonl").read_text().splitlines()
    told: list[tuple[int, int]] = []
    program = scenic_ref.load("p.scenic", dialect="scenic-2.1", profile="scenic-2.1")
    for workers in (1, 2):
        found = program.simulate_many(
            7, simulator="kinematic", steps=20, seed=4, workers=workers, progress=lambda done, attempts: told.append((done, attempts))
        )
        runs = list(found)
        assert [to_line(run.simulation, run.attempts).strip() for run in runs] == written
        assert [done for done, _ in told] == list(range(1, 8))
        assert told[-1][1] == sum(run.attempts for run in runs) > 7
        assert sum(sum(run.stuck.values()) for run in runs) == told[-1][1] - 7
        told.clear()


def test_they_can_begin_later_and_in_a_simulator_that_is_there() -> None:
    program = scenario()
    runs = program.simulate_many(2, simulator=by_name("kinematic", 0.2), steps=3, start=5)
    alone = [program.simulate("kinematic", 3, 0, index, timestep=0.2) for index in (5, 6)]
    assert [run.simulation.moments for run in runs] == [run.simulation.moments for run in alone]


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_comes_after_the_simulations_before_it(workers: int) -> None:
    program = scenario(FAILING)
    found = program.simulate_many(40, simulator="kinematic", steps=10, seed=1, start=7, workers=workers)
    done: list[object] = []
    with pytest.raises(UncaughtException, match="division by zero") as told:
        done.extend(found)
    assert told.value.span.line == 12
    assert 4 < len(done) < 40
    with pytest.raises(UncaughtException):
        program.simulate("kinematic", 10, 1, 7 + len(done))


def test_what_cannot_be_is_said_before_anything_runs() -> None:
    program = scenario()
    with pytest.raises(UsageError, match="other processes make their own simulators"):
        program.simulate_many(3, simulator=by_name("still"), workers=2)
    with pytest.raises(UsageError, match="no simulator carla"):
        program.simulate_many(3, simulator="carla", workers=2)
    with pytest.raises(UsageError, match="workers is a whole number of at least 1"):
        program.simulate_many(3, workers=0)
    assert list(program.simulate_many(0)) == []


SELDOM = """
behavior Go():
    require Range(0, 1) < 0.5
    take Range(0, 1)
x = Range(0, 1)
ego = Object at (x, 0), with behavior Go()
require x < 0.002
"""
"""A scene in 500 attempts, and every other one of its simulations is rejected."""


@pytest.mark.parametrize("reading", ["discard", "retry"])
def test_scenes_of_simulations_that_columns_find_are_those_of_the_machine(reading: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def runs(patience: int) -> list[tuple[object, ...]]:
        monkeypatch.setattr(simulation_rejection, "PATIENCE", patience)
        scenario = scenic_ref.loads(SELDOM, readings={"rejected-simulation": reading})
        told: list[int] = []
        found = [scenario.simulate("still", 2, 3, index, on_attempt=told.append) for index in range(3)]
        return [(run.attempts, run.stuck, str(run.simulation)) for run in found] + [(len(told), max(told))]

    one_by_one, by_columns = runs(10**9), runs(20)
    assert one_by_one == by_columns
    assert max(attempts for attempts, *_ in one_by_one) > 300


def test_a_simulation_without_a_scene_is_given_up_after_as_many_attempts(monkeypatch: pytest.MonkeyPatch) -> None:
    def error(patience: int) -> tuple[object, ...]:
        monkeypatch.setattr(simulation_rejection, "PATIENCE", patience)
        with pytest.raises(AttemptsExhausted) as found:
            scenic_ref.loads(SELDOM.replace("0.002", "0.0000001")).simulate("still", 2, 3, max_attempts=700)
        return found.value.message, found.value.attempts, found.value.stuck

    assert error(10**9) == error(20)
