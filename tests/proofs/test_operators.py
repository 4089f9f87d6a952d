"""The operators of `proofs/scenes/Operators.v` and those of the machine give the same, where sines, cosines and lengths are rational.

The theory's numbers are real, which Coq cannot print. It is told what the program computes, and proves that its own value is as near as 1e-9.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import atan2, cos, sin
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from scenic_ref.semantics.scenes import operators, released_forms, specifiers
from scenic_ref.semantics.space import geometry
from scenic_ref.semantics.space.vectors import Vector

from .coq import needs_coq, printed

COUNT = 860
TRIPLES = ((3, 4, 5), (5, 12, 13), (8, 15, 17), (7, 24, 25), (20, 21, 29), (0, 1, 1))
PREAMBLE = """From Coq Require Import Reals Lra.
Local Open Scope R_scope.
Definition near (x y : R) : Prop := - (1 / 1000000000) <= x - y <= 1 / 1000000000.
Definition near_pair (v w : R * R) : Prop := near (fst v) (fst w) /\\ near (snd v) (snd w).
Ltac computed :=
  unfold ahead_of, behind_of, left_of, right_of, of_box, offset_along, offset_local, rotate, turn, back, square, minus, plus, opposite; cbn [fst snd].
Ltac same :=
  unfold near_pair, near, facing_toward, facing_away_from; unfold beyond, relative_to, relative_heading;
  unfold distance_past, apparently_facing, apparent_heading, heading_of, distance.
Ltac long sight r := assert (length sight = r) as -> by (unfold length; apply sqrt_lem_1; computed; lra).
Ltac told sight r :=
  first [ solve [same; lazymatch goal with |- context [length] => long sight r | _ => idtac end; computed; lra]; idtac "agrees" | idtac "differs" ].
"""
"""The tactic `told` says whether Coq proves a goal, in which the length of one vector is `r`."""


@dataclass(frozen=True)
class Heading:
    """A heading with a rational cosine and sine."""

    cosine: Fraction
    sine: Fraction

    def __str__(self) -> str:
        return f"({real(self.cosine)}, {real(self.sine)})"

    def radians(self) -> float:
        return atan2(self.sine, self.cosine)


@dataclass(frozen=True)
class Input:
    """What operators are asked about: P is so far from V, in whole metres, and OP is at P; `size` is a width, `long` a length."""

    p: Vector
    v: Vector
    w: Vector
    h: Heading
    k: Heading
    far: int
    size: Fraction
    long: Fraction
    gap: Fraction

    def oriented_point(self) -> Any:
        """OP, and an object there."""
        return SimpleNamespace(position=self.p, heading=self.h.radians(), width=float(self.size), length=float(self.long))

    def itself(self) -> Any:
        """What is being made, at P: it is as wide as the object there is long."""
        return SimpleNamespace(position=self.p, heading=self.h.radians(), width=float(self.long), length=float(self.size))

    def at_v(self) -> Any:
        """An object at V."""
        return SimpleNamespace(position=self.v)

    def field(self) -> Any:
        """A field that has one heading everywhere."""
        return SimpleNamespace(at=lambda _: self.k.radians())


def some(count: int) -> list[Input]:
    random = Random(29)
    return [one(random) for _ in range(count)]


def one(random: Random) -> Input:
    """Numbers with three binary digits, so that they are the same in the program."""

    def number() -> Fraction:
        return Fraction(random.randint(-800, 800), 8)

    def triple() -> tuple[int, int, int]:
        x, y, r = random.choice(TRIPLES)
        x, y = random.choice(((x, y), (y, x)))
        return x * random.choice((1, -1)), y * random.choice((1, -1)), r

    def heading() -> Heading:
        x, y, r = triple()
        return Heading(Fraction(x, r), Fraction(y, r))

    x, y, r = triple()
    v = (number(), number())
    w = (number(), number())
    p = Vector(float(v[0] + x), float(v[1] + y))
    return Input(p, Vector(*map(float, v)), Vector(*map(float, w)), heading(), heading(), r, abs(number()), abs(number()), number())


def real(number: float | Fraction) -> str:
    """A number as Coq writes it; of the program's with twelve decimals."""
    exact = number if isinstance(number, Fraction) else Fraction(round(Fraction(number) * 10**12), 10**12)
    return f"({exact.numerator} / {exact.denominator})"


