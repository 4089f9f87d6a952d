"""Worlds to put scenes in, and simulators that run them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..semantics.store.errors import UsageError
from ..semantics.store.suggestions import did_you_mean
from .protocol import EndRun, RejectRun, Simulator, Surroundings
from .user_simulator import own_simulator


def _still(timestep: float | None) -> Simulator:
    from .still import Still

    return Still(1.0 if timestep is None else timestep)


def _kinematic(timestep: float | None) -> Simulator:
    from .kinematic import Kinematic

    return Kinematic(0.1 if timestep is None else timestep)


def _pymunk(timestep: float | None) -> Simulator:
    from .pymunk_simulator import Physics

    return Physics(0.1 if timestep is None else timestep)


def _sumo(timestep: float | None) -> Simulator:
    from .sumo_simulator import Traffic

    return Traffic(0.1 if timestep is None else timestep)


SIMULATORS: Mapping[str, Callable[[float | None], Simulator]] = {"still": _still, "kinematic": _kinematic, "pymunk": _pymunk, "sumo": _sumo}
"""The simulators by name; each is made with its time step in seconds, or with its own."""


def by_name(name: str, timestep: float | None = None) -> Simulator:
    """A simulator, also one of the user's own (`package.module:Class`).

    Raises `UsageError` if there is none of that name, or for a time step that is none.
    """
    if ":" in name:
        return own_simulator(name, timestep)
    if name not in SIMULATORS:
        known = f"the simulators are {', '.join(SIMULATORS)}; one of your own is named package.module:Class"
        raise UsageError(f"there is no simulator {name}", hint=did_you_mean(name, SIMULATORS, known))
    try:
        return SIMULATORS[name](timestep)
    except ValueError as problem:
        raise UsageError(str(problem)) from None


__all__ = ["SIMULATORS", "EndRun", "RejectRun", "Simulator", "Surroundings", "by_name"]
