"""`scenic-ref run --backend enumerate`: outcomes as JSON, as a chart, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

FINITE = "x = Uniform(1, 2, 3)\nrequire[0.5] x < 3\nego = Object at (x, 0)\nparam name = 'finite'\n"


@pytest.fixture
def finite(ask):
    Path("finite.scenic").write_text(FINITE)
    return ask


def test_a_pipe_gets_the_outcomes_as_json(finite):
    found = finite("run", "finite.scenic", "--backend", "enumerate")
    assert found.code == 0
    outcomes = json.loads(found.out)["outcomes"]
    # accepted: x < 3 always, x = 3 with tails only: 2/6 + 2/6 + 1/6
    assert [(o["probability"], o["scene"]["objects"][0]["position"][0]) for o in outcomes] == [("2/5", 1), ("2/5", 2), ("1/5", 3)]
    assert "3 outcomes of 6 runs; P(a run is accepted) = 5/6" in found.err
    assert "16.667% of the runs fail here: the requirement on line 2" in found.err


def test_a_file_gets_what_a_pipe_gets(finite):
    piped = finite("run", "finite.scenic", "--backend", "enumerate")
    assert finite("run", "finite.scenic", "--backend", "enumerate", "-o", "all.json").code == 0
    assert Path("all.json").read_text() == piped.out


def test_the_probabilities_can_be_drawn(finite):
    assert finite("run", "finite.scenic", "--backend", "enumerate", "--plot", "bars.png", "-o", "all.json").code == 0
    assert Path("bars.png").read_bytes().startswith(b"\x89PNG")


def test_a_continuous_draw_is_refused_at_its_place(finite):
    found = finite("run", "random.scenic", "--backend", "enumerate")
    assert found.code == 2
    assert "random.scenic:1:5" in found.err
    assert "--discretize N" in found.err


def test_a_discretized_enumeration_says_that_it_is_an_approximation(finite):
    found = finite("run", "random.scenic", "--backend", "enumerate", "--discretize", 3)
    assert found.code == 0
    assert "an approximation: each continuous draw was replaced by 3 equally likely values" in found.err
    assert json.loads(found.out)["exact"] is False


def test_too_many_runs_end_with_exit_code_3_and_write_nothing(finite):
    found = finite("run", "finite.scenic", "--backend", "enumerate", "--max-runs", 3, "-o", "all.json")
    assert found.code == 3
    assert "more than 3 runs: those made cover 0.5 of the probability" in found.err
    assert not Path("all.json").exists()


@pytest.mark.parametrize(
    "options", [("-n", 3), ("--scene", 1), ("--workers", 2), ("--resume",), ("-o", "all.jsonl"), ("-o", "nowhere/all.json"), ("--plot", "bars.txt")]
)
def test_what_does_not_belong_to_an_enumeration_is_refused(finite, options):
    assert finite("run", "finite.scenic", "--backend", "enumerate", *options).code == 2


def test_discretize_belongs_to_an_enumeration(finite):
    assert finite("run", "random.scenic", "--discretize", 3).code == 2
