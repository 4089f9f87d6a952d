"""Kernels of the compiled evaluators, compiled by numba: random numbers, and tests of points and boxes
against polygons.

The tests are those of `polygons`, one point at a time. `UNSURE` means that an edge is too near for rounding:
the run is then left to the interpreter.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numba
import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.core import cgutils
from numba.extending import get_cython_function_address, intrinsic

from ....interpreter.runtime.random_streams import (
    MULTIPLIER_0,
    MULTIPLIER_1,
    ROUNDS,
    UNIT,
    UNUSED_BITS,
    WEYL_0,
    WEYL_1,
)
from ....semantics.space.boundaries import METRES
from ....semantics.space.box_crowds import MARGIN
from ..code_cache import keep_code
from .point_in_polygon import INSIDE, OUTSIDE, TIE, UNSURE, Grid

_M0, _M1 = np.uint64(MULTIPLIER_0), np.uint64(MULTIPLIER_1)
_W0, _W1 = np.uint64(WEYL_0), np.uint64(WEYL_1)
NEAR = 1e-9
"""Metres, or shares of a segment, by which rounding may move what is nearest."""
_ZERO, _UNUSED = np.uint64(0), np.uint64(UNUSED_BITS)


def compile_(function: Callable[..., Any], text: str = "") -> Callable[..., Any]:
    """The function compiled: IEEE arithmetic as it stands, division as in NumPy, other threads run on.

    Machine code is kept under the `text` that the function was made from; one of a module, under its name.
    """
    return keep_code(numba.njit(nogil=True, error_model="numpy")(function), text or f"{function.__module__}.{function.__qualname__}")


def from_libm(name: str, arguments: int) -> Callable[..., float]:
    """A function of the C library, the one that Python's `math` calls."""
    return types.ExternalFunction(name, types.float64(*[types.float64] * arguments))


def from_scipy(name: str) -> Callable[..., float]:
    """A function of one number of scipy.special, the one behind its ufunc."""
    symbol = f"scenic_ref_{name}"
    binding.add_symbol(symbol, get_cython_function_address("scipy.special.cython_special", name))
    return types.ExternalFunction(symbol, types.float64(types.float64))


def compile_function_text(source: str, name: str, names: Mapping[str, object], callees: Sequence[str] = ()) -> Callable[..., Any]:
    """The function of that name which a text defines, compiled; `callees` are the texts of what it calls that is not in a module.

    Its own name tells its text, since the names of compiled functions that are called alike must not meet.
    """
    text = "\n".join([source, *callees])
    own = f"{name}_{hashlib.blake2b(text.encode(), digest_size=8).hexdigest()}"
    space: dict[str, Any] = {**names, "__name__": __name__}
    exec(source.replace(f"def {name}(", f"def {own}(", 1), space)  # our own text
    return compile_(space[own], text)


def _high(context: Any, a: Any, b: Any) -> Any:
    """The high word of the 128-bit product of two 64-bit words."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        wide = ir.IntType(128)
        left, right = (builder.zext(argument, wide) for argument in arguments)
        return builder.trunc(builder.lshr(builder.mul(left, right), ir.Constant(wide, 64)), ir.IntType(64))

    return numba.uint64(numba.uint64, numba.uint64), generate


high_word: Any = intrinsic(_high)


def _copy(context: Any, target: Any, at: Any, source: Any, start: Any, length: Any) -> Any:
    """Copy bytes of one array into another, from a place on; they do not overlap."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        into, at, out_of, start, length = arguments
        place = builder.gep(context.make_array(signature.args[0])(context, builder, into).data, [at])
        origin = builder.gep(context.make_array(signature.args[2])(context, builder, out_of).data, [start])
        cgutils.raw_memcpy(builder, place, origin, length, 1)
        return context.get_dummy_value()

    return numba.void(target, numba.int64, source, numba.int64, numba.int64), generate


copy_bytes: Any = intrinsic(_copy)


