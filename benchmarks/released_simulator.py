"""Run by the Python of a released Scenic: agent-steps per second of the processor in its simulator in which nothing happens.

    python released_simulator.py STEPS < PROGRAM

A line of JSON: the seconds of so many time steps, those of a simulation of a single one taken away. The text is in our syntax.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
import time
from pathlib import Path

ACTIONS = '''
from scenic.core.simulators import Action
class SetThrottleAction(Action):
    def __init__(self, throttle): self.throttle = throttle
    def applyTo(self, obj, simulation): pass
class SetSteerAction(Action):
    def __init__(self, steer): self.steer = steer
    def applyTo(self, obj, simulation): pass
class SetBrakeAction(Action):
    def __init__(self, brake): self.brake = brake
    def applyTo(self, obj, simulation): pass
'''
"""The names that the program takes from the driving library; here they do nothing."""


def main() -> None:
    """Run the program."""
    folder = tempfile.mkdtemp()
    (Path(folder) / "actions_of_benchmark.py").write_text(ACTIONS)
    sys.path.insert(0, folder)
    import scenic  # pyright: ignore[reportMissingImports]
    from scenic.core.simulators import DummySimulator  # pyright: ignore[reportMissingImports]

    newer = not hasattr(scenic.syntax.translator, "constructorStatements")
    text = sys.stdin.read().replace("from scenic.domains.driving.actions", "from actions_of_benchmark").replace("simulation.", "simulation().")
    text = re.sub(r"\bCar at \((\d+), (\d+)\)", rf"{'new ' if newer else ''}Car at \1 @ \2", text)
    text = re.sub(r"(with behavior \w+)$", r"\1()", text, flags=re.MULTILINE)
    scene, _ = scenic.scenarioFromString(text, **({"mode2D": True} if newer else {})).generate()
    simulator = DummySimulator()

    def seconds(count: int) -> float:
        begun = time.process_time()
        simulator.simulate(scene, maxSteps=count, maxIterations=1)
        return time.process_time() - begun

    seconds(1)
    print(json.dumps(seconds(int(sys.argv[1])) - seconds(1)))


if __name__ == "__main__":
    main()
