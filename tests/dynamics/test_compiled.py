"""Compiled behaviors give the simulations of the machine, byte for byte; wrong policies in their place are found out."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.conformance.generator.dynamic_programs import dynamic_program
from scenic_ref.conformance.implementations.reference import load_task
from scenic_ref.conformance.vector_files import load_vectors
from scenic_ref.inference import simulation_rejection
from scenic_ref.semantics.store.errors import FuelExhausted, UsageError
from scenic_ref.simulators.behaviors import generators, policy
from scenic_ref.simulators.behaviors.generators import Courses
from scenic_ref.simulators.behaviors.policy import CompiledPolicy

from ..oracle.invention import invented
from ..oracle.programs import text_of
from ..programs.dynamic_mistakes import misbehaving
from .compared import differences, said
from .programs_by_hand import BY_HAND

ROOT = Path(__file__).parent.parent.parent
SEED = 11


def by_hand(name: str, profile: str = "paper") -> scenic_ref.Scenario:
    """A program by hand."""
    if name == "a later dialect":
        return scenic_ref.loads(BY_HAND[name], dialect="scenic-3")
    return scenic_ref.loads(BY_HAND[name], profile=profile)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", BY_HAND)
@pytest.mark.parametrize("profile", ["paper", "scenic-3"])
def test_programs_by_hand(name: str, profile: str) -> None:
    scenario = by_hand(name, profile)
    assert not list(differences(scenario, range(12), steps=20))


@pytest.mark.parametrize("alternative", ["interrupt-first-step=later-steps", "invariant-of-caller=every-step", "terminate-who=simulation"])
def test_other_readings(alternative: str) -> None:
    reading, name = alternative.split("=")
    for number in range(5):
        scenario = scenic_ref.loads(text_of(invented(SEED, number)), readings={reading: name})
        assert not list(differences(scenario, range(2)))


def test_what_programs_by_hand_leave_to_the_machine() -> None:
    """Nothing but what is written here, so that the tests above test compiled code."""
    left = {}
    for name in BY_HAND:
        scenario = by_hand(name)
        for seed in range(5):
            said(scenario, "compiled", seed, steps=20)
        found = {*scenario.compiled.left.values(), *scenario.compiled.wholes}
        left |= {name: found} if found else {}
    assert left == {}


@pytest.mark.parametrize("first", range(0, 20, 10))
def test_programs_at_random(first: int) -> None:
    for number in range(first, first + 10):
        for text in (dynamic_program(SEED, number), text_of(invented(SEED, number))):
            assert not list(differences(scenic_ref.loads(text), range(2))), text


@pytest.mark.slow
@pytest.mark.parametrize("first", range(100, 300, 25))
def test_many_programs_at_random(first: int) -> None:
    for number in range(first, first + 25):
        for text in (dynamic_program(SEED, number), text_of(invented(SEED, number))):
            assert not list(differences(scenic_ref.loads(text), range(2))), text


def test_programs_with_mistakes() -> None:
    """Errors are the machine's, words and places included."""
    for wrong in misbehaving():
        scenario = scenic_ref.loads(wrong.text)
        assert not list(differences(scenario, range(1))), wrong.text


@pytest.mark.slow
def test_vectors() -> None:
    """All vectors about simulations, in every dialect."""
    count = 0
    for vector in load_vectors():
        if vector.steps is None:
            continue
        for dialect in vector.texts:
            try:
                scenario = load_task(vector.task(dialect))
            except Exception:  # whatever a vector about errors raises where it is loaded
                continue
            count += 1
            assert not list(differences(scenario, range(2))), (vector.name, dialect)
    assert count > 900


@pytest.mark.slow
@pytest.mark.parametrize("simulator", ["still", "kinematic"])
def test_listings_and_examples(simulator: str) -> None:
    """The dynamic programs of the paper, and of the folder of examples, on roads and elsewhere."""
    count = 0
    for path in sorted((ROOT / "examples").rglob("*.scenic")):
        if not any(word in path.read_text() for word in ("behavior ", "scenario ", "monitor ")):
            continue
        count += 1
        assert not list(differences(scenic_ref.load(path), range(1), simulator, 20)), path
    assert count >= 18


