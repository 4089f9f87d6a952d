"""What is noticed about a scenario besides errors."""

from __future__ import annotations

from ..interpreter.warnings import ProgramWarning, warnings_of
from ..simulators.protocol import PROPERTIES_READ
from .scenario import Scenario


def warnings_about(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about the program of a scenario, in the order of its text."""
    return warnings_of(scenario.program, scenario.settings.library, PROPERTIES_READ, trust=scenario.trust)  # type: ignore[arg-type]
