"""Programs in which something can be pruned, some of them random."""

from __future__ import annotations

import math

import numpy as np

MAP = """
west = PolygonalRegion([(0, 0), (6, 0), (6, 60), (0, 60)])
east = PolygonalRegion([(6, 0), (12, 0), (12, 60), (6, 60)])
far = PolygonalRegion([(20, 0), (26, 0), (26, 60), (20, 60)])
direction = PolygonalVectorField("direction", [(west.polygon, 0), (east.polygon, 3.1), (far.polygon, 0.2)])
road = PolygonalRegion(polygon=[west.polygon, east.polygon, far.polygon], orientation=direction)
workspace = Workspace(road)
"""
"""Two lanes side by side, in opposite directions, and one farther off."""

SEES_ALL = "with viewDistance 200, with viewAngle 360 deg"
EGO = f"ego = Object in road, with width 1, with length 2, {SEES_ALL}\n"
OTHER = "other = Object in road, with width 2, with length 4\n"
NEAR = "require (distance to other) <= 9\n"


def random_map(rng: np.random.Generator) -> str:
    """A map like `MAP`: a few lanes, which may touch and overlap, each turned a little, most with a heading along them."""
    lines, names, headings = [], [], []
    for k in range(int(rng.integers(2, 5))):
        x, width, length, lean = rng.uniform(0, 60), rng.uniform(2, 12), rng.uniform(15, 50), rng.uniform(-8, 8)
        corners = [(x, 0), (x + width, 0), (x + width + lean, length), (x + lean, length)]
        lines.append(f"lane{k} = PolygonalRegion({[(round(float(a), 3), round(float(b), 3)) for a, b in corners]})")
        along = math.atan2(-lean, length) + math.pi * rng.integers(0, 2)
        heading = along if rng.random() < 0.6 else rng.uniform(-math.pi, math.pi)
        names.append(f"lane{k}.polygon")
        headings.append(f"{heading:.3f}")
    cells = ", ".join(f"({name}, {heading})" for name, heading in zip(names, headings, strict=True))
    lines.append(f'direction = PolygonalVectorField("direction", [{cells}])')
    lines.append(f"road = PolygonalRegion(polygon=[{', '.join(names)}], orientation=direction)")
    return "\n".join(lines) + "\n"


def random_program(rng: np.random.Generator) -> str:
    """A program with a random map, two or three objects, and requirements hard and soft on headings, distances and regions."""
    size = lambda: f"with width {rng.uniform(0.3, 2.5):.2f}, with length Range(1, {rng.uniform(1.1, 4):.2f})"  # noqa: E731
    text = random_map(rng) + ("workspace = Workspace(road)\n" if rng.random() < 0.8 else "")
    text += "big = RectangularRegion((30, 25), 0, 90, 60)\n"
    ego = f"in road, {size()}, {turn(rng)}" if rng.random() < 0.8 else f"in big, {size()}, facing Range(0, 6)"
    text += f"ego = Object {ego}, with viewDistance {rng.uniform(8, 25):.1f}, with viewAngle 360 deg, {free(rng)}\n"
    for name in ("a", "b")[: int(rng.integers(1, 3))]:
        places = ["in road", f"in lane{rng.integers(2)}", f"at ego.position offset by ({rng.uniform(-1, 1):.2f}, 0.5)"]
        places.append(f"offset by (Range(-4, {rng.uniform(-4, 6):.2f}), Range(2, {rng.uniform(2, 9):.2f}))")
        places.append(f"at ego offset by ({rng.uniform(-5, 5):.2f}, Range(3, 5))")
        contained = ", with regionContainedIn lane0" if rng.random() < 0.2 else ""
        facing = turn(rng) if rng.random() < 0.8 else "facing Range(0, 6)"
        text += f"{name} = Object {places[int(rng.integers(5))]}, {size()}, {facing}, {free(rng)}{contained}\n"
        text += "".join(requirement(rng, name) for _ in range(int(rng.integers(0, 4))))
    return text + (["mutate\n", "mutate a\n", "mutate ego by 2\n"][int(rng.integers(3))] if rng.random() < 0.25 else "")


def free(rng: np.random.Generator) -> str:
    """Default requirements switched off, or not."""
    return f"with requireVisible {rng.random() < 0.5}, with allowCollisions {rng.random() < 0.8}"


def turn(rng: np.random.Generator) -> str:
    """A heading along the map, more or less."""
    deviation = rng.choice([0.0, 0.05, 0.5])
    return f"facing Range({-deviation}, {deviation}) relative to direction" if rng.random() < 0.7 else "facing direction"


def requirement(rng: np.random.Generator, name: str) -> str:
    """A requirement on the object, hard or soft."""
    kind = "require" if rng.random() < 0.7 else f"require[{rng.uniform(0.1, 0.9):.2f}]"
    angle, conditions = rng.uniform(-3, 3), []
    conditions.append(f"abs(relative heading of {name}) <= {abs(angle):.2f}")
    conditions.append(f"abs(relative heading of {name}) >= {abs(angle):.2f}")
    conditions.append(f"(relative heading of {name}) >= {angle:.2f} and (relative heading of {name}) <= {angle + 1:.2f}")
    conditions.append(f"abs((relative heading of {name}) - {angle:.2f}) <= 0.6")
    conditions.append(f"not (relative heading of ego from {name}) >= {angle:.2f}")
    conditions.append(f"(distance to {name}) <= {rng.uniform(4, 20):.2f}")
    conditions.append(f"{name} in lane0")
    conditions.append("(ego.position offset along direction by (0, 1)) in big")
    conditions.append(f"(distance from {name} to ego) < {rng.uniform(4, 20):.2f} and ego in road")
    conditions.append(f"(distance to {name}) >= {rng.uniform(2, 6):.2f} or {name} in lane1")
    return f"{kind} {conditions[int(rng.integers(len(conditions)))] if rng.random() < 0.7 else conditions[2]}\n"


SOFTLY_ALIGNED = """
west = PolygonalRegion([(0, 0), (6, 0), (6, 60), (0, 60)])
direction = PolygonalVectorField("direction", [(west.polygon, 0)])
workspace = Workspace(PolygonalRegion([(0, 0), (30, 0), (30, 60), (0, 60)]))
ego = Object in workspace
other = Object at ego.position offset by (0.5, 0.5), with allowCollisions True, with requireVisible False
require[0.2] (ego.position offset along direction by (0, 1)) in west
"""
"""A field that has a value at ego in a few accepted runs only: those in which the soft requirement is enforced."""
