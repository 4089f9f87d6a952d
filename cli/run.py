"""`scenic-ref run`: scenes of a program."""

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
from .shell_completion import one_of

BACKENDS = ("batch", "interpreter", "enumerate", "importance", "smc", "mcmc")
RARE = ("importance", "smc", "mcmc")
"""Those for requirements that few runs meet."""


def run(
    context: typer.Context,
    file: FileArgument,
    count: Annotated[int, typer.Option("-n", metavar="COUNT", min=0, help="How many scenes.")] = 1,
    seed: SeedOption = 0,
    scene: Annotated[int | None, typer.Option("--scene", metavar="NUMBER", min=0, help="Draw just this scene of the seed, counted from 0.")] = None,
    output: Annotated[
        str | None,
        typer.Option("-o", "--output", metavar="PATH", help="Write JSON Lines (PATH.jsonl) or a table (.parquet, .arrow, .npz, .csv); -: stdout."),
    ] = None,
    stream: Annotated[
        str,
        typer.Option(
            "--format", metavar="FORMAT", autocompletion=one_of("jsonl", "arrow"), help="What goes to stdout: jsonl, or arrow, a stream of tables."
        ),
    ] = "jsonl",
    plot: Annotated[str | None, typer.Option("--plot", metavar="PATH", help="Draw the scenes (or the probabilities), as .png, .pdf or .svg.")] = None,
    profile: ProfileOption = None,
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    scenario: ScenarioOption = None,
    param: ParamOption = None,
    map_file: MapOption = None,
    max_attempts: AttemptsOption = DEFAULT_ATTEMPTS,
    fuel: FuelOption = DEFAULT_FUEL,
    workers: Annotated[int, typer.Option("--workers", metavar="PROCESSES", min=1, help="Use so many processes; the scenes stay the same.")] = 1,
    resume: Annotated[bool, typer.Option("--resume", help="Continue an interrupted run to the same PATH.")] = False,
    backend: Annotated[
        str | None,
        typer.Option(
            "--backend", metavar="BACKEND", show_default=False,
            autocompletion=one_of("batch", "interpreter", "enumerate", "smc", "mcmc", "importance"),
            help="batch: draw many scenes at a time (the default for 10 or more); interpreter: draw the same scenes one by one; "
            "enumerate: all outcomes with their exact probabilities; smc, mcmc, importance: where few runs are accepted.",
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            "--cluster", metavar="ADDRESS", show_default=False,
            help="Draw the scenes on the Dask cluster at ADDRESS (host:port); local starts one on this machine.",
        ),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option(
            "--device", metavar="DEVICE", show_default=False,
            help="Let torch draw the scenes, on the cpu or on cuda (a GPU): the same ones, but for the last digits of numbers (extra torch).",
        ),
    ] = None,
    prune: Annotated[
        bool,
        typer.Option(
            "--prune",
            help="Draw from smaller regions, and independent parts separately, where that is safe: other scenes, from the same distribution.",
        ),
    ] = False,
    max_runs: Annotated[int, typer.Option("--max-runs", metavar="RUNS", min=1, help="enumerate: give up after so many runs.")] = 20_000,
    discretize: Annotated[
        int | None,
        typer.Option("--discretize", metavar="VALUES", min=1, help="enumerate: replace each continuous draw by so many values, an approximation."),
    ] = None,
    report: Annotated[
        str | None, typer.Option("--report", metavar="PATH", help="Write how likely a run is accepted, and what the scenes are worth, as PATH.json.")
    ] = None,
    resample: Annotated[bool, typer.Option("--resample", help="importance: scenes of weight 1, in more runs.")] = False,
    inference_data: Annotated[
        str | None, typer.Option("--inference-data", metavar="PATH", help="smc, mcmc: write all draws for ArviZ, as PATH.json or PATH.nc.")
    ] = None,
    limit_memory: LimitMemoryOption = DEFAULT_MEMORY,
    limit_seconds: LimitSecondsOption = DEFAULT_SECONDS,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Draw scenes of a program, or enumerate all that it can give.

    On a terminal the objects of each scene are shown; into a pipe, or with -o, one scene is written per line as JSON.
    The scenes are the same whatever the backend, the number of processes, and the cluster; the report says which backend drew them.
    --backend enumerate answers every draw with every value, and gives each outcome with its exact probability.
    Where few runs are accepted, smc and mcmc look for scenes step by step; these are other scenes, from the same distribution.
    """
    from ..semantics.store.errors import UsageError
    from ..semantics.store.suggestions import did_you_mean
    from .scene_run import SceneRequest, produce

    session = context.obj
    session.seed = seed
    backend = None if backend == "auto" else backend
    if backend not in (None, *BACKENDS):
        known = f"the backends are {', '.join(BACKENDS[:-1])} and {BACKENDS[-1]}"
        raise UsageError(f"there is no backend {backend}", hint=did_you_mean(backend, BACKENDS, known))
    if backend == "enumerate" and (count != 1 or scene is not None or resume or workers != 1 or cluster is not None):
        raise UsageError("an enumeration gives all outcomes at once: -n, --scene, --resume, --workers and --cluster cannot be given with it")
    if backend == "enumerate" and prune:
        raise UsageError("an enumeration draws nothing: --prune cannot be given with it")
    if backend == "enumerate" and stream != "jsonl":
        raise UsageError("an enumeration is written as JSON: --format cannot be given with it")
    if backend != "enumerate" and discretize is not None:
        raise UsageError("--discretize needs --backend enumerate")
    if scene is not None and count != 1:
        raise UsageError("--scene draws a single scene, so -n cannot be given as well")
    if backend in RARE:
        given = {
            "--scene": scene is not None, "--resume": resume, "--workers": workers != 1, "--cluster": cluster is not None, "--prune": prune,
            "-n 0": count == 0,
        }  # fmt: skip
        wrong = [name for name, is_given in given.items() if is_given]
        if wrong:
            raise UsageError(f"{backend} draws all scenes together: {' and '.join(wrong)} cannot be given with it", hint="leave it out")
        if backend != "importance" and max_attempts != DEFAULT_ATTEMPTS:
            raise UsageError(f"{backend} makes no attempts at one scene after the other: --max-attempts cannot be given with it", hint="leave it out")
    if backend not in ("smc", "mcmc") and inference_data is not None:
        raise UsageError("--inference-data needs --backend smc or mcmc")
    if device is not None and (backend not in (None, "batch") or resume):
        raise UsageError("torch evaluates the batch backend's graph: other backends, and --resume, cannot be given with --device")
    if backend != "importance" and resample:
        raise UsageError("--resample needs --backend importance")
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, map=map_file, fuel=fuel, trust=trust,
        limits=limits_of(limit_memory, limit_seconds), prune=prune, scenario=scenario, device=device,
    )
    if backend == "enumerate":
        from .enumeration_run import EnumerationRequest, produce_enumeration

        produce_enumeration(source, EnumerationRequest(max_runs, discretize, output, plot, report), session)
        return
    if backend in RARE:
        from .inference_run import InferenceRequest, produce_inference

        request = InferenceRequest(str(backend), count, seed, max_attempts, output, plot, report, resample, inference_data, stream)
        produce_inference(source, request, session)
        return
    start, stop = (0, count) if scene is None else (scene, scene + 1)
    backend = backend or ("auto" if device is None else "batch")
    produce(source, SceneRequest(start, stop, seed, max_attempts, output, plot, workers, resume, backend, cluster, report, stream), session)
