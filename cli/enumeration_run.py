"""`scenic-ref run --backend enumerate`: the exact distribution, as a table, as JSON, and as a bar chart."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..data.scene import in_json
from ..inference.comparison.relations import table_of
from ..inference.comparison.scene_columns import Column
from ..inference.enumeration import Enumeration
from ..inference.result import Probability, backend_report
from ..sampling.program_source import Source
from ..sampling.scene_sampler import drawing_of
from .output_paths import PICTURES, check_ending, check_file, check_place, write
from .scene_run import rehearse
from .session import Session, console, escape_controls, tell

if TYPE_CHECKING:
    from rich.status import Status

MOST_ROWS = 40
MOST_COLUMNS = 6
EVERY = 200  # runs between two signs of life


class EnumerationRequest(NamedTuple):
    """The request of an enumeration: its limits, and the files to write."""

    max_runs: int
    discretize: int | None
    output: str | None
    plot: str | None
    report: str | None


def produce_enumeration(source: Source, request: EnumerationRequest, session: Session) -> None:
    """Enumerate the program and show or write what was found. Raises `UsageError`, `RunsExhausted`, and the program's errors."""
    check_paths(source, request)
    begun = time.process_time()
    drawing = drawing_of(source)
    rehearse(drawing)
    with Life() as life:
        found = drawing.scenario.enumerate(max_runs=request.max_runs, discretize=request.discretize, on_run=life.sign)
    if found.discretized is not None:
        tell(f"an approximation: each continuous draw was replaced by {found.discretized:,} equally likely values")
    if request.output is None and sys.stdout.isatty():
        show_outcomes(found)
    else:
        text = in_json(found.to_json(), indent=1) + "\n"
        if request.output is None or request.output == "-":
            sys.stdout.write(text)
        else:
            write(request.output, text)
    exactly = "" if found.discretized is None else " (approximately)"
    tell(f"{len(found.outcomes):,} outcomes of {found.runs:,} runs; P(a run is accepted) = {fraction(found.acceptance)}{exactly}")
    for requirement, share in sorted(found.stuck.items(), key=lambda item: -item[1])[:5]:
        tell(f"  {float(share):.3%} of the runs fail here: {requirement.text} ({requirement.span})")
    if request.report is not None:
        write(request.report, in_json(report_of(found, time.process_time() - begun), indent=1) + "\n")
    if request.plot is not None:
        plot(found, request.plot, Path(source.file).name)


def report_of(found: Enumeration, seconds: float) -> dict[str, object]:
    """The report: its scenes are the outcomes, its attempts the runs that were made; an interval without width, if it is exact."""
    share = float(found.acceptance)
    n = found.discretized
    warnings = [] if n is None else [f"an approximation: each continuous draw was replaced by {n:,} equally likely values"]
    exact = Probability(share, share, share, 1.0) if n is None else Probability(share, 0.0, 1.0, 1.0)
    return backend_report("enumerate", len(found.outcomes), found.runs, exact, None, None, None, seconds, warnings)


class Life:
    """A progress bar on a terminal while runs are made."""

    def __init__(self) -> None:
        self.status: Status | None = None

    def __enter__(self) -> Life:
        if sys.stderr.isatty():
            self.status = console(sys.stderr).status("enumerating")
            self.status.start()
        return self

    def __exit__(self, *of_exception: object) -> None:
        if self.status is not None:
            self.status.stop()

    def sign(self, runs: int, covered: Fraction) -> None:
        """How many runs were made, and which part of the probability they cover."""
        if self.status is not None and runs % EVERY == 0:
            self.status.update(f"{runs:,} runs, {float(covered):.1%} of the probability")


