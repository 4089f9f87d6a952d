"""`scenic-ref bench`: how fast programs are sampled, by every backend and by released implementations, side by side."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import DebugOption


def bench(
    context: typer.Context,
    programs: Annotated[list[str] | None, typer.Argument(metavar="[PROGRAM]...", help="The Scenic programs.", show_default=False)] = None,
    seconds: Annotated[float, typer.Option("--seconds", metavar="S", help="Seconds of the processor for each measurement.")] = 1.0,
    repeat: Annotated[int, typer.Option("--repeat", metavar="R", min=1, help="Measure each so many times, taking turns.")] = 3,
    against: Annotated[
        list[str] | None,
        typer.Option(
            "--against", metavar="NAME==VERSION=PYTHON", show_default=False,
            help="Measure a released implementation as well, in the environment of this python: scenic==3.1.1=/path/to/bin/python.",
        ),
    ] = None,
    released: Annotated[
        str | None,
        typer.Option(
            "--released", metavar="DIR", show_default=False,
            help="Where the released implementations find the programs, under the same names in their syntax; else they get the programs themselves.",
        ),
    ] = None,
    prune: Annotated[bool, typer.Option("--prune", help="Measure the batch backend with pruning as well.")] = False,
    growth: Annotated[bool, typer.Option("--growth", help="Measure how cost grows with the number of objects and of polygons.")] = False,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="The seed of the scenes.")] = 0,
    output: Annotated[str | None, typer.Option("--json", metavar="PATH", help="Write all figures as JSON.")] = None,
    plot: Annotated[str | None, typer.Option("--plot", metavar="PATH", help="Draw scenes per second as bars, as .png, .pdf or .svg.")] = None,
    debug: DebugOption = False,
) -> None:
    """Measure how fast scenes are drawn: by the interpreter, by the batch backend on columns and compiled, and by released implementations.

    Each program and implementation has a process of its own; they take turns on one core, and scenes are counted per second of the
    processor. Ratios are to the first --against, else to the interpreter. Ctrl-C shows what is measured so far.
    """
    from ..semantics.kernel.errors import UsageError
    from .bench_running import Request, measure

    context.obj.seed = seed
    if not programs and not growth:
        raise UsageError("there is nothing to measure", hint="give programs, or --growth")
    if plot is not None and not programs:
        raise UsageError("--plot draws the figures of programs: give some")
    if not 0 < seconds < float("inf"):
        raise UsageError("--seconds must be a positive number")
    measure(Request(tuple(programs or ()), seconds, repeat, tuple(against or ()), released, prune, growth, seed, output, plot))
