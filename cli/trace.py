"""`scenic-ref trace`: the rules that fire in one run of a program."""

from __future__ import annotations

from typing import Annotated

import typer

from ..sampling.program_source import DEFAULT_ATTEMPTS, DEFAULT_FUEL
from .options import (
    DEFAULT_MEMORY,
    DEFAULT_SECONDS,
    AttemptsOption,
    DebugOption,
    DialectOption,
    FileArgument,
    FuelOption,
    LimitMemoryOption,
    LimitSecondsOption,
    MapOption,
    ModelOption,
    ParamOption,
    ProfileOption,
    ReadingOption,
    ScenarioOption,
    SeedOption,
    TrustOption,
    limits_of,
    read_source,
)
from .shell_completion import simulators, words


def trace(
    context: typer.Context,
    file: FileArgument,
    seed: SeedOption = 0,
    scene: Annotated[int, typer.Option("--scene", metavar="NUMBER", min=0, help="Trace a run for this scene of the seed, counted from 0.")] = 0,
    attempt: Annotated[
        int | None, typer.Option("--attempt", metavar="NUMBER", min=1, help="Trace this attempt, counted from 1, rather than the accepted one.")
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="Also show the rules inherited from Python, and those for default values.")] = False,
    html: Annotated[str | None, typer.Option("--html", metavar="PATH", help="Write a page to step through the run instead.")] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", metavar="STEPS", min=0, help="Go on after the scene: the policy's rules in at most so many time steps.")
    ] = None,
    simulator: Annotated[
        str, typer.Option("--simulator", metavar="NAME", autocompletion=words(simulators), help="With --steps: as for simulate.")
    ] = "still",
    timestep: Annotated[
        float | None, typer.Option("--dt", metavar="SECONDS", help="With --steps: the time step.", show_default="1 for still, 0.1 for others")
    ] = None,
    scenario: ScenarioOption = None,
    profile: ProfileOption = None,
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    param: ParamOption = None,
    map_file: MapOption = None,
    max_attempts: AttemptsOption = DEFAULT_ATTEMPTS,
    fuel: FuelOption = DEFAULT_FUEL,
    limit_memory: LimitMemoryOption = DEFAULT_MEMORY,
    limit_seconds: LimitSecondsOption = DEFAULT_SECONDS,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Show every rule that fires in a run.

    Each has its name, its probability, what it changes, and its place in the source.

    With --steps, a run is a simulation: its scene, then time steps. `--scene K` is then the one that `simulate --run K` gives.
    """
    from ..sampling.scene_sampler import drawing_of
    from ..semantics.store.errors import UsageError
    from ..simulators import by_name
    from .diagnostic_formats import tell_notes
    from .output_paths import check_ending, check_place
    from .trace_output import WhichRun, trace_attempt, traced_simulation, write_page, write_text

    session = context.obj
    session.seed = seed
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, map=map_file, fuel=fuel, trust=trust,
        limits=limits_of(limit_memory, limit_seconds), scenario=scenario
    )
    if html is not None:
        check_place(html, {"the program itself": source.file})
        check_ending("--html", html, "pages", (".html", ".htm"))
    asked = WhichRun(seed, scene, attempt, max_attempts)
    if steps is None:
        if simulator != "still" or timestep is not None:
            raise UsageError("--simulator and --dt are for simulations only", hint="give the number of time steps as well: --steps N")
        found = trace_attempt(source, asked)
    else:
        found = traced_simulation(source, asked, by_name(simulator, timestep), steps)
    if html is None:
        write_text(found, session.texts, everything=everything)
    else:
        write_page(found, session.texts, html)
    if found.error is not None:
        raise found.error
    tell_notes(drawing_of(source).scenario)
