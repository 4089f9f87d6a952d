"""Factorised rejection: the same distribution as plain rejection, exactly; and the sampler that draws again only what collides is found out."""

from __future__ import annotations

import math

import pytest
import scenic_ref
from scenic_ref.api import Scenario
from scenic_ref.conformance.generator import ProgramSettings, random_programs
from scenic_ref.inference.batch import Batch, NotLifted, block_rejection
from scenic_ref.inference.batch.block_rejection import BlockDrawing
from scenic_ref.inference.batch.factorised_rejection import Component, components, obstacle, worthwhile
from scenic_ref.inference.batch.graph import Site
from scenic_ref.inference.batch.tracing import trace_program
from scenic_ref.inference.comparison.exact_laws import Categorical, evidence
from scenic_ref.inference.enumeration import content_of_scene
from scenic_ref.semantics.store.errors import AttemptsExhausted, ScenicError

LEVEL = 1e-9
"""The risk that a right sampler fails a test here."""

NEIGHBOURS = """
ego = Object at (Uniform(0, 1, 2, 3), 0), with requireVisible False
other = Object at (Uniform(0, 1, 2, 3, 4, 5), 0), with width 2.5, with requireVisible False
require ego.position.x <= 2
require other.position.x >= 1
"""
"""Two objects that may collide, each with a requirement of its own; where ego is decides how many places are left for the other."""

FOUR = """
workspace = Workspace(RectangularRegion((0, 0), 0, 10, 10))
ego = Object at (Range(-6, 6), Range(-6, 6)), with viewDistance 30, with viewAngle 360 deg
for i in range(3):
    Object at (Range(-6, 6), Range(-6, 6)), facing Range(0, 6)
x = Range(0, 1)
require x < 0.5
require[0.5] x < 0.1
"""


@pytest.fixture
def always(monkeypatch):
    """Components are drawn apart even where that does not pay."""
    monkeypatch.setattr(block_rejection, "worthwhile", lambda graph, whole, rejects: whole)


def factorised(scenario: Scenario) -> Batch:
    scenario.rehearse()
    return Batch(scenario.start, fuel=scenario.fuel, factorised=True)


def graph_of(text: str):
    scenario = scenic_ref.loads(text)
    scenario.rehearse()
    return trace_program(scenario.start, scenario.fuel)[0]


def against_the_law(batch: Batch, scenario: Scenario, count: int) -> float:
    """The evidence (log10 of an e-value) against the scenes of a batch having the enumerated distribution."""
    law = Categorical(scenario.enumerate().law(content_of_scene))
    return evidence([content_of_scene(scene) for scene in batch.scenes(count, 17)], law)


# The tree


def test_components_are_about_disjoint_draws_and_the_whole_about_the_rest():
    graph = graph_of("x = Range(0, 1)\ny = Range(0, 1)\nz = Range(0, 1)\nrequire x < 0.5\nrequire y < 0.5\nrequire x < y\nego = Object with v z")
    whole = components(graph)
    assert {part.own for part in whole.parts} == {frozenset({(0,)}), frozenset({(1,)})}
    assert whole.own == {(2,)}
    about = {graph.events[k].requirement.span.line for k in whole.events if graph.events[k].requirement}
    assert 6 in about
    assert about.isdisjoint({4, 5})


def test_what_others_are_relative_to_is_drawn_again_with_them():
    graph = graph_of("x = Range(0, 1)\ny = Range(x, 2)\nz = Range(x, 2)\nrequire x < 0.5\nrequire y < 1\nrequire z < 1\nego = Object")
    assert not components(graph).parts


def test_a_coin_belongs_to_the_condition_behind_it():
    graph = graph_of("x = Range(0, 1)\ny = Range(0, 1)\nrequire[0.5] x < 0.5\nrequire y < 0.5\nego = Object")
    assert sorted(len(part.own) for part in components(graph).parts) == [1, 2]


def test_nothing_is_factorised_where_runs_may_take_another_course():
    graph = graph_of("x = Range(0, 1)\ny = Range(0, 1)\nrequire x < 0.5\nrequire y < 0.5\nego = Object with width x - 0.1")
    assert obstacle(graph)
    assert not components(graph).parts


@pytest.mark.parametrize(("last", "parts"), [("", 2), ("require a - b > 5.95\n", 0)])
def test_parts_that_only_delay_a_cheap_requirement_are_given_up(last, parts):
    text = "workspace = Workspace(PolygonalRegion([(0, 0), (8, 0), (8, 4), (0, 4)]))\na = Range(1, 7)\nb = Range(1, 7)\n" + last
    text += "ego = Object at (a, Range(-4, 8)), with requireVisible False\nObject at (b, Range(-4, 8)), with requireVisible False\n"
    assert len(factorised(scenic_ref.loads(text)).stage.parts) == parts


