"""Compiled functions give what the machine does, byte for byte; wrong ones in their place are found out."""

from __future__ import annotations

import inspect
import sys
import textwrap
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.inference import simulation_rejection
from scenic_ref.roads.network import Lane
from scenic_ref.semantics.machine.sandbox_table import may_ask
from scenic_ref.simulators.behaviors import compiled_library, host_calls, translate_statements
from scenic_ref.simulators.behaviors.operations import Calls, Equations
from scenic_ref.simulators.behaviors.policy import CompiledPolicy
from scenic_ref.simulators.worlds.driving import default_network

from .compared import differences, said
from .functions_at_random import functional_program
from .functions_by_hand import ERRORS, FUNCTIONS, LEFT

ROOT = Path(__file__).parents[2]
SEED = 40

BEHAVIOR = "behavior B:\n    {}\nego = Object with behavior B, with x Uniform(1, 2), with name 'ego'\n"


def taking(what: str, *functions: str) -> str:
    """A program whose behavior takes what some functions give."""
    return "\n".join(map(textwrap.dedent, functions)) + "\n" + BEHAVIOR.format(f"take {what}")


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_by_hand(name: str) -> None:
    scenario = scenic_ref.loads(FUNCTIONS[name])
    assert not list(differences(scenario, range(4), steps=12))
    is_error = isinstance(said(scenario, "compiled", 0, steps=12)[0], type)
    assert is_error is (name in ERRORS)
    assert bool(scenario.compiled.wholes) is (name in LEFT)
    assert not scenario.compiled.functions_left and not scenario.compiled.left


@pytest.mark.parametrize("first", range(0, 12, 4))
def test_programs_at_random(first: int) -> None:
    for number in range(first, first + 4):
        text = functional_program(SEED, number)
        assert not list(differences(scenic_ref.loads(text, dialect="scenic-2.1"), range(1), steps=6)), text


@pytest.mark.slow
@pytest.mark.parametrize("first", range(12, 132, 10))
def test_many_programs_at_random(first: int) -> None:
    for number in range(first, first + 10):
        text = functional_program(SEED, number)
        assert not list(differences(scenic_ref.loads(text, dialect="scenic-2.1"), range(1), steps=6)), text


# Functions that are compiled wrongly


WRONG = {
    "keywords are left out": (compiled_library.FunctionCode.bindings, "bound[name] = value", "pass"),
    "defaults are the first of all": (compiled_library.FunctionCode.bindings, "function.defaults[name]", "next(iter(function.defaults.values()))"),
    "a function is called in the scope of its caller": (Calls.applied, "Scope.of_call(function.scope", "Scope.of_call(scope"),
    "properties may draw": (
        Calls.property, "self.choose, self.price = refuse_property_draw, max(OF_HOST, self.fuel // (STEPS * MOST_OF_HOST))", "pass"
    ),
    "any looks at all": (Calls.quantified, "try:\n        for", "try:\n        found = list(found)\n        for"),
    "all is any": (Calls.quantified, "wanted = function is any", "wanted = True"),
    "elements are taken once": (Calls.elements, "return iterable", "return tuple(iterable)"),
    "an item from the other end": (Calls.item, "return subject[index]", "return subject[-index]"),
    "draws are not counted": (
        Equations.concluded, "self.state, self.draws = outcome.config.state, outcome.config.state.draws", "self.state = outcome.config.state"
    ),
    "+= makes a new list": (Calls.augmented, "[current, operand]", "[list(current) if type(current) is list else current, operand]"),
    "a comprehension shares its scope": (Calls.inner_scope, "return inner_scope(node, scope)", "return scope"),
}  # fmt: skip


def changed(function: Callable[..., object], old: str, new: str) -> Callable[..., object]:
    """A function of the compiled backend with another text."""
    text = textwrap.dedent(inspect.getsource(function))
    assert text.count(old) >= 1, old
    scope: dict[str, object] = dict(vars(sys.modules[function.__module__]))
    exec(text.replace(old, new), scope)
    return scope[function.__name__]  # type: ignore[return-value]


