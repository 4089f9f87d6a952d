"""Margins say whether a requirement is met, their gradients are what differences say, and a search that follows them finds scenes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import scenic_ref
from scenic_ref.inference.moves.states import States
from scenic_ref.semantics.store.errors import UsageError

if TYPE_CHECKING:
    from scenic_ref.inference.batch.torch_margins import Margins

pytestmark = pytest.mark.extra("torch")
GALLERY = Path(__file__).parent.parent.parent / "examples" / "gallery"
YARD = """
yard = PolygonalRegion([0@0, 14@0, 14@6, 6@6, 6@10, 0@10])
workspace = Workspace(yard)
def lorry():
    return Object at Range(0, 14) @ Range(0, 10), facing Range(-10, 10) deg, with width 2, with length 4.5, with requireVisible False
ego = lorry()
for i in range({others}):
    lorry()
"""
NUMBERS = """
x = Range(0, 10)
ego = Object at x @ 0, facing Normal(0, 1)
require[0.7] x < 2 or x > 9
require (distance from ego to 3 @ 4) < Normal(7, 1)
require abs(relative heading of (Range(-90, 90) deg)) < 20 deg
require not (x > 5 and x < 6)
Object at TruncatedNormal(3, 1, 0, 9) @ 4, with requireVisible True
"""
POINTS = """
yard = PolygonalRegion([0@0, 14@0, 14@6, 6@6, 6@10, 0@10])
ego = Object at 100 @ 100
p = Point at Range(-5, 20) @ Range(-5, 15)
require p in yard
"""
CHOICE = "x = Uniform(1, 2, 3)\nego = Object at x @ 0\nrequire x > 1.5\n"
STEP = 1e-6


def margins_of(text: str) -> Margins:
    return scenic_ref.loads(text).margins(seed=3)


def moved(states: States, number: int, by: float) -> States:
    uniforms = states.uniforms.copy()
    uniforms[number] += by
    return States(uniforms, states.words)


def compare(margins: Margins, count: int) -> tuple[int, int]:
    """How many derivatives are those of central differences, of how many that are looked at: away from kinks, where both sides have one slope."""
    states = margins.target.simulate(count, np.random.default_rng(1))
    found = margins.at(states)
    gradient = found.by_uniforms().numpy()
    right = looked = 0
    for number in range(len(states.uniforms)):
        above, below = (margins.at(moved(states, number, by)) for by in (STEP, -STEP))
        here, high, low = (m.values.detach().numpy() for m in (found, above, below))
        with np.errstate(invalid="ignore"):
            central, forward, backward = (high - low) / (2 * STEP), (high - here) / STEP, (here - low) / STEP
            smooth = np.abs(forward - backward) <= 1e-3 * (1 + np.abs(central))
        there = np.logical_and.reduce([m.described.numpy() for m in (found, above, below)])
        inner = (states.uniforms[number] > STEP) & (states.uniforms[number] < 1 - STEP)
        use = smooth & there & inner & np.isfinite(central)
        right += int((np.abs(gradient[:, number] - central)[use] <= 1e-5 * (1 + np.abs(central[use]))).sum())
        looked += int(use.sum())
    assert (gradient != 0).any()
    return right, looked


PROGRAMS = [YARD.format(others=2), NUMBERS, POINTS]


@pytest.mark.parametrize("text", PROGRAMS)
def test_margins_are_not_negative_exactly_where_the_columns_accept(text: str) -> None:
    margins = margins_of(text)
    states = margins.target.simulate(2_000, np.random.default_rng(2))
    found = margins.at(states)
    accepted = margins.target.assess(states).violation == 0
    assert ((found.values >= 0).all(0) & found.described).tolist() == accepted.tolist()
    assert found.values.shape == (len(margins.requirements), 2_000)


@pytest.mark.parametrize("text", PROGRAMS)
def test_violations_are_those_of_the_columns(text: str) -> None:
    """Where a corner of the yard is in a lorry, and no corner of this outside, they are larger: columns know no measure of that."""
    margins = margins_of(text)
    states = margins.target.simulate(500, np.random.default_rng(2))
    violation = margins.at(states).descent()[0].numpy()
    expected = margins.target.assess(states, np.inf).violation
    assert (violation >= expected - 1e-9).all()
    assert (violation <= expected + 1e-9).mean() >= (0.9 if "lorry" in text else 1.0)


@pytest.mark.parametrize("text", PROGRAMS)
def test_gradients_are_those_of_differences(text: str) -> None:
    right, looked = compare(margins_of(text), 40)
    assert right == looked >= 80


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two_cars", "mars_bottleneck"])
def test_gradients_of_the_gallery_are_those_of_differences(name: str) -> None:
    right, looked = compare(scenic_ref.load(GALLERY / f"{name}.scenic").margins(), 6)
    assert right == looked > 300


def test_wrong_margins_are_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rival of the tests above: the margin of `or` is that of its worst part."""
    import torch
    from scenic_ref.inference.batch import torch_margins as module

    margins = margins_of(NUMBERS)
    states = margins.target.simulate(2_000, np.random.default_rng(2))
    accepted = margins.target.assess(states).violation == 0
    monkeypatch.setattr(module.torch, "maximum", torch.minimum)
    found = margins.at(states)
    assert ((found.values >= 0).all(0) & found.described).tolist() != accepted.tolist()


