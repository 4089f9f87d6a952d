"""What is noticed about a scenario besides errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..interpreter.language.dialects import DIALECTS
from ..interpreter.language.lint import (
    IMPLAUSIBLE,
    ProgramWarning,
    misspelt_params,
    slips,
    unread_params,
    warnings_of,
)
from ..interpreter.language.modules import Library
from ..pictures.map_layers import FEATURES, SITE
from ..semantics.python.builtins import BUILTINS, OF_RELEASES
from ..semantics.syntax import Program, Span
from ..semantics.syntax.statements import Param
from ..simulators.protocol import PROPERTIES_READ
from ..simulators.worlds import PARAMS_READ
from ..simulators.worlds.names import MODELS_BY_NAME
from .scenario import Scenario

ALWAYS = ("ego", "workspace", "self")
"""Names that are bound without a statement that says so."""


def warnings_about(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about a scenario: those about the parameters that it was given, then those about its program, in the order of its text."""
    library: Library = scenario.settings.library  # type: ignore[assignment]
    released = DIALECTS[scenario.program.dialect].released
    found = [
        *warnings_of(scenario.program, library, PROPERTIES_READ, trust=scenario.trust),
        *about_map(scenario.program, library),
        *misspelt_params(scenario.program, library, PARAMS_READ),
        *slips(scenario.program, library, scenario.model, {*BUILTINS, *ALWAYS, *(OF_RELEASES if released else ())}, MODELS_BY_NAME),
    ]  # fmt: skip
    return [*given_in_vain(scenario), *sorted(dict.fromkeys(found), key=lambda warning: (warning.span.line, warning.span.column))]


def given_in_vain(scenario: Scenario) -> list[ProgramWarning]:
    """The warnings about the global parameters that a scenario was given."""
    return unread_params(scenario.program, scenario.settings.library, scenario.params, PARAMS_READ)  # type: ignore[arg-type]


def about_map(program: Program, library: Library) -> Iterator[ProgramWarning]:
    """A warning about a map of one's own, where the program names it, if its coordinates are most likely others than those that are read."""
    module = library.get(FEATURES)
    doubt = getattr(module.get(SITE), "doubt", None) if isinstance(module, Mapping) else None
    if doubt is not None:
        named = [one for st in program.statements if isinstance(st, Param) for one in st.assignments if one.name == "map"]
        yield ProgramWarning(IMPLAUSIBLE, doubt.what, named[-1].span if named else Span(program.file, 0, 0, 0, 0), doubt.remedy)
