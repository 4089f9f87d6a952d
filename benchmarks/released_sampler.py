"""Draws scenes with a released Scenic in its own environment. This file runs there, alone: it imports nothing of scenic-ref.

    python released_sampler.py --version scenic
    python released_sampler.py PROGRAM WORLD SEED

The first prints {"version": ...}. The second compiles the program, prints {"prepare": seconds}, then answers each line of standard input, a number
of seconds, by {"scenes": ..., "attempts": ..., "seconds": ..., "peak": bytes}: what was drawn in about so many seconds of the processor.
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
        resource = importlib.import_module("resource")
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def main(program, world, seed, out):
    """Compile, then draw as long as is asked for."""
    scenic = importlib.import_module("scenic")
    numpy = importlib.import_module("numpy")
    modern = int(importlib.metadata.version("scenic").split(".")[0]) >= 3
    begun = time.process_time()
    scenario = scenic.scenarioFromFile(program, params={"world": world}, **({"mode2D": True} if modern else {}))
    print(json.dumps({"prepare": time.process_time() - begun}), file=out, flush=True)
    random.seed(seed)
    numpy.random.seed(seed)
    scenario.generate(maxIterations=MOST, verbosity=0)
    for line in sys.stdin:
        scenes = attempts = 0
        begun = time.process_time()
        while not scenes or time.process_time() - begun < float(line):
            _, iterations = scenario.generate(maxIterations=MOST, verbosity=0)
            scenes += 1
            attempts += iterations
        used = time.process_time() - begun
        print(json.dumps({"scenes": scenes, "attempts": attempts, "seconds": used, "peak": peak()}), file=out, flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "--version":
        print(json.dumps({"version": importlib.metadata.version(sys.argv[2])}))
    else:
        answers = os.fdopen(os.dup(1), "w")
        os.dup2(2, 1)  # what the program prints is not an answer
        main(sys.argv[1], sys.argv[2], int(sys.argv[3]), answers)
