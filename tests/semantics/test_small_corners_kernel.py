"""Small changes of `semantics/store` and `semantics/machine` that no vector can show: hints, messages, limits, and what is drawn many scenes at a
time.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.trace import Trace
from scenic_ref.semantics.machine.outcome import Outcome
from scenic_ref.semantics.machine.sandbox_table import is_value
from scenic_ref.semantics.space.regions import everywhere
from scenic_ref.semantics.step import step
from scenic_ref.semantics.store import suggestions
from scenic_ref.semantics.store.errors import FuelExhausted, ProgramError, RunError
from scenic_ref.simulators.loop import simulate_once
from scenic_ref.simulators.still import Still

EGO = "ego = Object at (0, 0)\n"
REPEATING = f"from collections import deque\nfrom itertools import repeat\n{EGO}"


@pytest.mark.parametrize(
    ("program", "hint"),
    [
        ("x = Ego\n", "did you mean ego?"),
        ("x = Object at (9, 9), with width [1, 2, 3]\n", "for one of them write `Uniform(*values)`"),
        ("x = Object at (9, 9), with positionStdDev 'a'\n", "write a number without quotation marks"),
        ("x = Object at (9, 9), with positionStdDev -1\n", ""),
        ("x = Object at (9, 9), with requireVisible 'a'\n", ""),
        ("x = [].appendd(3)\n", "did you mean append?"),
        ("x = (1 @ 2).z\n", ""),
    ],
)
def test_what_to_write_instead_is(program: str, hint: str) -> None:
    with pytest.raises(ProgramError) as raised:
        scenic_ref.loads(EGO + program).sample()
    assert raised.value.hint == hint


def test_a_number_that_is_refused_is_shown_whatever_format_its_class_has() -> None:
    program = f"{EGO}class N(float):\n    def __format__(self, spec): return 'much'\nx = Object at (9, 9), with width N(-1)\n"
    with pytest.raises(RunError, match=r"must be at least 0, not -1\.0 "):
        scenic_ref.loads(program).sample()


MANY = pytest.param("repeat(1, 10 ** 7)", marks=pytest.mark.slow)


@pytest.mark.parametrize("endless", [MANY, "repeat('a' * 10 ** 6, 100)", "repeat([0] * 10 ** 6, 100)"])
def test_what_an_iterator_gives_is_paid_for_by_its_length(endless: str) -> None:
    with pytest.raises(FuelExhausted, match="goes through more, or makes more, than one run may"):
        scenic_ref.loads(f"{REPEATING}x = deque({endless}, maxlen=0)\n").sample()


@pytest.mark.parametrize("items", ["repeat(1, 10 ** 5)", "repeat('a' * 10 ** 5, 10)"])
def test_an_iterator_that_gives_little_may_be_gone_through(items: str) -> None:
    found = scenic_ref.loads(f"{REPEATING}param n = len(deque({items}, maxlen=3))\n").sample()
    assert found.params["n"] == 3


@pytest.mark.parametrize(("name", "known"), [("a" * 40, "a" * 10_000), ("a" * 101, "b" + "a" * 101), ("a" * 10_000, "b" * 10_000)])
def test_letters_are_not_compared_where_names_are_long_or_cannot_be_near(monkeypatch: pytest.MonkeyPatch, name: str, known: str) -> None:
    """Each pair of letters is looked at once: a program that is hostile would make that as many as it likes."""
    asked: list[str] = []
    monkeypatch.setattr(suggestions, "edit_distance", lambda one, other: asked.append(one) or 1)
    assert suggestions.nearest(name, [known]) is None
    assert asked == []


def test_of_names_that_are_as_near_the_one_with_the_same_first_letter_is_meant() -> None:
    assert suggestions.nearest("tablex", ["cablex", "Tables"]) == "Tables"
    assert suggestions.nearest("tablex", ["Tables", "cablex", "tables"]) == "tables"


def test_the_view_of_a_container_does_not_wait_for_a_position() -> None:
    program = "F = VectorField('F', lambda p: p.x)\nw = 0.5 relative to F\nd = {1: w}\nego = Object at (1, 0), with p d.values()\n"
    with pytest.raises(RunError, match="it needs the position of an object being specified"):
        scenic_ref.loads(program, readings={"field-dependency": "position"}).sample()


def test_a_function_of_the_program_runs_within_a_run_only() -> None:
    config = scenic_ref.loads(f"def same(x):\n    return x\n{EGO}").start()
    while "same" not in config.state.sigma.bindings:
        config = step(config).config  # type: ignore[union-attr]
    with pytest.raises(RunError, match="same is called outside any run"):
        config.state.sigma.bindings["same"](3)  # type: ignore[operator]


STRANGERS = (
    eval, print, open, np.zeros(3).tolist, np.zeros(3).tofile, [].__reduce_ex__, "a".__getattribute__, dict.__reduce__, np.ndarray.dump, np.ndarray,
    type, Path().read_text, everywhere.__init__, everywhere.__reduce_ex__,
)  # fmt: skip


@pytest.mark.parametrize("value", STRANGERS)
def test_functions_methods_and_classes_of_strangers_are_no_values_of_programs(value: object) -> None:
    assert not is_value(value)


@pytest.mark.parametrize("value", [abs, len, [].append, "a".join, str.upper, {}.get, int, ValueError, everywhere.containsPoint])
def test_functions_methods_and_classes_that_a_program_may_hold_are_values(value: object) -> None:
    assert is_value(value)


def test_what_a_partial_is_called_follows_from_no_class_of_the_program() -> None:
    program = f"from functools import partial\n{EGO}class Car(object):\n    name = 'Fred'\n"
    program += "    def __call__(self): return 1\nparam p = str(partial(Car)), q = str(partial(Car()))\n"
    assert set(scenic_ref.loads(program).sample().params.values()) == {"<built-in function partial>"}


SUBSCENARIO = """
monitor Watch():
    wait
