"""What a release makes of `examples/driving`: `python tests/released/record_driving.py scenic-3 PYTHON [--map FILE.xodr]` asks a Python with it.

It writes the record that `test_driving_examples.py` reads. With `--map` it writes nothing and compares on another map instead, with figures.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from scenic_ref.roads.map_generator import generate_map
from scenic_ref.simulators.worlds.driving import DEFAULT

sys.path.insert(0, str(Path(__file__).parent))
from test_driving_examples import HERE, PROGRAMS, SCENES, STEPS, compared, in_dialect

ASK = """
import importlib.metadata, json, random, signal, sys, warnings
warnings.simplefilter("ignore")
import numpy, scenic
road_map, scenes, steps, file = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
three = not importlib.metadata.version("scenic").startswith("2")
random.seed(0)
numpy.random.seed(0)
params = {"map": road_map, "render": False, "use2DMap": True}
signal.alarm(200)
try:
    scenario = scenic.scenarioFromFile(file, params=params, model="scenic.simulators.newtonian.driving_model", **({"mode2D": True} if three else {}))
    drawn = [scenario.generate(maxIterations=20_000)[0] for _ in range(scenes)]
    simulator, done, k = scenario.getSimulator(), None, 0
    while done is None:
        done, k = simulator.simulate(drawn[k], maxSteps=steps), k + 1
    objects = [[[round(float(n), 2) for n in (o.position.x, o.position.y, o.heading)] for o in scene.objects] for scene in drawn]
    print(json.dumps({"verdict": "ok", "objects": objects, "end": done.result.terminationType.name, "steps": len(done.result.trajectory) - 1}))
except Exception as problem:
    print(json.dumps({"verdict": "error", "message": f"{type(problem).__name__}: {problem}"[:200]}))
"""


def asked(dialect: str, python: str, road_map: Path) -> dict[str, dict[str, object]]:
    """What the release says of each program, in a process of its own."""
    told = {}
    with TemporaryDirectory() as folder:
        for program in PROGRAMS:
            file = Path(folder, program.name)
            file.write_text(in_dialect(program, dialect), encoding="utf-8")
            command = [python, "-c", ASK, str(road_map), str(SCENES), str(STEPS), str(file)]
            run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "MPLCONFIGDIR": folder}, check=False)
            answer = run.stdout.splitlines()[-1:] or ['{"verdict": "error", "message": "it took too long, or crashed"}']
            told[program.stem] = json.loads(answer[0])
            print(program.stem, told[program.stem]["verdict"], told[program.stem].get("message", ""), flush=True)
    return told


def main() -> int:
    """Write the record, or compare on another map; the exit code."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dialect")
    parser.add_argument("python")
    parser.add_argument("--map", type=Path)
    options = parser.parse_args()
    with TemporaryDirectory() as folder:
        road_map = options.map or Path(folder, "map.xodr")
        if options.map is None:
            road_map.write_text(generate_map("grid", **DEFAULT), encoding="utf-8")
        told = asked(options.dialect, options.python, road_map)
        if options.map is None:
            (HERE / f"driving-{options.dialect}.json").write_text(json.dumps(told, separators=(",", ":")) + "\n", encoding="utf-8")
            return 0
        for program in PROGRAMS:
            print(program.stem, compared(program, options.dialect, told[program.stem], str(road_map)))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
