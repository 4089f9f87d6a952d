"""A scenario without ego that runs those which make it (reading `compose-only`)."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import RunError
from scenic_ref.simulators.loop import Simulated

from .worlds import LIMIT, actions, simulated

SUB = "scenario Sub(x=3):\n    setup:\n        ego = Object at (x, 0)\n    compose:\n        wait\n        wait\n"


def test_ego_may_be_made_by_a_sub_scenario_at_any_time():
    assert actions(SUB + "scenario Main():\n    compose:\n        do Sub()\n") == [None, None, "terminated"]
    late = SUB + "scenario Main():\n    compose:\n        wait\n        do Sub()\n        require ego.position.x == 3\n"
    run = simulated(late)
    assert isinstance(run, Simulated)
    assert [len(moment.objects) for moment in run.moments] == [0, 1, 1, 1]
    assert run.scene.to_json()["ego"] is None


def test_ego_of_a_scenario_is_a_property_of_it():
    main = "scenario Main():\n    compose:\n        sub = Sub()\n        do sub until sub.ego.position.x {}\n"
    assert actions(SUB + main.format(">= 1")) == ["terminated"]
    assert actions(SUB + main.format(">= 4")) == [None, None, "terminated"]


def test_ego_is_an_error_where_it_is_needed_before():
    for use in ("require ego.position.x == 3", "x = ego.position", "x = distance to (1, 2)", "x = Sub().ego"):
        with pytest.raises(RunError):
            actions(SUB + f"scenario Main():\n    compose:\n        {use}\n        do Sub()\n")
    with pytest.raises(RunError, match=r"(ego is used before it is assigned|this is seen from ego)"):
        actions(SUB + "scenario Main():\n    setup: Object left of ego\n    compose: do Sub()\n")


def test_objects_made_before_ego_must_be_visible_when_it_is_made():
    main = "scenario Main():\n    setup: Object at ({}, 0)\n    compose:\n        wait\n        do Sub()\n"
    assert actions(SUB + main.format(10)) == [None, None, None, "terminated"]
    assert actions(SUB + main.format(99)) == ["rejected"]
    assert actions(SUB + main.format(99), 0) == [LIMIT]
    assert actions(SUB + main.format("3.5")) == ["rejected"]


def test_without_a_compose_block_ego_is_made_in_setup():
    for text in ("scenario Main():\n    setup: Object at (3, 0)\n", "Object at (3, 0)\n"):
        with pytest.raises(RunError, match="never assigns ego") as found:
            actions(text)
        assert "Main" not in found.value.hint


@pytest.mark.parametrize("count", [1, 20])
def test_a_scene_alone_has_an_ego(count):
    with pytest.raises(RunError, match="the scene has no ego"):
        list(scenic_ref.loads(SUB + "scenario Main():\n    compose: do Sub()\n").sample_many(count))
