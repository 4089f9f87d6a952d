"""Step 1 of `proofs/kernel/Machine.v` and that in Python give a thousand programs the same scenes and probabilities, and reject the same runs.

The normal distribution is replaced by one with two values on both sides, half of the standard deviation to the one and all of it to the other, which
are not equally likely: so which draw is added to what, and by which deviation it was drawn, shows.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction

import pytest
from scenic_ref.semantics.machine.config import Captured, State
from scenic_ref.semantics.machine.values import Instance
from scenic_ref.semantics.scenes import mutation, statements, termination
from scenic_ref.semantics.space.distributions import Normal

from .coq import needs_coq
from .core_programs import Program
from .extracted import answers
from .noisy_programs import noisy_program
from .test_machine import Answer, agree, by_the_machine, by_the_theory
from .theory import TOLD

pytestmark = pytest.mark.slow

COUNT = 1000
PROGRAMS = [noisy_program(seed) for seed in range(COUNT)]


@pytest.fixture(scope="module")
def theories() -> list[Answer]:
    """What the theory says about the programs."""
    assert TOLD.count("no_noise") == 1
    return [by_the_theory(told) for told in answers(TOLD.replace("no_noise", "lopsided_noise"), [one.coq for one in PROGRAMS])]


@pytest.fixture(autouse=True)
def lopsided(monkeypatch: pytest.MonkeyPatch) -> None:
    """The noise has two values in the program too."""
    monkeypatch.setattr(Normal, "support", lambda self: ((self.stdDev / 2, Fraction(1, 4)), (-self.stdDev, Fraction(3, 4))))


def differences(theories: Sequence[Answer]) -> Iterator[Program]:
    """The programs to which the machine gives something else."""
    return (one for one, theory in zip(PROGRAMS, theories, strict=False) if not agree(by_the_machine(one), theory))


@needs_coq
def test_the_noise_agrees(theories: list[Answer]) -> None:
    wrong = [one.scenic for one in differences(theories)]
    assert len(theories) == COUNT and not wrong, wrong[0]


@needs_coq
def test_there_is_noise_of_all_kinds(theories: list[Answer]) -> None:
    """Objects that move, turn, or both; runs that noise gets rejected; requirements that are checked with it."""
    assert not any(one.errors for one in theories)
    poses = [[dict(o) for _, _, objects in one.law for o in objects] for one in theories]
    moved = [any(o["position"][1].denominator > 1 for o in one) for one in poses]
    turned = [any(o["heading"][1] for o in one) for one in poses]
    both = [one and another for one, another in zip(moved, turned, strict=True)]
    assert min(sum(moved), sum(turned), 2 * sum(both)) > COUNT / 10
    kinds = Counter(kind for one in theories for kind in {kind for kind, _ in one.rejected})
    assert min(kinds[kind] for kind in ("require", "collision", "visibility")) > COUNT / 100, kinds
    assert sum(len(one.law) >= 8 for one in theories) > COUNT / 3


MUTATED, NORMAL_OF, AS_CAPTURED, MUTATE = mutation.mutate_object, mutation.normal_of, termination.as_captured, statements.conclude_mutate


def sideways(o: Instance, noise: tuple[object, ...], state: State) -> State:
    """The noise on y is that on x."""
    return MUTATED(o, (noise[0], noise[0], *noise[2:]), state)


def unscaled(o: Instance, component: int, state: State) -> Normal:
    """The scale of the mutation does not count, unless it is 0."""
    return NORMAL_OF(o, component, state.with_properties(o, {"mutationScale": 1}))


def turned_as_moved(o: Instance, component: int, state: State) -> Normal:
    """The heading has the deviation of the position."""
    return NORMAL_OF(o, min(component, 1), state)


def before_the_noise(captured: Captured, state: State) -> State:
    """Requirements that waited are checked where the objects were."""
    return AS_CAPTURED(captured, state._replace(scene=()))._replace(scene=state.scene)


def the_first_alone(node: object, values: list[object], stack: object, state: State) -> object:
    """`mutate` without objects is about the first object."""
    outcome = MUTATE(node, values, stack, state._replace(scene=state.scene[:1]) if len(values) == 1 else state)  # type: ignore[arg-type]
    config = outcome.config  # type: ignore[union-attr]
    return outcome._replace(config=config._replace(state=config.state._replace(scene=state.scene)))  # type: ignore[union-attr]


@needs_coq
@pytest.mark.parametrize(
    ("where", "name", "planted"),
    [
        (mutation, "mutate_object", sideways), (mutation, "normal_of", unscaled), (mutation, "normal_of", turned_as_moved),
        (termination, "as_captured", before_the_noise), (statements, "conclude_mutate", the_first_alone),
    ],
)  # fmt: skip
def test_wrong_noise_is_noticed(
    where: object, name: str, planted: Callable[..., object], theories: list[Answer], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(where, name, planted)
    assert len(list(differences(theories[:200]))) >= 3
