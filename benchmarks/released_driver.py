"""Simulates with a released Scenic in its own environment. This file runs there, alone: it imports nothing of scenic-ref.

    python released_driver.py PROGRAM STEPS SEED

It compiles the program, prints {"prepare": ...}, then answers each line of standard input, a number of seconds, by {"scenes": ..., "seconds": ...,
"peak": bytes}: how many time steps passed in simulations that took about so many seconds of the processor, in the Newtonian simulator. The scenes of
the simulations are drawn apart, and rejected simulations count for nothing.
"""

import importlib
import importlib.metadata
import json
import os
import random
import sys
import time

MOST = 100_000


def peak():
    """The most memory that this process has held, in bytes."""
    try:
        with open("/proc/self/status") as status:
            return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        return 0


def main(program, steps, seed, out):
    """Compile, then simulate as long as is asked for."""
    scenic = importlib.import_module("scenic")
    numpy = importlib.import_module("numpy")
    newtonian = importlib.import_module("scenic.simulators.newtonian")
    modern = int(importlib.metadata.version("scenic").split(".")[0]) >= 3
    begun = time.process_time()
    model = "scenic.simulators.newtonian.driving_model" if modern else "scenic.simulators.newtonian.model"
    scenario = scenic.scenarioFromFile(program, model=model, **({"mode2D": True} if modern else {}))
    simulator = newtonian.NewtonianSimulator(render=False)
    print(json.dumps({"prepare": time.process_time() - begun}), file=out, flush=True)
    random.seed(seed)
    numpy.random.seed(seed)
    for line in sys.stdin:
        passed, used = 0, 0.0
        while not passed or used < float(line):
            scene, _ = scenario.generate(maxIterations=MOST, verbosity=0)
            begun = time.process_time()
            simulation = simulator.simulate(scene, maxSteps=steps, maxIterations=1)
            took = time.process_time() - begun
            if simulation is not None:
                passed += len(simulation.result.trajectory) - 1
                used += took
        print(json.dumps({"scenes": passed, "seconds": used, "peak": peak()}), file=out, flush=True)


if __name__ == "__main__":
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the program prints is not an answer
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), answers)
