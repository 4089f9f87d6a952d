"""`scenic-ref simulate`: run dynamic scenarios in a simulator."""

from __future__ import annotations

from enum import StrEnum
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


class SimulationBackendName(StrEnum):
    """The backends of simulations."""

    COMPILED = "compiled"
    INTERPRETER = "interpreter"


DECIDED = {"count": "-n", "seed": "--seed", "run": "--run", "steps": "--steps", "max_attempts": "--max-attempts"}
"""The options whose values a recording decides, by parameter."""


def simulate(
    context: typer.Context,
    file: FileArgument,
    simulator: Annotated[
        str,
        typer.Option(
            "--simulator", metavar="NAME", autocompletion=words(simulators),
            help="still (nothing moves, any value is an action), kinematic (no forces), pymunk (collisions), sumo (traffic on roads), or your own: "
            "package.module:Class, from the current folder or installed.",
        ),
    ] = "still",
    steps: Annotated[int, typer.Option("--steps", metavar="STEPS", min=0, help="The time limit, in time steps.")] = 100,
    timestep: Annotated[
        float | None,
        typer.Option(
            "--dt", metavar="SECONDS", help="The time step in seconds.", show_default="1 for still, 0.1 for others; with --replay, that of RUNS"
        ),
    ] = None,
    count: Annotated[int, typer.Option("-n", metavar="COUNT", min=1, help="How many simulations.")] = 1,
    seed: SeedOption = 0,
    run: Annotated[int | None, typer.Option("--run", metavar="NUMBER", min=0, help="Run only this simulation of the seed, counted from 0.")] = None,
    scenario: ScenarioOption = None,
    output: Annotated[
        str | None, typer.Option("-o", "--output", metavar="PATH", help="Write one simulation per line as JSON (- for standard output).")
    ] = None,
    html: Annotated[
        str | None, typer.Option("--html", metavar="PATH", help="Also write a page that plays the simulations again (at most 50).")
    ] = None,
    gif: Annotated[
        str | None, typer.Option("--gif", metavar="PATH", help="Also write an animation of the (first) simulation, in real time.")
    ] = None,
    replay: Annotated[
        str | None,
        typer.Option(
            "--replay", metavar="RUNS", help="Take the actions recorded in RUNS (simulations of FILE, as -o writes them), in place of the program's."
        ),
    ] = None,
    workers: Annotated[int, typer.Option("--workers", metavar="PROCESSES", min=1, help="Use so many processes; the simulations stay the same.")] = 1,
    cluster: Annotated[
        str | None,
        typer.Option(
            "--cluster", metavar="ADDRESS", show_default=False,
            help="Run the simulations on the Dask cluster at ADDRESS (host:port); local starts one on this machine.",
        ),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the simulations of PATH, whose last one is checked.")] = False,
    backend: Annotated[
        SimulationBackendName,
        typer.Option(
            "--backend",
            help="What runs behaviors: Python code made from them (what has no translation is left to the machine), or the machine for all. The "
            "simulations are the same.",
        ),
    ] = SimulationBackendName.COMPILED,
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
    """Run simulations of a program.

    A simulation is a scene, then time steps in which the agents act. A run that violates a requirement is discarded with its scene, and
    another one begins. On a terminal the end of each simulation is shown; into a pipe, or with -o, one simulation is written per line as
    JSON, as soon as it is finished. --fuel limits each time step.

    A simulator may discard a run as well, or end it. One of your own is Python code that you choose to run: --trust is not needed for it.

    With --replay the scenes are generated again, and must be those of RUNS; the report says how far the states differ from the recorded
    ones.
    """
    from ..semantics.store.errors import UsageError
    from .simulation_run import SimulationRequest, produce_simulations

    session = context.obj
    session.seed = seed
    if replay is not None:
        sources = {name: context.get_parameter_source(parameter) for parameter, name in DECIDED.items()}
        given = [name for name, source in sources.items() if source is not None and source.name != "DEFAULT"]
        if given:
            raise UsageError(f"the recording decides what is replayed: {', '.join(given)} cannot be given with --replay")
        if resume:
            raise UsageError("what is replayed begins anew: --resume cannot be given with --replay")
        if workers > 1:
            raise UsageError("one process replays: --workers cannot be given with --replay", hint="leave it out")
        if cluster is not None:
            raise UsageError("one process replays: --cluster cannot be given with --replay", hint="leave it out")
        session.seed = None
    if run is not None and count != 1:
        raise UsageError("--run asks for a single simulation, so -n cannot be given as well")
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, map=map_file, fuel=fuel, trust=trust,
        limits=limits_of(limit_memory, limit_seconds), scenario=scenario
    )
    first = 0 if run is None else run
    request = SimulationRequest(
        first, first + count, seed, max_attempts, simulator, steps, timestep, output, html, gif, replay, workers, backend.value, resume, cluster,
    )  # fmt: skip
    produce_simulations(source, request, session)
