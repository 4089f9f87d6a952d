"""The figures of a benchmark as bars on a logarithmic scale."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..pictures.scene_figures import CLASSES, EGO, INK, check_format, figure_bytes

if TYPE_CHECKING:
    from .figures import Figures

WIDTH, THICK = 8.5, 0.16
"""Inches: of the picture, and of a bar."""


def bars(figures: Figures, *, format: str = "png") -> bytes:
    """Scenes per second: a group of bars for each program, a bar for each implementation, from the least to the most. Raises `UsageError`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    check_format(format)
    programs, contenders = figures.programs(), figures.contenders
    figure = Figure(figsize=(WIDTH, 1.3 + THICK * len(programs) * (len(contenders) + 1)), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    step = 1 / (len(contenders) + 1)
    for number, contender in enumerate(contenders):
        found = [(place, cell) for place, p in enumerate(programs) if (cell := figures.cell(p, contender)) is not None and cell.samples]
        rates = [cell.rate or 0.0 for _, cell in found]
        spread = [[r - min(c.rates) for r, (_, c) in zip(rates, found)], [max(c.rates) - r for r, (_, c) in zip(rates, found)]]
        colour = EGO if contender == figures.standard else CLASSES[number % len(CLASSES)]
        places = [place + (number + 1) * step - 0.5 for place, _ in found]
        if found:
            axes.barh(places, rates, height=0.9 * step, color=colour, label=contender, xerr=spread, error_kw={"elinewidth": 0.7, "ecolor": INK})
    axes.set_xscale("log")
    axes.set_yticks(range(len(programs)), programs, fontsize=8)
    axes.invert_yaxis()
    axes.tick_params(labelsize=8)
    axes.set_xlabel(f"{figures.what} per second of the processor (median; lines from the least to the most)", fontsize=8, color=INK)
    figure.legend(loc="outside upper center", ncols=min(4, len(contenders)), frameon=False, fontsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure_bytes(figure, format)