# Wrong policies


def changed(function: Callable[..., object], old: str, new: str) -> Callable[..., object]:
    """A function of the compiled backend with another text."""
    text = textwrap.dedent(inspect.getsource(function))
    assert text.count(old) >= 1, old
    scope: dict[str, object] = dict(vars(generators) if function.__module__ == generators.__name__ else vars(policy))
    exec(text.replace(old, new), scope)
    return scope[function.__name__]  # type: ignore[return-value]


WRONG = {
    "earlier clauses first": (Courses.interruptible, "clauses[after]", "clauses[last - after if current == BODY else after]"),
    "handlers are not interrupted": (Courses.interruptible, "while after > current:", "while after > current and current == BODY:"),
    "interrupts from the second step on": (Courses.interruptible, 'if isinstance(node, LATER) and', "if True or"),
    "handlers do not repeat": (Courses.interruptible, "current if since < simulation_of(self.state).step else current - 1", "current - 1"),
    "handlers repeat in their own step": (Courses.interruptible, "if since < simulation_of(self.state).step else current - 1", ""),
    "no invariants when a handler begins": (Courses.interruptible, "if begun and leaf is here and here.invariants:", "if False:"),
    "invariants at the beginning only": (Courses.check_invariants, "self.check(of.invariants, of.scope)", "return"),
    "no preconditions": (Courses.entered, "if code.preconditions and not enabled:", "if False:"),
    "no invariants of the caller": (Courses.run_behavior, "if caller.invariants and not limited:", "if False:"),
    "violations reject": (
        Courses.check, 'raise Raised(Abrupt("raise", guard.violation(guard.text), guard.node.span))',
        'raise RunRejected("", Requirement("guard", guard.node.span, guard.text))',
    ),
    "all are enabled": (Courses.is_enabled, "return all(", "return True or all("),
    "shuffle stops after one": (Courses.pick, "if isinstance(node, d.DoShuffle) else []", "if False else []"),
    "weights are equal": (Courses.pick, "(k, options[k][1])", "(k, 1)"),
    "draws are not counted": (Courses.drawn, "self.draws += 1", "pass"),
    "behaviors together draw the same": (Courses.together, "(*base, place), 0", "(*base, 0), 0"),
    "behaviors together end with the first": (Courses.together, "if not left:", "if len(left) < len(running):"),
    "terminate ends one of several": (Courses.together, "if terminates:\n            raise", "if False:\n            raise"),
    "finally is skipped": (Courses.at_last, "except (Raised, Aborted, Terminated) as found:", "except Aborted as found:"),
    "abort ends nothing": (Courses.abort, "raise Aborted", "return"),
    "else after abort": (Courses.abortable, "return None", "raise"),
    "monitors after behaviors": (CompiledPolicy.steps, "self.monitors()", "pass"),
    "no check of the flag before behaviors": (CompiledPolicy.steps, 'self.ended("D-Policy-4")', "None"),
    "no check of the flag after them": (CompiledPolicy.steps, 'self.ended("D-Policy-6")', "None"),
    "requirements are not looked at": (CompiledPolicy.steps, "self.requirements()", "None"),
    "always is eventually": (CompiledPolicy.requirement, "if not eventually and not holds:", "if False:"),
    "conditions share draws": (CompiledPolicy.evaluated, "address_of(who, self.state), 0, ()", "address_of(who, self.state)[:3], 0, ()"),
    "termination is not looked at": (CompiledPolicy.termination, "for index, declared in enumerate(top.terminations):", "for index, declared in ():"),
    "agents begin anew": (CompiledPolicy.behaviors, "if agent is not None and agent.ended:", "if False:"),
}  # fmt: skip


