"""`proofs/inference/Rejection.v` and the machine give the same distributions to a thousand programs: by rejection, and by what may take its place."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from pathlib import Path
from random import Random

import pytest
import scenic_ref
from scenic_ref.inference import rejection
from scenic_ref.inference.enumeration import Enumeration, Runner, Taken, next_prefix
from scenic_ref.semantics.machine.outcome import Draw
from scenic_ref.semantics.store.errors import AttemptsExhausted

from .coq import evaluated, needs_coq

pytestmark = pytest.mark.slow

COUNT, FEWER = 1000, 300
Law = dict[int | None, Fraction]
"""The probability of each scene, by 10 x + y, and that of none; those of probability 0 are left out."""
LAWS = ("factorised", "apart", "weighted", "redrawn", "repaired", "exchanged")
"""Distributions that are, but for the repaired one, those of rejection sampling."""
ASKED = """map (fun '(dx, dy, allowed_x, allowed_y, apart, attempts) =>
    let one_of allowed v := existsb (Nat.eqb v) allowed in
    let x_holds := one_of allowed_x in
    let y_holds := one_of allowed_y in
    let fits (xy : nat * nat) := negb (existsb (fun no => (Nat.eqb (fst no) (fst xy) && Nat.eqb (snd no) (snd xy))%bool) apart) in
    let accepts (xy : nat * nat) := (x_holds (fst xy) && y_holds (snd xy) && fits xy)%bool in
    let joint := product dx dy in
    let told q := let r := Qred q in (Qnum r, Zpos (Qden r)) in
    let scenes := list_prod (map fst dx) (map fst dy) in
    let is (xy other : nat * nat) := (Nat.eqb (fst xy) (fst other) && Nat.eqb (snd xy) (snd other))%bool in
    let law d := map (fun xy => told (pr (is xy) d)) scenes in
    let tried := sample accepts joint attempts in
    let scenes_of := desired accepts joint in
    let mass_of xy := pr (is xy) (given accepts joint) in
    let drawn_from (xy : nat * nat) := Qmake 1 (Pos.of_nat (1 + fst xy + 2 * snd xy)) in
    let w xy := Qdiv (mass_of xy) (drawn_from xy) in
    let runs := table scenes drawn_from in
    let alone d holds := Component [d] [] (forallb holds) in
    let pair l := match l with [a; b] => (a, b) | _ => (0, 0)%nat end in
    let same_prior (a : nat * nat * unit) := accepts (fst a) in
    (told (pr is_none tried),
     [law (found tried);
      law (normalised (found tried));
      law scenes_of;
      law (factorised dx dy x_holds y_holds fits);
      law (bind (drawn_apart (Component [] [alone dx x_holds; alone dy y_holds] (fun l => fits (pair l)))) (fun l => ret (pair l)));
      map (fun xy => told (Qdiv (expect (fun a => Qmult (w a) (indicator (is xy a))) runs) (expect w runs))) scenes;
      law (bind scenes_of (where_accepted accepts (redraw dx)));
      law (repaired accepts dx (fun _ => dy));
      law (bind (bind (desired same_prior (product (product dx dx) (ret tt))) (where_accepted same_prior exchange)) (fun a => ret (fst a)))]))"""
"""What Coq is asked: how probable it is that all attempts fail, and distributions of scenes. The last one is of programs whose draws are alike."""


@dataclass(frozen=True)
class Program:
    """Two draws with these weights of 0, 1, ...; the values that are required of each, pairs that are ruled out, and how many attempts are made."""

    x: tuple[int, ...]
    y: tuple[int, ...]
    allowed_x: tuple[int, ...]
    allowed_y: tuple[int, ...]
    apart: tuple[tuple[int, int], ...]
    attempts: int

    def in_scenic(self) -> str:
        """The program."""
        lines = [
            *(f"{name} = Discrete({{{', '.join(f'{v}: {w}' for v, w in enumerate(weights))}}})" for name, weights in (("x", self.x), ("y", self.y))),
            *(f"require {one_of(name, allowed)}" for name, allowed in (("x", self.allowed_x), ("y", self.allowed_y))),
            *(f"require not (x == {x} and y == {y})" for x, y in self.apart),
        ]
        return "\n".join((*lines, "ego = Object", "param r = 10 * x + y")) + "\n"

    def in_coq(self) -> str:
        """The same as a term of the theory."""
        draws = (listed(f"({v}%nat, Qmake {w} {sum(weights)})" for v, w in enumerate(weights)) for weights in (self.x, self.y))
        allowed = (f"{listed(map(str, values))}%nat" for values in (self.allowed_x, self.allowed_y))
        return f"({', '.join((*draws, *allowed, listed(f'({x}, {y})' for x, y in self.apart) + '%nat', f'{self.attempts}%nat'))})"

    def scenes(self) -> list[int]:
        """All pairs, as 10 x + y, in Coq's order."""
        return [10 * x + y for x, y in product(range(len(self.x)), range(len(self.y)))]


def one_of(name: str, values: Sequence[int]) -> str:
    """That a variable has one of these values, in Scenic."""
    return " or ".join(f"{name} == {value}" for value in values) or f"{name} < 0"


def listed(items: Iterable[str]) -> str:
    """A list in Coq."""
    return f"[{'; '.join(items)}]"


@dataclass(frozen=True)
class Answer:
    """What Coq says: the distribution of `sample`, with None where no attempt succeeds; that, given a scene; the desired one; and others by name."""

    sample: Law
    given: Law
    desired: Law
    others: dict[str, Law]


Asked = tuple[Program, Answer]


