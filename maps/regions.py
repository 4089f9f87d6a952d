"""The regions that elements of a network make up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from shapely.geometry import MultiPolygon, Polygon

from ..semantics.space.fields import Cell, PolygonalVectorField, VectorField
from ..semantics.space.regions import PolygonalRegion, Region, nowhere
from .shapes import united

if TYPE_CHECKING:
    from .elements import LinearElement, NetworkElement


def region(elements: Sequence[LinearElement], name: str) -> Region:
    """The union of elements, oriented by the first of them at a point; the empty region if there are none."""
    cells: list[Cell] = [cell for element in elements for cell in element.strips]
    return region_along(elements, name, PolygonalVectorField(f"direction of {name}", cells))


def region_along(elements: Sequence[NetworkElement], name: str, orientation: VectorField) -> Region:
    """The union of elements, oriented by a field; the empty region if there are none."""
    whole = united([element.polygon for element in elements]) if elements else None
    return nowhere if whole is None else PolygonalRegion(polygon=whole, orientation=orientation, name=name)


def polygons(shape: Polygon | MultiPolygon) -> list[Polygon]:
    """The polygons of an area."""
    return list(shape.geoms) if isinstance(shape, MultiPolygon) else [shape]