@compile_
def philox_uniforms(seed: np.uint64, code: np.uint64, scene: np.uint64, attempt: np.uint64, block: np.uint64) -> tuple[float, float, float, float]:
    """The four numbers in [0, 1) of a block, as `interpreter.runtime.random_streams` defines them."""
    k0, k1, c0, c1, c2, c3 = seed, code, scene, attempt, block, _ZERO
    for _ in range(ROUNDS):
        high0, low0, high1, low1 = high_word(_M0, c0), _M0 * c0, high_word(_M1, c2), _M1 * c2
        c0, c1, c2, c3 = high1 ^ c1 ^ k0, low1, high0 ^ c3 ^ k1, low0
        k0, k1 = k0 + _W0, k1 + _W1
    return (c0 >> _UNUSED) * UNIT, (c1 >> _UNUSED) * UNIT, (c2 >> _UNUSED) * UNIT, (c3 >> _UNUSED) * UNIT


@compile_
def bisect_right(cumulative: np.ndarray, value: float) -> int:
    """How many of the increasing numbers are at most `value`."""
    low, high = 0, len(cumulative)
    while low < high:
        middle = (low + high) // 2
        if value < cumulative[middle]:
            high = middle
        else:
            low = middle + 1
    return low


@compile_
def search_part(values: np.ndarray, starts: np.ndarray, part: int, value: float) -> int:
    """The position of the first number of a part that is greater than a value: see `graph.SearchPart`."""
    low, high = starts[part], starts[part + 1] - 1
    while low < high:
        middle = (low + high) // 2
        if values[middle] <= value:
            low = middle + 1
        else:
            high = middle
    return low


@compile_
def nearest_heading(x: float, y: float, segments: np.ndarray, headings: np.ndarray, first: int, last: int) -> tuple[bool, float]:
    """The heading of the segment nearest to a point, the first one where two meet there, and whether that is beyond rounding."""
    least = math.inf
    for k in range(first, last):
        least = min(least, away_from(x, y, segments, k)[0])
    count, at, end = 0, first, 0.0
    for k in range(first, last):
        away, share = away_from(x, y, segments, k)
        if away > least + NEAR:
            continue
        count += 1
        if count == 1:
            at, end = k, share
        elif count > 2 or k != at + 1 or end < 1.0 + NEAR or share > -NEAR:  # else the point is nearest to where both meet
            return False, 0.0
    return count > 0, headings[at]


@compile_
def polygon_distance(x: float, y: float, edges: np.ndarray, first: int, last: int) -> tuple[bool, float]:
    """The distance of a point from a polygon, as GEOS computes it, and whether it is beyond rounding on which side of its edges it is."""
    least, inside = math.inf, False
    for k in range(first, last):
        ax, ay, bx, by = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
        dx, dy = bx - ax, by - ay
        squared = dx * dx + dy * dy
        share = 0.0 if squared == 0 else ((x - ax) * dx + (y - ay) * dy) / squared
        if share <= 0:
            away = math.sqrt((x - ax) * (x - ax) + (y - ay) * (y - ay))
        elif share >= 1:
            away = math.sqrt((x - bx) * (x - bx) + (y - by) * (y - by))
        else:
            away = abs(((ay - y) * dx - (ax - x) * dy) / squared) * math.sqrt(squared)
        least = min(least, away)
        if (ay > y) != (by > y) and (dx * (y - ay) - dy * (x - ax) > 0) == (dy > 0):
            inside = not inside
    return least > NEAR, 0.0 if inside else least


@compile_
def away_from(x: float, y: float, segments: np.ndarray, k: int) -> tuple[float, float]:
    """How far a point is from a segment, and at which share of its line the nearest point of that is."""
    ax, ay = segments[k, 0], segments[k, 1]
    dx, dy = segments[k, 2] - ax, segments[k, 3] - ay
    squared = dx * dx + dy * dy
    share = 0.5 if squared == 0 else ((x - ax) * dx + (y - ay) * dy) / squared
    within = min(max(share, 0.0), 1.0)
    return math.sqrt((ax + within * dx - x) ** 2 + (ay + within * dy - y) ** 2), share


GridArrays = tuple[np.ndarray, np.ndarray, np.ndarray]


