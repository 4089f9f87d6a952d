"""Scenes of generated programs: the same for the same seed, and the same again from a trace."""

from __future__ import annotations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scenic_ref.api import Scenario, loads
from scenic_ref.conformance.generator.hypothesis_strategies import programs
from scenic_ref.data.scene import Scene
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.semantics.syntax import Program

from .cases import quick
from .run_replays import first_accepted, replayed

ATTEMPTS = 12


def scene_or_none(scenario: Scenario, seed: int, index: int = 0) -> Scene | None:
    try:
        return scenario.sample(seed, index, max_attempts=ATTEMPTS)
    except AttemptsExhausted:
        return None


def content(scene: Scene | None) -> object:
    return None if scene is None else scene.to_json()


@pytest.mark.slow
@quick(60)
@given(programs(), st.integers(0, 2**64))
def test_the_same_seed_gives_the_same_scene(program: Program, seed: int):
    one, other = loads(program.text), Scenario(parse(program.text))
    assert content(scene_or_none(one, seed)) == content(scene_or_none(other, seed))


@pytest.mark.slow
@quick(30)
@given(programs(), st.integers(0, 1000))
def test_a_scene_does_not_depend_on_those_drawn_before(program: Program, seed: int):
    used, fresh = loads(program.text), loads(program.text)
    for index in range(3):
        scene_or_none(used, seed, index)
    assert content(scene_or_none(used, seed, 3)) == content(scene_or_none(fresh, seed, 3))


@pytest.mark.slow
@quick(30)
@given(programs())
def test_the_tree_as_it_is_gives_the_scene_of_its_text(program: Program):
    assert content(scene_or_none(Scenario(program), 1)) == content(scene_or_none(loads(program.text), 1))


@pytest.mark.slow
@quick(80)
@given(programs(), st.integers(0, 1000))
def test_replaying_a_trace_gives_the_same_scene_and_density(program: Program, seed: int):
    scenario = loads(program.text)
    first = first_accepted(scenario, seed, ATTEMPTS)
    assume(first is not None)
    assert first is not None and first.scene is not None
    again = replayed(scenario, first.answers)
    assert again.scene is not None
    assert again.scene.to_json() == first.scene.to_json()
    assert again.log_density == first.log_density
    assert first.log_density > float("-inf")
    assert tuple(again.answers) == tuple(first.answers)
    assert not first.repeated
