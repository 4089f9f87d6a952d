"""A program with everything that decides its scenes, apart from the seed."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..interpreter.runtime.limits import DEFAULT_LIMITS, Limits

if TYPE_CHECKING:
    from ..api import Scenario

DEFAULT_FUEL = 5_000_000
DEFAULT_ATTEMPTS = 100_000


@dataclass(frozen=True, slots=True)
class Source:
    """A program text and everything but the seed that decides its scenes; can be sent to another process."""

    file: str
    text: str
    profile: str | None = None
    readings: tuple[tuple[str, str], ...] = ()
    dialect: str | None = None
    model: str | None = None
    params: tuple[tuple[str, str], ...] = ()
    fuel: int = DEFAULT_FUEL
    trust: bool = False
    prune: bool = False
    scenario: str | None = None
    limits: Limits = DEFAULT_LIMITS
    device: str | None = None
    beside: bool = True
    """Whether modules in the folder of the file can be imported."""

    def load(self) -> Scenario:
        """The scenario. Raises `ParseError`, `CheckError`, `UsageError`."""
        from ..api.program_loader import scenario_of
        from ..inference.batch.torch_devices import check_device
        from ..interpreter.language.dialects import choose
        from ..interpreter.language.parser import tables
        from ..interpreter.runtime.process_sandbox import WALL

        if self.device is not None:
            check_device(self.device)  # which also prepares it: CUDA takes more of the address space than the wall leaves
        if not self.trust:
            tables(choose(self.text, self.dialect).released)  # the parser's own memory is no part of what a program may take
            WALL.build(self.limits)
        scenario = scenario_of(
            self.text, file=self.file, dialect=self.dialect, profile=self.profile, readings=dict(self.readings),
            params={name: literal(value) for name, value in self.params}, model=self.model, trust=self.trust,
            directory=Path(self.file).parent if self.beside else None, fuel=self.fuel, scenario=self.scenario,
        )
        scenario = scenario.pruned() if self.prune else scenario
        return scenario if self.device is None else scenario.on_device(self.device)


def literal(text: str) -> object:
    """A Python literal as its value; any other text as it stands."""
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return text