def grid_arrays(grid: Grid) -> GridArrays:
    """A grid for compiled code: (west, south, side, columns, rows), where the list of each square starts, and the lists one after the other."""
    starts = np.concatenate([[0], np.cumsum(grid.counts)]).astype(np.int64)
    packed = np.concatenate([grid.lists[i, :n] for i, n in enumerate(grid.counts)] or [np.zeros(0, dtype=np.int64)]).astype(np.int64)
    return np.array([grid.west, grid.south, grid.side, grid.columns, grid.rows], dtype=float), starts, packed


@compile_
def square_of(frame: np.ndarray, x: float, y: float) -> int:
    """The square in which a point lies; the last one, which is empty, for points beyond all."""
    columns, rows = int(frame[3]), int(frame[4])
    column, row = math.floor((x - frame[0]) / frame[2]), math.floor((y - frame[1]) / frame[2])
    if not (0 <= column < columns and 0 <= row < rows):
        return columns * rows
    return int(row) * columns + int(column)


@compile_
def point_in(
    x: float, y: float, scale: float, edges: np.ndarray, reference: np.ndarray, reference_inside: np.ndarray,
    frame: np.ndarray, starts: np.ndarray, lists: np.ndarray,
) -> int:  # fmt: skip
    """Whether a point is in a polygon: see `PolygonTests.contains_point`."""
    square = square_of(frame, x, y)
    inside = reference_inside[square]
    first, last = starts[square], starts[square + 1]
    if first < last:
        eps = TIE * scale
        rx, ry = reference[square, 0], reference[square, 1]
        ex, ey = x - rx, y - ry
        way = eps * math.sqrt(ex * ex + ey * ey)
        for k in range(first, last):
            e = lists[k]
            ax, ay, bx, by = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
            dx, dy = bx - ax, by - ay
            point_side, reference_side = dx * (y - ay) - dy * (x - ax), dx * (ry - ay) - dy * (rx - ax)
            start_side, end_side = ex * (ay - ry) - ey * (ax - rx), ex * (by - ry) - ey * (bx - rx)
            length = eps * math.sqrt(dx * dx + dy * dy)
            if min(abs(point_side), abs(reference_side)) <= length or min(abs(start_side), abs(end_side)) <= way:
                return UNSURE
            if (point_side > 0) != (reference_side > 0) and (start_side > 0) != (end_side > 0):
                inside = not inside
    return INSIDE if inside else OUTSIDE


@compile_
def box_in(
    x: float, y: float, heading: float, width: float, length: float, scale: float, largest: float, edges: np.ndarray, reference: np.ndarray,
    reference_inside: np.ndarray, frame: np.ndarray, starts: np.ndarray, lists: np.ndarray,
    near_frame: np.ndarray, near_starts: np.ndarray, near_lists: np.ndarray, known: np.ndarray,
) -> int:  # fmt: skip
    """Whether a box is in a polygon: see `PolygonTests.contains_box`. The near lists hold the edges within `largest` metres of squares,
    and `known` says where those without any are.
    """
    hw, hl = width / 2, length / 2
    if not (hw > TIE * scale and hl > TIE * scale and hw * hw + hl * hl <= largest * largest):
        return UNSURE
    square = square_of(near_frame, x, y)
    if known[square] != UNSURE:
        return int(known[square])
    found = point_in(x, y, scale, edges, reference, reference_inside, frame, starts, lists)
    if found != INSIDE:
        return found
    first, last = near_starts[square], near_starts[square + 1]
    if first < last:
        c, s = math.cos(heading), math.sin(heading)
        eps = 4 * TIE * scale
        for k in range(first, last):
            e = near_lists[k]
            ax, ay, bx, by = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
            dx, dy, px, py = (bx - ax) / 2, (by - ay) / 2, (ax + bx) / 2 - x, (ay + by) / 2 - y
            mx, my, hx, hy = px * c + py * s, py * c - px * s, dx * c + dy * s, dy * c - dx * s
            gap = max(abs(mx) - hw - abs(hx), abs(my) - hl - abs(hy))
            if gap > eps:
                continue
            half = math.sqrt(hx * hx + hy * hy)
            gap = max(gap, (abs(mx * hy - my * hx) - hw * abs(hy) - hl * abs(hx)) / half)
            if gap < -eps:
                return OUTSIDE
            if gap <= eps:
                return UNSURE
    return INSIDE


