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
    plot: Annotated[str | None, typer.Option("--plot", metavar="PATH", help="Draw the scenes (or the probabilities), as .png, .pdf or .svg.")] = None,
    profile: ProfileOption = "paper",
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    param: ParamOption = None,
    max_attempts: AttemptsOption = DEFAULT_ATTEMPTS,
    fuel: FuelOption = DEFAULT_FUEL,
    workers: Annotated[int, typer.Option("--workers", metavar="K", min=1, help="Use K processes; the scenes stay the same.")] = 1,
    resume: Annotated[bool, typer.Option("--resume", help="Go on where an interrupted run to the same PATH stopped.")] = False,
    backend: Annotated[
        str, typer.Option("--backend", metavar="B", help="interpreter: draw scenes; enumerate: all outcomes with their exact probabilities.")
    ] = "interpreter",
    max_runs: Annotated[int, typer.Option("--max-runs", metavar="M", min=1, help="enumerate: give up after so many runs.")] = 20_000,
    discretize: Annotated[
        int | None,
        typer.Option("--discretize", metavar="N", min=1, help="enumerate: replace each continuous draw by N values, an approximation."),
    ] = None,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Draw scenes of a program, or enumerate all that it can give.

    On a terminal the objects of each scene are shown; into a pipe, or with -o, one scene is written per line as JSON.
    --backend enumerate answers every draw with every value, and gives each outcome with its exact probability.
    """
    from ..semantics.errors import UsageError
    from .production import Request, produce

    session = context.obj
    session.seed = seed
    if backend not in ("interpreter", "enumerate"):
        raise UsageError(f"there is no backend {backend}", hint="there are interpreter and enumerate")
    if backend == "enumerate" and (count != 1 or scene is not None or resume or workers != 1):
        raise UsageError("an enumeration gives all outcomes at once: -n, --scene, --resume and --workers do not belong to it")
    if backend != "enumerate" and discretize is not None:
        raise UsageError("--discretize belongs to --backend enumerate")
    if scene is not None and count != 1:
        raise UsageError("--scene draws a single scene, so -n cannot be given as well")
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, fuel=fuel, trust=trust
    )
    if backend == "enumerate":
        from .enumerating import Request as EnumerationRequest
        from .enumerating import produce_enumeration

        produce_enumeration(source, EnumerationRequest(max_runs, discretize, output, plot), session)
        return
    start, stop = (0, count) if scene is None else (scene, scene + 1)
    produce(source, Request(start, stop, seed, max_attempts, output, plot, workers, resume), session)
