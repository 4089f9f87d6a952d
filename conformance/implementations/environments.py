"""The implementation that an option names: a release of Scenic in an environment that is made for it once, or any command."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import venv
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ...interpreter.runtime.cache_folders import cache_place
from ...semantics.readings import select
from ...semantics.store.errors import UsageError
from .harness_client import ANSWER_SECONDS, External

ADAPTER = Path(__file__).parent / "adapters" / "released.py"
MADE = "made-by-scenic-ref"
"""A file in an environment that is complete."""
SHOWN = 5
"""Lines of pip's output in an error."""


@dataclass(frozen=True, slots=True)
class Release:
    """A release of Scenic: the profile of readings that it follows, and what pip is asked for, one call after the other."""

    profile: str
    installs: tuple[tuple[str, ...], ...]


RELEASES: Mapping[str, Release] = {
    "2.1.0": Release("scenic-2.1", (("setuptools<81", "wheel"), ("--no-build-isolation", "scenic==2.1.0"))),
    "3.1.1": Release("scenic-3", (("scenic==3.1.1",),)),
}


def implementation(text: str, seconds: float = ANSWER_SECONDS, say: Callable[[str], None] = lambda line: None) -> External:
    """Return the implementation that `--impl` names: `scenic==VERSION`, or a command that speaks the harness
    protocol; each answer may take so many seconds.

    `say` is told what takes long.

    Raises `UsageError` for an unknown release, an empty command, and an environment that cannot be made.
    """
    if text.startswith("scenic=="):
        return open_release(text.removeprefix("scenic=="), seconds, say)
    try:
        command = shlex.split(text)
    except ValueError as error:
        raise UsageError(f"the command {text!r} cannot be read: {error}") from None
    if not command:
        raise UsageError("there is no command", hint="--impl scenic==3.1.1, or --impl 'python my_implementation.py'")
    program = shutil.which(command[0])
    if program is None:
        hint = f"known releases are {', '.join('scenic==' + version for version in RELEASES)}"
        raise UsageError(f"there is no program {command[0]!r}", hint=hint)
    return External([str(Path(program).absolute()), *map(here, command[1:])], seconds=seconds)


def here(word: str) -> str:
    """A word of a command: a file of this folder by its whole path, since the command runs in a folder of its own.

    Links are not followed: the Python of a virtual environment is one.
    """
    return str(Path(word).absolute()) if Path(word).is_file() else word


def open_release(version: str, seconds: float, say: Callable[[str], None]) -> External:
    """A release, in its own environment. Raises `UsageError`."""
    if version not in RELEASES:
        raise UsageError(f"there is no adapter for scenic {version}", hint=f"known releases are {', '.join(RELEASES)}")
    python = environment(version, say)
    return External([str(python), str(ADAPTER)], profile=select(RELEASES[version].profile), seconds=seconds)


def environment(version: str, say: Callable[[str], None]) -> Path:
    """The Python that has the release installed; its environment is made if there is none. Raises `UsageError`."""
    tag = f"{sys.version_info.major}.{sys.version_info.minor}"
    folder = cache_place() / f"scenic-{version}-python-{tag}"
    python = Path("Scripts", "python.exe") if sys.platform == "win32" else Path("bin", "python")
    if not (folder / MADE).exists():
        say(f"making an environment with scenic {version} in {folder}, once: this takes some minutes")
        make(folder, python, RELEASES[version], say)
    return folder / python


def make(folder: Path, python: Path, release: Release, say: Callable[[str], None]) -> None:
    """An environment with a release, in a folder that appears only when it is complete. Raises `UsageError`."""
    unfinished = folder.with_name(f".{folder.name}.{os.getpid()}.unfinished")
    try:
        unfinished.mkdir(parents=True, exist_ok=True)
        venv.create(unfinished, with_pip=True, symlinks=sys.platform != "win32")
        for packages in release.installs:
            say(f"pip install {' '.join(packages)}")
            install(unfinished / python, packages)
        (unfinished / MADE).write_text("")
        with suppress(FileExistsError):
            if folder.exists() and not (folder / MADE).exists():
                shutil.rmtree(folder)
            unfinished.replace(folder)
    except OSError as error:
        if not (folder / MADE).exists():  # another process was faster
            raise UsageError(f"the environment {folder} cannot be made: {error.strerror or error}") from error
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def install(python: Path, packages: tuple[str, ...]) -> None:
    """Call pip of an environment. Raises `UsageError` with the last lines of what it says."""
    pip = [str(python), "-m", "pip", "--disable-pip-version-check", "install", *packages]
    done = subprocess.run(pip, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode:
        words = "\n".join((done.stdout + done.stderr).strip().splitlines()[-SHOWN:])
        raise UsageError(f"pip could not install {' '.join(packages)}:\n{words}")