@compile_
def first_cell(
    x: float, y: float, scale: float, edges: np.ndarray, number: np.ndarray, frame: np.ndarray, starts: np.ndarray, lists: np.ndarray,
    known: np.ndarray,
) -> int:  # fmt: skip
    """The first cell of a field that holds a point: see `FieldTests.first`; -1 for none, -2 if an edge is too near."""
    square = square_of(frame, x, y)
    if known[square] != -2:
        return int(known[square])
    eps = TIE * scale
    for k in range(starts[square], starts[square + 1]):
        cell = lists[k]
        inside = False
        for j in range(number[cell]):
            ax, ay, bx, by = edges[cell, j, 0], edges[cell, j, 1], edges[cell, j, 2], edges[cell, j, 3]
            dx, dy = bx - ax, by - ay
            side = dx * (y - ay) - dy * (x - ax)
            if abs(side) <= eps * (abs(dx) + abs(dy)):
                return -2
            if (ay > y) != (by > y) and (side > 0) == (dy > 0):
                inside = not inside
        if inside:
            return cell
    return -1


hypot = from_libm("hypot", 2)


@compile_
def part_inside(
    ax: float, ay: float, bx: float, by: float, dx: float, dy: float, radius: float, angle: float,
    lx: float, ly: float, rx: float, ry: float, mx: float, my: float,
) -> tuple[float, float]:  # fmt: skip
    """The parameters of the part of the segment from a to b in a sector about the origin: see `CurveTests.inside`."""
    a, b, c = dx * dx + dy * dy, ax * dx + ay * dy, ax * ax + ay * ay - radius * radius
    discriminant = b * b - a * c
    if discriminant < 0:
        return 2.0, -1.0
    root = math.sqrt(discriminant)
    low, high = max(0.0, (-b - root) / a), min(1.0, (-b + root) / a)
    if angle < 2.0 * math.pi:
        for side in range(3):
            if side == 0:
                start, end = rx * ay - ry * ax, rx * by - ry * bx
            elif side == 1:
                start, end = ax * ly - ay * lx, bx * ly - by * lx
            else:
                start, end = mx * ax + my * ay, mx * bx + my * by
            if start < 0 and end < 0:
                return 2.0, -1.0
            if start < 0:
                low = max(low, start / (start - end))
            elif end < 0:
                high = min(high, start / (start - end))
    return low, high


@compile_
def clipped_point(
    x: float, y: float, radius: float, heading: float, angle: float, uniform: float, start: np.ndarray, end: np.ndarray,
    frame: np.ndarray, starts: np.ndarray, lists: np.ndarray,
) -> tuple[bool, float, float]:  # fmt: skip
    """A point of the part of a curve in a sector, and whether there is one: see `CurveTests.sample`."""
    square = square_of(frame, x, y)
    left, right = heading + angle / 2, heading - angle / 2
    lx, ly, rx, ry = -math.sin(left), math.cos(left), -math.sin(right), math.cos(right)
    mx, my = -math.sin(heading), math.cos(heading)
    total, target, found = 0.0, math.inf, False
    sx, sy, ex, ey, before, length = 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    for turn in range(2):
        if turn == 1:
            target = uniform * total
        total = 0.0
        for k in range(starts[square], starts[square + 1]):
            e = lists[k]
            px, py, qx, qy = start[e, 0], start[e, 1], end[e, 0], end[e, 1]
            dx, dy = qx - px, qy - py
            low, high = part_inside(px - x, py - y, qx - x, qy - y, dx, dy, radius, angle, lx, ly, rx, ry, mx, my)
            if low < high:
                ax, ay, bx, by = px + dx * low, py + dy * low, px + dx * high, py + dy * high
                piece = hypot(bx - ax, by - ay)
                if piece > 0:
                    found = True
                    sx, sy, ex, ey, before = ax, ay, bx, by, total
                    total += piece
                    length = total - before
                    if target < total:
                        break
        if not found:
            break
    share = min((target - before) / length, 1.0)
    return found, sx + (ex - sx) * share, sy + (ey - sy) * share


