"""What is given of the parameters of a scene (`Scenario.condition_on`): premises at the end of a run, beside those of Step 2."""

from __future__ import annotations

import operator
from collections.abc import Iterator
from functools import partial

from ..kernel.config import State
from ..kernel.host import host
from ..kernel.outcome import Requirement
from ..kernel.values import plain
from ..syntax.nodes import NOWHERE
from .default_requirements import Premise


def given_params(state: State) -> Iterator[Premise]:
    """The parameters that have to have a given value, once a scene is generated."""
    if state.simulation is None:
        for name, value in state.settings.given.params.items():
            yield Premise(partial(has_value, name, value), (), Requirement("given", NOWHERE, f"the parameter {name} is {value!r}, as is given"))


def has_value(name: str, value: object, state: State) -> bool:
    """π(name) = value; on symbols a symbol."""
    return plain(host(state.settings.door, state, operator.eq, state.params[name], value))  # type: ignore[return-value]