def test_derivatives_by_pose() -> None:
    """Of a distance, the direction from the other point; of a box beside a wall, -1 across, and what a corner moves by as it turns."""
    import torch

    text = "ego = Object at Range(1, 2) @ Range(1, 2), with requireVisible False\nrequire (distance from ego to 5 @ 4) < 4\n"
    margins = margins_of(text)
    found = margins.at(margins.target.simulate(50, np.random.default_rng(2)))
    x, y, heading = found.poses[0]
    assert x is not None and y is not None and heading is None
    by = found.by_pose(0)[0]
    dx, dy = 5 - x.detach(), 4 - y.detach()
    assert by[0].numpy() == pytest.approx((dx / torch.hypot(dx, dy)).numpy())
    assert by[1].numpy() == pytest.approx((dy / torch.hypot(dx, dy)).numpy())
    assert not by[2].any()
    wall = "workspace = Workspace(RectangularRegion(0 @ 0, 0, 20, 200))\nego = Object at Range(9.4, 9.6) @ 0, facing Range(0.1, 0.4)"
    margins = margins_of(f"{wall}, with width 2, with length 4\n")
    found = margins.at(margins.target.simulate(50, np.random.default_rng(2)))
    x, _, heading = found.poses[0]
    assert x is not None and heading is not None
    by, h = found.by_pose(0)[0].numpy(), heading.detach().numpy()
    assert by[0] == pytest.approx(-1.0)
    assert by[2] == pytest.approx(np.sin(h) - 2 * np.cos(h))
    assert found.values[0].detach().numpy() == pytest.approx(10 - x.detach().numpy() - np.cos(h) - 2 * np.sin(h), abs=1e-7)


