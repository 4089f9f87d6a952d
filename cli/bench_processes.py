"""The processes that a benchmark asks for scenes: one for each program and implementation, each in its own environment."""

from __future__ import annotations

import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Any

from ..semantics.kernel.errors import UsageError
from .bench_child import Task

SAMPLE = Path(__file__).with_name("bench_sample.py")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
FORM = re.compile(r"(?P<name>[\w.-]+)==(?P<version>[\w.+!-]+)=(?P<python>.+)")
KNOWN = "scenic"


@dataclass(frozen=True, slots=True)
class Program:
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
        """What tables call it."""
        return self.backend + (" --prune" if self.prune else "")

    def command(self, program: Program, seed: int) -> list[str]:
        """Starts its process."""
        task = Task(program.path, self.backend, self.prune, program.trust, seed)
        code = f"import sys; sys.path[:] = {sys.path!r}; from {__package__}.bench_child import main; main()"
        return [sys.executable, "-c", code, task.text()]

    def environment(self) -> Mapping[str, str]:
        """The variables of its process."""
        return {**os.environ, **ONE_THREAD}


@dataclass(frozen=True, slots=True)
class Released:
    """A released implementation, in the environment of `python`; `script` and `world` are files that its process reads."""

    name: str
    python: str
    script: str = ""
    world: str = ""

    def command(self, program: Program, seed: int) -> list[str]:
        """Starts its process."""
        assert program.released is not None
        return [self.python, self.script, program.released, self.world, str(seed)]

    def environment(self) -> Mapping[str, str]:
        """The variables of its process: nothing of the environment of this one."""
        own = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "__PYVENV_LAUNCHER__")
        return {**{name: value for name, value in os.environ.items() if name not in own}, **ONE_THREAD}

    def at(self, directory: Path) -> Released:
        """The same, with the files that it reads in `directory`: its script must stand alone, and the world is that of the gallery."""
        script, world = directory / SAMPLE.name, directory / "world.json"
        if not script.exists():
            script.write_text(SAMPLE.read_text(encoding="utf-8"), encoding="utf-8")
            world.write_text(json.dumps(world_of_the_gallery()), encoding="utf-8")
        return replace(self, script=str(script), world=str(world))


Contender = Ours | Released


def released(text: str) -> Released:
    """A `--against`, checked: the environment is there and holds that version. Raises `UsageError`."""
    match = FORM.fullmatch(text)
    if match is None:
        raise UsageError(f"--against expects NAME==VERSION=PYTHON, not {text!r}", hint=f"--against {KNOWN}==3.1.1=/path/to/bin/python")
    name, version, python = match["name"].lower(), match["version"], match["python"]
    if name != KNOWN:
        raise UsageError(f"--against knows how to measure {KNOWN} only, not {name}")
    if not Path(python).is_file() or not os.access(python, os.X_OK):
        raise UsageError(f"--against {name}=={version}: {python} is no program that could be run", hint="give the path of its environment's python")
    found = Released(f"{name}=={version}", python)
    there = version_of(found, name)
    if there != version:
        raise UsageError(f"--against {name}=={version}: the environment of {python} holds {name} {there}")
    return found


def version_of(contender: Released, name: str) -> str:
    """The version of a package in the environment of a released implementation. Raises `UsageError`."""
    command = [contender.python, str(SAMPLE), "--version", name]
    try:
        with tempfile.TemporaryDirectory() as directory:
            command[1] = str(Path(directory) / SAMPLE.name)
            Path(command[1]).write_text(SAMPLE.read_text(encoding="utf-8"), encoding="utf-8")
            done = subprocess.run(command, capture_output=True, text=True, timeout=60, env=contender.environment(), check=False)
        return str(json.loads(done.stdout)["version"])
    except (OSError, ValueError, KeyError, TypeError, subprocess.TimeoutExpired):
        what = f"--against {contender.name}: {contender.python} does not tell its version of {name}"
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


class Process:
    """A program in the hands of one implementation; used in a `with`. `ready` tells what preparing took, or why it is skipped."""

    def __init__(self, contender: Contender, program: Program, seed: int) -> None:
        self.errors = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115 (closed with the process)
        self.running = subprocess.Popen(
            contender.command(program, seed), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, text=True,
            env=contender.environment(),
        )
        try:
            self.ready = self.answer()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Process:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """End the process."""
        self.running.kill()
        for stream in (self.running.stdin, self.running.stdout, self.errors):
            if stream is not None:
                with contextlib.suppress(OSError):  # what it did not read before it ended is still to be written
                    stream.close()
        self.running.wait()

    def sample(self, seconds: float) -> dict[str, Any]:
        """What it draws in about so many seconds of the processor."""
        assert self.running.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            print(seconds, file=self.running.stdin, flush=True)
        return self.answer()

    def answer(self) -> dict[str, Any]:
        """The next line that it prints; if it ended instead, why."""
        assert self.running.stdout is not None
        line = self.running.stdout.readline()
        try:
            found = json.loads(line)
            return found if isinstance(found, dict) else {"skipped": f"its answer was {line.strip()!r}"}
        except ValueError:
            return {"skipped": self.why(line)}

    def why(self, line: str) -> str:
        """The end of what it said before it ended."""
        self.errors.seek(0)
        said = [text.strip() for text in self.errors.read().splitlines() if text.strip()]
        return line.strip() or (said[-1][:300] if said else "its process ended without an answer")
