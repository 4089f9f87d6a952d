"""Run by the Python of a released Scenic: the processor's seconds of a simulation, in its simulator in which nothing happens or its Newtonian one.

    python released_simulator.py STEPS still|kinematic < PROGRAM

A line of JSON: the seconds of so many time steps, those of a simulation of a single one taken away. The text is in our syntax.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

ACTIONS = '''
from scenic.core.simulators import Action
class SetThrottleAction(Action):
    def __init__(self, throttle): self.throttle = throttle
    def applyTo(self, obj, simulation): obj.throttle = self.throttle
class SetSteerAction(Action):
    def __init__(self, steer): self.steer = steer
    def applyTo(self, obj, simulation): obj.steer = self.steer
class SetBrakeAction(Action):
    def __init__(self, brake): self.brake = brake
    def applyTo(self, obj, simulation): obj.brake = self.brake
'''
"""The names that the program takes from the driving library, which needs a map there; they set what the Newtonian simulator reads."""
CONTROLS = "class Car:\n    isCar: True\n    throttle: 0\n    brake: 0\n    steer: 0\n    hand_brake: 0\n    reverse: 0"
"""What its cars have."""


def newtonian() -> Any:
    """The simulator of vehicles without forces between them, which shows nothing."""
    from scenic.simulators.newtonian import NewtonianSimulator  # pyright: ignore[reportMissingImports]

    return NewtonianSimulator(render=False)


def main() -> None:
    """Run the program as a process of the benchmark."""
    folder = tempfile.mkdtemp()
    (Path(folder) / "actions_of_benchmark.py").write_text(ACTIONS)
    sys.path.insert(0, folder)
    import scenic  # pyright: ignore[reportMissingImports]
    from scenic.core.simulators import DummySimulator  # pyright: ignore[reportMissingImports]

    newer = not hasattr(scenic.syntax.translator, "constructorStatements")
    text = sys.stdin.read().replace("from scenic.domains.driving.actions", "from actions_of_benchmark").replace("simulation.", "simulation().")
    text = re.sub(r"\bCar at \((\d+), (\d+)\)", rf"{'new ' if newer else ''}Car at \1 @ \2", text)
    text = re.sub(r"(with behavior \w+)$", r"\1()", text, flags=re.MULTILINE)
    text = text.replace("class Car:", CONTROLS)
    scene, _ = scenic.scenarioFromString(text, **({"mode2D": True} if newer else {})).generate()
    simulator = newtonian() if sys.argv[2] == "kinematic" else DummySimulator()

    def seconds(count: int) -> float:
        begun = time.process_time()
        simulator.simulate(scene, maxSteps=count, maxIterations=1)
        return time.process_time() - begun

    seconds(1)
    print(json.dumps(seconds(int(sys.argv[1])) - seconds(1)))


if __name__ == "__main__":
    main()
