"""The options that several commands share, and the program that they describe."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..interpreter.runtime.limits import Limits, bytes_of, seconds_of
from ..sampling.program_source import Source
from .shell_completion import alternatives, dialects, models, profiles, words

if TYPE_CHECKING:
    from .session import Session


def set_debug(context: typer.Context, wanted: bool) -> None:
    """`--debug` may stand before or after the command."""
    context.obj.debug = context.obj.debug or wanted


DebugOption = Annotated[bool, typer.Option("--debug", callback=set_debug, help="Show the traceback of an internal error.")]
FileArgument = Annotated[str, typer.Argument(metavar="FILE", help="The Scenic program.")]
SeedOption = Annotated[int, typer.Option("--seed", metavar="SEED", help="The seed: a scene follows from the program, the seed and its number.")]
ProfileOption = Annotated[
    str | None,
    typer.Option(
        "--profile", metavar="PROFILE", autocompletion=words(profiles), help="A profile of readings; see `scenic-ref readings`.",
        show_default="that of the dialect",
    ),
]
ReadingOption = Annotated[
    list[str] | None,
    typer.Option("--reading", metavar="ID=ALT", autocompletion=words(alternatives), help="One reading of the paper, whatever the profile says."),
]
DialectOption = Annotated[
    str | None,
    typer.Option("--dialect", metavar="DIALECT", autocompletion=words(dialects), help="The program's syntax: paper, pldi19, scenic-2.1 or scenic-3."),
]
ModelOption = Annotated[
    str | None, typer.Option("--model", metavar="MODEL", autocompletion=words(models), help="The world model, in place of the program's.")
]
ScenarioOption = Annotated[
    str | None, typer.Option("--scenario", metavar="NAME", help="The modular scenario to begin with.", show_default="Main, if there is one")
]
ParamOption = Annotated[
    list[str] | None, typer.Option("-p", "--param", metavar="NAME=VALUE", help="A global parameter; wins over the program's.")
]
MapOption = Annotated[
    str | None,
    typer.Option("--map", metavar="PATH", show_default=False, help="The parameter map: roads (.xodr), or a map of one's own (.geojson, .wkt, .shp)."),
]
AttemptsOption = Annotated[int, typer.Option("--max-attempts", metavar="ATTEMPTS", min=1, help="Give up on a scene after so many attempts.")]
FuelOption = Annotated[int, typer.Option("--fuel", metavar="STEPS", min=1, help="The most steps that one attempt may take.")]
LimitMemoryOption = Annotated[
    str, typer.Option("--limit-memory", metavar="SIZE", help="The memory for a program without --trust, such as 512M or 4G; none: no limit.")
]
LimitSecondsOption = Annotated[
    str,
    typer.Option(
        "--limit-seconds", metavar="SECONDS",
        help="The processor time for one attempt, one time step, parsing or a map of a program without --trust; none: no limit."
    ),
]
DEFAULT_MEMORY, DEFAULT_SECONDS = "4G", "60"
TrustOption = Annotated[bool, typer.Option("--trust", help="Let the program import any Python module.")]


def read_source(
    session: Session, file: str, *, profile: str | None, reading: list[str] | None, dialect: str | None, model: str | None, param: list[str] | None,
    fuel: int, trust: bool, limits: Limits, prune: bool = False, scenario: str | None = None, device: str | None = None, map: str | None = None,
) -> Source:
    """The program in `file` under the given options; `map` is the global parameter of that name. Raises `UsageError`."""
    from ..interpreter.language.modules import read_text

    session.program = file
    text = read_text(Path(file))
    session.texts[file] = text
    params = with_map(pairs(param, "-p", "NAME=VALUE"), map)
    return Source(
        file, text, profile, pairs(reading, "--reading", "ID=ALT"), dialect, model, params, fuel, trust, prune,
        scenario, limits, device,
    )


def with_map(params: tuple[tuple[str, str], ...], map: str | None) -> tuple[tuple[str, str], ...]:
    """The global parameters, with the one that `--map` gives. Raises `UsageError` if it is given twice."""
    from ..semantics.store.errors import UsageError

    if map is None:
        return params
    if any(name == "map" for name, _ in params):
        raise UsageError("the map is given twice, by --map and by -p map=...")
    return (*params, ("map", repr(map)))


def limits_of(memory: str, seconds: str) -> Limits:
    """The limits that the options give. Raises `UsageError`."""
    return Limits(bytes_of(memory), seconds_of(seconds))


def pairs(given: list[str] | None, option: str, form: str) -> tuple[tuple[str, str], ...]:
    """`NAME=VALUE` arguments as pairs; the last one of a name counts. Raises `UsageError`."""
    from ..semantics.store.errors import UsageError

    found: dict[str, str] = {}
    for text in given or ():
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise UsageError(f"{option} expects {form}, not {text!r}")
        found[name.strip()] = value.strip()
    return tuple(found.items())
