"""How fast the reference interpreter is: rules and attempts per second, attempts per scene, for every gallery program.

    python benchmarks/interpreter.py [-n SCENES] [-o RESULT.json]

The interpreter alone, on one core, in seconds of the processor. Absolute figures depend on the machine: compare those of one run.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import scenic_ref
from scenic_ref.benchmarks.results import gallery, print_head, print_row, save


def measure_interpreter(path: Path, n: int) -> dict[str, object]:
    """Seconds of the processor, attempts and steps for `n` scenes of a program; loading and the rehearsal run are not counted."""
    scenario = scenic_ref.load(path)
    scenario.sampled(seed=0, index=n)
    begun = time.process_time()
    attempts = steps = 0
    for index in range(n):
        sampled = scenario.sampled(seed=0, index=index)
        attempts += sampled.scene.attempts
        steps += sampled.steps
    seconds = time.process_time() - begun
    return {
        "program": path.stem, "scenes": n, "seconds": round(seconds, 3), "attempts per scene": attempts / n,
        "attempts per second": round(attempts / seconds, 1), "steps per second": round(steps / seconds), "scenes per second": round(n / seconds, 2),
    }


def main() -> None:
    """Measure all gallery programs, print a table, perhaps write JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-n", type=int, default=100, help="scenes per program")
    parser.add_argument("-o", type=Path, help="write the figures as JSON")
    options = parser.parse_args()
    rows = []
    for path in gallery():
        rows.append(measure_interpreter(path, options.n))
        if len(rows) == 1:
            print_head(list(rows[0]))
        print_row(list(rows[-1].values()))
    save(options.o, rows)


if __name__ == "__main__":
    main()