def test_what_has_no_gradient() -> None:
    """A choice among values has a margin that no number moves; a soft requirement is as far off as its coin is from tails, if that is nearer."""
    margins = margins_of(CHOICE)
    found = margins.at(margins.target.simulate(100, np.random.default_rng(2)))
    assert set(found.values[0].tolist()) == {-1.0, 1.0}
    assert not found.by_uniforms().any()
    margins = margins_of("x = Range(0, 1)\nego = Object at x @ 0\nrequire[0.5] x < 0.1\n")
    found = margins.at(margins.target.simulate(1_000, np.random.default_rng(2)))
    x, coin = found.uniforms.detach().numpy()
    assert found.values[0].detach().numpy() == pytest.approx(np.maximum(0.1 - x, coin - 0.5))
    by_x, by_coin = found.by_uniforms()[0].numpy()
    nearer = coin - 0.5 > 0.1 - x
    assert 100 < nearer.sum() < 900
    assert (by_x == np.where(nearer, 0.0, -1.0)).all() and (by_coin == nearer).all()
    margins = margins_of("import math\nx = Range(0, 1)\nego = Object at math.exp(x) @ 0\nrequire ego.position.x < 2\n")
    found = margins.at(margins.target.simulate(100, np.random.default_rng(2)))
    assert margins.reasons == ("exp",)
    assert not found.by_uniforms().any()
    assert set(found.by_pose(0)[0, 0].tolist()) == {-1.0}
    margins = margins_of("import math\nx = Range(0, 1)\nego = Object at math.exp(x) @ 0, with requireVisible False\nrequire x < 0.5\n")
    found = margins.at(margins.target.simulate(10, np.random.default_rng(2)))
    assert not found.by_pose(0).any()
    assert set(found.by_uniforms()[0, 0].tolist()) == {-1.0}


def test_runs_that_the_graph_does_not_describe_are_told() -> None:
    cells = "field = PolygonalVectorField('field', [(PolygonalRegion([0@0, 5@0, 5@5, 0@5]), 0.3)])\n"
    margins = margins_of(cells + "ego = Object at Range(0, 10) @ 2, facing field\nrequire ego.position.x > 1\n")
    states = margins.target.simulate(400, np.random.default_rng(2))
    assert margins.at(states).described.tolist() == (states.uniforms[0] <= 0.5).tolist()


def test_margins_of_nothing_and_of_no_states() -> None:
    margins = margins_of("ego = Object at Range(0, 1) @ 0, with requireVisible False\n")
    found = margins.at(margins.target.simulate(4, np.random.default_rng(2)))
    assert not margins.requirements
    assert found.by_uniforms().shape == (0, 1, 4) and found.by_pose(0).shape == (0, 3, 4)
    assert found.descent()[0].tolist() == [0.0] * 4
    margins = margins_of(NUMBERS)
    found = margins.at(margins.target.simulate(0, np.random.default_rng(2)))
    assert found.by_uniforms().shape == (len(margins.requirements), len(margins.target.space.sites), 0)


def test_what_has_no_margins_is_told() -> None:
    with pytest.raises(UsageError, match="there are no margins of this program: <string>:2:1: the text of a random value"):
        scenic_ref.loads("x = Range(0, 1)\nprint(x)\nego = Object at x @ 0\n").margins()
    with pytest.raises(UsageError, match="soft=scene"):
        scenic_ref.loads("x = Range(0, 1)\nego = Object at x @ 0\nrequire[0.5] x > 1\n", readings={"soft": "scene"}).margins()


def descended(margins: Margins, states: States, steps: int) -> States:
    """The states after steps against the gradient of their violation, each a little shorter."""
    for step in range(steps):
        _, direction = margins.at(states).descent()
        longest = direction.abs().amax(0).clamp(min=1e-12)
        by = 0.05 * math.pow(0.97, step) * (direction / longest).numpy()
        states = States(np.clip(states.uniforms + by, 0.0, 1 - 2**-53), states.words)
    return states


@pytest.mark.slow
def test_a_search_along_gradients_finds_scenes_where_few_runs_are_accepted() -> None:
    """Four lorries in a yard: some 4 runs of 100,000 are accepted."""
    margins = margins_of(YARD.format(others=3))
    random = np.random.default_rng(5)
    assert (margins.target.assess(margins.target.simulate(50_000, random)).violation == 0).sum() <= 15
    states = descended(margins, margins.target.simulate(60, random), 40)
    accepted = states.at(margins.target.assess(states).violation == 0)
    assert len(accepted) >= 30
    scenes = list(margins.target.scenes(accepted, seed=3))
    assert all(0 <= o.position.x <= 14 for scene in scenes for o in scene.objects)
