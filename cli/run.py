"""`scenic-ref run`: scenes of a program."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import (
    DEFAULT_ATTEMPTS,
    DEFAULT_FUEL,
    AttemptsOption,
    DebugOption,
    DialectOption,
    FileArgument,
    FuelOption,
    ModelOption,
    ParamOption,
    ProfileOption,
    ReadingOption,
    SeedOption,
    TrustOption,
    read_source,
)


def run(
    context: typer.Context,
    file: FileArgument,
    count: Annotated[int, typer.Option("-n", metavar="N", min=0, help="How many scenes.")] = 1,
    seed: SeedOption = 0,
    scene: Annotated[int | None, typer.Option("--scene", metavar="K", min=0, help="Draw just scene K of the seed.")] = None,
    output: Annotated[
        str | None, typer.Option("-o", "--output", metavar="PATH", help="Write JSON Lines (or a table, if PATH ends in .parquet); - for stdout.")
    ] = None,
    plot: Annotated[str | None, typer.Option("--plot", metavar="PATH", help="Draw the scenes, as .png, .pdf or .svg.")] = None,
    profile: ProfileOption = "paper",
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    param: ParamOption = None,
    max_attempts: AttemptsOption = DEFAULT_ATTEMPTS,
    fuel: FuelOption = DEFAULT_FUEL,
    workers: Annotated[int, typer.Option("--workers", metavar="K", min=1, help="Use K processes; the scenes stay the same.")] = 1,
    resume: Annotated[bool, typer.Option("--resume", help="Go on where an interrupted run to the same PATH stopped.")] = False,
    backend: Annotated[str, typer.Option("--backend", metavar="B", help="Who runs the program: interpreter.")] = "interpreter",
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Draw scenes of a program.

    On a terminal the objects of each scene are shown; into a pipe, or with -o, one scene is written per line as JSON.
    """
    from ..semantics.errors import UsageError
    from .production import Request, produce

    session = context.obj
    session.seed = seed
    if backend != "interpreter":
        raise UsageError(f"there is no backend {backend}", hint="there is interpreter")
    if scene is not None and count != 1:
        raise UsageError("--scene draws a single scene, so -n cannot be given as well")
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, fuel=fuel, trust=trust
    )
    start, stop = (0, count) if scene is None else (scene, scene + 1)
    produce(source, Request(start, stop, seed, max_attempts, output, plot, workers, resume), session)