def check_paths(source: Source, request: EnumerationRequest) -> None:
    """Find wrong paths before the work begins. Raises `UsageError`."""
    for path in (request.output, request.plot, request.report):
        if path is None or path == "-":
            continue
        check_place(path, {"the program itself": source.file})
    if request.output is not None:
        check_ending("-o", request.output, "enumerations", (".json",))
    if request.plot is not None:
        check_ending("--plot", request.plot, "pictures", PICTURES)
    check_file("--report", request.report, "reports", (".json",))


def varying_features(found: Enumeration) -> list[Column]:
    """The features in which the outcomes differ: those that stand in a scene, without copies of others."""
    columns: list[Column] = []
    seen: set[tuple[str, ...]] = set()
    for column in table_of(found.scenes).columns.values():
        values = tuple(str(v) for v in column.values)
        if not column.is_relation and column.name not in ("attempts", "ego") and len(set(values)) > 1 and values not in seen:
            seen.add(values)
            columns.append(column)
    return columns


def short_feature_name(name: str) -> str:
    """A short name of a feature."""
    name = name.replace(".properties.", ".").removeprefix("params.").replace(".position[0]", ".x").replace(".position[1]", ".y")
    return name.replace("objects[", "").replace("].", ".", 1) if name.startswith("objects[") else name


def cell(column: Column, row: int) -> str:
    """The value of a feature in an outcome."""
    return f"{column.values[row]:.6g}" if column.is_number else str(column.values[row])


def fraction(p: Fraction) -> str:
    """A probability as a fraction, if that is short, and in per cent."""
    text = str(p)
    return f"{text} = {float(p):.4%}" if len(text) <= 24 else f"{float(p):.6%}"


def show_outcomes(found: Enumeration) -> None:
    """The outcomes as a table: their probabilities, and the features in which they differ."""
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    columns = varying_features(found)
    table = Table(box=SIMPLE_HEAD, caption_justify="left", caption_style="dim")
    table.add_column("probability", justify="right", no_wrap=True)
    table.add_column("", justify="right", no_wrap=True)
    for column in columns[:MOST_COLUMNS]:
        table.add_column(escape(escape_controls(short_feature_name(column.name))), justify="right")
    for row, (p, _) in enumerate(found.outcomes[:MOST_ROWS]):
        table.add_row(
            str(p) if len(str(p)) <= 24 else "", f"{float(p):.4%}", *(escape(escape_controls(cell(c, row))) for c in columns[:MOST_COLUMNS])
        )
    more = [f"{len(found.outcomes) - MOST_ROWS:,} more outcomes"] if len(found.outcomes) > MOST_ROWS else []
    more += [f"{len(columns) - MOST_COLUMNS:,} more features that differ"] if len(columns) > MOST_COLUMNS else []
    table.caption = f"... and {' and '.join(more)}; -o PATH.json writes all of them" if more else None
    console(sys.stdout).print(table)


def plot(found: Enumeration, path: str, name: str) -> None:
    """The outcomes as bars, the likeliest first. Raises `UsageError`."""
    from ..pictures.scene_figures import bar_chart

    columns = varying_features(found)[:MOST_COLUMNS]
    shown = found.outcomes[:MOST_ROWS]
    labels = [", ".join(f"{short_feature_name(c.name)} = {cell(c, row)}" for c in columns) or "the only outcome" for row in range(len(shown))]
    heights = [float(p) for p, _ in shown]
    if len(found.outcomes) > MOST_ROWS:
        labels.append(f"the other {len(found.outcomes) - MOST_ROWS:,} outcomes")
        heights.append(float(sum((p for p, _ in found.outcomes[MOST_ROWS:]), Fraction(0))))
    about = "exact" if found.discretized is None else f"approximate: {found.discretized} values for each continuous draw"
    write(path, bar_chart(clip_labels(labels), heights, f"{name}, {about}", format=Path(path).suffix[1:].lower()))


def clip_labels(labels: Sequence[str]) -> list[str]:
    """Labels, shortened to leave room for their bars."""
    return [label if len(label) <= 60 else f"{label[:59]}…" for label in labels]
