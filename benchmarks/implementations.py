"""The subjects of a benchmark: programs, the backends of this package, and released implementations in their
own environments.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from ..semantics.store.errors import UsageError
from .own_driver import DrivingTask
from .own_sampler import SamplingTask

SAMPLER = Path(__file__).with_name("released_sampler.py")
DRIVER = Path(__file__).with_name("released_driver.py")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
FORM = re.compile(r"(?P<name>[\w.-]+)==(?P<version>[\w.+!-]+)=(?P<python>.+)")
KNOWN = "scenic"


def python_that_runs(module: str, *arguments: str) -> list[str]:
    """Starts a process that calls `main` of a module which this one could import."""
    return [sys.executable, "-c", f"import sys; sys.path[:] = {sys.path!r}; from {module} import main; main()", *arguments]


def on_one_thread() -> Mapping[str, str]:
    """The variables of this process, for one that computes on one thread."""
    return {**os.environ, **ONE_THREAD}


@dataclass(frozen=True, slots=True)
class MeasuredProgram:
    """A program to be measured; `released` is the same program for released implementations, if there is one."""

    name: str
    path: str
    released: str | None = None
    trust: bool = False


@dataclass(frozen=True, slots=True)
class Ours:
    """A backend of this package."""

    backend: str
    prune: bool = False

    @property
    def name(self) -> str:
        """The name in tables."""
        return self.backend + (" --prune" if self.prune else "")

    def command(self, program: MeasuredProgram, seed: int) -> list[str]:
        """Return the command that starts its process."""
        task = SamplingTask(program.path, self.backend, self.prune, program.trust, seed)
        return python_that_runs(f"{__package__}.own_sampler", task.text())

    def environment(self) -> Mapping[str, str]:
        """The variables of its process."""
        return on_one_thread()


@dataclass(frozen=True, slots=True)
class OursOverTime:
    """A backend of simulations of this package; its simulations have so many time steps at most."""

    name: str
    steps: int

    def command(self, program: MeasuredProgram, seed: int) -> list[str]:
        """Return the command that starts its process."""
        task = DrivingTask(program.path, self.name, self.steps, program.trust, seed)
        return python_that_runs(f"{__package__}.own_driver", task.text())

    def environment(self) -> Mapping[str, str]:
        """The variables of its process."""
        return on_one_thread()


@dataclass(frozen=True, slots=True)
class Released:
    """A released implementation, in the environment of `python`; `script` and `world` are files that its process reads.

    It simulates where there are time steps, else it draws scenes.
    """

    name: str
    python: str
    script: str = ""
    world: str = ""
    steps: int | None = None

    def command(self, program: MeasuredProgram, seed: int) -> list[str]:
        """Return the command that starts its process."""
        assert program.released is not None
        return [self.python, self.script, program.released, self.world if self.steps is None else str(self.steps), str(seed)]

    def environment(self) -> Mapping[str, str]:
        """The variables of its process: nothing of the environment of this one."""
        own = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "__PYVENV_LAUNCHER__")
        return {**{name: value for name, value in os.environ.items() if name not in own}, **ONE_THREAD}

    def at(self, directory: Path, steps: int | None = None) -> Released:
        """Return the implementation with its script and the gallery's world copied to `directory`, where the
        script runs alone.

        It simulates `steps` time steps at a time, or draws scenes if they are None.
        """
        source = SAMPLER if steps is None else DRIVER
        script, world = directory / source.name, directory / "world.json"
        if not script.exists():
            script.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
            world.write_text(json.dumps(world_of_the_gallery()), encoding="utf-8")
        return replace(self, script=str(script), world=str(world), steps=steps)


class Contender(Protocol):
    """Who draws: `Ours`, `Released`, or the whole command (`end_to_end.RunToFile`)."""

    @property
    def name(self) -> str:
        """The name in tables."""
        ...

    def command(self, program: MeasuredProgram, seed: int) -> list[str]:
        """Return the command that starts its process."""
        ...

    def environment(self) -> Mapping[str, str]:
        """The variables of its process."""
        ...


def parse_release(text: str) -> Released:
    """A `--against`, checked: the environment is there and holds that version. Raises `UsageError`."""
    match = FORM.fullmatch(text)
    if match is None:
        raise UsageError(f"--against expects NAME==VERSION=PYTHON, not {text!r}", hint=f"--against {KNOWN}==3.1.1=/path/to/bin/python")
    name, version, python = match["name"].lower(), match["version"], match["python"]
    if name != KNOWN:
        raise UsageError(f"--against knows how to measure {KNOWN} only, not {name}")
    if not Path(python).is_file() or not os.access(python, os.X_OK):
        raise UsageError(f"--against {name}=={version}: {python} is not a program that can be run", hint="give the path of its environment's python")
    found = Released(f"{name}=={version}", python)
    there = version_of(found, name)
    if there != version:
        raise UsageError(f"--against {name}=={version}: the environment of {python} holds {name} {there}")
    return found


def version_of(contender: Released, name: str) -> str:
    """The version of a package in the environment of a released implementation. Raises `UsageError`."""
    command = [contender.python, str(SAMPLER), "--version", name]
    try:
        with tempfile.TemporaryDirectory() as directory:
            command[1] = str(Path(directory) / SAMPLER.name)
            Path(command[1]).write_text(SAMPLER.read_text(encoding="utf-8"), encoding="utf-8")
            done = subprocess.run(command, capture_output=True, text=True, timeout=60, env=contender.environment(), check=False)
        return str(json.loads(done.stdout)["version"])
    except (OSError, ValueError, KeyError, TypeError, subprocess.TimeoutExpired):
        what = f"--against {contender.name}: {contender.python} does not report its version of {name}"
        raise UsageError(what, hint="is it installed there?") from None


def world_of_the_gallery() -> dict[str, object]:
    """The synthetic city and the constants of its cars, for the released implementation's own copy of the world."""
    import shapely

    from ..simulators.worlds.city import city
    from ..simulators.worlds.gta.data import COLOR_WEIGHTS, MODELS, WEATHER_WEIGHTS

    town = city()
    return {
        "cells": [(shapely.get_coordinates(polygon).tolist(), heading) for polygon, heading in town.cells],
        "road": json.loads(shapely.to_geojson(town.road)),
        "curbs": [shapely.get_coordinates(curb).tolist() for curb in town.curbs],
        "models": [(m.name, m.width, m.length) for m in MODELS.values()],
        "colors": list(COLOR_WEIGHTS.items()),
        "weather": WEATHER_WEIGHTS,
    }
