"""Faults that implementations of Scenic are known to have, or might: for each one a few vectors must fail.

A fault is ourselves with the program rewritten (or a reading exchanged) so that it behaves as the faulty implementation would.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import pytest
from scenic_ref.conformance import Enumerated, Ourselves, Task, judge, load_vectors
from scenic_ref.conformance.implementations.protocol import SceneRecord

VECTORS = {v.name: v for v in load_vectors()}
Rewrite = Callable[[str], str]


class Faulty(Ourselves):
    """Ourselves, running another program than the one that was given."""

    def __init__(self, rewrite: Rewrite, readings: dict[str, str] | None = None) -> None:
        self.rewrite = rewrite
        self.readings = readings or {}

    def task(self, task: Task) -> Task:
        return replace(task, program=self.rewrite(task.program), readings={**task.readings, **self.readings})

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        return super().scenes(self.task(task), count, seed=seed, attempts=attempts)

    def enumerated(self, task: Task) -> Enumerated | None:
        return super().enumerated(self.task(task))

    def fired(self, task: Task, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        return super().fired(self.task(task), wanted, seed=seed)


def sub(pattern: str, replacement: str) -> Rewrite:
    return lambda text: re.sub(pattern, replacement, text, flags=re.MULTILINE)


def unchanged(text: str) -> str:
    return text


def sizes_exchanged(text: str) -> str:
    """An implementation that takes the width for the extent along the heading."""
    return re.sub(r"\b(width|length)\b", lambda m: {"width": "length", "length": "width"}[m[1]], text)


def mutated_at_once(text: str) -> str:
    """Noise that is added when `mutate` runs."""
    noise = "ego.position = ego.position offset by (Normal(0, 1), Normal(0, 1))\nego.heading = ego.heading + Normal(0, 5 deg)"
    return re.sub(r"^mutate( ego)?$", noise, text, flags=re.MULTILINE)


def class_defaults_once(text: str) -> str:
    """Default values that are drawn when the class is defined."""
    return re.sub(r"^(class A:\n)    (\w+): ((?:Range|Uniform)\(.*\))$", r"_drawn = \3\n\1    \2: _drawn", text, flags=re.MULTILINE)


def bounding_box(text: str) -> str:
    """Points of a polygon that are drawn in its bounding box."""

    def box(match: re.Match[str]) -> str:
        corners = [(float(x), float(y)) for x, y in re.findall(r"\((-?[\d.]+), (-?[\d.]+)\)", match[1])]
        (west, east), (south, north) = ((min(c), max(c)) for c in zip(*corners, strict=True))
        return f"RectangularRegion(({(west + east) / 2}, {(south + north) / 2}), 0, {east - west}, {north - south})"

    return re.sub(r"PolygonalRegion\(\[([^\]]*)\]\)", box, text)


def weights_ignored(text: str) -> str:
    """Weights of Discrete that are all taken as equal."""
    return re.sub(r"Discrete\(\{(.*?)\}\)", lambda m: "Uniform(" + ", ".join(pair.split(": ")[0] for pair in m[1].split(", ")) + ")", text)


def weights_not_normalised(text: str) -> str:
    """Weights taken for probabilities as they are: the last value takes the rest."""

    def taken(match: re.Match[str]) -> str:
        pairs = [pair.split(": ") for pair in match[1].split(", ")]
        left, found = 1.0, []
        for value, weight in pairs[:-1]:
            found.append((value, min(left, float(weight))))
            left -= found[-1][1]
        found.append((pairs[-1][0], left))
        return "Discrete({" + ", ".join(f"{value}: {weight}" for value, weight in found) + "})"

    return re.sub(r"Discrete\(\{(.*?)\}\)", taken, text)


def in_order(*rewrites: Rewrite) -> Rewrite:
    def all_of_them(text: str) -> str:
        for rewrite in rewrites:
            text = rewrite(text)
        return text

    return all_of_them


class Fault(NamedTuple):
    """What the faulty implementation runs, and vectors that must fail on it."""

    implementation: Faulty
    vectors: tuple[str, ...]


FAULTS: dict[str, Fault] = {
    "the coin of a soft requirement is thrown once per scene": Fault(
        Faulty(unchanged, {"soft": "scene"}), ("soft-requirement-coin-per-run", "soft-requirement-of-an-interval", "reading-soft-run"),
    ),
    "the coin of a soft requirement is turned round": Fault(
        Faulty(lambda t: re.sub(r"require\[([\d.]+)\]", lambda m: f"require[{1 - float(m[1])}]", t)),
        ("soft-requirement-of-an-interval", "soft-requirements-have-their-own-coins", "soft-requirement-of-probability-one"),
    ),
    "soft requirements are hard": Fault(
        Faulty(sub(r"require\[[^\]]*\]", "require")), ("soft-requirement-coin-per-run", "soft-requirement-of-probability-zero"),
    ),
    "an optional specifier beats a non-optional one": Fault(
        Faulty(sub(r"(left of op[^,\n]*|on r|following f from \(0, 0\) for 4), facing [^,\n]*( deg)?", r"\1")),
        ("non-optional-wins-over-optional", "in-region-heading-overridden", "following-with-its-own-heading"),
    ),
    "an optional specifier does not count against a default": Fault(
        Faulty(sub(r"A (left of op|following f from \(0, 0\) for 8)$", r"A \1, with heading 1")),
        ("optional-wins-over-default", "optional-of-a-field-wins-over-default"),
    ),
    "width and length are exchanged": Fault(
        Faulty(sizes_exchanged),
        ("left-of-vector", "ahead-of-vector-by", "front-of", "left-of-operator", "turned-object-in-region", "collision-along-the-length",
         "no-collision-along-the-width", "left-of-oriented-point-by", "ahead-of-object-by", "containment-of-a-turned-box"),
    ),
    "the specifiers use half of the length for the width": Fault(
        Faulty(sub(r"with width 3, with length 8", "with width 8, with length 8")), ("left-of-vector", "right-of-vector"),
    ),
    "headings of a sector are not taken modulo a turn": Fault(
        Faulty(sub(r"(\w+) can see (\(-?\d+, -10\))", r"(abs((angle from \1 to \2) - \1.heading) <= \1.viewAngle / 2)")),
        ("can-see-across-south",),
    ),
    "differences of headings are wrapped": Fault(
        Faulty(sub(r"relative heading of (.*?)(, s =|$)", r"((relative heading of \1) + 180 deg) % 360 deg - 180 deg\2")),
        ("relative-heading-is-not-wrapped", "angle-difference-across-south"),
    ),
    "mutation happens at the statement": Fault(
        Faulty(mutated_at_once), ("noise-comes-at-the-end", "requirement-before-mutation", "reading-require-time-statement"),
    ),
    "mutation comes after the default requirements": Fault(
        Faulty(sub(r"^workspace = .*$", "")), ("containment-is-checked-after-mutation",),
    ),
    "mutation does nothing": Fault(
        Faulty(sub(r"^mutate.*$", "")), ("noise-on-the-position", "noise-on-the-heading", "noise-is-independent-in-x-and-y"),
    ),
    "the scale of a mutation is ignored": Fault(
        Faulty(sub(r"^mutate ego by 2$", "mutate ego")), ("noise-scales-with-the-mutation", "reading-mutate-scale"),
    ),
    "positionStdDev is ignored": Fault(
        Faulty(sub(r", with positionStdDev [\d.]+", "")), ("noise-on-the-other-coordinate", "noise-scales-with-the-mutation"),
    ),
    "resample draws the parameters anew": Fault(
        Faulty(in_order(
            sub(r"^y = resample\(x\)$", "y = again()"),
            sub(r"^(low = (.*)\nx = Range\(low, low \+ 1\)\n)", r"def again():\n    l = \2\n    return Range(l, l + 1)\n\1"),
            sub(r"^(a = (.*)\nx = Uniform\(a, 10\)\n)", r"def again():\n    return Uniform(\2, 10)\n\1"),
        )),
        ("resample-keeps-the-parameters", "resample-keeps-finite-parameters"),
    ),
    "resample gives the same value": Fault(
        Faulty(sub(r"resample\((\w+)\)", r"\1")),
        ("x-plus-resample-x-is-triangular", "resample-of-finite-values-is-independent", "resample-of-a-default-argument", "reading-resample"),
    ),
    "points of a polygon are drawn in its bounding box": Fault(
        Faulty(bounding_box), ("in-triangle-is-uniform-in-x", "in-triangle-stays-in-the-triangle", "in-l-shaped-polygon"),
    ),
    "a variable is drawn again at every use": Fault(
        Faulty(sub(r"x \+ x", "Range(0, 1) + Range(0, 1)")), ("x-plus-x-is-uniform",),
    ),
    "require is dropped": Fault(
        Faulty(sub(r"^( *)require .*$", r"\1pass")),
        ("hard-requirement-conditions", "hard-requirement-on-an-interval", "hard-requirement-that-never-holds", "requirement-in-a-function",
         "requirement-with-a-draw-of-its-own", "requirements-add-up"),
    ),
    "a requirement is repaired by drawing again instead of conditioning": Fault(
        Faulty(sub(r"^require Uniform\(0, 1, 2, 3\) < p$", "")), ("requirement-with-a-draw-of-its-own",),
    ),
    "containment is dropped": Fault(
        Faulty(sub(r"^workspace = .*$", "")),
        ("containment-in-the-workspace", "not-contained-in-the-workspace", "containment-of-a-turned-box", "containment-of-every-object"),
    ),
    "regionContainedIn is dropped": Fault(
        Faulty(sub(r", with regionContainedIn .*$", "")), ("region-contained-in", "reading-region-contained"),
    ),
    "collisions are dropped": Fault(
        Faulty(sub(r"(Object at [^,\n]*,[^,\n]*)", r"\1, with allowCollisions True")),
        ("collision", "collision-conditions-the-distribution", "collision-along-the-length", "collision-of-turned-boxes"),
    ),
    "collisions are always checked": Fault(
        Faulty(sub(r", with allowCollisions True", "")), ("collision-allowed-by-one-of-two", "visible-is-in-the-disc-of-ego"),
    ),
    "visibility is dropped": Fault(
        Faulty(sub(r"^(Object .*)$", r"\1, with requireVisible False")),
        ("visible-from-ego-by-default", "visibility-within-the-view-angle", "reading-oncoming-range"),
    ),
    "visibility is of the centre": Fault(
        Faulty(sub(r"^(Object at \(0, 14\)), with length 9$", r"\1, with length 0, with width 0")), ("visibility-of-a-part",),
    ),
    "beyond is reckoned from the viewer": Fault(
        Faulty(sub(r"beyond (\([^)]*\)|P|taxi) by (\(.*?\)) from (\([^)]*\))", r"beyond \3 by \2 from \1")), ("beyond-from",),
    ),
    "beyond goes along the axes of the point": Fault(
        Faulty(sub(r"beyond P by \(-2, 1\)", "at ((-2, 1) relative to P).position")), ("drawn-point-beyond-p",),
    ),
    "beyond goes along the global axes": Fault(
        Faulty(sub(r"Object beyond (\([^)]*\)|taxi) by (\([^)]*\))( from \([^)]*\))?", r"Object at (\1 offset by \2)")),
        ("beyond-ego", "beyond-from"),
    ),
    "degrees are taken for radians": Fault(
        Faulty(sub(r" deg\b", "")), ("degrees", "facing-field", "relative-heading-ego", "degrees-of-a-random-number", "heading-relative-to-heading"),
    ),
    "radians are taken for degrees": Fault(
        Faulty(sub(r"facing (1|1\.5)(?=,|$)", r"facing \1 deg")), ("degrees", "facing-heading"),
    ),
    "headings go clockwise": Fault(
        Faulty(sub(r"facing (-?\d+) deg", r"facing -(\1) deg")), ("left-of-vector-by", "right-of-vector-by", "offset-by-is-local"),
    ),
    "a class default is evaluated once per class": Fault(
        Faulty(class_defaults_once), ("default-is-drawn-for-each-object", "default-range-is-drawn-for-each-object"),
    ),
    "a default argument is drawn at every call": Fault(
        Faulty(sub(r"^def f\(x=(Uniform\(0, 1\))\):\n    return x$", r"def f():\n    return \1")), ("default-argument-is-drawn-once",),
    ),
    "weights of Discrete are ignored": Fault(
        Faulty(weights_ignored), ("discrete-with-weights", "discrete-weights-below-one", "discrete-weight-zero", "random-parameter"),
    ),
    "weights of Discrete are not normalised": Fault(
        Faulty(weights_not_normalised), ("discrete-with-weights", "discrete-weights-below-one"),
    ),
    "the second parameter of Normal is a variance": Fault(Faulty(sub(r"Normal\(1, 2\)", "Normal(1, 2 ** 0.5)")), ("normal",)),
    "TruncatedNormal is not truncated": Fault(
        Faulty(sub(r"TruncatedNormal\((.*?), (.*?), .*?\)$", r"Normal(\1, \2)")), ("truncated-normal", "truncated-normal-support"),
    ),
    "offset by goes along the global axes": Fault(Faulty(unchanged, {"offset-by": "global"}), ("offset-by-is-local", "drawn-point-offset-by")),
    "boxes that touch do not collide": Fault(Faulty(unchanged, {"touching": "allow"}), ("reading-touching-collide",)),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_the_fault_is_found(fault: str) -> None:
    implementation, names = FAULTS[fault]
    verdicts = {name: judge(implementation, VECTORS[name]).verdict for name in names}
    assert {name: verdict.status for name, verdict in verdicts.items()} == dict.fromkeys(names, "failed"), verdicts