@compile_
def point_away(x: float, y: float, edges: np.ndarray) -> float:
    """How far a point is outside of the polygon with these edges; 0 inside."""
    least, inside = np.inf, False
    for k in range(len(edges)):
        ax, ay, bx, by = edges[k, 0], edges[k, 1], edges[k, 2], edges[k, 3]
        dx, dy = bx - ax, by - ay
        squared = dx * dx + dy * dy
        share = 0.0 if squared == 0 else min(max(((x - ax) * dx + (y - ay) * dy) / squared, 0.0), 1.0)
        px, py = ax + share * dx - x, ay + share * dy - y
        least = min(least, px * px + py * py)
        if (ay > y) != (by > y) and x < ax + (y - ay) / dy * dx:
            inside = not inside
    return 0.0 if inside else math.sqrt(least)


@compile_
def box_away(x: float, y: float, heading: float, width: float, length: float, edges: np.ndarray) -> float:
    """How far the farthest corner of a box is outside."""
    c, s, most = math.cos(heading), math.sin(heading), 0.0
    for a in (-width / 2, width / 2):
        for b in (-length / 2, length / 2):
            most = max(most, point_away(x + a * c - b * s, y + a * s + b * c, edges))
    return most


@compile_
def is_within_reach(away: float, reach: float, closed: bool) -> bool:
    """Whether a distance is at most the reach, or less for open sets."""
    return away <= reach if closed else away < reach


@compile_
def pair_meets(boxes: np.ndarray, i: int, j: int, closed: bool) -> bool:
    """Whether two of the boxes share a point: `geometry.boxes_intersect`, its comparisons one by one."""
    x, y = boxes[j, 0] - boxes[i, 0], boxes[j, 1] - boxes[i, 1]
    c1, s1, hw1, hl1 = boxes[i, 2], boxes[i, 3], boxes[i, 4], boxes[i, 5]
    c2, s2, hw2, hl2 = boxes[j, 2], boxes[j, 3], boxes[j, 4], boxes[j, 5]
    c, s = abs(c1 * c2 + s1 * s2), abs(s2 * c1 - c2 * s1)
    margin = METRES if closed else -METRES
    return (
        is_within_reach(abs(x * c1 + y * s1), hw1 + (hw2 * c + hl2 * s) + margin, closed)
        and is_within_reach(abs(y * c1 - x * s1), hl1 + (hw2 * s + hl2 * c) + margin, closed)
        and is_within_reach(abs(x * c2 + y * s2), hw2 + (hw1 * c + hl1 * s) + margin, closed)
        and is_within_reach(abs(y * c2 - x * s2), hl2 + (hw1 * s + hl1 * c) + margin, closed)
    )


@compile_
def row_meets(boxes: np.ndarray, closed: bool) -> bool:
    """Whether any two boxes share a point; (boxes, `NUMBERS`). From West to East, each is compared with those that begin before it ends."""
    count = len(boxes)
    low, high = np.empty(count), np.empty(count)
    finite = True
    for k in range(count):
        x, y, hw, hl = boxes[k, 0], boxes[k, 1], boxes[k, 4], boxes[k, 5]
        reach = math.sqrt(hw * hw + hl * hl) + MARGIN * (1 + abs(x) + abs(y) + abs(hw) + abs(hl))
        low[k], high[k] = x - reach, x + reach
        finite = finite and math.isfinite(low[k]) and math.isfinite(high[k])
    order = np.argsort(low) if finite else np.arange(count)
    for place in range(count):
        for later in range(place + 1, count):
            k, m = order[place], order[later]
            if finite and low[m] > high[k]:
                break
            if pair_meets(boxes, min(k, m), max(k, m), closed):
                return True
    return False

