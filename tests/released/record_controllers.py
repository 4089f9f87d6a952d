"""What the controllers of the released driving library answer: `python tests/released/record_controllers.py PYTHON` asks a Python with a release.

It writes the record that `test_controllers.py` reads. The controllers are those that its Newtonian simulator gives to a car and to
a vehicle that is none, in time steps of 0.1 s (the only one of 2.1.0) and 0.25 s, and some that are made with gains of their own.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from scenic_ref.roads.map_generator import generate_map

RECORD = Path(__file__).parent / "controllers.json"
ERRORS = (0.0, 1.0, -0.5, 0.25, 3.0, 0.1, 0.1, -0.2, 0.05, -4.0, 0.3, 0.02, 0.4, 0.4, 0.4)
"""What the controllers are told, one after the other: m/s, or metres."""
OWN = (
    ("PIDLongitudinalController", {}), ("PIDLateralController", {}),
    ("PIDLongitudinalController", {"K_P": 0.02, "K_D": 0.01, "K_I": 0.05, "dt": 0.5}),
    ("PIDLateralController", {"K_P": 0, "K_D": 0, "K_I": 0.04, "dt": 8}),  # the sum of its errors becomes too large
)  # fmt: skip
"""Controllers by their classes and arguments."""
PROGRAM = """
model scenic.simulators.newtonian.driving_model
class Van(Vehicle):
    pass
behavior Ask():
    pairs = [simulation().getLaneFollowingControllers(self), simulation().getTurningControllers(self), simulation().getLaneChangingControllers(self)]
    print('TOLD', repr([[float(c.run_step(e)) for e in globalParameters.errors] for pair in pairs for c in pair]))
    take SetBrakeAction(1) if self.isCar else ()
ego = NEW KIND on road, with behavior Ask, with regionContainedIn None
"""
ASK = """
import importlib.metadata, json, random, sys, warnings
warnings.simplefilter("ignore")
import numpy, scenic
from scenic.domains.driving import controllers
road_map, folder, text, errors, own = json.loads(sys.argv[1])
three = not importlib.metadata.version("scenic").startswith("2")
for name, options in own:
    one = getattr(controllers, name)(**options)
    print('TOLD', repr([float(one.run_step(e)) for e in errors]))
for kind in ("Car", "Van"):
    with open(folder + "/program.scenic", "w") as file:
        file.write(text.replace("NEW ", "new " if three else "").replace("KIND", kind))
    random.seed(0)
    numpy.random.seed(0)
    params = {"map": road_map, "render": False, "use2DMap": True, "errors": errors}
    scenario = scenic.scenarioFromFile(file.name, params=params, **({"mode2D": True} if three else {}))
    scene, _ = scenario.generate(maxIterations=2000)
    for timestep in (0.1, 0.25) if three else (0.1,):
        try:
            scenario.getSimulator().simulate(scene, maxSteps=1, **({"timestep": timestep} if three else {}))
        except Exception as problem:
            print(problem, file=sys.stderr)
"""


def told(python: str) -> list[object]:
    """What the release says: of its own controllers, then of each kind of vehicle and time step."""
    with TemporaryDirectory() as folder:
        road_map = Path(folder, "map.xodr")
        road_map.write_text(generate_map("grid"), encoding="utf-8")
        question = json.dumps([str(road_map), folder, PROGRAM, ERRORS, OWN])
        run = subprocess.run([python, "-c", ASK, question], capture_output=True, text=True, env={**os.environ, "MPLCONFIGDIR": folder}, check=False)
        return [json.loads(line.removeprefix("TOLD ")) for line in run.stdout.splitlines() if line.startswith("TOLD ")]


if __name__ == "__main__":
    RECORD.write_text(json.dumps(told(sys.argv[1]), separators=(",", ":")) + "\n", encoding="utf-8")
