"""`scenic_ref.testing`: what samples and references it takes, and how its message says to repeat a comparison."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import UsageError
from scenic_ref.testing import assert_same_distribution, same_distribution

PROGRAM = "ego = Object at (Range(0, 1), 0)\n"


@pytest.fixture
def scenario():
    return scenic_ref.loads(PROGRAM)


def test_scenes_may_come_from_an_iterator(scenario):
    assert same_distribution(scenario.sample_many(800, 3), scenario, detect_tv=0.4).kind == "equivalent"


def test_what_is_no_scene_is_refused(scenario):
    with pytest.raises(UsageError, match="sample 2 is a int"):
        same_distribution([scenario.sample(), 2], scenario)
    with pytest.raises(UsageError, match="compared with a scenario, not with a str"):
        same_distribution([scenario.sample()], "scene.scenic")


def test_the_reference_must_be_scenes_of_the_program_and_other_ones(scenario):
    samples = list(scenario.sample_many(300, 3))
    with pytest.raises(UsageError, match="both hold scene 0 of seed 3"):
        same_distribution(samples, scenario, reference=samples)
    wide = list(scenic_ref.loads(PROGRAM.replace("0)", "0), with width 2")).sample_many(300, 4))
    with pytest.raises(UsageError, match=r"the reference holds what the program cannot give: objects\[0\].width is always 1"):
        same_distribution(samples, scenario, reference=wide)


def test_files_are_replayed_by_a_command_that_can_be_pasted(tmp_path):
    program, samples = tmp_path / "a program.scenic", tmp_path / "samples.jsonl"
    program.write_text(PROGRAM)
    wrong = scenic_ref.loads("ego = Object at (Range(0, 0.5), 0)\n")
    samples.write_text("".join(scene.to_line() + "\n" for scene in wrong.sample_many(600, 2)))
    with pytest.raises(AssertionError) as raised:
        assert_same_distribution(samples, scenic_ref.load(program), detect_tv=0.3)
    assert f"replay: scenic-ref check '{program}' --samples {samples} --alpha 1e-09 --detect-tv 0.3 --seed 20190625" in str(raised.value)
    with pytest.raises(AssertionError, match="with the same samples and the same scenario"):
        assert_same_distribution(list(wrong.sample_many(600, 2)), scenic_ref.load(program), detect_tv=0.3)
