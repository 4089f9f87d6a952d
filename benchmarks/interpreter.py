"""How fast the reference interpreter is: rules and attempts per second, attempts per scene, for every gallery program.

    python benchmarks/interpreter.py [-n SCENES] [-o RESULT.json]

One core, the interpreter alone, CPU seconds. Absolute figures depend on the machine; they are recorded for comparison with other
backends measured in the same run.
"""

from __future__ import annotations

import argparse
import json
import platform
import time
from pathlib import Path

import scenic_ref

EXAMPLES = Path(__file__).parent.parent / "examples" / "gallery"


def measure(path: Path, n: int) -> dict[str, object]:
    """CPU seconds, attempts and steps for `n` scenes of a program; loading and the rehearsal run are not counted."""
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
    print(f"{'program':28}{'seconds':>9}{'att/scene':>11}{'att/s':>9}{'steps/s':>10}{'scenes/s':>10}")
    for path in sorted(EXAMPLES.glob("*.scenic")):
        row = measure(path, options.n)
        rows.append(row)
        speeds = f"{row['attempts per second']:9}{row['steps per second']:10}{row['scenes per second']:10}"
        print(f"{row['program']:28}{row['seconds']:9}{row['attempts per scene']:11.2f}{speeds}")
    if options.o is not None:
        machine = {"python": platform.python_version(), "processor": platform.machine(), "version": scenic_ref.__version__}
        options.o.write_text(json.dumps({"machine": machine, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
