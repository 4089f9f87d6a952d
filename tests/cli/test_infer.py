"""`scenic-ref run --backend importance|smc|mcmc`: scenes, reports, pictures, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

SOFT = "x = Range(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire[0.5] x < 0.1\nrequire x > 0.05\nparam x = x\n"
FIELDS = ["backend", "scenes", "attempts", "acceptance", "ess", "rhat", "seconds_cpu", "warnings"]


@pytest.mark.parametrize("backend", ["importance", "smc", "mcmc"])
def test_scenes_a_report_and_a_picture_are_written(ask, backend):
    Path("soft.scenic").write_text(SOFT)
    found = ask("run", "soft.scenic", "-n", 8, "--backend", backend, "-o", "s.jsonl", "--report", "r.json", "--plot", "p.png")
    assert found.code == 0, found.err
    scenes = [json.loads(line) for line in Path("s.jsonl").read_text().splitlines()]
    assert [scene["scene"] for scene in scenes] == list(range(8))
    assert all(0.05 < scene["params"]["x"] < 1 for scene in scenes)
    report = json.loads(Path("r.json").read_text())
    assert list(report) == FIELDS
    assert (report["backend"], report["scenes"]) == (backend, 8)
    assert report["acceptance"]["low"] < 0.5 < report["acceptance"]["high"]
    assert report["acceptance"]["level"] == 0.999
    assert set(report["ess"]) == {"bulk", "tail"}
    assert Path("p.png").read_bytes()[:4] == b"\x89PNG"
    assert f"8 scenes of seed 0 by {backend}" in found.err
    assert "P(a run is accepted) = 0." in found.err


def test_scenes_that_cannot_be_trusted_are_written_with_a_warning_and_exit_code_5(ask):
    """A soft requirement that hardly any run meets: 16,384 runs are worth few."""
    Path("hardly.scenic").write_text("x = Range(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire[0.9999999] x < 0.0001\n")
    found = ask("run", "hardly.scenic", "-n", 3, "--backend", "importance")
    assert found.code == 5
    assert len(found.out.splitlines()) == 3
    assert "warning: not to be trusted: the draws are worth" in found.err


@pytest.mark.parametrize(("options", "says"), [
    (["--backend", "smc", "--workers", 2], "smc draws all scenes together"),
    (["--backend", "mcmc", "--prune"], "mcmc draws all scenes together"),
    (["--backend", "smc", "-n", 0], "smc draws all scenes together"),
    (["--report", "r.json"], "--report needs --backend"),
    (["--backend", "smc", "--resample"], "--resample needs --backend importance"),
    (["--backend", "smc", "--report", "r.txt"], "r.txt"),
    (["--backend", "smc", "--reading", "soft=scene"], "soft=scene"),
    (["--backend", "hmc"], "there is no backend hmc"),
])  # fmt: skip
def test_what_makes_no_sense_is_refused_before_the_work(ask, options, says):
    Path("soft.scenic").write_text(SOFT)
    found = ask("run", "soft.scenic", *options)
    assert found.code == 2
    assert says in found.err
    assert not Path("r.json").exists()


def test_that_nothing_is_found_leaves_no_file(ask):
    Path("never.scenic").write_text("x = Normal(0, 1)\nego = Object at 0 @ 0\nrequire x > 60\n")
    found = ask("run", "never.scenic", "-n", 3, "--backend", "smc", "-o", "s.jsonl", "--report", "r.json")
    assert found.code == 3
    assert "as far as can be seen" in found.err
    assert not Path("r.json").exists()
    assert not Path("s.jsonl").exists() or Path("s.jsonl").read_text() == ""
