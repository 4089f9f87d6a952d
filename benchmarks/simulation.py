"""Microseconds of the processor per agent-step with 2, 10 and 50 agents in each simulator, with simple and with nested behaviors, by each backend.

    python benchmarks/simulation.py [--steps N] [--repeat K] [--against NAME=PYTHON ...] [-o RESULT.json]

Turns of both backends, and of each released Scenic (the Python of its environment; still and kinematic only: its simulator in which nothing happens,
and its Newtonian one), alternate. Medians of K turns with the least and the most; also what the compiled policy and the simulator's own time step
take of a turn. At last the milliseconds until a simulation of one time step ends, of a scenario that was just loaded.
"""

from __future__ import annotations

import argparse
import gc
import json
import statistics
import subprocess
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import scenic_ref
from scenic_ref.benchmarks.results import print_head, print_row, save
from scenic_ref.simulators import by_name
from scenic_ref.simulators.behaviors.policy import CompiledPolicy

HEAD = """
from scenic.domains.driving.actions import *
class Car:
    width: 2
    length: 4.5
    speed: 0
    requireVisible: False
    allowCollisions: True
behavior Go(throttle=0.3):
    while True:
        take SetThrottleAction(throttle), SetSteerAction(0)
behavior Slow():
    take SetBrakeAction(0.5)
behavior Drive():
    try:
        do Go()
    interrupt when self.speed > 8:
        do Slow()
behavior Nested():
    try:
        do Drive()
    interrupt when simulation.currentTime > 1e6:
        abort
"""
SIMULATORS = ("still", "kinematic", "pymunk")
"""Those that need no map."""
BACKENDS = ("compiled", "interpreter")
RELEASED = Path(__file__).with_name("released_simulator.py")
BEHAVIORS = {"simple": "Go", "nested": "Nested"}


@contextmanager
def time_method(owner: Any, name: str) -> Iterator[Callable[[], float]]:
    """Measure the total time of calls of a method of this class or object, in seconds of the processor."""
    method = getattr(owner, name)
    spent = 0.0

    def measured(*arguments: object) -> object:
        nonlocal spent
        begun = time.process_time()
        try:
            return method(*arguments)
        finally:
            spent += time.process_time() - begun

    setattr(owner, name, measured)
    try:
        yield lambda: spent
    finally:
        setattr(owner, name, method)


class Row(NamedTuple):
    """Microseconds per agent-step: the median of the turns, the least and the most."""

    median: float
    least: float
    most: float

    def __str__(self) -> str:
        return f"{self.median:.1f} ({self.least:.1f} to {self.most:.1f})"


def row_of(seconds: Sequence[float], count: int) -> Row:
    """The seconds of some turns, each of `count` agent-steps."""
    each = [1e6 * s / count for s in seconds]
    return Row(*(round(x, 2) for x in (statistics.median(each), min(each), max(each))))


def measure_simulation(simulator: str, agents: int, behavior: str, steps: int, repeat: int, against: Mapping[str, str]) -> dict[str, object]:
    """One row of the table."""
    text = program(agents, behavior)
    scenario = scenic_ref.loads(text)
    turns: dict[str, list[float]] = {name: [] for name in ("compiled", "interpreter", *against)}
    policies: list[float] = []
    inside: list[float] = []
    for backend in BACKENDS:
        seconds_of(scenario, by_name(simulator), 5, backend)
    for _ in range(repeat):
        for backend in BACKENDS:
            alone = seconds_of(scenario, by_name(simulator), 0, backend)
            turns[backend].append(seconds_of(scenario, by_name(simulator), steps, backend) - alone)
        for name, python in against.items():
            done = subprocess.run([python, str(RELEASED), str(steps), simulator], input=text, check=True, capture_output=True, text=True)
            turns[name].append(json.loads(done.stdout))
        inner = by_name(simulator)
        with time_method(CompiledPolicy, "__call__") as policy, time_method(inner, "step") as inner_step:
            seconds_of(scenario, inner, 0, "compiled")
            alone = policy()
            seconds_of(scenario, inner, steps, "compiled")
            policies.append(policy() - 2 * alone)
            inside.append(inner_step())
    rows = {name: row_of(seconds, agents * steps) for name, seconds in turns.items()}
    others = [name for name in turns if name != "compiled"]
    ratios = {f"{name} / compiled": round(statistics.median(a / b for a, b in zip(turns[name], turns["compiled"])), 1) for name in others}
    return {
        "simulator": simulator, "behavior": behavior, "agents": agents, **{name: str(row) for name, row in rows.items()},
        "policy": str(row_of(policies, agents * steps)), "simulator's step": str(row_of(inside, agents * steps)), **ratios,
    }  # fmt: skip


def first_step(agents: int, behavior: str, repeat: int) -> dict[str, object]:
    """Until the first time step has passed: a scenario that was just loaded, the scene and one time step; milliseconds."""
    turns: dict[str, list[float]] = {backend: [] for backend in BACKENDS}
    for backend in BACKENDS * (1 + repeat):
        turns[backend].append(seconds_of(scenic_ref.loads(program(agents, behavior)), by_name("still"), 1, backend))
    rows = {backend: str(row_of(seconds[1:], 1000)) for backend, seconds in turns.items()}
    ratio = statistics.median(a / b for a, b in zip(*(turns[backend][1:] for backend in BACKENDS)))
    return {"behavior": behavior, "agents": agents, **rows, "compiled / interpreter": round(ratio, 2)}


def print_rows(rows: Iterable[dict[str, object]]) -> list[dict[str, object]]:
    """The rows of a table, each printed when it is there."""
    table: list[dict[str, object]] = []
    for row in rows:
        table.append(row)
        if len(table) == 1:
            print_head(list(row))
        print_row(list(row.values()))
    return table


def program(agents: int, behavior: str) -> str:
    """So many cars with a behavior."""
    return HEAD + "".join(f"{'ego = ' if k == 0 else ''}Car at ({5 * k}, 0), with behavior {BEHAVIORS[behavior]}\n" for k in range(agents))


def seconds_of(scenario: scenic_ref.Scenario, simulator: object, steps: int, backend: str) -> float:
    """The processor's seconds that a simulation takes."""
    gc.collect()  # what others left behind
    begun = time.process_time()
    scenario.simulate(simulator, steps, backend=backend)  # type: ignore[arg-type]
    return time.process_time() - begun


def main() -> None:
    """Measure, print a table, perhaps write JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("-o", type=Path, help="write the figures as JSON")
    parser.add_argument("--against", action="append", default=[], metavar="NAME=PYTHON", help="measure a released Scenic as well, by its Python")
    parser.add_argument("--simulators", nargs="+", default=list(SIMULATORS), choices=SIMULATORS)
    options = parser.parse_args()
    against = dict(one.split("=", 1) for one in options.against)
    rows = print_rows(
        measure_simulation(s, n, b, options.steps, options.repeat, against if s != "pymunk" else {})
        for s in options.simulators for b in BEHAVIORS for n in (2, 10, 50)
    )  # fmt: skip
    first = print_rows(first_step(n, b, 3 * options.repeat) for b in BEHAVIORS for n in (1, 2, 10))
    save(options.o, rows, steps=options.steps, first=first)


if __name__ == "__main__":
    main()
