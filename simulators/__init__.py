"""Worlds to put scenes in, and simulators that run them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..semantics.kernel.errors import UsageError
from .protocol import Simulator


def _still(timestep: float | None) -> Simulator:
    from .still import Still

    return Still(1.0 if timestep is None else timestep)


def _kinematic(timestep: float | None) -> Simulator:
    from .kinematic import Kinematic

    return Kinematic(0.1 if timestep is None else timestep)


def _pymunk(timestep: float | None) -> Simulator:
    from .physics import Physics

    return Physics(0.1 if timestep is None else timestep)


SIMULATORS: Mapping[str, Callable[[float | None], Simulator]] = {"still": _still, "kinematic": _kinematic, "pymunk": _pymunk}
"""The simulators by name; each is made with its time step in seconds, or with its own."""


def by_name(name: str, timestep: float | None = None) -> Simulator:
    """A simulator. Raises `UsageError` if there is none of that name, or for a time step that is none."""
    if name not in SIMULATORS:
        raise UsageError(f"there is no simulator {name}", hint=f"the simulators are {', '.join(SIMULATORS)}")
    try:
        return SIMULATORS[name](timestep)
    except ValueError as problem:
        raise UsageError(str(problem)) from None
