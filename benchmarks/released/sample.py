"""Measures a released Scenic 3 in its own environment: python sample.py PROGRAM WORLD SECONDS [SEED].

Prints a JSON object: scenes and attempts in about so many seconds of CPU time, and the seconds that compiling took. This file
imports nothing of scenic-ref.
"""

import json
import random
import sys
import time

import numpy
import scenic


def main(program, world, seconds, seed=1):
    """Draw scenes until the time is over."""
    begun = time.process_time()
    scenario = scenic.scenarioFromFile(program, mode2D=True, params={"world": world})
    compiled = time.process_time() - begun
    random.seed(seed)
    numpy.random.seed(seed)
    scenes = attempts = 0
    begun = time.process_time()
    while time.process_time() - begun < seconds:
        _, iterations = scenario.generate(maxIterations=100_000, verbosity=0)
        scenes += 1
        attempts += iterations
    used = time.process_time() - begun
    print(json.dumps({"scenes": scenes, "attempts": attempts, "seconds": used, "compile": compiled}))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]), *map(int, sys.argv[4:]))