def test_dissolving_parts_keeps_every_draw_and_event():
    graph = graph_of(FOUR)

    def events(c: Component) -> list[int]:
        return sorted([*c.events, *(k for part in c.parts for k in events(part))])

    whole = components(graph)
    for rate in (0.0, 0.5, 0.999):
        left = worthwhile(graph, whole, dict.fromkeys(range(len(graph.events)), rate))
        assert left.addresses == whole.addresses
        assert events(left) == events(whole) == list(range(len(graph.events)))
    assert whole.parts


# The distribution


def test_the_distribution_is_the_enumerated_one(always):
    scenario = scenic_ref.loads(NEIGHBOURS)
    batch = factorised(scenario)
    assert len(batch.stage.parts) == 2
    assert against_the_law(batch, scenario, 6000) < -math.log10(LEVEL)


def test_to_draw_again_only_the_object_that_collides_is_found_out(always, monkeypatch):
    """The mutant: the first part of a scene is drawn once, and only the other one again after a collision."""
    right = BlockDrawing.settled
    kept: dict[tuple[int, int], dict[int, object]] = {}

    def settled(self, stage, places):
        columns = right(self, stage, places)
        if stage.number == 1:
            for k, place in enumerate(places.tolist()):
                first = kept.setdefault((self.start, place), {name: column[k] for name, column in columns.items()})
                for name, column in columns.items():
                    column[k] = first[name]
        return columns

    monkeypatch.setattr(BlockDrawing, "settled", settled)
    scenario = scenic_ref.loads(NEIGHBOURS)
    assert against_the_law(factorised(scenario), scenario, 6000) > -math.log10(LEVEL)


@pytest.mark.slow
def test_finite_random_programs_have_the_enumerated_distribution(always):
    """Level: `LEVEL` for all programs together."""
    apart, count = 0, 150
    settings = ProgramSettings(requirements=1.0, soft=0.5).as_finite()
    for program in random_programs(count, 4321, settings):
        scenario = scenic_ref.loads(program.text)
        try:
            batch = factorised(scenario)
            if not batch.stage.parts:
                continue
            found = against_the_law(batch, scenario, 300)
        except (NotLifted, AttemptsExhausted):
            continue
        apart += 1
        assert found < -math.log10(LEVEL / count), program.text
    assert apart >= 10


# The same scenes, whoever draws them


@pytest.mark.slow
@pytest.mark.parametrize("text", [NEIGHBOURS, FOUR], ids=["neighbours", "four"])
def test_interpreter_columns_and_compiled_code_give_the_same_scenes(text, always):
    scenario = scenic_ref.loads(text).pruned()
    batch = scenario.batch
    assert batch is not None
    assert batch.stage.parts
    count = 12
    one_by_one = [scenario.sample(3, k).to_line() for k in range(count)]
    assert all('"pruned": true' in line for line in one_by_one)
    assert [scene.to_line() for scene in batch.scenes(count, 3)] == one_by_one
    assert [scene.to_line() for scene in batch.scenes(5, 3, start=6)] == one_by_one[6:11]
    columns = batch.block(3, 0, 900)
    if not batch.compile():
        assert batch.not_compiled == "numba is not installed"
        return
    compiled = batch.block(3, 0, 900)
    assert compiled.attempts_by_stage.tolist() == columns.attempts_by_stage.tolist()
    assert [scene.to_line() for scene in batch.scenes_of(compiled, 3)] == [scene.to_line() for scene in batch.scenes_of(columns, 3)]


def test_the_numbers_of_a_scene_are_those_of_the_attempts_at_its_parts(always):
    scenario = scenic_ref.loads(NEIGHBOURS).pruned()
    batch = scenario.batch
    assert batch is not None
    block = batch.block(3, 0, 50)
    assert (block.attempts_by_stage.max(axis=0) == block.attempts).all()
    assert any(len(set(attempts)) > 1 for attempts in block.attempts_by_stage.T.tolist())
    attempt = batch.attempts_of(block, 7)
    first, second = (next(iter(part.own)) for part in batch.stage.parts)
    assert [attempt(first), attempt(second)] == block.attempts_by_stage[1:, 7].tolist()


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.extra("fast"))])
def test_a_part_that_cannot_be_drawn_is_an_error(always, compiled):
    text = "x = Range(0, 1)\ny = Range(0, 1)\nz = Range(0, 1)\nrequire x < 0.3\nrequire y < 0.00001\nrequire z < 0.5\nego = Object with v x"
    scenario = scenic_ref.loads(text).pruned()
    batch = scenario.batch
    assert batch is not None
    if compiled:
        assert batch.compile(), batch.not_compiled
    with pytest.raises(AttemptsExhausted, match=r"no scene in 100 attempts.*line 5"):
        list(batch.scenes(5, 1, max_attempts=100))
    with pytest.raises(ScenicError, match=r"no scene in 100 attempts.*line 5"):
        scenario.sample(1, 0, max_attempts=100)