def exact(v: Vector) -> str:
    """A vector of an input."""
    return f"({real(Fraction(v.x))}, {real(Fraction(v.y))})"


def pair(found: Vector | float, *, heading: bool) -> str:
    """What the program gives, as a pair of numbers: a heading by its cosine and sine, another number with a 0."""
    if isinstance(found, Vector):
        return f"({real(found.x)}, {real(found.y)})"
    return f"({real(cos(found))}, {real(sin(found))})" if heading else f"({real(found)}, 0)"


@dataclass(frozen=True)
class Operator:
    """An operator in the theory, with its operands in braces, and in the program; whether it gives a heading."""

    term: str
    of: Callable[[Input], Vector | float]
    heading: bool = False

    def goal(self, i: Input) -> str:
        """That the two give the same."""
        sizes = {"size": real(i.size), "long": real(i.long), "gap": real(i.gap)}
        term = self.term.format(p=exact(i.p), v=exact(i.v), w=exact(i.w), h=i.h, k=i.k, **sizes)
        return f"Goal near_pair ({term}) {pair(self.of(i), heading=self.heading)}. told (minus {exact(i.p)} {exact(i.v)}) {i.far}. Abort."


def beside(name: str, i: Input) -> Vector:
    """Where a specifier puts the object that is being made beside OP, P, or the object at OP."""
    reference = i.p if name.endswith("vector") else i.oriented_point()
    found = getattr(specifiers, name)(reference, float(i.gap), i.itself())
    return found if isinstance(found, Vector) else found.position


def part(name: str, i: Input) -> Vector:
    """A side or a corner of the object at OP."""
    return getattr(operators, name)(i.oriented_point()).position


OPERATORS = (
    Operator("rotate {v} {h}", lambda i: geometry.rotate(i.v, i.h.radians())),
    Operator("offset_along {v} {h} {w}", lambda i: operators.vector_offset_along_heading(i.v, i.h.radians(), i.w)),
    Operator("offset_along {p} {k} {w}", lambda i: specifiers.offset_along_heading(i.k.radians(), i.w, i.oriented_point())),
    Operator("offset_local {p} {h} {w}", lambda i: operators.vector_relative_to_oriented_point(i.w, i.oriented_point()).position),
    Operator("beyond {p} {w} {v}", lambda i: specifiers.beyond(i.p, i.w, i.v)),
    Operator("heading_of (minus {p} {v})", lambda i: operators.angle(i.v, i.p), heading=True),
    Operator("distance {v} {p}, 0", lambda i: operators.distance(i.v, i.p)),
    Operator("relative_to {h} {k}", lambda i: operators.headings_relative(i.h.radians(), i.k.radians()), heading=True),
    Operator("relative_heading {h} {k}", lambda i: operators.relative_heading(i.h.radians(), i.k.radians()), heading=True),
    Operator("distance_past {p} {h} {v}, 0", lambda i: operators.distance_past(i.oriented_point(), i.v)),
    Operator("apparently_facing {k} {p} {v}", lambda i: specifiers.apparently_facing(i.k.radians(), i.v, i.itself()), heading=True),
    Operator("apparent_heading {p} {h} {v}", lambda i: operators.apparent_heading(i.oriented_point(), i.v), heading=True),
    Operator("relative_heading {h} {k}", lambda i: released_forms.relative_heading_wrapped(i.h.radians(), i.k.radians()), heading=True),
    Operator("apparent_heading {p} {h} {v}", lambda i: released_forms.apparent_heading_wrapped(i.oriented_point(), i.v), heading=True),
    Operator("facing_toward {p} {v}", lambda i: specifiers.facing_toward(i.p, i.at_v()), heading=True),
    Operator("facing_away_from {v} {p}", lambda i: specifiers.facing_away_from(i.v, i.itself()), heading=True),
    Operator("plus {v} {w}", lambda i: operators.vectors_relative(i.v, i.w)),
    Operator("plus {v} {w}", lambda i: operators.vector_offset_by(i.v, i.w)),
    Operator("plus {p} {w}", lambda i: specifiers.offset_by_global(i.w, i.oriented_point())),
    Operator("minus {v} {w}", lambda i: released_forms.relative_position(i.v, i.w)),
    Operator("offset_along {v} {k} {w}", lambda i: operators.vector_offset_along_field(i.v, i.field(), i.w)),
    Operator("offset_along {p} {k} {w}", lambda i: specifiers.offset_along_field(i.field(), i.w, i.oriented_point())),
    Operator("offset_local {p} {h} {w}", lambda i: specifiers.offset_by_local(i.w, i.oriented_point())),
    *(
        Operator(f"{side.removesuffix('_of')}_of {at} {{h}} {{{size}}} {{gap}}", partial(beside, f"{side}_{kind}"))
        for side, size, edge in (
            ("left_of", "long", "(-1) 0"), ("right_of", "long", "1 0"), ("ahead_of", "size", "0 1"), ("behind", "size", "0 (-1)"),
        )
        for kind, at in (("oriented_point", "{p}"), ("vector", "{p}"), ("object", f"(of_box {{p}} {{h}} {{size}} {{long}} {edge})"))
    ),
    *(
        Operator(f"of_box {{p}} {{h}} {{size}} {{long}} {x} {y}", partial(part, f"{name}_of"))
        for name, x, y in (
            ("front", "0", "1"), ("back", "0", "(-1)"), ("left", "(-1)", "0"), ("right", "1", "0"),
            ("front_left", "(-1)", "1"), ("back_left", "(-1)", "(-1)"), ("front_right", "1", "1"), ("back_right", "1", "(-1)"),
        )
    ),
)  # fmt: skip


