"""Worlds: the modules that Scenic programs import for their simulator's regions, fields and classes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path

from ...interpreter.language.modules import World
from ...roads.user_maps import FEATURES
from ...semantics.machine.values import Native
from ...semantics.python.builtins import BUILTINS
from ...semantics.syntax import Program
from . import driving, site_maps
from .city import city
from .gta import data


@cache
def _text(name: str) -> str:
    return (files(__spec__.parent if __spec__ else "scenic_ref.simulators.worlds") / name).read_text(encoding="utf-8")


@cache
def gta_map() -> Mapping[str, object]:
    """The regions and the traffic direction of the synthetic city, under the names of the paper."""
    town = city()
    return {
        "MODELS": data.MODELS, "COLOR_WEIGHTS": data.COLOR_WEIGHTS, "WEATHER_WEIGHTS": data.WEATHER_WEIGHTS,
        "road": town.road_region(), "curb": town.curb_region(), "roadDirection": town.road_direction(),
    }


UNCHANGED = Native("distributionFunction", lambda function: function)
OF_RELEASES = {**BUILTINS, "distributionFunction": UNCHANGED, "distributionMethod": UNCHANGED}
"""What the modules of the releases may give. Any function or method here takes random values, so that these decorators have nothing to do."""
CORE = {
    "vectors": "Vector VectorField PolygonalVectorField",
    "regions": "Region everywhere nowhere CircularRegion SectorRegion RectangularRegion PolygonalRegion PolylineRegion PointSetRegion",
    "workspaces": "Workspace",
    "object_types": "Point OrientedPoint Object",
    "distributions": "Range DiscreteRange Normal TruncatedNormal Uniform Discrete Options distributionFunction distributionMethod",
}
"""What the language has, under the names of the released implementations' modules."""

SIMULATORS = {"newtonian": "NewtonianSimulator", "webots": "WebotsSimulator", "carla": "CarlaSimulator", "lgsvl": "LGSVLSimulator"}
"""Simulators of the released implementations that `simulator` may name, by their modules."""


def simulators_of(name: str) -> Callable[[], str]:
    """The module of a simulator: programs import its name for `simulator NAME()`, which is read and not evaluated; nothing else can be done by it."""
    why = "which simulator runs a program says whoever runs it: scenic-ref simulate --simulator NAME"
    return lambda: f"def {name}(*arguments, **options):\n    raise NotImplementedError({why!r})\n"


WORLDS: Mapping[str, Callable[[], str | Mapping[str, object]]] = {
    "scenic.simulators.gta.model": lambda: _text("gta/model.scenic"),
    "scenic.simulators.gta.map": gta_map,
    **driving.FIXED,
    "scenic.simulators.utils.colors": lambda: _text("driving/colors.scenic"),
    "scenic.simulators.utils.rgb": lambda: {"RGB": data.RGB, "COLOR_WEIGHTS": data.COLOR_WEIGHTS},
    "gtaLib": lambda: "from scenic.simulators.gta.model import *\n",
    "scenic.simulators.newtonian.model": lambda: "",  # it has no classes or regions of its own
    **{f"scenic.core.{module}": lambda names=names: {name: OF_RELEASES[name] for name in names.split()} for module, names in CORE.items()},
    **{f"scenic.simulators.{module}{end}": simulators_of(name) for module, name in SIMULATORS.items() for end in ("", ".simulator")},
    "mars": lambda: _text("mars/mars.scenic"),
    "scenic.simulators.webots.mars.model": lambda: "from mars import *\n",
    site_maps.MODEL: lambda: site_maps.TEXT,
    FEATURES: dict,
}
"""Shipped modules by name: the text of a Scenic module, or the namespace of a Python one."""

PARAMS_READ: Mapping[str, tuple[str, ...]] = {
    "map": ("scenic.domains.driving.model", site_maps.MODEL, driving.MAP, driving.MAPS[0]), site_maps.CRS: (site_maps.MODEL,),
    "map_options": ("scenic.domains.driving.model", driving.MAP, driving.MAPS[0]),
}  # fmt: skip
"""The global parameters that modules read before a program runs, with these modules."""


def modules_of(program: Program, params: Mapping[str, object], directory: Path | None) -> Mapping[str, World]:
    """All shipped modules for a program: those that depend on its map as well."""
    return {**WORLDS, **driving.modules(program, params, directory), **site_maps.modules(program, params, directory)}
