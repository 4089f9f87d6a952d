"""A released Scenic as its users run it, in the words of the harness protocol: by its API, or by its command line.

    PYTHON tools/release_by_its_defaults.py api
    PYTHON tools/release_by_its_defaults.py command-line

Where `conformance/implementations/adapters/released.py` says how many attempts a scene or simulation may take, here nothing is said: each function
has the defaults of the release. The command line is the real code of `python -m scenic`; only its simulator is replaced, by one that
records, and the window in which it shows a scene.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import os
import runpy
import sys
from contextlib import suppress
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "conformance" / "implementations" / "adapters"))
os.environ["MPLBACKEND"] = "svg"  # the command line refuses to run under `agg`, though nothing is drawn

import matplotlib.pyplot  # noqa: F401
import released
from scenic.core.distributions import RejectionException
from scenic.core.scenarios import Scenario, Scene

write_and_compile = released.compile_program


class Enough(BaseException):
    """As many scenes were shown as are wanted; the command line has no end of its own."""


def sample_by_api(request, say):
    """As many scenes as are wanted, each by a call without arguments."""
    released.seeded(request)
    for number in range(request["count"]):
        scene, attempts = released.compiled[0].generate()
        say({"answer": "scene", "scene": released.scene_json(scene, request["seed"], number, attempts)})
    return {"answer": "done"}


def simulate_by_api(request, say):
    """As many simulations as are wanted; after a call that returns none, a user draws a new scene."""
    released.seeded(request)
    simulator = recording(request, say)
    for _ in range(request["count"]):
        run = None
        while run is None:
            scene, _ = released.compiled[0].generate()
            run = simulator.simulate(scene, maxSteps=request["steps"])
    return {"answer": "done"}


def recording(request, say):
    """A simulator that says what it simulates; it raises `RejectionException` after as many rejections as there may be attempts."""
    world, rejected = released.world_of(request.get("world")), 0
    simulate = world.simulate

    def recorded(scene, **options):
        nonlocal rejected
        told = released.scene_json(scene, request["seed"], 0, 1)
        run = simulate(scene, **options)
        rejected = 0 if run is not None else rejected + 1
        if rejected >= request["attempts"]:
            raise RejectionException(f"{rejected} simulations were rejected")
        if run is not None:
            say({"answer": "simulation", "simulation": released.simulation_json(run, told)})
        return run

    world.simulate = recorded
    return world


def written(request):
    """Write the program and its modules to a folder: the command line compiles them itself."""
    compile_file = released.scenic.scenarioFromFile
    released.scenic.scenarioFromFile = lambda file, **options: file
    try:
        return write_and_compile(request)
    finally:
        released.scenic.scenarioFromFile = compile_file


def sample_by_command(request, say):
    """The scenes that `scenic FILE` shows."""
    released.seeded(request)
    shown = 0

    def show(scene, **options):
        nonlocal shown
        say({"answer": "scene", "scene": released.scene_json(scene, request["seed"], shown, 1)})
        shown += 1
        if shown == request["count"]:
            raise Enough

    setattr(Scene, "show2D" if released.THREE else "show", show)
    count = ["--count", str(request["count"])] if released.THREE else []
    return command_line(*count)


def simulate_by_command(request, say):
    """The simulations that `scenic -S FILE` runs."""
    released.seeded(request)
    Scenario.getSimulator = lambda scenario: recording(request, say)
    return command_line("-S", "--count", str(request["count"]), "--time", str(request["steps"]))


def command_line(*options):
    """Run `python -m scenic` on the program, in this process."""
    sys.argv = ["scenic", os.path.basename(released.compiled[0]), *(["--2d"] if released.THREE else []), *options]
    with suppress(Enough):
        runpy.run_module("scenic", run_name="__main__")
    return {"answer": "done"}


if __name__ == "__main__":
    if sys.argv[1] == "api":
        released.sample, released.simulate = sample_by_api, simulate_by_api
    else:
        released.compile_program = written
        released.sample, released.simulate = sample_by_command, simulate_by_command
    released.main()
