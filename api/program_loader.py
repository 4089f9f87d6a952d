"""A scenario from a text or a file."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from pathlib import Path

from ..interpreter.language.modules import read_text
from ..interpreter.language.parser import parse
from ..interpreter.runtime.program_run import DEFAULT_FUEL
from ..semantics.store.errors import ScenicError, UsageError
from .diagnostics import given_in_vain
from .scenario import Scenario

PATH = re.compile(r"[^\s=()'\"#]+\.scenic")
"""A text that is no program that means anything, and was meant for `load`."""


def loads(
    text: str, *, file: str = "<string>", dialect: str | None = None, profile: str | None = None, readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, directory: str | Path | None = None,
    fuel: int = DEFAULT_FUEL, scenario: str | None = None,
) -> Scenario:
    """The scenario of a program text; modules in `directory` can be imported.

    Raises `ParseError`, `CheckError`, `UsageError`; warns of parameters that nothing reads.
    """
    return warn_unread_params(
        scenario_of(
            text, file=file, dialect=dialect, profile=profile, readings=readings, params=params, model=model, trust=trust, directory=directory,
            fuel=fuel, scenario=scenario,
        )
    )  # fmt: skip


def scenario_of(
    text: str, *, file: str = "<string>", dialect: str | None = None, profile: str | None = None, readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, directory: str | Path | None = None,
    fuel: int = DEFAULT_FUEL, scenario: str | None = None,
) -> Scenario:
    """As `loads`, without a warning."""
    if not isinstance(text, str):
        raise UsageError(f"a program is a text, not {text!r:.60}", hint="`load` takes the path of a file")
    if PATH.fullmatch(text):
        raise UsageError(f"{text} is a path, not the text of a program", hint="`load` takes the path of a file")
    program = parse(text, file, dialect)
    return Scenario(
        program, profile=profile, readings=readings, params=params, model=model, trust=trust, directory=directory, fuel=fuel, scenario=scenario
    )


def load(
    path: str | Path, *, dialect: str | None = None, profile: str | None = None, readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, fuel: int = DEFAULT_FUEL,
    scenario: str | None = None,
) -> Scenario:
    """The scenario of a program file; modules next to it can be imported. Raises `ParseError`, `CheckError`, `UsageError`, `OSError`."""
    if not isinstance(path, (str, Path)):
        raise UsageError(f"a path is a text or a `pathlib.Path`, not {path!r:.60}", hint="`loads` takes the text of a program")
    where = Path(path)
    return warn_unread_params(
        scenario_of(
            read_text(where), file=str(path), dialect=dialect, profile=profile, readings=readings, params=params, model=model, trust=trust,
            directory=where.parent, fuel=fuel, scenario=scenario,
        )
    )  # fmt: skip


def warn_unread_params(scenario: Scenario) -> Scenario:
    """The scenario, with a warning to the caller of `load` or `loads` about each parameter that nothing reads."""
    if scenario.params:
        try:
            found = given_in_vain(scenario)
        except ScenicError:  # it is raised where scenes are asked for
            return scenario
        for one in found:
            warnings.warn(f"{one.message}: {one.hint}", stacklevel=3)
    return scenario
