"""`scenic-ref map`: what is in a road map."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from .options import DebugOption
from .shell_completion import map_kinds, words

if TYPE_CHECKING:
    from ..roads.network import Network

NAMES = {"left": "left turns", "right": "right turns", "u_turn": "U-turns", "merge": "from lane to lane outside intersections"}
"""Of kinds of maneuvers, where they are not those of the JSON."""
SITES = (".geojson", ".json", ".wkt", ".shp")
UNITS = {"areas": "m²", "lines": "m", "points": ""}
"""Of the sizes of features."""


def show_map(
    file: Annotated[
        str | None,
        typer.Argument(metavar="FILE", help="The map: roads (.xodr), or one's own (.geojson, .wkt, .shp); with --make, where it is written, or -."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
    plot: Annotated[str | None, typer.Option("--plot", metavar="PICTURE", help="Draw the map: a .png, .pdf or .svg file.")] = None,
    check: Annotated[bool, typer.Option("--check", help="Look for gaps at joints, roads that overlap, and lanes that cannot be reached.")] = False,
    make: Annotated[
        str | None,
        typer.Option(
            "--make", metavar="KIND", autocompletion=words(map_kinds),
            help="Make a grid, crossing, t, roundabout, highway or suburb; without FILE, list the parameters and their values.",
        ),
    ] = None,
    param: Annotated[
        list[str] | None, typer.Option("-p", "--param", metavar="NAME=VALUE", help="A parameter of --make, or map_crs of one's own map.")
    ] = None,
    debug: DebugOption = False,
) -> None:
    """Say what is in a map, draw it, or make one.

    Roads, lanes, intersections, and the maneuvers through them, or the features of one's own.

    Roads are counted outside intersections; lanes are counted everywhere. Lengths are in metres.

    Exit codes: 0, 1 if --check finds something, 2 wrong usage or a broken map.
    """
    from ..semantics.store.errors import UsageError
    from .output_paths import PICTURES, check_file, check_place, write

    check_file("--plot", plot, "pictures", PICTURES)
    if plot is not None and file is not None:
        check_place(plot, {"the map": file})
    if file is None:
        print("\n".join(map_kind_help(make)))
        return
    is_site = Path(file).suffix.lower() in SITES
    if make is not None:
        if is_site:
            raise UsageError(f"--make writes road maps, .xodr files, and {Path(file).name} is no name of one")
        if file != "-":
            check_place(file, {})
        text = generated_map_text(make, param or [])
        if file == "-":
            print(text, end="")
            return
        write(file, text)
    if is_site:
        if check:
            raise UsageError("--check is about road maps")
        show_site(file, crs_in(param or []), as_json=as_json, plot=plot)
        return
    if param and make is None:
        raise UsageError("-p gives parameters of --make, or map_crs of a map of one's own")
    from ..roads import read_map
    from ..roads.map_summary import faults, summary

    network = read_map(file)
    found = list(faults(network)) if check else []
    told = summary(network)
    if as_json:
        print(json.dumps({**told, **({"faults": found} if check else {})}, ensure_ascii=False, indent=2))
    else:
        print("\n".join(line for line in lines(told) if line.removeprefix("note: ") not in found))
        if check:
            print("\n".join(f"fault: {fault}" for fault in found) or "no faults were found")
    if plot is not None:
        write(plot, map_image(network, plot))
    if found:
        raise typer.Exit(1)


def crs_in(given: list[str]) -> str | None:
    """The parameter map_crs, None if it is not given. Raises `UsageError` for others."""
    from ..sampling.program_source import literal
    from ..semantics.store.errors import UsageError
    from ..simulators.worlds.site_maps import CRS
    from .options import pairs

    values = {name: str(literal(value)) for name, value in pairs(given, "--param", "NAME=VALUE")}
    if others := values.keys() - {CRS}:
        raise UsageError(f"there is no parameter {min(others)}: of a map of one's own there is {CRS}")
    return values.get(CRS)


def show_site(file: str, crs: str | None, *, as_json: bool, plot: str | None) -> None:
    """Say what is on a map of one's own, and draw it."""
    from ..pictures.map_figures import site_picture
    from ..roads.geodata import read_site
    from .output_paths import write
    from .text_columns import columns

    site = read_site(Path(file), crs)
    told = site.summary()
    if as_json:
        print(json.dumps(told, ensure_ascii=False, indent=2))
    else:
        rows = []
        for one in cast("list[dict[str, object]]", told["features"]):
            heading = "" if one["heading"] is None else f"{one['heading']:g}°"
            rows.append((str(one["name"] or ""), str(one["kind"]), f"{one['size']:,.1f} {UNITS[str(one['kind'])]}".rstrip(), heading))
        west, south, east, north = cast("list[float]", told["bounds"])
        print("\n".join(columns(("name", "kind", "size", "heading"), rows)))
        print(f"bounds         {west:.1f} to {east:.1f} m East, {south:.1f} to {north:.1f} m North")
        print("".join(f"note: {note}\n" for note in cast("list[str]", told["notes"])), end="")
    if plot is not None:
        write(plot, site_picture(site, format=Path(plot).suffix[1:].lower()))


