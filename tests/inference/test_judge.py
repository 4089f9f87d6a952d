"""The judge of samples: features in columns, supports, joint laws, repeated values, features that the program suggests, bounded memory."""

from __future__ import annotations

import json
import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.inference.comparison import compare
from scenic_ref.inference.comparison.cells import Repeated
from scenic_ref.inference.comparison.feature_names import SampleNames, feature_matcher
from scenic_ref.inference.comparison.rounding import ROUNDINGS, Rounding
from scenic_ref.inference.comparison.sample_files import Samples
from scenic_ref.inference.comparison.scene_columns import Column, FeatureTable, features_table, stack_tables
from scenic_ref.testing import same_distribution

ROOT = Path(__file__).parents[2]
ODD = """
import math
x = Uniform(1, 2.5, 'a', None, True)
param p = {'a': x, 'b': [Range(0, 1), Uniform((1, 2), (3, 4))]}, q = Uniform({'k': 1}, {'k': 2, 'l': 'm'})
ego = Object with v x, with w (Range(0, 1), 'b'), with u Range(0, 1) > 0.5, with c Uniform(Object, 3), with n []
Object at (Range(3, 4), 5), facing Range(-9, 9), with f lambda: 3, with requireVisible False
"""
SECTOR = "ego = Object in SectorRegion((0, 0), 20, 0, 170 deg)\n"
REQUIRED = "ego = Object at (Range(0, 1), Range(0, 1))\nrequire ego.position.x + ego.position.y < {}\n"
COINS = "a = Uniform(0, 1)\nb = Uniform(0, 1)\nc = {}\nego = Object with a a, with b b, with c c\n"


def polygon_of_sector(pieces: int) -> str:
    turns = [math.radians(-85 + 170 * k / pieces) for k in range(pieces + 1)]
    points = ["(0, 0)", *(f"({20 * math.sin(a):.12f}, {20 * math.cos(a):.12f})" for a in turns)]
    return f"ego = Object in PolygonalRegion([{', '.join(points)}])\n"


# Columns


def programs() -> list[object]:
    files = sorted((ROOT / "examples").glob("gallery/*.scenic")) + sorted((ROOT / "examples").glob("paper/*.scenic"))
    return [pytest.param(f, id=f.stem) for f in files if f.stem not in ("mars_bottleneck", "bumper_to_bumper")] + [pytest.param(None, id="odd")]


