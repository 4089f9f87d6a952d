"""How the cost of a scene grows: programs with more and more objects, and on maps of more and more polygons."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from pathlib import Path

from .implementations import MeasuredProgram, Ours

OBJECTS = (2, 5, 10, 20, 50, 200, 1_000, 2_000)
POLYGONS = (50, 500, 5_000, 50_000)
FEW = {"objects": 2_000, "polygons": 500}
"""The interpreter is measured up to these sizes."""
SIDE = 10.0
FIELD = 10_000.0
WHAT = {
    "objects": f"objects of 2 m by 4 m, uniform in an empty square of {FIELD / 1000:g} km",
    "polygons": f"polygons: a grid of square cells of {SIDE:g} m, each with its heading, as road and as field; two cars",
}


def programs(kind: str, directory: Path) -> Iterator[tuple[int, MeasuredProgram]]:
    """The programs by size, written into `directory`."""
    for size in OBJECTS if kind == "objects" else POLYGONS:
        path = directory / f"{size}_{kind}.scenic"
        path.write_text(many_objects(size) if kind == "objects" else many_polygons(size), encoding="utf-8")
        yield size, MeasuredProgram(path.stem, str(path), trust=True)


def contenders(kind: str, size: int, numba: bool) -> list[Ours]:
    """Who is measured at a size."""
    return [*([Ours("interpreter")] if size <= FEW[kind] else []), Ours("numpy"), *([Ours("numba")] if numba else [])]


def many_objects(count: int) -> str:
    """A program with `count` objects, all independent."""
    half = FIELD / 2
    place = f"Object at (Range({-half}, {half}), Range({-half}, {half})), with width 2, with length 4, facing Range(0, 360) deg"
    place += ", with requireVisible False"
    return f"ego = {place}\n" + f"{place}\n" * (count - 1)


def many_polygons(count: int) -> str:
    """Two cars on a map of `count` cells."""
    car = "with width 2, with length 4, with requireVisible False"
    return (
        f"from {__name__} import grid\nroad, direction = grid({count})\nworkspace = Workspace(road)\n"
        f"ego = Object in road, facing direction, {car}\nObject in road, facing direction, {car}\n"
    )


@functools.cache
def grid(count: int) -> tuple[object, object]:
    """A road of `count` square cells in rows, and the field of their headings, which turns from cell to cell."""
    import numpy as np
    import shapely

    from ..semantics.space.fields import PolygonalVectorField
    from ..semantics.space.regions import PolygonalRegion

    across = math.ceil(math.sqrt(count))
    rows, columns = np.divmod(np.arange(count), across)
    cells = shapely.box(columns * SIDE, rows * SIDE, (columns + 1) * SIDE, (rows + 1) * SIDE)
    headings = ((rows * 7 + columns * 3) % 12) * math.pi / 6
    direction = PolygonalVectorField("direction", list(zip(cells, headings.tolist())))
    union = shapely.union_all(cells)
    assert isinstance(union, shapely.Polygon)
    return PolygonalRegion(polygon=union, orientation=direction, name="road"), direction
