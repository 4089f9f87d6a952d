"""Questions of behaviors about the world: the time, and the distance of the nearest object (paper, Section
"Dynamic Scenarios").
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..store.errors import RunError
from ..store.scenic_classes import ScenicClass
from ..syntax import expressions as e
from .config import Stack, value
from .operand_kinds import Reader, kind_name
from .outcome import Outcome
from .values import Instance, Module, value_in_run

if TYPE_CHECKING:
    from ..syntax.nodes import Node
    from .config import State
    from .simulation_state import Simulation


@dataclass(frozen=True, slots=True)
class Clock:
    """The value of `simulation`, which can be called as well (dialects `scenic-2.1` and `scenic-3`)."""

    def __repr__(self) -> str:
        return "<simulation>"


@dataclass(frozen=True, slots=True)
class Parameters:
    """The value of `globalParameters` (dialects `scenic-2.1` and `scenic-3`): the global parameters that are set so far."""

    def __repr__(self) -> str:
        return "<globalParameters>"


@dataclass(frozen=True, slots=True)
class Closest:
    """The method `distanceToClosest` of an object."""

    instance: Instance


CLOCK = ("currentTime", "currentRealTime", "timestep", "objects")
"""What a simulation may be asked for."""
CONTROLLERS = "scenic.domains.driving.controllers"
"""The module of the driving library whose functions of the names below `simulation` has as well, where a program has imported it."""
OF_CONTROLLERS = ("getLaneFollowingControllers", "getTurningControllers", "getLaneChangingControllers")


def check_running(node: Node, state: State) -> Simulation:
    """The simulation that runs. Raises `RunError` while the scene is generated."""
    if state.simulation is None:
        raise RunError("there is no simulation while the scene is generated", node.span, rule="E-Attribute", hint="ask in a behavior")
    return state.simulation


def attribute_of_clock(name: str, node: Node, state: State) -> object:
    """`simulation.currentTime`: in seconds, or in steps (reading `time-unit`).

    Of the released implementations: `currentRealTime` and `timestep`, in seconds, and `objects`, those that there are by now; on roads
    `getLaneFollowingControllers(agent)` and its kin.
    """
    driving = state.modules.get(CONTROLLERS)
    if name in OF_CONTROLLERS and isinstance(driving, Module):
        check_running(node, state)
        return driving.scope.bindings[name]
    if name not in CLOCK:
        where = "; those of roads come with `model scenic.domains.driving.model`" if name in OF_CONTROLLERS else ""
        raise RunError(f"`simulation` has no {name}", node.span, rule="E-Attribute", hint=f"it has {', '.join(CLOCK)}{where}")
    simulation = check_running(node, state)
    if name == "objects":
        return state.scene
    if name == "timestep":
        return simulation.timestep
    return simulation.step if name == "currentTime" and state.reading("time-unit") == "steps" else simulation.step * simulation.timestep


def distance_to_closest(closest: Closest, arguments: tuple[object, ...], node: Node, state: State) -> float:
    """`X.distanceToClosest(C)`: from the centre of X to that of the nearest other object of class C, in metres; infinite if there is none."""
    class_ = value_in_run(arguments[0]) if len(arguments) == 1 else None
    if not isinstance(class_, ScenicClass):
        got = kind_name(class_) if len(arguments) == 1 else f"{len(arguments)} arguments"
        raise RunError(f"distanceToClosest expects a class, not {got}", node.span, rule="E-Call")
    reader = Reader(state)
    here = reader.property(closest.instance, "position")
    there = [reader.property(o, "position") for o in state.scene if o is not closest.instance and o.class_.is_subclass_of(class_)]
    return min((math.hypot(v.x - here.x, v.y - here.y) for v in there), default=math.inf)  # type: ignore[attr-defined]


def in_initial_scenario(node: e.InInitialScenario, stack: Stack, state: State) -> Outcome:
    """Section "Compositional Scenarios", "Interrupts, Overriding, and Initial Scenarios": "testing whether we are inside the initial scenario,
    i.e., the very first scenario to run."
    """
    return value("E-InInitialScenario", state.simulation is None, stack, state, node)
