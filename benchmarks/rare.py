"""Scenes where few runs are accepted: independent draws for a second of the processor, by rejection, factorised rejection, splitting and chains.

    python benchmarks/rare.py [-n SCENES] [--repetitions R] [--only NAME ...] [-o RESULT.json]

Rejection is measured in runs per second (compiled, where it is), times the probability that splitting estimates: it would take hours. Draws are
worth what the report says (`ess.bulk`), over all seconds of the processor, compiling included.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.benchmarks.results import GALLERY, print_head, print_row, save
from scenic_ref.inference.result import Inferred

YARD = """
yard = PolygonalRegion([0@0, 14@0, 14@6, 6@6, 6@10, 0@10])
workspace = Workspace(yard)
def lorry():
    return Object in yard, facing Range(-10, 10) deg, with width {width}, with length {length}, with requireVisible False
ego = lorry()
for i in range(4):
    lorry()
"""
PLATOON = """
road = PolygonalRegion([0@0, 2.8@0, 2.8@60, 0@60])
workspace = Workspace(road)
ego = Object at Range(0, 2.8) @ 3, facing Range(-15, 15) deg, with width 2, with length 4.5, with viewDistance 200
last = ego
for i in range(4):
    last = Object at last offset by Range(-0.3, 0.3) @ Range(5, 8.5), facing Range(-15, 15) deg, with width 2, with length 4.5
"""
SOFT = """
xs = [Range(0, 1) for i in range(6)]
ego = Object at 0 @ 0, with requireVisible False
require[0.99999] xs[0] + xs[1] + xs[2] + xs[3] + xs[4] + xs[5] < 0.3
param x = xs[0]
"""
MARS = (GALLERY / "mars_bottleneck.scenic").read_text().replace("<= 10 deg", "<= 0.05 deg")
PROGRAMS = {
    "yard, 2.0 m x 4.5 m": YARD.format(width=2.0, length=4.5), "yard, 2.2 m x 4.8 m": YARD.format(width=2.2, length=4.8),
    "platoon on a narrow road": PLATOON, "bottleneck, within 0.05 deg": MARS, "soft requirement on a rare event": SOFT,
}  # fmt: skip
RUNS = 4_000_000
"""By which rejection is timed."""


def rejection(scenario: Scenario) -> float:
    """Runs for a second of the processor."""
    batch = scenario.batch
    assert batch is not None, scenario.not_lifted
    batch.compile()
    block = batch.block(0, 0, 1, max_attempts=10_000)
    begun = time.process_time()
    runs = 0
    for index in range(1, 1000):
        block = batch.block(0, index, index + 1, max_attempts=RUNS // 4)
        runs += block.runs
        if runs >= RUNS or time.process_time() - begun > 20:
            break
    return runs / (time.process_time() - begun)


def measure_pruned_rejection(scenario: Scenario) -> tuple[float, int]:
    """Scenes for a second of the processor with `--prune`, and how many there were; as many as come in about 20 seconds.

    A scene that takes too many attempts is given up, which does not change how often scenes come.
    """
    batch = scenario.pruned().batch
    assert batch is not None
    batch.compile()
    begun, found, index = time.process_time(), 0, 0
    while time.process_time() - begun < 20 and found < 1000:
        block = batch.block(1, index, index + 1, max_attempts=50_000)
        found, index = found + len(block.attempts), index + 1
    return found / (time.process_time() - begun), found


def measure_rare_event(name: str, text: str, n: int, repetitions: int) -> dict[str, object]:
    """One row of the table."""
    scenario = scenic_ref.loads(text)
    row: dict[str, object] = {"program": name}
    reports: dict[str, list[Inferred]] = {}
    for backend in ("smc", "mcmc"):
        reports[backend] = [scenario.infer(backend, n, seed) for seed in range(repetitions)]
        rates = [found.diagnosis.bulk / found.seconds for found in reports[backend]]
        row[f"{backend} /s"] = float(np.median(rates))
        row[f"{backend} doubts"] = sum(bool(found.doubts) for found in reports[backend])
    estimates = np.array([found.acceptance.estimate for found in reports["smc"]])
    row["acceptance"] = float(estimates.mean())
    row["intervals with it"] = sum(bool(f.acceptance.low <= estimates.mean() <= f.acceptance.high) for f in reports["smc"])
    row["runs /s"] = rejection(scenario)
    row["rejection /s"] = row["runs /s"] * row["acceptance"]  # type: ignore[operator]
    row["factorised /s"], row["factorised scenes"] = measure_pruned_rejection(scenario)
    row["smc : rejection"] = row["smc /s"] / row["rejection /s"]  # type: ignore[operator]
    row["mcmc : rejection"] = row["mcmc /s"] / row["rejection /s"]  # type: ignore[operator]
    row["seconds of smc"] = float(np.median([f.seconds for f in reports["smc"]]))
    row["seconds of mcmc"] = float(np.median([f.seconds for f in reports["mcmc"]]))
    return row


def main() -> None:
    """Measure all programs, print a table, perhaps write JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=1_000, help="scenes of each program")
    parser.add_argument("--repetitions", type=int, default=5, help="how often each backend runs, with other seeds")
    parser.add_argument("--only", nargs="*", default=[""], help="only programs whose names contain one of these")
    parser.add_argument("-o", type=Path, help="write the figures as JSON")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    for name, text in PROGRAMS.items():
        if any(part in name for part in options.only):
            rows.append(measure_rare_event(name, text, options.n, options.repetitions))
            if len(rows) == 1:
                print_head(list(rows[0]))
            print_row([f"{cell:.3g}" if isinstance(cell, float) else cell for cell in rows[-1].values()])
    save(options.o, rows, scenes=options.n, repetitions=options.repetitions)


if __name__ == "__main__":
    main()