scenario Part():
    setup:
        require monitor Watch()
    compose:
        wait
scenario Main():
    setup:
        ego = new Object
        require monitor Watch()
    compose:
        do Part()
        do Part()
"""


def test_a_trace_says_whose_monitors_and_blocks_run() -> None:
    """What scenarios draw follows from the seed and their numbers, which count on from 0, the top-level one, in the order in which they begin."""
    trace, numbers = Trace(), set()

    def witness(outcome: Outcome, drawn: object) -> None:
        trace.witness(outcome, drawn)
        if trace.state is not None and trace.state.simulation is not None:
            numbers.update(trace.state.simulation.scenarios)

    simulate_once(scenic_ref.loads(SUBSCENARIO, dialect="scenic-3").start(), from_stream(0, 0, 0), Still(1.0), 3, witness=witness)
    told = " ".join(event.change for event in trace.events)
    assert "a monitor of Main()" in told and "a monitor of Part()" in told and "the compose block of Part()" in told
    assert "top-level" not in told
    assert numbers == {0, 1, 2}


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        ("x = Range(0, 3)\nfound = filter(lambda v: v > x, Uniform([1, 2, 3], [2, 3]))\nparam n = len(found)\n", None),
        ("x = Range(0, 1)\nparam d = distance from (x, 2) to (0, 0)\n", None),
        ("v = Uniform((1, 2), (3, 4))\na, *b = v\nparam a = a, b = b\n", None),
        ("v = Uniform({'a': (1, 2)}, {'a': 3 @ 4})['a']\na, b = v\nparam a = a, b = b\n", "a choice among values of different types"),
    ],
)
def test_what_is_drawn_many_at_a_time_is_what_is_drawn_one_by_one(program: str, reason: str | None) -> None:
    scenario = scenic_ref.loads(EGO + program)
    many, single = (list(scenario.sample_many(12, 1, backend=backend)) for backend in ("batch", "interpreter"))  # type: ignore[arg-type]
    assert [scene.to_json() for scene in many] == [scene.to_json() for scene in single]
    assert scenario.not_lifted is None if reason is None else reason in str(scenario.not_lifted)


def test_names_and_constants_beside_something_random_leave_later_draws_as_they_are() -> None:
    """They draw nothing, so the numbers for what is drawn afterwards are those of a program without the operator."""
    programs = [f"x = Uniform(True, False)\ny = {y}\nego = Object at Range(0, 1) @ 0\nparam z = Range(0, 1)\n" for y in ("x", "x or x", "x and True")]
    first, *others = [[(scene.ego.position, scene.params["z"]) for scene in scenic_ref.loads(program).sample_many(5, 3)] for program in programs]
    assert others == [first, first]