@cache
def by_machine(name: str, seed: int) -> tuple[object, ...]:
    """What the machine says of one of the programs."""
    return said(scenic_ref.loads(FUNCTIONS[name]), "interpreter", seed, steps=12)


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_function_is_found_out(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    function, old, new = WRONG[name]
    wrong = changed(function, old, new)
    if function.__name__ == "bindings":
        monkeypatch.setattr(compiled_library.FunctionCode, "bindings", wrong)
    else:
        monkeypatch.setattr(simulation_rejection, "CompiledPolicy", type("Wrong", (CompiledPolicy,), {function.__name__: wrong}))
    tried = ((program, seed) for seed in range(3) for program in FUNCTIONS if program != "recursion without end")
    assert any(said(scenic_ref.loads(FUNCTIONS[p]), "compiled", seed, steps=12) != by_machine(p, seed) for p, seed in tried)


TEXTS = {
    "finally is skipped": ("self.block(node.final)", "self.line('    pass')"),
    "finally also where the run ends": ('self.line(f"    {goes_on} = False")', 'self.line("    pass")'),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_wrong_translation_is_found_out(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled_library.function_code.cache_clear()
    monkeypatch.setattr(translate_statements.FunctionBody, "at_last", changed(translate_statements.FunctionBody.at_last, *TEXTS[name]))
    programs = [p for p in FUNCTIONS if "finally" in p]
    try:
        assert any(said(scenic_ref.loads(FUNCTIONS[p]), "compiled", s, steps=12) != by_machine(p, s) for p in programs for s in range(4))
    finally:
        compiled_library.function_code.cache_clear()


# What is not compiled, limits, and what is compiled once


def test_functions_with_something_untranslated_are_left_to_the_machine() -> None:
    scenario = scenic_ref.loads(taking("f(3)", "def f(n):\n    n = n + 1\n    param x = n\n    return n"))
    assert not list(differences(scenario, range(1), steps=3))
    assert scenario.compiled.functions_left == {"f (line 1)": "`param` on line 3"}
    assert scenario.compiled.nanoseconds["f (line 1)"] > 0
    assert not scenario.compiled.wholes


def test_deep_calls_are_the_machines(monkeypatch: pytest.MonkeyPatch) -> None:
    text = taking("f(400), f(2000)", "def f(n):\n    return 0 if n == 0 else 1 + f(n - 1)")
    scenario = scenic_ref.loads(text)
    assert not list(differences(scenario, range(1), steps=2))
    assert not scenario.compiled.wholes


@pytest.mark.parametrize("body", ["[x for x in range(10**7)]", "any(False for x in range(10**7))", "f(30)"])
def test_what_takes_very_long_is_for_the_machine_to_say(body: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation_rejection, "DEFAULT_FUEL", 20_000)
    text = taking(f"g({body})", "def g(x):\n    return 1\ndef f(n):\n    return n if n < 2 else f(n - 1) + f(n - 2)")
    scenario = scenic_ref.loads(text, fuel=20_000)
    assert not list(differences(scenario, range(1), steps=2))
    assert set(scenario.compiled.wholes) == {"a time step of very many turns"}


def test_functions_of_world_models_are_compiled_once_for_a_process() -> None:
    text = "model scenic.domains.driving.model\nego = Car with behavior FollowLaneBehavior(5)\n"
    compiled_library.function_code.cache_clear()
    scenic_ref.loads(text).simulate("kinematic", 5)
    made = compiled_library.function_code.cache_info().misses
    scenic_ref.loads(text).simulate("kinematic", 5)
    assert compiled_library.function_code.cache_info().misses == made > 0


# Host code


def attributes() -> Iterator[tuple[object, str]]:
    """What a program may ask of things of a map."""
    network = default_network()
    lane = network.lanes[0]
    subjects = [network, lane, lane.group, lane.road, lane.sections[0], *lane.maneuvers[:1], network.intersections[0], network.sidewalks[0]]
    return ((subject, name) for subject in subjects for name in sorted(dir(type(subject))) if may_ask(subject, name))


def test_what_is_read_without_the_machine_is_what_it_reads() -> None:
    count = 0
    for subject, name in attributes():
        found = host_calls.attribute(subject, name)
        if found is host_calls.SLOWLY or callable(found):
            continue
        assert found is getattr(subject, name) or found == getattr(subject, name), name
        count += 1
    assert count > 60


def test_what_is_no_matter_of_programs_is_not_read() -> None:
    lane = default_network().lanes[0]
    for name in ("network", "polygon", "left", "by_uid", "__dict__", "__class__", "scenic_names", "strips", "_tree", "near"):
        assert host_calls.attribute(lane, name) is host_calls.SLOWLY or may_ask(lane, name), name
        assert (Lane, name) not in host_calls.OPEN or may_ask(lane, name), name


def test_a_driving_program_of_many_functions_runs_compiled_altogether() -> None:
    scenario = scenic_ref.load(ROOT / "examples" / "many_functions.scenic")
    assert not list(differences(scenario, range(2), "kinematic", 25))
    assert not (scenario.compiled.functions_left or scenario.compiled.left or scenario.compiled.wholes)
