"""The order of specifiers in the source has no meaning.

Draws inside specifiers are numbered in the order in which they are made, so that with another order a seed gives other
numbers: finite programs are compared in law, exactly; others scene by scene, where the specifiers that change places draw nothing.
"""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scenic_ref.api import loads
from scenic_ref.conformance.generator import ProgramSettings, random_programs
from scenic_ref.conformance.generator.choice_sources import SeededChoices
from scenic_ref.conformance.generator.hypothesis_strategies import finite_programs
from scenic_ref.data.scene import Scene
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.semantics.syntax import Program

from .cases import quick
from .specifier_permutations import has_order, permuted
from .test_scenes import scene_or_none


def law(program: Program) -> dict[object, Fraction] | None:
    try:
        return loads(program.text).enumerate(max_runs=64).law(content)
    except AttemptsExhausted:
        return None


def content(scene: Scene | None) -> str:
    """A scene with its properties in alphabetical order: the order of evaluation is not part of it."""
    shown = {} if scene is None else {k: v for k, v in scene.to_json().items() if k not in ("scene", "weight")}
    return json.dumps(shown, sort_keys=True)


@pytest.mark.slow
@quick(40)
@given(finite_programs(ProgramSettings(max_outcomes=32)), st.integers(0, 1000))
def test_another_order_of_specifiers_gives_the_same_law(program: Program, seed: int):
    assume(not has_order(program))
    other = permuted(program, SeededChoices(seed, 0))
    assume(other.statements != program.statements)
    assert law(other) == law(program)


@pytest.mark.slow
def test_another_order_of_specifiers_that_draw_nothing_gives_the_same_scene():
    compared = 0
    for index, program in enumerate(random_programs(250, 2026, ProgramSettings(max_depth=1, classes=0.3))):
        other = permuted(program, SeededChoices(index, 0), drawless=True)
        if other.statements != program.statements:
            scene = scene_or_none(loads(program.text), index)
            assert content(scene_or_none(loads(other.text), index)) == content(scene), program.text
            compared += scene is not None
    assert compared >= 20
