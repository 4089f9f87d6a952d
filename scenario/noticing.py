"""What is noticed about a scenario besides errors."""

from __future__ import annotations

from ..interpreter.warnings import ProgramWarning, unread_params, warnings_of
from ..simulators.protocol import PROPERTIES_READ
from ..simulators.worlds import PARAMS_READ
from .scenario import Scenario


def warnings_about(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about a scenario: those about the parameters that it was given, then those about its program, in the order of its text."""
    library = scenario.settings.library
    return [*given_in_vain(scenario), *warnings_of(scenario.program, library, PROPERTIES_READ, trust=scenario.trust)]  # type: ignore[arg-type]


def given_in_vain(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about the global parameters that a scenario was given."""
    return unread_params(scenario.program, scenario.settings.library, scenario.params, PARAMS_READ)  # type: ignore[arg-type]