def by_the_theory(programs: Sequence[Program], folder: Path) -> list[Asked]:
    """The programs with what Coq says of them."""
    theories = ["kernel.Distribution", "inference.Rejection", "inference.Components"]
    told = evaluated(theories, [f"{ASKED} {listed(p.in_coq() for p in programs)}"], folder)[0]
    found = []
    for program, (numerator, denominator, laws) in zip(programs, told, strict=True):
        some, given, desired, *others = (
            {scene: Fraction(*pair) for scene, pair in zip(program.scenes(), law) if pair[0]} for law in laws
        )  # fmt: skip
        none: Law = {None: Fraction(numerator, denominator)} if numerator else {}
        named = {name: law for name, law in zip(LAWS, others, strict=True) if name != "exchanged" or program.x == program.y}
        found.append((program, Answer({**some, **none}, given, desired, named)))
    return found


def enumerated(program: Program) -> Enumeration | None:
    """The exact distribution of a program, if it has scenes."""
    try:
        return scenic_ref.loads(program.in_scenic()).enumerate()
    except AttemptsExhausted:
        return None


def law_of(found: Enumeration | None) -> Law:
    """The distribution of the scenes; empty if there are none."""
    return {} if found is None else {**found.law(lambda scene: scene.params["r"])}  # type: ignore[dict-item]


Chooser = Callable[[Draw], object]


def sampled(program: Program, patch: pytest.MonkeyPatch, chooser: Callable[[Chooser], Chooser] = lambda choose: choose) -> Law:
    """The exact distribution of what `rejection.sample` gives: each draw, of all attempts, is answered with each of its values."""
    scenario = scenic_ref.loads(program.in_scenic())
    law: Law = defaultdict(Fraction)
    prefix: list[Taken] | None = []
    while prefix is not None:
        runner = Runner(prefix, None)
        choose = chooser(runner.choose)
        patch.setattr(rejection, "from_stream", lambda *_, choose=choose: choose)
        try:
            scene: int | None = rejection.sample(scenario.start, 0, 0, max_attempts=program.attempts).scene.params["r"]  # type: ignore[assignment]
        except AttemptsExhausted:
            scene = None
        law[scene] += runner.probability
        prefix = next_prefix(runner.choices)
    return dict(law)


def keeping_x(choose: Chooser) -> Chooser:
    """A chooser that draws only y again where a run is rejected."""
    kept: list[tuple[tuple[int, ...], object]] = []

    def answer(draw: Draw) -> object:
        if not kept:
            kept.append((draw.address, choose(draw)))
        address, value = kept[0]
        return value if draw.address == address else choose(draw)

    return answer


def some(count: int) -> list[Program]:
    """Random programs; every third has two draws with the same prior."""
    random = Random(11)

    def weights() -> tuple[int, ...]:
        return tuple(random.choice((1, 1, 2, 3, 5)) for _ in range(random.choice((2, 2, 3))))

    def program(number: int) -> Program:
        x, y = weights(), weights()
        y = x if number % 3 == 0 else y
        allowed = [tuple(v for v in range(len(w)) if random.random() < 0.85) for w in (x, y)]
        pairs = [pair for pair in product(range(len(x)), range(len(y))) if random.random() < 0.25]
        return Program(x, y, allowed[0], allowed[1], tuple(pairs), random.choice((1, 2, 2)) if len(x) + len(y) > 4 else random.choice((1, 2, 3)))

    return [program(number) for number in range(count)]


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> list[Asked]:
    """A thousand programs, and what Coq says of them."""
    return by_the_theory(some(COUNT), tmp_path_factory.mktemp("coq"))


@needs_coq
def test_the_distributions_are_the_enumerated_one(asked: list[Asked]) -> None:
    """That of `sample`, given a scene, for any number of attempts; that of accepted runs; and all that may take the place of rejection."""
    others: dict[str, int] = defaultdict(int)
    impossible = rejecting = 0
    for program, answer in asked:
        found = enumerated(program)
        law = law_of(found)
        assert answer.desired == answer.given == law, program
        impossible += found is None
        if found is not None:
            rejecting += found.acceptance < 1
            none = Fraction(1) - sum(found.attempts_probability(k) for k in range(1, program.attempts + 1))
            assert answer.sample.get(None, 0) == none == (1 - found.acceptance) ** program.attempts
        for name, other in answer.others.items():
            others[name] += other != law
    repaired = others.pop("repaired")
    assert not any(others.values()), dict(others)
    assert 50 < impossible < 300 and rejecting > 500
    assert repaired > 300  # to draw only y again is wrong
    assert sum("exchanged" in answer.others for _, answer in asked) > 300


@needs_coq
def test_sample_has_the_distribution_of_the_theory(asked: list[Asked], monkeypatch: pytest.MonkeyPatch) -> None:
    several = asked[:FEWER]
    assert [program for program, answer in several if sampled(program, monkeypatch) != answer.sample] == []
    assert sum(0 < answer.sample.get(None, 0) < 1 for _, answer in several) > FEWER / 2


@needs_coq
def test_a_sampler_that_draws_only_one_object_again_is_noticed(asked: list[Asked], monkeypatch: pytest.MonkeyPatch) -> None:
    several = [(program, answer) for program, answer in asked if program.attempts > 1][:100]
    assert sum(sampled(program, monkeypatch, keeping_x) != answer.sample for program, answer in several) > 50


@needs_coq
def test_the_distribution_before_the_requirements_is_noticed(asked: list[Asked]) -> None:
    wrong = 0
    for program, answer in asked[:100]:
        free = Program(program.x, program.y, tuple(range(len(program.x))), tuple(range(len(program.y))), (), 1)
        wrong += law_of(enumerated(free)) != answer.desired
    assert wrong > 50
