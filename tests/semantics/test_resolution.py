"""Algorithm 1, called directly: its order, its precedence, its four errors."""

from __future__ import annotations

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenic_ref import loads
from scenic_ref.semantics.scenes.resolution import Specification, resolve_specifiers
from scenic_ref.semantics.store.errors import (
    CyclicDependencies,
    MissingProperty,
    SpecifiedTwice,
    SpecifiedTwiceOptionally,
)
from scenic_ref.semantics.syntax.nodes import NOWHERE
from scenic_ref.semantics.syntax.python_expressions import Constant


def specifier(name, specifies, optional=(), dependencies=(), default=False):
    return Specification(Constant(value=name), name, tuple(specifies), tuple(optional), tuple(dependencies), is_default=default)


def defaults(**dependencies):
    return {name: specifier(f"default {name}", [name], dependencies=needs, default=True) for name, needs in dependencies.items()}


def resolve(specifiers, given_defaults):
    return resolve_specifiers(NOWHERE, specifiers, given_defaults)


def chosen(specifiers, given_defaults):
    return {name: s.name for s, names in resolve(specifiers, given_defaults) for name in names}


BESIDE = specifier("left of OP", ["position"], ["heading"], ["width"])


def test_non_optional_wins_over_optional_wins_over_default():
    base = defaults(position=(), heading=(), width=())
    assert chosen([], base) == {"position": "default position", "heading": "default heading", "width": "default width"}
    assert chosen([BESIDE], base)["heading"] == "left of OP"
    assert chosen([BESIDE, specifier("facing", ["heading"])], base)["heading"] == "facing"


def test_dependencies_come_first():
    order = [s.name for s, _ in resolve([BESIDE], defaults(position=(), heading=(), width=("model",), model=()))]
    assert order.index("default model") < order.index("default width") < order.index("left of OP")


def test_specified_twice():
    with pytest.raises(SpecifiedTwice, match="position is specified twice: by `at` and by `on`"):
        resolve([specifier("at", ["position"]), specifier("on", ["position"], ["heading"])], {})


AREA = "ego = new Object at (0, 0), with visibleDistance 10\nR = RectangularRegion((8, 0), 0, 8, 2)\n"


@pytest.mark.parametrize("specifiers", ["visible, in R", "in R, visible", "visible from ego, contained in R", "on R, visible from ego"])
def test_a_position_that_is_to_be_visible_is_refused_and_the_requirement_named(specifiers):
    with pytest.raises(SpecifiedTwice, match="position is specified twice") as found:
        loads(f"{AREA}x = new Object {specifiers}, with requireVisible False", dialect="scenic-3").sample()
    assert "leave `visible` out and write `require P can see x`" in found.value.hint
    scenes = loads(f"{AREA}x = new Object in R, with requireVisible False\nrequire ego can see x", dialect="scenic-3").sample_many(60)
    assert max(scene.attempts for scene in scenes) > 1


@pytest.mark.parametrize("specifiers", ["not visible, in R", "at (50, 0), not visible from ego"])
def test_a_position_that_is_to_be_hidden_is_refused_and_the_requirement_named(specifiers):
    text = f"workspace = Workspace(RectangularRegion((0, 0), 0, 200, 200))\n{AREA}x = new Object {specifiers}"
    with pytest.raises(SpecifiedTwice, match="position is specified twice") as found:
        loads(text, dialect="scenic-3").sample()
    assert "write `require not (P can see x)`" in found.value.hint


def test_two_specifiers_of_visible_points_are_no_requirement():
    with pytest.raises(SpecifiedTwice) as found:
        loads("ego = Object at (0, 0)\nx = Object visible, visible from ego").sample()
    assert not found.value.hint


def test_specified_optionally_twice_is_ambiguous_unless_specified_outright():
    two = [specifier("a", ["p"], ["heading"]), specifier("b", ["q"], ["heading"])]
    with pytest.raises(SpecifiedTwiceOptionally, match="by `a` and by `b`"):
        resolve(two, {})
    assert chosen([*two, specifier("facing", ["heading"])], {})["heading"] == "facing"


def test_missing_property():
    with pytest.raises(MissingProperty, match="needs the property width"):
        resolve([BESIDE], {})


def test_cycle_is_printed():
    with pytest.raises(CyclicDependencies) as caught:
        resolve(
            [specifier("left of V", ["position"], dependencies=["heading"]), specifier("facing F", ["heading"], dependencies=["position"])], {}
        )
    assert set(caught.value.cycle) == {"position", "heading"}
    assert caught.value.cycle[0] == caught.value.cycle[-1]
    assert str(caught.value.hint).endswith("position with `at`")
    with pytest.raises(CyclicDependencies) as caught:
        resolve([specifier("width", ["width"], dependencies=["length"]), specifier("length", ["length"], dependencies=["width"])], {})
    assert str(caught.value.hint).endswith(("`with width 2`", "`with length 2`")), "position is not in this circle"


@given(st.dictionaries(st.sampled_from("abcdef"), st.sets(st.sampled_from("abcdef"), max_size=3), min_size=1))
def test_an_order_exists_exactly_if_the_dependencies_are_closed_and_acyclic(graph):
    specifiers = [specifier(name, [name], dependencies=sorted(needs)) for name, needs in graph.items()]
    closed = all(needs <= set(graph) for needs in graph.values())
    acyclic = any(all(graph[n] <= set(order[:i]) for i, n in enumerate(order)) for order in permutations(graph))
    try:
        order = [s.name for s, _ in resolve(specifiers, {})]
    except MissingProperty:
        assert not closed
    except CyclicDependencies:
        assert closed
        assert not acyclic
    else:
        assert all(graph[name] <= set(order[:i]) for i, name in enumerate(order))
        assert sorted(order) == sorted(graph)


@given(st.permutations([BESIDE, specifier("facing", ["heading"]), specifier("with model", ["model"])]))
def test_the_order_in_the_source_does_not_change_who_determines_what(specifiers):
    base = defaults(position=(), heading=(), width=("model",), model=())
    assert chosen(specifiers, base) == chosen(sorted(specifiers, key=lambda s: s.name), base)
