"""A scenario from a text or a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..interpreter.modules import read_text
from ..interpreter.parser import parse
from ..interpreter.running import DEFAULT_FUEL
from .scenario import Scenario


def loads(
    text: str, *, file: str = "<string>", dialect: str | None = None, profile: str = "paper", readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, directory: Path | None = None,
    fuel: int = DEFAULT_FUEL, scenario: str | None = None,
) -> Scenario:
    """The scenario of a program text. Raises `ParseError`, `CheckError`, `UsageError`."""
    program = parse(text, file, dialect)
    return Scenario(
        program, profile=profile, readings=readings, params=params, model=model, trust=trust, directory=directory, fuel=fuel, scenario=scenario
    )


def load(
    path: str | Path, *, dialect: str | None = None, profile: str = "paper", readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, fuel: int = DEFAULT_FUEL,
    scenario: str | None = None,
) -> Scenario:
    """The scenario of a program file; modules next to it can be imported."""
    where = Path(path)
    return loads(
        read_text(where), file=str(path), dialect=dialect, profile=profile, readings=readings, params=params, model=model, trust=trust,
        directory=where.parent, fuel=fuel, scenario=scenario,
    )
