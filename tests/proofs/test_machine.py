"""The machine of `proofs/kernel/Machine.v` and that in Python give a thousand programs the same scenes and probabilities, or the same errors.

None of the programs has noise: the theory's is a finite distribution that stands for the normal one, so that `mutate` is by 0, or of an object
whose deviations are 0.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import pytest
import scenic_ref
from scenic_ref.data.scene import Scene
from scenic_ref.errors import AttemptsExhausted, ScenicError
from scenic_ref.semantics.machine.config import PASS, Config, Stack, State
from scenic_ref.semantics.machine.outcome import Observe, Outcome, Requirement
from scenic_ref.semantics.machine.values import Instance
from scenic_ref.semantics.rules import RULES
from scenic_ref.semantics.scenes import statements, termination
from scenic_ref.semantics.space.vectors import Vector

from .coq import PROOFS, Term, evaluated, needs_coq
from .core_programs import NAMES, Both, Program, assigned, binary, discrete, fraction, listed, number, program, truth, variable
from .extracted import answers
from .theory import ERRORS, TOLD, Key, bindings, value

pytestmark = pytest.mark.slow

COUNT = 1000
BEYOND = ERRORS[-1]
"""Of such programs the theory says nothing."""


# What they do


@dataclass(frozen=True)
class Answer:
    """The scenes and their probabilities; where runs are rejected, with what probability (0, if there is no scene); the errors."""

    law: Mapping[Key, Fraction]
    rejected: Mapping[Key, Fraction]
    errors: frozenset[tuple[str, str]]


def by_the_theory(told: Term) -> Answer:
    """What Coq says about a program."""
    scenes: dict[Key, Fraction] = defaultdict(Fraction)
    rejected: dict[Key, Fraction] = defaultdict(Fraction)
    errors: set[tuple[str, str]] = set()
    assert told, "the theory ran out of steps"
    for (kind, detail, above, below), *scene in told:
        weight = Fraction(above, below)
        if kind == 0:
            params, ego, *objects = scene
            content = tuple(tuple(sorted((NAMES[p], v) for p, v in bindings(o))) for o in objects)
            scenes[tuple(sorted((f"a{x}", v) for x, v in bindings(params))), value(iter(ego)), content] += weight
        elif kind == 4:
            errors.add(ERRORS[detail])
        else:
            rejected[("require", detail) if kind == 1 else (("collision", "visibility")[kind - 2], 0)] += weight
    assert errors or sum(scenes.values()) + sum(rejected.values()) == 1
    accepted = sum(scenes.values())
    law = {scene: p / accepted for scene, p in scenes.items()}
    return Answer(law, dict(rejected) if accepted else dict.fromkeys(rejected, Fraction(0)), frozenset(errors))


def by_the_machine(one: Program, readings: Mapping[str, str] | None = None) -> Answer:
    """What the enumeration gives."""
    try:
        found = scenic_ref.loads(one.scenic, readings={"require-time": one.reading, **(readings or {})}).enumerate()
    except AttemptsExhausted as problem:
        return Answer({}, {place(r): Fraction(0) for r, _ in problem.stuck}, frozenset())  # type: ignore[arg-type]
    except ScenicError as problem:
        exception = getattr(problem, "exception", None)
        return Answer({}, {}, frozenset({(type(exception or problem).__name__, problem.rule)}))
    rejected: dict[Key, Fraction] = defaultdict(Fraction)
    for requirement, probability in found.stuck.items():
        rejected[place(requirement)] += probability
    return Answer(found.law(content_of), dict(rejected), frozenset())  # type: ignore[arg-type]


def place(requirement: Requirement) -> Key:
    """A requirement of the program by its line; of the default ones only the kind."""
    return requirement.kind, requirement.span.line if requirement.kind == "require" else 0


def content_of(scene: Scene) -> Key:
    """A scene as the theory tells it."""
    numbers = {o.made: i for i, o in enumerate(scene.objects)}

    def read(found: object) -> Key:
        if isinstance(found, bool):
            return 1, Fraction(found)
        if isinstance(found, Instance):
            return 3, Fraction(numbers[found.number])
        if isinstance(found, (Vector, tuple)):
            return 2, Fraction(found[0]), Fraction(found[1])
        return 0, Fraction(found)  # type: ignore[arg-type]

    objects: list[Key] = []
    for o in scene.objects:
        all_ = {**o.properties, "position": o.position, "heading": o.heading, "width": o.width, "length": o.length}
        objects.append(tuple(sorted((name, read(all_[name])) for name in NAMES.values() if name in all_)))
    assert scene.ego is not None
    return tuple(sorted((name, read(v)) for name, v in scene.params.items())), (3, Fraction(scene.ego.id)), tuple(objects)


def agree(machine: Answer, theory: Answer) -> bool:
    """Whether they say the same; where runs fail, the Python raises the error of one of them."""
    return machine.errors <= theory.errors if machine.errors else machine == theory


def telling() -> Iterator[Program]:
    """Programs that tell the readings of `soft` and `require-time` apart."""
    drawn, small = assigned(1, discrete([(number(Fraction(v)), Fraction(1)) for v in range(4)])), binary("<", variable(1), number(Fraction(1)))
    first = assigned(0, Both("Object", "(Object [] [])"))
    shown = Both("param a0 = x1", f"Param 0%nat {variable(1).coq}")
    for made in (
        [first, drawn, shown, Both(f"require[0.5] {small.scenic}", f"SoftRequire 4%nat {fraction(Fraction(1, 2))} {small.coq}")],
        [first, drawn, Both(f"require {truth(False).scenic}", f"Require 3%nat {truth(False).coq}"), assigned(2, variable(99))],
    ):
        for reading in ("statement", "end"):
            yield Program(
                "\n".join(s.scenic for s in made) + "\n", f"({str(reading == 'end').lower()}, {listed(f'({s.coq})' for s in made)})", reading
            )


PROGRAMS = [*telling(), *(program(seed) for seed in range(COUNT))]


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[Term]:
    """What Coq says about the programs."""
    terms = [f"map ({TOLD}) {listed(one.coq for one in PROGRAMS)}"]
    return evaluated(["kernel.Distribution", "kernel.Machine"], terms, tmp_path_factory.mktemp("machine"))[0]


@pytest.fixture(scope="module")
def theories(told: list[Term]) -> list[Answer]:
    """What the theory says about the programs."""
    return [by_the_theory(one) for one in told]


def differences(theories: Sequence[Answer], readings: Mapping[str, str] | None = None) -> Iterator[Program]:
    """The programs to which the machine gives something else."""
    return (one for one, theory in zip(PROGRAMS, theories, strict=False) if not agree(by_the_machine(one, readings), theory))


@needs_coq
def test_the_machines_agree(theories: list[Answer]) -> None:
    assert len(theories) == len(PROGRAMS) >= COUNT
    wrong = [one.scenic for one in differences(theories)]
    assert not wrong, wrong[0]


@needs_coq
def test_the_extracted_machine_says_what_coq_says(told: list[Term]) -> None:
    assert answers(TOLD, [one.coq for one in PROGRAMS]) == told


@needs_coq
def test_the_programs_do_various_things(theories: list[Answer]) -> None:
    assert not any(BEYOND in one.errors for one in theories)
    lawful = [one for one in theories if not one.errors]
    assert len(lawful) > COUNT / 2
    assert sum(len(one.law) > 1 for one in lawful) > COUNT / 4
    assert sum(bool(one.law) and bool(one.rejected) for one in lawful) > COUNT / 10
    assert COUNT / 50 < sum(not one.law for one in lawful) < COUNT / 3
    kinds = Counter(kind for one in lawful if one.law for kind in {kind for kind, _ in one.rejected})
    assert min(kinds[kind] for kind in ("require", "collision", "visibility")) >= COUNT / 100, kinds
    errors = Counter(e for one in theories for e in one.errors)
    assert len(errors) >= 12 and sum(errors.values()) > COUNT / 10, errors


def unchecked(rule: str, requirement: Requirement, holds: object, stack: Stack, state: State) -> Outcome:
    """A rule for requirements that fires in any case."""
    return Observe(rule, requirement, Config(PASS, stack, state))


def all_hold(premises: Sequence[object], index: int, state: State) -> None:
    """Step 2 without its premises."""


def tails(node: object, stack: Stack, state: State) -> Config:
    """`require[p] B` that never enforces B."""
    return statements.skip(stack, state)


@needs_coq
@pytest.mark.parametrize(
    ("where", "name", "planted"),
    [
        (statements, "observe_requirement", unchecked), (termination, "check_default_requirements", all_hold),
        (statements, "check_soft_requirement", tails)
    ],
)
def test_a_machine_with_a_wrong_rule_is_noticed(
    where: object, name: str, planted: object, theories: list[Answer], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(where, name, planted)
    assert len(list(differences(theories[:100]))) >= 3


@needs_coq
@pytest.mark.parametrize("readings", [{"soft": "scene"}, {"require-time": "end"}, {"require-time": "statement"}])
def test_the_other_reading_is_noticed(readings: dict[str, str], theories: list[Answer]) -> None:
    assert any(differences(theories[:4], readings))


def test_the_rules_are_those_of_the_catalogue() -> None:
    text = (PROOFS / "kernel" / "Machine.v").read_text().partition("Inductive step ")[2].partition("Inductive stuck_at")[0]
    names = [name.replace("_", "-") for name in re.findall(r"^\| (\w+)", text, re.MULTILINE)]
    ours = [name for name in names if not f"{name}-".startswith("Premise-")]
    assert len(ours) > 25
    assert not [name for name in ours if not any(name == rule or name.startswith(f"{rule}-") for rule in RULES)]
