"""Default requirements whose conditions branched on what is drawn, so that runs were left to the interpreter: found by a campaign against ourselves.

Properties that turn one off are a part of its condition; so is the gap of a wide sector.
"""

from __future__ import annotations

from collections import Counter

import pytest
import scenic_ref
from scenic_ref.inference.batch.block_rejection import Batch
from scenic_ref.inference.batch.numpy_evaluator import leavers
from scenic_ref.semantics.machine.outcome import Requirement
from scenic_ref.semantics.scenes import default_requirements
from scenic_ref.semantics.space.symbol_seam import Symbol
from scenic_ref.testing import assert_same_distribution, same_distribution

PROGRAMS = {
    "visible or need not be": "ego = Object at 0 @ 0, with viewAngle 60 deg\nObject at Range(-9, 9) @ 5, with requireVisible Uniform(True, False)\n",
    "apart or need not be": "ego = Object at 0 @ 0\nObject at Range(-2, 2) @ 0.5, with allowCollisions Uniform(True, False)\n",
    "either of two": "ego = Object at 0 @ 0, with allowCollisions Discrete({True: 1, False: 3})\n"
    "Object at Range(-2, 2) @ 0.5, with allowCollisions Uniform(True, False)\n",
    "by a condition": "x = Range(0, 4)\nego = Object at 0 @ 0\nObject at x @ 0, with allowCollisions x < 0.5, with requireVisible x < 2\nmutate\n",
    "in a wide sector": "workspace = Workspace(SectorRegion(0 @ 0, 5, 0.3, 4.5))\nego = Object at Range(-5, 5) @ Range(-5, 5), facing Range(0, 2)\n",
    "ego, too": "ego = Object at Range(0, 3) @ 0, with requireVisible Uniform(True, False), with allowCollisions Uniform(True, False)\n"
    "Object at 1 @ 0, with allowCollisions Uniform(True, False)\nObject at 2 @ 0.5, with requireVisible Uniform(True, False)\n",
}  # fmt: skip


def lifted(text: str) -> Batch:
    found = scenic_ref.loads(text).batch
    assert found is not None
    return found


def told(name: str, backend: str) -> list[object]:
    return [scene.to_json() for scene in scenic_ref.loads(PROGRAMS[name]).sample_many(200, 3, backend=backend)]  # type: ignore[arg-type]


@pytest.mark.parametrize("name", PROGRAMS)
def test_no_run_is_left_and_the_scenes_are_the_interpreters(name: str) -> None:
    batch = lifted(PROGRAMS[name])
    assert not leavers(batch.graph, 512)
    assert told(name, "batch") == told(name, "interpreter")
    assert batch.block(3, 0, 200).left == 0


@pytest.mark.parametrize("name", [name for name, text in PROGRAMS.items() if text.count("Object at") == 2])
def test_what_rejects_is_told_as_the_interpreter_tells_it(name: str) -> None:
    scenario = scenic_ref.loads(PROGRAMS[name])
    counted = sum((scenario.sampled(3, index).stuck for index in range(200)), Counter[Requirement]())
    assert lifted(PROGRAMS[name]).block(3, 0, 200).stuck == counted and counted


PRUNED = """workspace = Workspace(RectangularRegion(0 @ 0, 0, 40, 40))
ego = Object at 0 @ 0, with viewDistance 6
Object in workspace, with requireVisible Discrete({True: 3, False: 1}), with allowCollisions Uniform(True, False)
"""


@pytest.mark.slow
def test_pruning_and_importance_keep_the_law() -> None:
    scenario = scenic_ref.loads(PRUNED)
    assert_same_distribution(scenario.pruned().sample_many(3000, 1), scenario, inconclusive="pass")
    assert_same_distribution(scenario.infer("importance", 3000, 1, resample=True).scenes, scenario, inconclusive="pass")
    assert_same_distribution(scenario.sample_many(500, 1, backend="interpreter"), scenario, inconclusive="pass")
    required = scenic_ref.loads(PRUNED.replace("Discrete({True: 3, False: 1})", "True"))
    assert same_distribution(scenario.pruned().sample_many(3000, 1), required).kind == "different"


@pytest.mark.slow
@pytest.mark.extra("fast")
@pytest.mark.parametrize("name", PROGRAMS)
def test_compiled_the_scenes_are_the_same(name: str) -> None:
    scenario = scenic_ref.loads(PROGRAMS[name])
    assert scenario.batch is not None and scenario.batch.compile()
    assert [scene.to_json() for scene in scenario.sample_many(200, 3, backend="batch")] == told(name, "interpreter")


@pytest.mark.parametrize("name", PROGRAMS)
def test_of_many_objects_the_runs_in_which_others_may_collide_are_left(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A premise about all of them has to know which they are."""
    monkeypatch.setattr(default_requirements, "MANY", 1)
    monkeypatch.setattr(default_requirements, "MANY", 1)
    assert told(name, "batch") == told(name, "interpreter")


@pytest.mark.parametrize("name, property", [("visible or need not be", "requireVisible"), ("apart or need not be", "allowCollisions")])
def test_a_requirement_that_cannot_be_turned_off_is_found_out(name: str, property: str, monkeypatch: pytest.MonkeyPatch) -> None:
    as_it_is = default_requirements.to_floats
    fixed = 1.0 if property == "requireVisible" else 0.0
    monkeypatch.setattr(default_requirements, "to_floats", lambda value: fixed if isinstance(value, Symbol) else as_it_is(value))
    assert told(name, "batch") != told(name, "interpreter")
