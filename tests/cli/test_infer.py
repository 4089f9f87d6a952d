"""`scenic-ref run --backend importance|smc|mcmc`: scenes, reports, pictures, and what is refused."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

SOFT = "x = Range(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire[0.5] x < 0.1\nrequire x > 0.05\nparam x = x\n"
FIELDS = ["backend", "scenes", "attempts", "acceptance", "ess", "rhat", "seconds_cpu", "warnings"]


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["importance", "smc", "mcmc"])
def test_scenes_a_report_and_a_picture_are_written(ask, backend):
    Path("soft.scenic").write_text(SOFT)
    found = ask("run", "soft.scenic", "-n", 8, "--backend", backend, "-o", "s.jsonl", "--report", "r.json", "--plot", "p.png")
    assert found.code == 0, found.err
    scenes = [json.loads(line) for line in Path("s.jsonl").read_text().splitlines()]
    assert [scene["scene"] for scene in scenes] == list(range(8))
    assert all(0.05 < scene["params"]["x"] < 1 for scene in scenes)
    report = json.loads(Path("r.json").read_text())
    more = {"importance": ["notes"], "smc": ["levels"], "mcmc": ["levels", "moves"]}[backend]
    assert list(report) == [*FIELDS, *more]
    assert not report["warnings"]
    for level in report.get("levels", []):
        assert list(level) == ["violation", "kept", "taken"]
        assert 0 < level["kept"] <= 1
    assert all(0 <= part <= 1 for part in report.get("moves", {}).values())
    assert (report["backend"], report["scenes"]) == (backend, 8)
    assert report["acceptance"]["low"] < 0.5 < report["acceptance"]["high"]
    assert report["acceptance"]["level"] == 0.999
    assert set(report["ess"]) == {"bulk", "tail"}
    assert Path("p.png").read_bytes()[:4] == b"\x89PNG"
    assert f"8 scenes of seed 0 by {backend}" in found.err
    assert "P(a run is accepted) = 0." in found.err


def test_scenes_that_cannot_be_trusted_are_written_with_a_warning_and_exit_code_5(ask):
    """A soft requirement that hardly any run meets: so many runs are worth few."""
    Path("hardly.scenic").write_text("x = Range(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire[0.9999999] x < 0.0001\n")
    found = ask("run", "hardly.scenic", "-n", 3, "--backend", "importance")
    assert found.code == 5
    assert len(found.out.splitlines()) == 3
    assert "warning: not to be trusted: the draws are worth" in found.err


@pytest.mark.parametrize(("options", "says"), [
    (["--backend", "smc", "--workers", 2], "smc draws all scenes together"),
    (["--backend", "mcmc", "--prune"], "mcmc draws all scenes together"),
    (["--backend", "smc", "-n", 0], "smc draws all scenes together"),
    (["--report", "r.txt"], "r.txt"),
    (["--report", "-"], "not to standard output"),
    (["--backend", "enumerate", "--report", "-"], "not to standard output"),
    (["--backend", "mcmc", "--inference-data", "-"], "not to standard output"),
    (["--backend", "enumerate", "--report", "r.txt"], "r.txt"),
    (["--backend", "importance", "--inference-data", "d.json"], "--inference-data needs --backend smc or mcmc"),
    (["--inference-data", "d.json"], "--inference-data needs --backend smc or mcmc"),
    (["--backend", "smc", "--inference-data", "d.csv"], "d.csv"),
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


HALF = "x = Range(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire x > 0.5\nparam x = x\n"
COIN = "x = Uniform(0, 1)\nego = Object at 0 @ 0, with requireVisible False\nrequire x > 0\nparam x = x\n"


def report_of(ask, program, *options):
    Path("own.scenic").write_text(program)
    Path("r.json").unlink(missing_ok=True)
    found = ask("run", "own.scenic", "--report", "r.json", *options)
    assert found.code == 0, found.err
    report = json.loads(Path("r.json").read_text())
    assert list(report) == FIELDS
    return report


@pytest.mark.slow
@pytest.mark.parametrize(("options", "backend"), [
    (["-n", 400, "-o", "s.jsonl"], "batch"), (["-n", 400, "-o", "s.jsonl", "--workers", 2], "batch"), (["-n", 9, "-o", "s.jsonl"], "interpreter"),
])  # fmt: skip
def test_rejection_reports_how_often_runs_are_accepted(ask, options, backend):
    report = report_of(ask, HALF, *options)
    attempts = [json.loads(line)["attempts"] for line in Path("s.jsonl").read_text().splitlines()]
    assert (report["backend"], report["scenes"], report["attempts"]) == (backend, len(attempts), sum(attempts))
    share = report["acceptance"]
    assert share["estimate"] == len(attempts) / sum(attempts)
    assert 0 < share["low"] < 0.5 < share["high"] <= 1 and share["level"] == 0.999
    assert (report["ess"], report["rhat"], report["warnings"]) == ({"bulk": len(attempts), "tail": len(attempts)}, 1.0, [])
    assert report["seconds_cpu"] > 0


def test_what_attempts_do_not_tell_is_not_reported(ask):
    report = report_of(ask, SOFT, "-n", 20, "--reading", "soft=scene")
    assert (report["acceptance"]["estimate"], report["acceptance"]["low"], report["acceptance"]["high"]) == (None, 0.0, 1.0)
    assert "coins are thrown once for a scene" in report["warnings"][0]


def test_pruned_runs_count_as_those_of_the_program(ask):
    """Half of the points of the square lie where the box fits; pruning draws among them only."""
    program = "w = Workspace(RectangularRegion(0 @ 0, 0, 4, 4))\nworkspace = w\nego = Object in w, with width 1.2, with length 1.2, facing 0\n"
    reports = [report_of(ask, program, "-n", 3000, *extra)["acceptance"] for extra in ([], ["--prune"])]
    exact = (2.8 / 4) ** 2
    assert all(r["low"] < exact < r["high"] for r in reports)
    assert reports[1]["high"] - reports[1]["low"] < reports[0]["high"] - reports[0]["low"]


def test_an_enumeration_reports_exact_figures(ask):
    report = report_of(ask, COIN, "--backend", "enumerate")
    assert report["acceptance"] == {"estimate": 0.5, "low": 0.5, "high": 0.5, "level": 1.0}
    assert (report["scenes"], report["attempts"], report["rhat"], report["warnings"]) == (1, 2, None, [])
    about = report_of(ask, HALF, "--backend", "enumerate", "--discretize", 8)
    assert "an approximation" in about["warnings"][0]


def test_a_resumed_run_reports_what_it_drew_itself(ask):
    report_of(ask, HALF, "-n", 20, "-o", "s.jsonl")
    report = report_of(ask, HALF, "-n", 50, "-o", "s.jsonl", "--resume")
    assert report["scenes"] == 30
    assert report["warnings"] == ["20 scenes were there already, and are not counted"]


@pytest.mark.parametrize("backend", ["smc", "mcmc"])
def test_all_draws_are_written_for_arviz(ask, backend):
    Path("soft.scenic").write_text(SOFT)
    found = ask("run", "soft.scenic", "-n", 8, "--backend", backend, "-o", "s.jsonl", "--report", "r.json", "--inference-data", "d.json")
    assert found.code == 0, found.err
    data, report = json.loads(Path("d.json").read_text()), json.loads(Path("r.json").read_text())
    assert json.loads(data["posterior_attrs"]["report"]) | {"seconds_cpu": 0} == report | {"seconds_cpu": 0}
    assert list(data["posterior"]) == ["params.x"]  # the rest of the scene does not vary
    drawn = np.array(data["posterior"]["params.x"])
    assert drawn.shape[0] == (8 if backend == "smc" else 256)
    assert ((drawn > 0.05) & (drawn < 1)).all()
    scenes = [json.loads(line)["params"]["x"] for line in Path("s.jsonl").read_text().splitlines()]
    assert np.isin(scenes, drawn).all()


@pytest.mark.extra("arviz")
def test_arviz_reads_them_and_finds_the_same(ask):
    import arviz

    Path("soft.scenic").write_text(SOFT)
    for ending in ("json", "nc"):
        found = ask("run", "soft.scenic", "-n", 8, "--backend", "mcmc", "-o", "s.jsonl", "--report", "r.json", "--inference-data", f"d.{ending}")
        assert found.code == 0 and "Warning" not in found.err, found.err
        data = arviz.from_json("d.json") if ending == "json" else arviz.from_netcdf("d.nc")
        report = json.loads(Path("r.json").read_text())
        assert float(arviz.rhat(data)["params.x"]) == pytest.approx(report["rhat"], rel=1e-9)
        assert float(arviz.ess(data)["params.x"]) == pytest.approx(report["ess"]["bulk"], rel=0.02)


def test_without_arviz_netcdf_is_refused_before_the_work(ask, monkeypatch):
    Path("soft.scenic").write_text(SOFT)
    monkeypatch.setitem(sys.modules, "arviz", None)
    found = ask("run", "soft.scenic", "--backend", "smc", "-o", "s.jsonl", "--inference-data", "d.nc")
    assert found.code == 2 and "pip install 'scenic-ref[arviz]'" in found.err and ".json" in found.err
    assert not Path("s.jsonl").exists()


@pytest.mark.parametrize(("backend", "says"), [("mcmc", "draw (of one chain in each group)"), ("smc", "a line for each population")])
def test_a_picture_shows_ranks_and_of_chains_traces(ask, backend, says):
    Path("soft.scenic").write_text(SOFT)
    assert ask("run", "soft.scenic", "-n", 4, "--backend", backend, "-o", "s.jsonl", "--plot", "p.svg").code == 0
    text = Path("p.svg").read_text()
    assert says in text and "params.x, R-hat 1.0" in text  # matplotlib leaves the text of an SVG in a comment


def test_that_nothing_is_found_leaves_no_file(ask):
    Path("never.scenic").write_text("x = Normal(0, 1)\nego = Object at 0 @ 0\nrequire x > 60\n")
    found = ask("run", "never.scenic", "-n", 3, "--backend", "smc", "-o", "s.jsonl", "--report", "r.json")
    assert found.code == 3
    assert "as far as can be seen" in found.err
    assert not Path("r.json").exists()
    assert not Path("s.jsonl").exists() or Path("s.jsonl").read_text() == ""
