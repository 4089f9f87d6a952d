"""The regions that elements of a network make up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import shapely
from shapely.geometry import MultiPolygon, Polygon

from ..semantics.space.fields import Cell, PolygonalVectorField, VectorField
from ..semantics.space.regions import PolygonalRegion, PolylineRegion, Region, nowhere
from .shapes import united

if TYPE_CHECKING:
    from .elements import LinearElement, NetworkElement
    from .network import Network


class OfNetwork:
    """What a network has by a name, under which it is pickled."""

    scenic_made = True

    network: Network

    def __reduce__(self) -> tuple[object, ...]:
        return getattr, (self.network, self.name)  # type: ignore[attr-defined]


class NetworkRegion(OfNetwork, PolygonalRegion):
    """A region of a network."""


class NetworkCurve(OfNetwork, PolylineRegion):
    """A curve of a network."""


class NetworkField(OfNetwork, PolygonalVectorField):
    """A field of a network."""


def region(elements: Sequence[LinearElement], name: str, network: Network | None = None) -> Region:
    """The union of elements, oriented by the first of them at a point; the empty region if there are none."""
    cells: list[Cell] = [cell for element in elements for cell in element.strips]
    return region_along(elements, name, PolygonalVectorField(f"direction of {name}", cells), network)


def region_along(elements: Sequence[NetworkElement], name: str, orientation: VectorField, network: Network | None) -> Region:
    """The union of elements, oriented by a field; the empty region if there are none."""
    if not elements:
        return nowhere
    whole = united([element.polygon for element in elements])
    if network is None:
        return PolygonalRegion(polygon=whole, orientation=orientation, name=name)
    made = NetworkRegion(polygon=whole, orientation=orientation, name=name)
    made.network = network
    return made


def fringe(cells: Sequence[Cell], elements: Sequence[NetworkElement], width: float) -> list[Cell]:
    """What is so near to the cells of elements but outside these: the cells so much wider, in their order, where they come out of the elements."""
    if not cells:
        return []
    whole = united([element.polygon for element in elements])
    shapely.prepare(whole)
    wider = shapely.buffer([polygon for polygon, _ in cells], width, quad_segs=2)
    outside = ~shapely.covers(whole, wider)
    return [(polygon, heading) for polygon, (_, heading), kept in zip(wider, cells, outside, strict=True) if kept]


def polygons(shape: Polygon | MultiPolygon) -> list[Polygon]:
    """The polygons of an area."""
    return list(shape.geoms) if isinstance(shape, MultiPolygon) else [shape]
