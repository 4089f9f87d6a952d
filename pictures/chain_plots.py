"""Draws of Markov chains and populations: as inference data, which ArviZ reads, and as pictures of traces and
ranks.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, cast

import numpy as np

from ..data.scene import in_json
from ..interpreter.runtime.optional_packages import missing_package_error
from .scene_figures import CLASSES, EDGE, INK, draw_scenes, figure_bytes, multiples_layout, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import SubFigure

    from ..data.scene import Scene

MOST_SHOWN = 4
"""Quantities in a picture: those about which the chains agree least."""
GROUPS = 8
"""Of chains, each with its colour: neighbours, which began in one population, are together."""
BINS = 20
LINE = 0.6


def inference_data(names: Sequence[str], draws: np.ndarray, report: Mapping[str, object]) -> dict[str, object]:
    """In the form of ArviZ's `from_json`; `draws` is (names, chains, draws), and the report becomes an attribute. What does not vary is left out."""
    return {
        "posterior": {name: values.tolist() for name, values in varying_quantities(names, draws)},
        "posterior_attrs": {"inference_library": "scenic-ref", "report": in_json(dict(report))},
    }


def varying_quantities(names: Sequence[str], draws: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """The quantities that are not the same in all draws."""
    return ((name, values) for name, values in zip(names, draws, strict=True) if np.ptp(values) > 0)


def inference_data_in(path: str, names: Sequence[str], draws: np.ndarray, report: Mapping[str, object]) -> bytes:
    """Return inference data as the bytes of a file, JSON or netCDF by the ending of its path; netCDF needs
    ArviZ.
    """
    found = inference_data(names, draws, report)
    if Path(path).suffix.lower() != ".nc":
        return in_json(found).encode()
    import arviz

    with TemporaryDirectory() as folder:
        made = Path(folder) / "draws.nc"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # there are more chains than draws
            data = arviz.from_dict(dict(varying_quantities(names, draws)), posterior_attrs=found["posterior_attrs"])
        data.to_netcdf(str(made))
        return made.read_bytes()


def needs_arviz() -> None:
    """Raise `UsageError` unless inference data can be written as netCDF."""
    try:
        import arviz  # noqa: F401  # pyright: ignore[reportUnusedImport]
    except ImportError as problem:
        raise missing_package_error("inference data as netCDF", "arviz", problem, ", or write it as .json, which ArviZ reads as well") from None


def picture_with_chains(scenes: Sequence[Scene], names: Sequence[str], draws: np.ndarray, rhats: Sequence[float], kind: str, *, format: str) -> bytes:
    """The scenes, and below them traces and ranks of some quantities, the least agreed upon first; populations have ranks only.

    `draws` is (names, chains, draws); `kind` is "chain" or "population". Raises `UsageError`.
    """
    shown = sorted((k for k in range(len(names)) if np.ptp(draws[k]) > 0), key=lambda k: -rhats[k])[:MOST_SHOWN]
    rows, columns, side = multiples_layout(len(scenes))
    tall, height = rows * (side + 0.3), 1.6 * len(shown) + 0.5
    figure = new_figure(max(columns * side, 8.0), tall + height)
    above, below = cast("list[SubFigure]", figure.subfigures(2, 1, height_ratios=[tall, height]))
    draw_scenes(above, scenes, None)
    for row, k in enumerate(shown):
        draw_quantity(below, row, len(shown), f"{names[k]}, R-hat {rhats[k]:.3f}", draws[k], kind)
    return figure_bytes(figure, format)


def draw_quantity(figure: SubFigure, row: int, rows: int, title: str, draws: np.ndarray, kind: str) -> None:
    """A row of the picture: the trace of one chain of each group, and how the ranks of each group are spread among all."""
    groups = np.array_split(draws, min(GROUPS, len(draws)))
    columns = 2 if kind == "chain" else 1
    if columns == 2:
        trace = figure.add_subplot(rows, 2, 2 * row + 1)
        for k, group in enumerate(groups):
            trace.plot(group[0], color=CLASSES[k % len(CLASSES)], linewidth=LINE, alpha=0.8)
        trace.set_title(title, fontsize=8, color=INK, loc="left")
        trace.set_xlabel("draw (of one chain in each group)" if row == rows - 1 else "", fontsize=7)
        trace.tick_params(labelsize=7)
    ranks = figure.add_subplot(rows, columns, columns * row + columns)
    order = np.argsort(np.argsort(draws, axis=None, kind="stable")).reshape(draws.shape) / draws.size
    edges = np.linspace(0.0, 1.0, BINS + 1)
    split = np.array_split(order, len(groups))
    for k, group in enumerate(split):
        counts = np.histogram(group, edges)[0] / group.size * BINS
        ranks.stairs(counts, edges, color=CLASSES[k % len(CLASSES)], linewidth=LINE)
    ranks.axhline(1.0, color=EDGE, linewidth=LINE, zorder=0)
    ranks.set_ylim(0.0, max(2.0, math.ceil(ranks.get_ylim()[1])))
    ranks.set_title("ranks" if columns == 2 else f"{title}: ranks", fontsize=8, color=INK, loc="left")
    lines = kind if len(groups) == len(draws) else f"group of {kind}s"
    ranks.set_xlabel(f"rank among all draws; a line for each {lines}, at 1 where they agree" if row == rows - 1 else "", fontsize=7)
    ranks.tick_params(labelsize=7)

