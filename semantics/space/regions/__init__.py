"""Regions: sets of points that can be sampled uniformly, tested for points and boxes, and combined."""

from .combinations import DifferenceRegion, IntersectionRegion, UnionRegion
from .errors import BadRegion, EmptyRegion, UnboundedRegion
from .plane_shapes import PlaneShape
from .polygons import PolygonalRegion
from .region import Region, everywhere, nowhere
from .shapes import AlongCurve, CircularRegion, PointSetRegion, PolylineRegion, RectangularRegion, SectorRegion
from .workspace import Workspace

__all__ = [
    "AlongCurve",
    "BadRegion",
    "CircularRegion",
    "DifferenceRegion",
    "EmptyRegion",
    "IntersectionRegion",
    "PlaneShape",
    "PointSetRegion",
    "PolygonalRegion",
    "PolylineRegion",
    "RectangularRegion",
    "Region",
    "SectorRegion",
    "UnboundedRegion",
    "UnionRegion",
    "Workspace",
    "everywhere",
    "nowhere",
]