def map_kind_help(kind: str | None) -> list[str]:
    """The parameters of a kind of map. Raises `UsageError` if there is none."""
    from ..roads.map_generator import KINDS
    from ..semantics.store.errors import UsageError
    from .text_columns import columns

    if kind is None:
        raise UsageError("which map? Name a file, or make one with --make")
    if kind not in KINDS:
        raise UsageError(f"there is no kind of map {kind!r}: there are {', '.join(KINDS)}")
    rows = [(name, str(parameter.default), parameter.values, parameter.about) for name, parameter in KINDS[kind].parameters.items()]
    return [f"{kind}: {KINDS[kind].description}", *columns(("parameter", "default", "values", "meaning"), rows)]


def generated_map_text(kind: str, given: list[str]) -> str:
    """The map of a kind with these parameters. Raises `UsageError`."""
    from ..roads.map_generator import KINDS, generate_map
    from ..sampling.program_source import literal
    from ..semantics.store.errors import UsageError
    from .options import pairs

    truths = {"true": True, "false": False}
    values = {name: truths.get(value.lower(), literal(value)) for name, value in pairs(given, "--param", "NAME=VALUE")}
    try:
        return generate_map(kind, **values)  # type: ignore[arg-type]  # it checks them
    except ValueError as problem:
        raise UsageError(str(problem), hint=f"`scenic-ref map --make {kind}` lists the parameters" if kind in KINDS else "") from None


def lines(told: dict[str, object]) -> list[str]:
    """A summary to read."""
    maneuvers = cast("dict[str, int]", told["maneuvers"])
    west, south, east, north = cast("list[float]", told["bounds"])
    return [
        f"roads          {told['roads']}, with {told['lanes']} lanes (connecting ones included) in {told['lane_sections']} sections",
        f"intersections  {told['intersections']}, of which {told['four_way']} join four roads",
        f"maneuvers      {', '.join(f'{count} {NAMES.get(name, name)}' for name, count in maneuvers.items())}",
        f"areas          {told['drivable_area_m2']:,.0f} m² to drive on, {told['sidewalk_area_m2']:,.0f} m² of sidewalks",
        f"furniture      {told['signals']} signals, {told['crosswalks']} crosswalks, {told['shoulders']} shoulders",
        f"bounds         {west:.1f} to {east:.1f} m East, {south:.1f} to {north:.1f} m North",
        *(f"note: {warning}" for warning in cast("list[str]", told["warnings"])),
    ]


def map_image(network: Network, path: str) -> bytes:
    """The picture of a map."""
    from ..pictures.map_figures import map_picture

    return map_picture(network, format=Path(path).suffix[1:].lower())
