"""Agent-steps per second of the processor with 2, 10 and 50 agents in each simulator, with simple and with nested behaviors; the policy's share.

    python benchmarks/simulation.py [--steps N] [--repeat K] [-o RESULT.json]

The policy is what remains when the simulator's own calls are taken away. Medians of K turns.
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import scenic_ref
from scenic_ref.benchmarks.results import print_head, print_row, save
from scenic_ref.simulators import by_name
from scenic_ref.simulators.simulating import Simulator

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
BEHAVIORS = {"simple": "Go", "nested": "Nested"}


class Timed:
    """A simulator that adds up the seconds spent in it."""

    def __init__(self, inner: Simulator) -> None:
        self.inner, self.timestep, self.properties, self.random = inner, inner.timestep, inner.properties, inner.random
        self.seconds = 0.0

    def __getattr__(self, name: str) -> object:
        method = getattr(self.inner, name)

        def timed(*arguments: object) -> object:
            begun = time.process_time()
            try:
                return method(*arguments)
            finally:
                self.seconds += time.process_time() - begun

        return timed


def measure(simulator: str, agents: int, behavior: str, steps: int, repeat: int) -> dict[str, object]:
    """One row."""
    text = HEAD + "".join(f"{'ego = ' if k == 0 else ''}Car at ({5 * k}, 0), with behavior {BEHAVIORS[behavior]}\n" for k in range(agents))
    scenario = scenic_ref.loads(text)
    whole, inside = [], []
    for _ in range(repeat):
        timed = Timed(by_name(simulator))
        begun = time.process_time()
        scenario.simulate(timed, 0)  # type: ignore[arg-type]
        alone = time.process_time() - begun
        timed.seconds, begun = 0.0, time.process_time()
        scenario.simulate(timed, steps)  # type: ignore[arg-type]
        whole.append(time.process_time() - begun - alone)
        inside.append(timed.seconds)
    seconds, own = statistics.median(whole), statistics.median(inside)
    return {
        "simulator": simulator, "agents": agents, "behavior": behavior, "agent-steps per second": round(agents * steps / seconds),
        "microseconds of the simulator per agent-step": round(1e6 * own / (agents * steps), 1),
        "microseconds of the policy per agent-step": round(1e6 * (seconds - own) / (agents * steps), 1),
    }  # fmt: skip


def main() -> None:
    """Measure, print a table, perhaps write JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("-o", type=Path, help="write the figures as JSON")
    options = parser.parse_args()
    rows = [measure(s, n, b, options.steps, options.repeat) for s in SIMULATORS for b in BEHAVIORS for n in (2, 10, 50)]
    print_head(list(rows[0]))
    for row in rows:
        print_row(list(row.values()))
    save(options.o, rows, steps=options.steps)


if __name__ == "__main__":
    main()