@pytest.mark.slow
@pytest.mark.extra("fast")
def test_ties_are_drawn_on_columns(always):
    """Boxes whose edges lie on the border: the compiled evaluator cannot tell, and the same scenes come out."""
    text = "workspace = Workspace(PolygonalRegion([(0, 0), (8, 0), (8, 4), (0, 4)]))\n" + "".join(
        f"{name} = Object at (Uniform(0.5, 1, 2, 3.5, {x}), Uniform(0.25, 0.5, 3.5)), with requireVisible False\n"
        for name, x in (("ego", 7.75), ("other", 7.5))
    )
    scenario = scenic_ref.loads(text)
    columns, compiled = factorised(scenario), factorised(scenario)
    assert columns.stage.parts
    assert compiled.compile(), compiled.not_compiled
    assert [s.to_line() for s in compiled.scenes(300, 2)] == [s.to_line() for s in columns.scenes(300, 2)]

# Found by reading


FIELD = """
cells = [(PolygonalRegion([(0, 0), (4, 0), (4, 4), (0, 4)]), 1.0)]
d = PolygonalVectorField("d", [(region.polygon, heading) for region, heading in cells])
px = Range(0, 8)
qx = Range(0, 8)
require[0.5] (d at px @ 1) > 0
require[0.5] not ((d at qx @ 1) > (d at px @ 1))
ego = Object at px @ 1, with other qx, with requireVisible False
"""
"""The value of a field is needed under a coin in a part, and under another one around it."""
SOME_NUMBERS = """
p = Point in PolygonalRegion([(2, 8), (0, 8), (2, 4), (2, 4), (8, 8)])
y = Range(0, 1)
require p.position.y < 5.2
require y < 0.3
require p.position.x + y > 3
ego = Object at p, with v y, with requireVisible False
"""
"""A requirement of a part needs some of the numbers of a draw only."""
SUM = "x = Range(0, 1)\ny = Range(0, 1)\nrequire x < 0.5\nrequire y < 0.5\nrequire x + y < 0.4\nego = Object with v (x, y)"


def lines(batch: Batch, count: int, seed: int, attempts: int) -> list[str]:
    """The lines of the scenes, one block for each, or the error."""
    found: list[str] = []
    for k in range(count):
        try:
            found += [scene.to_line() for scene in batch.scenes(1, seed, start=k, max_attempts=attempts)]
        except AttemptsExhausted:
            found.append("exhausted")
    return found


@pytest.mark.slow
@pytest.mark.parametrize("text", [FIELD, SOME_NUMBERS, SUM], ids=["field", "some numbers", "sum"])
@pytest.mark.parametrize("attempts", [3, 10_000])
def test_columns_compiled_code_and_interpreter_agree_to_the_last_attempt(text, attempts, always):
    scenario = scenic_ref.loads(text.replace("px @ 1", "(px, 1)").replace("qx @ 1", "(qx, 1)")).pruned()
    batch = scenario.batch
    assert batch is not None
    assert batch.stage.parts
    for stage in batch.stage.all:
        sites = [n.function for step in stage.steps for n in step.nodes if isinstance(n.function, Site) and not n.function.per_scene]
        assert all(site.address in stage.own for site in sites)
    columns = lines(batch, 150, 1, attempts)
    assert ("exhausted" in columns) == (attempts == 3)
    for k in range(25):
        if columns[k] != "exhausted":
            assert scenario.sample(1, k, max_attempts=attempts).to_line() == columns[k]
    if not batch.compile():
        assert batch.not_compiled == "numba is not installed"
        return
    assert lines(batch, 150, 1, attempts) == columns


@pytest.mark.slow
@pytest.mark.extra("fast")
def test_no_scene_is_lost_where_the_compiled_code_leaves_some(always):
    text = "workspace = Workspace(PolygonalRegion([(0, 0), (8, 0), (8, 4), (0, 4)]))\n" + "".join(
        f"{name} = Object at (Uniform(0.5, 1, 2, 3.5, 9, {x}), Uniform(0.25, 1.5, 2)), with requireVisible False\n"
        for name, x in (("ego", 7.75), ("other", 7.25))
    )
    scenario = scenic_ref.loads(text)
    columns, compiled = factorised(scenario), factorised(scenario)
    assert compiled.compile(), compiled.not_compiled
    for attempts in (1, 2, 4, 1000):
        for start in range(0, 120, 12):
            one, other = (b.block(5, start, start + 12, max_attempts=attempts) for b in (columns, compiled))
            assert one.attempts_by_stage.tolist() == other.attempts_by_stage.tolist()
            assert (one.error is None) == (other.error is None)
            if one.error is None:
                assert one.stuck == other.stuck


def test_many_requirements_that_always_reject_have_a_price():
    text = "x = Range(0, 1)\ny = Range(0, 1)\n" + "".join(f"require {v} < 0.0001 + {i} / 1e9\n" for v in "xy" for i in range(120))
    assert factorised(scenic_ref.loads(text + "ego = Object with v x")).stage.parts == ()