def verdicts(count: int, folder: Path) -> Counter[tuple[str, str]]:
    """How often Coq finds that an operator agrees, or differs."""
    asked = [(OPERATORS[number % len(OPERATORS)], given) for number, given in enumerate(some(count))]
    goals = [operator.goal(given) for operator, given in asked]
    told = printed(["scenes.Operators"], [PREAMBLE + goals[0], *goals[1:]], folder)
    return Counter((operator.term.split()[0], answer.strip()) for (operator, _), answer in zip(asked, told, strict=True))


@pytest.mark.slow
@needs_coq
def test_the_operators_agree(tmp_path: Path) -> None:
    found = verdicts(COUNT, tmp_path)
    assert {verdict for _, verdict in found} == {"agrees"}, found
    assert len(found) == len({operator.term.split()[0] for operator in OPERATORS}) and min(found.values()) >= COUNT / len(OPERATORS)


ROTATE, RIGHT, BEHIND = geometry.rotate, specifiers._right, specifiers.behind_vector
WRONG = {
    "turned clockwise": (geometry, "rotate", lambda v, angle: ROTATE(v, -angle), {"rotate", "offset_along", "offset_local", "beyond"}),
    "seen from the other side": (geometry, "angle_of", lambda v: atan2(v.x, -v.y), {"heading_of", "beyond", "apparent_heading", "apparently_facing"}),
    "headings the other way round": (operators, "relative_heading", lambda h1, h2: h2 - h1, {"relative_heading"}),
    "right is left": (specifiers, "_left", RIGHT, {"left_of"}),
    "the gap is forgotten": (specifiers, "behind_vector", lambda v, s, self: BEHIND(v, 0.0, self), {"behind_of"}),
    "corners the other way round": (operators, "front_left_of", lambda o: operators.front_right_of(o), {"of_box"}),
    "toward is away": (specifiers, "facing_toward", lambda v, self: geometry.angle_of(self.position - v), {"facing_toward"}),
    "past it sideways": (operators, "distance_past", lambda op, v: ROTATE(op.position - v, -op.heading).x, {"distance_past"}),
}


@pytest.mark.slow
@needs_coq
@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_operator_is_noticed(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module, function, wrong, noticed = WRONG[name]
    monkeypatch.setattr(module, function, wrong)
    assert noticed <= {operator for operator, verdict in verdicts(10 * len(OPERATORS), tmp_path) if verdict == "differs"}