@cache
def programs() -> list[scenic_ref.Scenario]:
    """Those by hand, and some at random."""
    texts = [text_of(invented(SEED, number)) for number in range(40)] + [dynamic_program(SEED, number) for number in range(40)]
    return [*map(by_hand, BY_HAND), *map(scenic_ref.loads, texts)]


@cache
def by_machine(program: int, seed: int) -> tuple[object, ...]:
    """What the machine says of one of the programs."""
    return said(programs()[program], "interpreter", seed, steps=20)


@pytest.mark.slow
@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_policy_is_found_out(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a program by hand, or one of those at random."""
    method, old, new = WRONG[name]
    wrong = type("Wrong", (CompiledPolicy,), {method.__name__: changed(method, old, new)})
    monkeypatch.setattr(simulation_rejection, "CompiledPolicy", wrong)
    tried = ((k, seed) for k in range(len(programs())) for seed in range(2))
    assert any(said(programs()[k], "compiled", seed, steps=20) != by_machine(k, seed) for k, seed in tried)


# What is left, limits, and what is kept


def test_a_coroutine_with_something_untranslated_is_left_alone() -> None:
    scenario = scenic_ref.loads(
        "behavior Fine:\n    take 7\nbehavior Odd:\n    for a, b in [(1, 2)]:\n        param x = a\n        take a, b\n"
        "behavior Plain:\n    take 1\n    do Odd\n"
        "ego = Object with behavior Plain\nother = Object at 5 @ 0, with behavior Odd\nlast = Object at 9 @ 0, with behavior Fine\n"
    )
    assert not list(differences(scenario, range(2)))
    assert sorted(scenario.compiled.left.values()) == ["`param` on line 5"] * 2
    assert not scenario.compiled.wholes


def test_endless_loops_and_recursion_are_the_machines_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation_rejection, "DEFAULT_FUEL", 20_000)
    for text in (
        "behavior B:\n    while True:\n        pass\nego = Object with behavior B",
        "behavior B:\n    do B()\nego = Object with behavior B",
        "behavior B:\n    take 1\n    for i in range(10**9):\n        x = i\nego = Object with behavior B",
    ):
        scenario = scenic_ref.loads(text, fuel=20_000)
        assert said(scenario, "compiled", 0) == said(scenario, "interpreter", 0)
    assert isinstance(said(scenario, "compiled", 0)[0], type(FuelExhausted))


def test_handlers_that_interrupt_each_other_without_end_are_the_machines_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation_rejection, "DEFAULT_FUEL", 20_000)
    text = """
n = 0
behavior B:
    global n
    try:
        take 1
        take 2
    interrupt when n % 2 == 0 and simulation.currentTime == 1:
        n = n + 1
        while n % 2 == 1:
            n = n + 2
    interrupt when n % 2 == 1 and simulation.currentTime == 1:
        n = n + 1
        while n % 2 == 0:
            n = n + 2
ego = Object with behavior B"""
    scenario = scenic_ref.loads(text, fuel=20_000)
    assert said(scenario, "compiled", 0, steps=3) == said(scenario, "interpreter", 0, steps=3)


def test_many_turns_that_end_are_the_machines_too() -> None:
    scenario = scenic_ref.loads("behavior B:\n    n = 0\n    while n < 100000:\n        n += 1\n    take n\nego = Object with behavior B")
    assert not list(differences(scenario, range(1), steps=2))
    assert scenario.compiled.wholes


def test_what_is_compiled_is_compiled_once() -> None:
    scenario = scenic_ref.loads(BY_HAND["loops"])
    scenario.simulate(steps=5)
    codes = dict(scenario.compiled.codes)
    scenario.simulate(steps=5, seed=1)
    assert scenario.compiled.codes == codes
    assert codes


def test_an_unknown_backend_is_an_error() -> None:
    scenario = scenic_ref.loads("ego = Object")
    with pytest.raises(UsageError, match="there is no backend 'fast' of simulations"):
        scenario.simulate(backend="fast")  # type: ignore[arg-type]
