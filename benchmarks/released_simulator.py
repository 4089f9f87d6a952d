"""Run by the Python of a released Scenic: agent-steps per second of the processor in its simulator in which nothing happens.

    python released_simulator.py "AGENTS BEHAVIOR STEPS REPEAT" ...

Each request is answered by a line of JSON: the seconds of each turn, those of a simulation without time steps taken away.
"""

from __future__ import annotations

import json
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
HEAD = """
from actions_of_benchmark import *
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
    interrupt when simulation().currentTime > 1e6:
        abort
"""


def main() -> None:
    """Answer the requests."""
    folder = tempfile.mkdtemp()
    (Path(folder) / "actions_of_benchmark.py").write_text(ACTIONS)
    sys.path.insert(0, folder)
    import scenic  # pyright: ignore[reportMissingImports]
    from scenic.core.simulators import DummySimulator  # pyright: ignore[reportMissingImports]

    newer = not hasattr(scenic.syntax.translator, "constructorStatements")
    for request in sys.argv[1:]:
        agents, behavior, steps, repeat = request.split()
        text = HEAD + "".join(
            f"{'ego = ' if k == 0 else ''}{'new ' if newer else ''}Car at {5 * k} @ 0, with behavior {behavior}()\n" for k in range(int(agents))
        )
        scene, _ = scenic.scenarioFromString(text, **({"mode2D": True} if newer else {})).generate()
        simulator = DummySimulator()

        def seconds(count: int, scene: object = scene, simulator: object = simulator) -> float:
            begun = time.process_time()
            simulator.simulate(scene, maxSteps=count, maxIterations=1)  # type: ignore[attr-defined]
            return time.process_time() - begun

        seconds(1)
        print(json.dumps([seconds(int(steps)) - seconds(1) for _ in range(int(repeat))]), flush=True)


if __name__ == "__main__":
    main()
