"""What is noticed about a scenario besides errors."""

from __future__ import annotations

from ..interpreter.modules import Library
from ..interpreter.slips import slips
from ..interpreter.warnings import ProgramWarning, unread_params, warnings_of
from ..semantics.python.builtins import BUILTINS
from ..simulators.protocol import PROPERTIES_READ
from ..simulators.worlds import PARAMS_READ
from ..simulators.worlds.names import MODELS_BY_NAME
from .scenario import Scenario

ALWAYS = ("ego", "workspace", "self")
"""Names that are bound without a statement that says so."""


def warnings_about(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about a scenario: those about the parameters that it was given, then those about its program, in the order of its text."""
    library: Library = scenario.settings.library  # type: ignore[assignment]
    found = [
        *warnings_of(scenario.program, library, PROPERTIES_READ, trust=scenario.trust),
        *slips(scenario.program, library, scenario.model, {*BUILTINS, *ALWAYS}, MODELS_BY_NAME),
    ]  # fmt: skip
    return [*given_in_vain(scenario), *sorted(found, key=lambda warning: (warning.span.line, warning.span.column))]


def given_in_vain(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about the global parameters that a scenario was given."""
    return unread_params(scenario.program, scenario.settings.library, scenario.params, PARAMS_READ)  # type: ignore[arg-type]
