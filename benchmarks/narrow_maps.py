"""Programs on made-up maps of narrow or lone roads, on which each technique of pruning shows what it can do at best."""

from __future__ import annotations

ROADS = """
cells = [{cells}]
direction = PolygonalVectorField("direction", [(region.polygon, heading) for region, heading in cells])
road = PolygonalRegion(polygon=[region.polygon for region, heading in cells], orientation=direction)
workspace = Workspace(road)
"""
SEEN = "with viewDistance 15, with viewAngle 360 deg"


def lane(x: float, width: float, heading: float, length: float = 200.0) -> str:
    """A straight lane from South to North whose left edge is at x."""
    return f"(PolygonalRegion([({x}, 0), ({x + width}, 0), ({x + width}, {length}), ({x}, {length})]), {heading})"


def roads(*lanes: str) -> str:
    """The map with these lanes."""
    return ROADS.format(cells=", ".join(lanes))


NARROW = {
    "narrow_lanes (containment)": roads(*(lane(20 * k, 2.4, 0) for k in range(6)))
    + f"ego = Object in road, with width 1.8, with length 4.2, facing direction, {SEEN}\n",
    "lone_opposite (orientation)": roads(*(lane(40 * k, 4, 0) for k in range(8)), lane(4, 4, 3.14159))
    + f"ego = Object in road, with width 1.8, with length 4.2, facing direction, {SEEN}\n"
    + "other = Object in road, with width 1.8, with length 4.2, facing Range(-5, 5) deg relative to direction\n"
    + "require abs(relative heading of other) >= 150 deg\n",
    "side_by_side (size)": roads(*(lane(40 * k, 4, 0) for k in range(8)), lane(4, 4, 0))
    + f"ego = Object in road, with width 1.8, with length 4.2, facing direction, {SEEN}\n"
    + "Object at ego offset by (4.2, Range(-2, 2)), with width 1.8, with length 4.2, facing direction\n",
}
