"""The figures of a benchmark as tables on a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import geometric_mean
from typing import TYPE_CHECKING

from .figures import Cell, Figures, fit_exponent
from .growth import WHAT

if TYPE_CHECKING:
    from rich.table import Table

NARROWEST = 140
"""Columns of the output where no terminal says how many there are."""


def print_tables(figures: Figures) -> None:
    """All tables, on standard output."""
    from rich.console import Console

    console = Console(highlight=False)
    if not console.is_terminal and console.width < NARROWEST:
        console = Console(width=NARROWEST, highlight=False)
    if figures.cells:
        console.print(table_of(figures))
        console.print(table_of_means(figures))
    if any(figures.writing(cell) for cell in figures.cells):
        console.print(table_of_writing(figures))
    for kind, cells in figures.growth.items():
        console.print(table_of_growth(kind, cells))
    for line in reasons(figures):
        console.print(line, markup=False)
    console.print(load_line(figures), style="dim", markup=False)


def empty_table(title: str, words: Sequence[str], numbers: Sequence[str]) -> Table:
    """A table without rows: columns of words, then of numbers."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    for name in words:
        table.add_column(name, no_wrap=True)
    for name in numbers:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def table_of(figures: Figures) -> Table:
    """One row for each program and implementation."""
    numbers = (f"{figures.what}/s", "least", "most", "attempts/scene", "prepare s", "peak MiB", "ratio")
    table = empty_table(f"{figures.what} per second of the processor; ratios to {figures.standard}", ("program", "implementation"), numbers)
    for program in figures.programs():
        cells = [cell for cell in figures.cells if cell.program == program]
        for cell in cells:
            table.add_row(program if cell is cells[0] else "", cell.contender, *row(cell), times(figures.ratio(cell)), end_section=cell is cells[-1])
    return table


def row(cell: Cell) -> tuple[str, ...]:
    """The figures of a cell, but for the ratio."""
    if not cell.samples:
        return ("-",) * 6
    least, most = min(cell.rates), max(cell.rates)
    return (*(format_digits(x) for x in (cell.rate, least, most, cell.attempts, cell.prepare)), format_digits(cell.peak, digits=3))


def table_of_means(figures: Figures) -> Table:
    """One row for each implementation: the geometric mean of its ratios."""
    table = empty_table(f"geometric means of the ratios to {figures.standard}", ("implementation",), ("ratio", "programs"))
    for name, (mean, count) in figures.means().items():
        table.add_row(name, times(mean), str(count))
    return table


def table_of_writing(figures: Figures) -> Table:
    """Return the table of the cost of writing drawn scenes: a row for each program and format, then one for
    each format.
    """
    numbers = ("drawing, µs/scene", "writing, µs/scene", "writing/drawing", "numbers/scene", "writing, ns/number")
    table = empty_table("writing beside drawing, in time of the processor for each further scene", ("program", "implementation"), numbers)
    shares: dict[str, list[float]] = {}
    for cell in figures.cells:
        if (found := figures.writing(cell)) is not None:
            row = (1e6 * found.drawing, 1e6 * found.writing, found.share, found.numbers, found.per_number)
            table.add_row(cell.program, cell.contender, *(format_digits(x, digits=3) for x in row))
            shares.setdefault(cell.contender, []).append(found.share)
    table.add_section()
    for name, found in shares.items():
        table.add_row("geometric mean", name, "-", "-", format_digits(geometric_mean(max(share, 1e-3) for share in found), digits=3), "-", "-")
    return table


def table_of_growth(kind: str, cells: Sequence[Cell]) -> Table:
    """The cost of a scene and of an attempt by size, one row for each size and implementation; then how it grows."""
    numbers = ("µs/scene", "µs/attempt", "attempts/scene", "prepare s", "peak MiB")
    table = empty_table(f"growth with the number of {WHAT[kind]}", (kind, "implementation"), numbers)
    for cell in cells:
        if cell.rate is None or cell.attempts is None:
            table.add_row(f"{growing_size(cell):,}", cell.contender, *("-",) * 5)
            continue
        cost = 1e6 / cell.rate
        figures = (cost, cost / cell.attempts, cell.attempts, cell.ready.get("prepare"))
        table.add_row(f"{growing_size(cell):,}", cell.contender, *(format_digits(x) for x in figures), format_digits(cell.peak, digits=3))
    table.caption = "; ".join(f"{name}: cost of an attempt ~ {kind}^{power:.2f}" for name, power in powers(cells).items())
    table.caption_justify = "left"
    return table


def growing_size(cell: Cell) -> int:
    """The number of objects or polygons of a program that grows."""
    return int(cell.program.partition("_")[0])


def powers(cells: Sequence[Cell]) -> dict[str, float]:
    """For each implementation the power of the size that the cost of an attempt grows with."""
    found = {}
    for name in dict.fromkeys(cell.contender for cell in cells):
        points = [(growing_size(c), 1 / (c.rate * c.attempts)) for c in cells if c.contender == name and c.rate and c.attempts]
        power = fit_exponent(points)
        if power is not None:
            found[name] = power
    return found


def reasons(figures: Figures) -> list[str]:
    """Why cells are empty, each reason once."""
    cells = [*figures.cells, *(cell for found in figures.growth.values() for cell in found)]
    return [f"{cell.program}, {cell.contender}: {cell.skipped}" for cell in cells if cell.skipped is not None]


def load_line(figures: Figures) -> str:
    """How busy the machine was."""
    shown = [f"{' '.join(f'{x:.2f}' for x in values)} {when}" for when, values in figures.load.items() if values]
    return f"load average (1, 5, 15 minutes): {', '.join(shown)}" if shown else ""


def format_digits(value: float | None, digits: int = 4) -> str:
    """A number with `digits` significant digits, and commas."""
    if value is None:
        return "-"
    return f"{value:,.0f}" if abs(value) >= 10 ** (digits - 1) else f"{value:.{digits}g}"


def times(ratio: float | None) -> str:
    """Return a ratio as text."""
    return "-" if ratio is None else f"{format_digits(ratio, digits=3)}x"
