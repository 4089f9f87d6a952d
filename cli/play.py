"""`scenic-ref play`: a page that draws the scenes of a program while one types."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import (
    DebugOption,
    DialectOption,
    FuelOption,
    LimitMemoryOption,
    MapOption,
    ModelOption,
    ParamOption,
    ProfileOption,
    ReadingOption,
    ScenarioOption,
    SeedOption,
    TrustOption,
    limits_of,
)

PORT = 8642
FUEL = 1_000_000
MEMORY, SECONDS = "2G", "15"


def play(
    context: typer.Context,
    file: Annotated[
        str | None, typer.Argument(metavar="FILE", help="The Scenic program to begin with, or a link that the page made.", show_default=False)
    ] = None,
    port: Annotated[
        int | None,
        typer.Option("--port", metavar="PORT", min=0, max=65535, help="The port.", show_default=f"{PORT}, or a free one where that is taken"),
    ] = None,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Show the address, and open no browser.")] = False,
    seed: SeedOption = 0,
    profile: ProfileOption = None,
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    scenario: ScenarioOption = None,
    param: ParamOption = None,
    map_file: MapOption = None,
    fuel: FuelOption = FUEL,
    limit_memory: LimitMemoryOption = MEMORY,
    limit_seconds: Annotated[
        str, typer.Option("--limit-seconds", metavar="SECONDS", help="The time for one answer, with or without --trust; none: no limit.")
    ] = SECONDS,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Draw the scenes of a program while one types.

    A page in the browser has the program on one side and its scenes on the other: what rejected, histograms with exact laws, traces, readings,
    simulations. It works without a network; the server answers on this machine only, and only to who has the token of its address. Every answer is
    worked out by a process of its own, which --limit-seconds and --limit-memory end. FILE is read, and never written.
    Ctrl-C ends the server. Needs the extra play.
    """
    from ..playground.page_assembly import begin, source_of

    session = context.obj
    session.seed = seed
    source, linked = source_of(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, map=map_file, fuel=fuel, trust=trust,
        limits=limits_of(limit_memory, limit_seconds), scenario=scenario,
    )
    begin(source, linked, seed, PORT if port is None else port, otherwise=port is None, browser=not no_browser)
