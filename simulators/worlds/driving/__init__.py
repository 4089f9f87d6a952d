"""The driving library: the map of a program, and the modules under the released library's names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from importlib.resources import files
from pathlib import Path

from ....interpreter.language.modules import World
from ....roads import network as roads
from ....roads import vehicle_paths
from ....roads.map_generator import generate_map
from ....roads.network import Network
from ....roads.network_builder import TOLERANCE, network_from
from ....semantics.python.builtin_rules import MAPS
from ....semantics.store.errors import ImportRefused
from ....semantics.syntax import Program
from ....semantics.syntax.nodes import NOWHERE, Span
from ....semantics.syntax.statements import Param
from ...actions import ACTIONS
from .arguments import check_arguments
from .named_maps import constants, maps_of, read_named_map, text_and_path, tolerance_in

MAP = "scenic.domains.driving.map"
"""The module that gives `network`, the map of the program."""
OF_ROADS = (
    "Network", "NetworkElement", "LinearElement", "Road", "LaneGroup", "Lane", "RoadSection", "LaneSection", "Sidewalk", "PedestrianCrossing",
    "Shoulder", "Intersection", "Signal", "Maneuver", "ManeuverType", "VehicleType",
)  # fmt: skip
"""What the module `roads` gives."""
FIXED_ROADS = {name: vars(roads)[name] for name in OF_ROADS}
SAME = "from scenic.domains.driving.model import *\n"
"""A model that has no more than the driving library."""

DEFAULT = {
    "block": 120.0, "leg": 80.0, "sidewalks": True, "shoulders": True, "shoulder_width": 2.5, "signals": True, "crosswalks": True
}  # fmt: skip
"""The parameters of the default map, on whose shoulders there is room for parked cars."""


@cache
def driving_module_text(name: str) -> str:
    """A module in Scenic."""
    return (files(__spec__.name if __spec__ else "scenic_ref.simulators.worlds.driving") / f"{name}.scenic").read_text(encoding="utf-8")


@cache
def default_network(tolerance: float = TOLERANCE) -> Network:
    """The map of programs that name none: nine crossings with traffic lights and crosswalks."""
    return network_from(generate_map("grid", **DEFAULT).encode(), tolerance)


def map_of(program: Program, params: Mapping[str, object], directory: Path | None) -> tuple[str, Path, Span] | Exception | None:
    """The global parameter `map`, the file that it names, and where, before the program runs; None if there is none, and the default map is meant."""
    given = params.get("map")
    if given is not None:
        wrong = f"the parameter map must be the path of a file, not {given!r}"
        return (given, Path(given), NOWHERE) if isinstance(given, str) else ImportRefused(wrong)
    for statement in reversed(program.statements):
        for one in statement.assignments if isinstance(statement, Param) else ():
            if one.name == "map":
                named = text_and_path(one.value, directory)
                wrong = "the parameter map must be a text, or localPath(a text): the map is read before the program runs"
                return (*named, one.value.span) if named is not None else ImportRefused(wrong, one.value.span)
    return None


def tolerance_of(program: Program, params: Mapping[str, object]) -> float:
    """The tolerance of the map, by the global parameter `map_options`. Raises `ImportRefused`."""
    if "map_options" in params:
        return tolerance_in(params["map_options"], NOWHERE)
    for statement in reversed(program.statements):
        for one in statement.assignments if isinstance(statement, Param) else ():
            if one.name == "map_options":
                return tolerance_in(constants(one.value), one.value.span)
    return TOLERANCE


def modules(program: Program, params: Mapping[str, object], directory: Path | None) -> Mapping[str, World]:
    """The modules that depend on the maps of a program, each of which is read once, also if that fails."""

    @lru_cache(maxsize=None, typed=True)  # 1 is a tolerance, True is none
    def read_once(path: Path, tolerance: float) -> Network | ImportRefused:
        return read_named_map(path, tolerance, directory)

    def of_map() -> Mapping[str, object] | Exception:
        named = map_of(program, params, directory)
        try:
            tolerance = tolerance_of(program, params)
        except ImportRefused as wrong:
            return wrong
        if isinstance(named, Exception):
            return named
        found = default_network(tolerance) if named is None else read_once(named[1], tolerance)
        if isinstance(found, ImportRefused) and named is not None:
            found.span = named[2]
            found.hint = found.hint or ON_DEFAULT
        return found if isinstance(found, Exception) else {"network": found}

    def of_roads() -> Mapping[str, object]:
        own = map_of(program, params, directory)
        try:
            tolerance = tolerance_of(program, params)
        except ImportRefused:  # which the module of the map says
            tolerance = TOLERANCE
        return {**FIXED_ROADS, MAPS[1]: maps_of(program, directory, {own[0]: (own[1], tolerance)} if isinstance(own, tuple) else {}, read_once)}

    return {MAP: of_map, MAPS[0]: of_roads}


FIXED: Mapping[str, Callable[[], str | Mapping[str, object]]] = {
    "scenic.domains.driving.actions": lambda: ACTIONS,
    "scenic.domains.driving.arguments": lambda: {"check_arguments": check_arguments},
    MAPS[0]: lambda: FIXED_ROADS,
    "scenic.domains.driving.paths": lambda: {"Trajectory": vehicle_paths.Trajectory},
    "scenic.domains.driving.controllers": lambda: driving_module_text("controllers"),
    "scenic.domains.driving.lights": lambda: driving_module_text("lights"),
    "scenic.domains.driving.kinds": lambda: driving_module_text("kinds"),
    "scenic.domains.driving.behaviors": lambda: driving_module_text("behaviors"),
    "scenic.domains.driving.scenarios": lambda: driving_module_text("scenarios"),
    "scenic.domains.driving.model": lambda: driving_module_text("model"),
    "scenic.domains.driving.missing": lambda: driving_module_text("missing"),
    "scenic.simulators.carla.model": lambda: driving_module_text("carla"),
    "scenic.simulators.lgsvl.model": lambda: driving_module_text("lgsvl"),
    "scenic.simulators.newtonian.driving_model": lambda: driving_module_text("newtonian"),
    "scenic.simulators.metadrive.model": lambda: SAME,
}
"""The modules that do not depend on a map."""

STAND_INS = {
    "scenic.simulators.newtonian.driving_model": "the driving library; --simulator kinematic moves vehicles as the released simulator does",
    "scenic.simulators.carla.model": "the driving library without CARLA: no shapes, sensors or weather, and boxes of fixed sizes",
    "scenic.simulators.lgsvl.model": "the driving library without LGSVL",
    "scenic.simulators.metadrive.model": "the driving library without MetaDrive",
}
"""What the models of other simulators are here."""
ON_DEFAULT_MAP = "the program names no map: the default map is used, and `param map = ...` names another"
ON_DEFAULT = "leave the parameter out to use the default map"
MOST_NOTES = 3
"""So many notes about a map are told where it is used."""


def notes(library: Mapping[str, object], program: Program, params: Mapping[str, object]) -> list[str]:
    """Return the notes about the modules that a program may import: the meaning of a model that stands in for
    another, the use of the default map, and oddities of the map.
    """
    found = [f"note: {name} stands for {what}" for name, what in STAND_INS.items() if name in library]
    roads = library.get(MAP)
    network = roads.get("network") if isinstance(roads, Mapping) else None
    if isinstance(network, Network) and map_of(program, params, None) is None:
        found.append(f"note: {ON_DEFAULT_MAP}")
    if isinstance(network, Network) and network.warnings:
        more = len(network.warnings) - MOST_NOTES
        found += [f"note: the map has {line}" for line in network.warnings[:MOST_NOTES]]
        found += [f"note: {more} more notes about the map: `scenic-ref map FILE` lists them"] if more > 0 else []
    return found