@pytest.mark.parametrize("file", programs())
def test_features_in_columns_are_those_of_the_scenes(file: Path | None):
    scenario = scenic_ref.loads(ODD) if file is None else scenic_ref.load(file)
    assert scenario.batch is not None or file is not None
    one, other = features_table(scenario.sample_many(40, 3)), stack_tables(list(scenario.feature_tables(40, 3)))
    assert list(one.arrays) == list(other.arrays)
    for name, values in one.arrays.items():
        assert values.dtype == other.arrays[name].dtype
        np.testing.assert_array_equal(values, other.arrays[name], err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize("file", programs())
def test_supports_hold_in_scenes(file: Path | None):
    scenario = scenic_ref.loads(ODD) if file is None else scenic_ref.load(file)
    samples = Samples(scenario.sample_many(300, 8), facts=scenario.facts)
    assert not samples.found.lines
    assert same_distribution(list(scenario.sample_many(60, 9)), scenario).kind == "inconclusive"


def test_scenes_of_different_forms_are_one_table():
    one = [{"objects": [{"position": [1, 2], "properties": {"v": 3}}]}, {"objects": []}]
    other = [{"objects": [{"position": [1, 2], "properties": {"v": "a", "w": [1, None]}}], "params": {"t": 1}}]
    both = stack_tables([features_table(one), features_table(other)])
    np.testing.assert_array_equal(both.arrays["objects[0].properties.v"], [3.0, math.nan, math.nan])
    assert list(both.arrays["objects[0].properties.v where it is not a number"]) == ["(a number)", "(absent)", "a"]
    assert list(both.arrays["objects"]) == ["1", "0", "1"]
    whole = features_table([*one, *other])
    assert {n: list(map(str, v)) for n, v in whole.arrays.items()} == {n: list(map(str, v)) for n, v in both.arrays.items()}


@pytest.mark.slow
def test_samples_are_read_in_bounded_memory_in_a_random_order(tmp_path):
    """Three times as many scenes take hardly more memory than a part of them, whatever their order; all come back once."""
    path, peaks = tmp_path / "s.jsonl", []
    for n in (30_000, 90_000):
        line = '{{"objects": [{{"position": [{}, 0.5], "properties": {{"v": {}, "w": {}, "u": {}}}}}]}}\n'
        path.write_text("".join(line.format(k, k + 0.5, k / 3, k / 7) for k in range(n)))
        tracemalloc.start()
        samples = Samples(path, 4)
        seen = [table.arrays["objects[0].position[0]"] for table in samples.tables()]
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        order = np.concatenate(seen)
        assert sorted(order) == list(range(n))
        assert abs(np.corrcoef(order, np.arange(n))[0, 1]) < 6 / math.sqrt(n)
        assert all(len(part) < n / 10 for part in seen)
    columns = 5 * 8 * 60_000  # what the further scenes take as columns
    assert peaks[1] - peaks[0] < 64 * 2**20 + columns


# Laws


def test_a_finite_program_is_compared_by_its_joint_law_too():
    right, wrong = COINS.format("Uniform(0, 1)"), COINS.format("(a + b) % 2")
    samples = list(scenic_ref.loads(wrong).sample_many(2000, 3))
    verdict = same_distribution(samples, scenic_ref.loads(right), detect_tv=0.1)
    assert (verdict.kind, verdict.worst) == ("different", "all features together")
    assert same_distribution(list(scenic_ref.loads(right).sample_many(2000, 3)), scenic_ref.loads(right), detect_tv=0.15).kind == "equivalent"


def test_what_only_the_exact_law_knows_to_be_constant_is_looked_at_too():
    scenario = scenic_ref.loads("ego = Object at Discrete({1: 2, 2: 1}) @ 0")
    assert "objects[0].position[1]" not in scenario.facts.constants
    scenes = [scene.to_json() for scene in scenario.sample_many(20, 7)]
    assert same_distribution(scenes, scenario, alpha=1e-6, detect_tv=0.3, seed=1).kind == "inconclusive"
    scenes[11]["objects"][0]["position"][1] = 1.0
    verdict = same_distribution(scenes, scenario, alpha=1e-6, detect_tv=0.3, seed=1)
    assert verdict.impossible == ("objects[0].position[1] is always 0, but 1 in sample 12",)


@pytest.mark.parametrize("count", [2, 5, 7, 12, 19, 40])
def test_laws_of_few_values_are_cut_too(count: int):
    scenario = scenic_ref.loads(f"ego = Object at Uniform(*range({count})) @ Uniform(0, 1)\nObject at 50.25 @ 70, with requireVisible False")
    samples = [scene.to_json() for scene in scenario.sample_many(600, 3)]
    assert same_distribution(samples, scenario, detect_tv=0.5, alpha=1e-3).kind == "equivalent"


def test_joint_laws_ignore_what_is_not_compared():
    scenario = scenic_ref.loads(COINS.format("Uniform(0, 1)"))
    samples = list(scenic_ref.loads(COINS.format("(a + b) % 2")).sample_many(2000, 3))
    assert same_distribution(samples, scenario, detect_tv=0.15, ignore=["c"]).kind == "equivalent"


# Values that come again


def clamped(seed: int, n: int, share: float) -> FeatureTable:
    source = np.random.Generator(np.random.Philox(seed))
    return FeatureTable({"x": np.where(source.random(n) < share, 0.7310585786, source.random(n))}, n)


def test_an_atom_where_the_law_has_none_is_found():
    verdict = compare(clamped(1, 60_000, 0.002), clamped(2, 60_000, 0.0))
    assert (verdict.kind, verdict.worst) == ("different", "repeated values of x")
    assert compare(clamped(1, 60_000, 0.002), clamped(2, 60_000, 0.002), detect_tv=0.1).kind == "equivalent"


def test_bets_on_repeated_values_are_made_before_they_are_seen():
    cells, column = Repeated(), Column("x", np.array([1.0, 1.0, 1.0, 2.0, 2.0, 3.0]))
    assert cells.assign(column).tolist() == [0] * 6
    cells.learn(column)
    assert cells.assign(Column("x", np.array([1.0, 1 + 1e-12, 2.0, 3.0]))).tolist() == [1, 1, 0, 0]


# Features that the program suggests


def test_margins_and_depths_are_what_they_say():
    scenario = scenic_ref.loads(
        "workspace = Workspace(RectangularRegion((0, 0), 0, 40, 20))\nego = Object in CircularRegion((1, 0), 5)\n"
        "Object at (Range(-9, -8), 4), with speed Range(0, 1)\nrequire (distance to (9, 9)) <= 15\n"
    )
    scenes = list(scenic_ref.loads("ego = Object at (2, 3)\nObject at (-8.5, 4), with speed 0.25\n").sample_many(1))
    found = {name: float(values[0]) for name, values in scenario.facts.derived(features_table(scenes)).items()}
    assert found["boundaryDistance(0, its region)"] == pytest.approx(5 - math.hypot(1, 3))
    assert found["boundaryDistance(0, workspace)"] == pytest.approx(6.5)
    assert found["viewMargin(1)"] == pytest.approx(50 - math.hypot(10.0, 0.5))
    assert any("the requirement on line 4" in name and value == pytest.approx(15 - math.hypot(7, 6)) for name, value in found.items())


def test_depths_in_regions_have_the_sign_of_containment():
    """The boundary of each region, by points on both sides: the sign is that of `contains_point`, and no point is nearer to a boundary."""
    from scenic_ref.inference.batch.suggested_features import inside_by
    from scenic_ref.semantics.space.regions import CircularRegion, PolygonalRegion, RectangularRegion, SectorRegion
    from scenic_ref.semantics.space.vectors import Vector

    regions = [
        CircularRegion(Vector(1, 2), 3), SectorRegion(Vector(0, 1), 4, 0.3, 1.1), SectorRegion(Vector(0, 1), 4, 0.3, 4.0),
        RectangularRegion(Vector(1, 1), 0.4, 3, 5), PolygonalRegion([(-3, -2), (4, -2), (0, 0), (3, 4)]),
    ]
    x, y = (np.random.default_rng(k).uniform(-6, 6, 1500) for k in (1, 2))
    for region in [*regions, regions[0].intersect(regions[4]), regions[0].union(regions[3]) if hasattr(regions[0], "union") else regions[0]]:
        depth = inside_by(region, x, y, lambda node: np.zeros(0))
        inside = np.array([region.contains_point(Vector(a, b)) for a, b in zip(x, y, strict=True)])
        assert ((depth >= 0) == inside).all()
        for k in np.flatnonzero(depth > 0)[:60]:
            turns = np.linspace(0, math.tau, 24)
            ring = zip(x[k] + 0.999 * depth[k] * np.cos(turns), y[k] + 0.999 * depth[k] * np.sin(turns), strict=True)
            assert all(region.contains_point(Vector(a, b)) for a, b in ring)


@pytest.mark.parametrize(
    ("right", "wrong", "n", "worst"),
    [
        (SECTOR, polygon_of_sector(10), 20_000, "boundaryDistance(0, its region, from its arc)"),
        (REQUIRED.format(1.5), REQUIRED.format(1.48), 30_000, "margin(1, the requirement on line 2)"),
    ],
    ids=["sector as its polygon", "requirement"],
)
def test_a_deviation_near_a_limit_is_found_by_what_the_program_suggests(right, wrong, n, worst):
    """The samples without these features are not told apart; those of the program itself are not different."""
    scenario, rival = scenic_ref.loads(right), scenic_ref.loads(wrong)
    tables = stack_tables(list(rival.feature_tables(n, 3)))
    verdict = compare(tables, stack_tables(list(scenario.feature_tables(n, 4))), facts=scenario.facts)
    assert verdict.kind == "different"
    assert worst in [f.name for f in verdict.features[:2]]
    assert compare(tables, stack_tables(list(scenario.feature_tables(n, 4)))).kind == "inconclusive"
    fresh = stack_tables(list(scenario.feature_tables(n, 5)))
    assert compare(fresh, stack_tables(list(scenario.feature_tables(n, 4))), facts=scenario.facts).kind == "inconclusive"


# False alarms


@pytest.mark.slow
def test_false_alarms_with_all_features_are_as_rare_as_stated():
    """60 comparisons of rounded samples at 1 in 20: more than 13 alarms have probability below 1e-5, if each has probability 1/20."""
    scenario, alarms = scenic_ref.loads(SECTOR + "Object at (Range(30, 31), 40), with v Uniform(1, 1/3), with requireVisible False\n"), 0
    for k in range(60):
        lines = [scene.to_line() for scene in scenario.sample_many(400, 100 + k)]
        rows = [json.loads(line, parse_float=(float, lambda t: round(float(t), 6), lambda t: float(f"{float(t):.6g}"))[k % 3]) for line in lines]
        alarms += same_distribution(rows, scenario, alpha=0.05, seed=900 + k).kind == "different"
    assert alarms <= 13


# Names and digits


@pytest.mark.parametrize(
    ("feature", "yes", "no"),
    [
        ("class", "objects[3].class", "objects[3].properties.classes"), ("1.speed", "objects[1].properties.speed", "objects[11].properties.speed"),
        ("objects[1]", "objects[1].position[0]", "objects[10].width"), ("speed", "objects[2].properties.speed[1]", "objects[2].properties.speeds"),
        ("time", "params.time", "params.times"), ("objects[*].width", "objects[4].width", "objects[4].length"),
        ("0.x", "objects[0].position[0]", "objects[0].position[1]"),
        ("position", "objects[0].position[1]", "objects[0].heading"), ("attempts", "attempts", "objects"),
    ],
)  # fmt: skip
def test_features_are_named_in_short_or_in_full(feature, yes, no):
    assert feature_matcher(feature)(yes)
    assert not feature_matcher(feature)(no)


def test_a_mapped_name_keeps_what_is_below_it():
    names = SampleNames((), {"vel": "velocity", "1.w": "1.width"})
    assert names.feature("objects[0].properties.vel[1]") == "objects[0].properties.velocity[1]"
    assert names.feature("objects[1].properties.w") == "objects[1].width"
    assert names.feature("objects[1].properties.velo") == "objects[1].properties.velo"


@pytest.mark.parametrize("rounding", ROUNDINGS, ids=str)
def test_roundings_change_no_more_than_they_say_and_keep_what_they_made(rounding: Rounding):
    values = np.random.default_rng(3).uniform(-1000, 1000, 2000) * 10.0 ** np.random.default_rng(4).integers(-9, 2, 2000)
    changed = rounding(values)
    assert (np.abs(changed - values) <= rounding.error * np.maximum(1, np.abs(values)) * (1 + 1e-9)).all()
    assert rounding.keeps(changed)
    written = [float(f"{v:.{rounding.digits}g}") if rounding.kind == "significant" else round(v, rounding.digits) for v in values.tolist()]
    assert rounding.kind == "float32" or rounding.keeps(np.array(written))


def test_what_noise_changes_is_not_constant_where_the_scale_is_drawn():
    scenario = scenic_ref.loads("ego = Object\nObject at (0, 5), with mutationScale Uniform(0, 1), with color (0.1, 0.2, 0.3)\n")
    constants = scenario.facts.constants
    assert not [name for name in constants if name.startswith(("objects[1].position", "objects[1].heading", "objects[1].properties.color"))]
    assert constants["objects[1].width"] == 1.0 and constants["objects[0].heading"] == 0.0
    assert len({scene.objects[1].heading for scene in scenario.sample_many(8)}) > 1
