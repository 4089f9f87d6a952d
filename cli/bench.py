"""`scenic-ref bench`: how fast programs are sampled, by every backend and by released implementations, side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .options import DebugOption, TrustOption
from .shell_completion import one_of

if TYPE_CHECKING:
    from ..benchmarks.figures import Figures
    from ..benchmarks.measurement import CourseRequest


def bench(
    context: typer.Context,
    programs: Annotated[list[str] | None, typer.Argument(metavar="PROGRAM", help="The Scenic programs.", show_default=False)] = None,
    seconds: Annotated[float, typer.Option("--seconds", metavar="SECONDS", help="Seconds of the processor for each measurement.")] = 1.0,
    repeat: Annotated[int, typer.Option("--repeat", metavar="TIMES", min=1, help="How many times each is measured, in turns.")] = 3,
    against: Annotated[
        list[str] | None,
        typer.Option(
            "--against", metavar="NAME==VERSION=PYTHON", show_default=False,
            help="Also measure a released implementation, in the environment of this Python: scenic==3.1.1=/path/to/bin/python.",
        ),
    ] = None,
    released: Annotated[
        str | None,
        typer.Option(
            "--released", metavar="DIR", show_default=False,
            help="A folder with the programs in the syntax of the released implementations, under the same names; "
            "by default they get the programs themselves.",
        ),
    ] = None,
    prune: Annotated[bool, typer.Option("--prune", help="Also measure the batch backend with pruning.")] = False,
    growth: Annotated[bool, typer.Option("--growth", help="Measure how cost grows with the number of objects and of polygons.")] = False,
    end_to_end: Annotated[
        bool, typer.Option("--end-to-end", help="Measure what `run` to a file takes, in each format, beside drawing by the fastest backend.")
    ] = False,
    formats: Annotated[
        list[str] | None,
        typer.Option(
            "--format", metavar="FORMAT", show_default=False, autocompletion=one_of("jsonl", "npz", "parquet", "arrow", "csv"),
            help="With --end-to-end: only jsonl, npz, parquet, arrow or csv.",
        ),
    ] = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Measure time steps of simulations in the kinematic simulator, in place of scenes.")
    ] = False,
    steps: Annotated[int, typer.Option("--steps", metavar="STEPS", min=1, help="With --simulate: time steps of a simulation, at most.")] = 200,
    trust: TrustOption = False,
    seed: Annotated[int, typer.Option("--seed", metavar="SEED", help="The seed of the scenes.")] = 0,
    output: Annotated[str | None, typer.Option("--json", metavar="PATH", help="Write all figures as JSON.")] = None,
    plot: Annotated[str | None, typer.Option("--plot", metavar="PATH", help="Draw scenes per second as bars, as .png, .pdf or .svg.")] = None,
    debug: DebugOption = False,
) -> None:
    """Measure how fast scenes are drawn, or simulations run.

    The interpreter, the batch backend (on columns, compiled, by torch) and released implementations draw each program in a process of their own.
    They take turns on one core, and scenes are counted per second of the processor. Ratios are to the first --against, else to the
    interpreter. Ctrl-C shows what is measured so far.

    With --simulate time steps are counted, of compiled behaviors, of the machine and of the released implementation's Newtonian simulator;
    what the scenes take is left out. A program for all of them names its map by `param map = localPath(...)`.

    Exit codes: 0, 1 if nothing could be measured of a program, 2 wrong usage.
    """
    from ..benchmarks.end_to_end import FORMATS
    from ..benchmarks.measurement import CourseRequest, measure_request
    from ..semantics.store.errors import UsageError
    from .session import tell

    context.obj.seed = seed
    if not programs and not growth:
        raise UsageError("there is nothing to measure", hint="give programs, or --growth")
    if end_to_end and (prune or growth or against):
        raise UsageError("--end-to-end measures the command itself, and goes with none of --prune, --growth and --against")
    if simulate and (prune or growth or end_to_end or not programs):
        raise UsageError("--simulate measures programs, and goes with none of --prune, --growth and --end-to-end")
    if formats and not end_to_end:
        raise UsageError("--format says which files --end-to-end measures")
    if unknown := [form for form in formats or () if form not in FORMATS]:
        raise UsageError(f"there is no format {unknown[0]}", hint=f"the formats are {', '.join(FORMATS)}")
    if plot is not None and not programs:
        raise UsageError("--plot draws the figures of programs, so it needs some")
    if not 0 < seconds < float("inf"):
        raise UsageError("--seconds must be a positive number")
    check_outputs(programs or (), output, plot)
    request = CourseRequest(
        tuple(programs or ()), seconds, repeat, tuple(against or ()), released, prune, growth, seed, end_to_end, trust, tuple(formats or FORMATS),
        steps if simulate else None,
    )
    figures = measure_request(request, tell, lambda figures: finish(figures, request, output, plot))
    if unmeasured := figures.unmeasured():
        tell(f"nothing could be measured of {', '.join(unmeasured)}")
        raise typer.Exit(1)


def check_outputs(programs: Sequence[str], output: str | None, plot: str | None) -> None:
    """Raise `UsageError` unless the files can be written."""
    from .output_paths import PICTURES, check_ending, check_place

    for place in (output, plot):
        if place is not None:
            check_place(place, {f"the program {Path(p).stem}": p for p in programs})
    if output is not None:
        check_ending("--json", output, "figures", (".json",))
    if plot is not None:
        check_ending("--plot", plot, "pictures", PICTURES)


def finish(figures: Figures, request: CourseRequest, output: str | None, plot: str | None) -> None:
    """The tables on standard output, the files."""
    from ..benchmarks.terminal_tables import print_tables
    from .output_paths import write
    from .session import tell

    if figures.interrupted:
        tell("interrupted: these figures are what was measured so far")
    print_tables(figures)
    if output is not None:
        write(output, json.dumps(figures.json(request.json()), indent=1) + "\n")
    if plot is not None and any(cell.rate is not None for cell in figures.cells):
        from ..benchmarks.bar_chart import bars

        write(plot, bars(figures, format=Path(plot).suffix[1:].lower()))
