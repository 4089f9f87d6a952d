"""How many scenes `compare` needs to find small faults, and how often it raises a false alarm.

`python benchmarks/power.py power [FAULT]` and `nulls` print their measurements as JSON; docs/checking.md shows them. `unaided` is `power` with the
features of scenes alone, without those that the program suggests.
"""

from __future__ import annotations

import json
import math
import sys
import time
from functools import partial

import numpy as np
import scenic_ref
from scenic_ref.inference.comparison import compare
from scenic_ref.inference.comparison.known_features import Facts
from scenic_ref.inference.comparison.scene_columns import FeatureTable

VIEWER = "v = Point at (0, 0), with viewDistance {}\nego = Object at (0, 0), with viewDistance 40\nObject visible from v\n"
WRAP = (
    "ego = Object at (0, 0), facing 170 deg, with viewAngle 60 deg, with viewDistance 9\n"
    "v = (Range(-5, 5), Range(-5, -1))\nrequire {}\nego.v = v\n"
)
WIGGLE = "w = Range(-1, 1)\nego = Object at (0, w)\nObject at (3, {}), with requireVisible False\n"
PAIRS: dict[str, tuple[str, str, dict[str, str]]] = {
    "Range(-9.9, 9.9) for Range(-10, 10)": ("ego = Object at (Range(-10, 10), 0)\n", "ego = Object at (Range(-9.9, 9.9), 0)\n", {}),
    "view radius 29.8 for 30": (VIEWER.format(30), VIEWER.format(29.8), {}),
    "a forgotten resample": (WIGGLE.format("resample(w)"), WIGGLE.format("w"), {}),
    "a radius drawn uniformly": (
        "ego = Object in CircularRegion((0, 0), 10)\n", "ego = Object at (0, 0) offset along Range(0, 360) deg by (0, Range(0, 10))\n", {},
    ),
    "soft read the other way": (
        "x = Range(0, 1)\nrequire[0.5] x < 0.1\nego = Object with v x\n", "x = Range(0, 1)\nrequire[0.5] x < 0.1\nego = Object with v x\n",
        {"soft": "scene"},
    ),
    "a missing wrap-around": (
        WRAP.format("ego can see v"), WRAP.format("abs((angle from ego.position to v) - 170 deg) <= 30 deg"), {},
    ),
    "a coin of 0.51 for 0.5": ("ego = Object with v Discrete({1: 0.5, 2: 0.5})\n", "ego = Object with v Discrete({1: 0.51, 2: 0.49})\n", {}),
}
SQUARE = (
    "workspace = Workspace(RectangularRegion((0, 0), 0, 200, 200))\n"
    "ego = Object in RectangularRegion((0, 0), 0, {0}, {0}), with positionStdDev 0.5\nmutate\n"
)
"""A position that is mutated and must then lie in the workspace: drawn from all of it, or from a part as pruning would without the mutation."""
SECTOR = "ego = Object in SectorRegion((0, 0), 20, 0, 170 deg)\n"
PIECES = [math.radians(-85 + 17 * k) for k in range(11)]
POLYGON = f"ego = Object in PolygonalRegion([(0, 0), {', '.join(f'({20 * math.sin(a):.12f}, {20 * math.cos(a):.12f})' for a in PIECES)}])\n"
PAIRS |= {
    "a sector of 170 degrees drawn as its polygon": (SECTOR, POLYGON, {}),
    "mutated positions pruned as if they were not": (SQUARE.format(200), SQUARE.format(199), {}),
}
SEEDS = ((0, 1), (2, 3), (4, 5))
BUDGET = 1_000_000


def power(only: str = "", *, suggested: bool = True) -> dict[str, list[dict[str, object]]]:
    """Scenes of each side until each fault (or those whose name begins with `only`) is found, three times; `suggested`: with those of the program."""
    found: dict[str, list[dict[str, object]]] = {}
    for name, (right, wrong, readings) in PAIRS.items():
        if not name.startswith(only):
            continue
        found[name] = []
        for seeds in SEEDS:
            begun = time.process_time()
            scenario, facts = scenic_ref.loads(right), None if suggested else Facts()
            verdict = compare(scenic_ref.loads(wrong, readings=readings), scenario, seeds=seeds, budget=BUDGET, facts=facts)
            found[name].append(
                {
                    "verdict": verdict.kind, "scenes of each side": verdict.n + verdict.burned, "log10 evidence": round(verdict.evidence, 1),
                    "worst": verdict.worst, "seconds": round(time.process_time() - begun, 1),
                }
            )
            print(name, found[name][-1], file=sys.stderr, flush=True)
    return found


def nulls(count: int = 10_000, scenes: int = 1_600, alpha: float = 0.01) -> dict[str, object]:
    """False alarms in `count` comparisons of samples of one distribution."""
    source = np.random.Generator(np.random.Philox(2026))
    begun = time.process_time()
    alarms = sum(compare(_synthetic_scenes(source, scenes), _synthetic_scenes(source, scenes), alpha=alpha).kind == "different" for _ in range(count))
    seconds = round(time.process_time() - begun)
    return {"comparisons": count, "scenes of each side": scenes, "alpha": alpha, "false alarms": alarms, "seconds": seconds}


def _synthetic_scenes(source: np.random.Generator, n: int) -> FeatureTable:
    """Scenes with continuous, discrete, circular, dependent and rare features."""
    x, y, turn = source.random(n), source.normal(size=n), source.uniform(-math.pi, math.pi, n)
    columns = {
        "objects[0].position[0]": x, "objects[0].position[1]": x + 0.1 * y, "objects[0].heading": turn,
        "params.kind": np.floor(source.random(n) * 5), "params.rare": (source.random(n) < 0.01).astype(float),
        "attempts": source.geometric(0.3, n).astype(float),
    }
    return FeatureTable(columns, n)


if __name__ == "__main__":
    print(json.dumps({"power": power, "unaided": partial(power, suggested=False), "nulls": nulls}[sys.argv[1]](*sys.argv[2:]), indent=1))
