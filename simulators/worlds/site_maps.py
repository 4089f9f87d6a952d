"""The world model `site_map`: the regions of a map of one's own, which the global parameter `map` names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ...interpreter.language.modules import World
from ...roads.geodata import read_site
from ...roads.user_maps import FEATURES, SiteMap
from ...semantics.store.errors import ImportRefused, ScenicError
from ...semantics.syntax import Program
from ...semantics.syntax.nodes import NOWHERE, Span
from ...semantics.syntax.python_expressions import Constant
from ...semantics.syntax.statements import Param
from .driving import map_of
from .driving.named_maps import beside_program_hint

MODEL = "site_map"
CRS = "map_crs"
TEXT = f"from {FEATURES} import *\n"
"""The module in Scenic."""
WORKSPACE = "workspace = Workspace(regions['workspace'] if 'workspace' in regions else area)\n"
"""Where objects must lie, on a map with areas."""
NO_MAP = "the model site_map needs a map"
HOW = "write `param map = localPath('site.geojson')` before it, or set the parameter map (-p map=site.geojson)"


def modules(program: Program, params: Mapping[str, object], directory: Path | None) -> Mapping[str, World]:
    """The modules that depend on the map of a program, which is read once."""
    read: list[SiteMap | Exception] = []

    def site() -> SiteMap | Exception:
        if not read:
            read.append(site_of(program, params, directory))
        return read[0]

    def of_features() -> Mapping[str, object] | Exception:
        found = site()
        return found if isinstance(found, Exception) else found.namespace

    def of_model() -> str | Exception:
        found = site()
        return found if isinstance(found, Exception) else TEXT + (WORKSPACE if found.areas() else "")

    return {FEATURES: of_features, MODEL: of_model}


def site_of(program: Program, params: Mapping[str, object], directory: Path | None) -> SiteMap | Exception:
    """The map that a program names, or why it cannot be had."""
    named = map_of(program, params, directory)
    crs, where = crs_of(program, params)
    if named is None:
        return ImportRefused(NO_MAP, hint=HOW)
    if isinstance(named, Exception):
        return named
    if crs is not None and not isinstance(crs, str):
        return ImportRefused(f"the parameter {CRS} must be a text, such as 'metres' or 'EPSG:25832'", where)
    _, path, span = named
    try:
        return read_site(path, crs)
    except ScenicError as problem:
        return ImportRefused(problem.message, span, hint=beside_program_hint(path, directory) or problem.hint)


def crs_of(program: Program, params: Mapping[str, object]) -> tuple[object, Span]:
    """The global parameter `map_crs` before the program runs, and where it is given: None if it is not, a node if it is no constant."""
    if CRS in params:
        return params[CRS], NOWHERE
    for statement in reversed(program.statements):
        for one in statement.assignments if isinstance(statement, Param) else ():
            if one.name == CRS:
                return one.value.value if isinstance(one.value, Constant) else one.value, one.value.span
    return None, NOWHERE
