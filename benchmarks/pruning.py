"""Attempts per scene of the gallery, and on narrow roads: without pruning, with each technique alone, with the paper's four, with all.

    python benchmarks/pruning.py [-n SCENES] [-o RESULT.json]

The number of attempts does not depend on the machine; the figures of one seed have the standard error that is printed. `seconds` is what the
analysis itself takes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.benchmarks.narrow_maps import NARROW
from scenic_ref.benchmarks.results import gallery, print_head, print_row, save
from scenic_ref.inference.batch.block_rejection import Batch
from scenic_ref.inference.pruning import PAPER, TECHNIQUES, Pruning
from scenic_ref.inference.pruning.analysis import prune_recorded
from scenic_ref.inference.pruning.traced_points import record_points
from scenic_ref.semantics.machine.config import Config

CHOICES = {**{technique: (technique,) for technique in TECHNIQUES}, "the paper's": PAPER, "all": TECHNIQUES}
FUEL = 5_000_000


def attempts(start: Callable[[], Config], pruning: Pruning | None, n: int) -> tuple[float, float]:
    """The mean number of attempts per scene, and its standard error."""
    batch = Batch(start, fuel=FUEL, draws={} if pruning is None else pruning.draws)
    counts = np.asarray(batch.block(0, 0, n, max_attempts=10_000_000).attempts) + 1
    return float(counts.mean()), float(counts.std() / np.sqrt(n))


def measure_pruning(name: str, scenario: Scenario, n: int) -> dict[str, object]:
    """One row of the table."""
    recorded = record_points(scenario.start, FUEL)
    row: dict[str, object] = {"program": name, "scenes": n, "without": attempts(scenario.start, None, n)}
    seconds, report = 0.0, ""
    for choice, techniques in CHOICES.items():
        begun = time.process_time()
        pruning = prune_recorded(recorded, techniques)
        seconds = time.process_time() - begun
        report = str(pruning)
        row[choice] = attempts(scenario.start, pruning, n) if pruning.pruned else "off"
    row["seconds"] = round(seconds, 2)
    row["report"] = report.splitlines()
    return row


def format_mean(cell: object) -> str:
    """A mean with its standard error."""
    return f"{cell[0]:.4g} ± {cell[1]:.1g}" if isinstance(cell, tuple) else str(cell)


def main() -> None:
    """Measure all gallery programs, print a table, perhaps write JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=20_000, help="scenes per program")
    parser.add_argument("--slow", type=int, default=1_000, help="scenes of the bottleneck, whose attempts take longest")
    parser.add_argument("-o", type=Path, help="write the figures as JSON")
    options = parser.parse_args()
    columns = ["program", "without", *CHOICES, "seconds"]
    print_head(columns)
    rows = []
    programs = {path.stem: scenic_ref.load(path) for path in gallery()}
    programs |= {name: scenic_ref.loads(text) for name, text in NARROW.items()}
    for name, scenario in programs.items():
        rows.append(measure_pruning(name, scenario, options.slow if name == "mars_bottleneck" else options.n))
        print_row([format_mean(rows[-1][column]) for column in columns])
    save(options.o, rows)


if __name__ == "__main__":
    main()
