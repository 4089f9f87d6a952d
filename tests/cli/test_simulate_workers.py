"""`simulate --workers K` and `--cluster`: the same bytes as those of one process, and the same ends."""

from __future__ import annotations

import json
import os
import signal
import sys

import pytest

PROGRAM = """
workspace = Workspace(RectangularRegion((0, 0), 0, 60, 60))
behavior B():
    while True:
        x = Range(0, 1)
        print(simulation.currentTime, x)
        take x
        require x < 0.9
ego = Object at (Range(0, 1), 0), with behavior B
Object at (Range(5, 6), 0), with velocity (1, 0)
"""
ODD = "behavior B:\n    param x = 1\n    take 1\nego = Object with behavior B\n"
"""Its loop has no translation."""
FAILS = "behavior B():\n    take 1 / (Uniform(0, 1, 1, 1, 1, 1, 1, 1) + 0)\nego = Object at (0, 0), with behavior B"


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 7])
def test_output_page_animation_and_report_are_those_of_one_process(ask, tmp_path, count):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    told = []
    for workers in (1, 3):
        names = [f"{workers}.{ending}" for ending in ("jsonl", "html", "gif")]
        done = ask("simulate", "p.scenic", "-n", count, "--steps", 6, "--workers", workers, "-o", names[0], "--html", names[1], "--gif", names[2])
        assert done.code == 0, done.err
        told.append([line.replace(f"{workers}.gif", "gif") for line in done.err.splitlines() if " of seed " not in line])
        told[-1] += [line.rpartition(",")[0] for line in done.err.splitlines() if " of seed " in line]
    assert told[0] == told[1]
    assert "stuck attempt" in "".join(told[0])
    for ending in ("jsonl", "html", "gif"):
        assert (tmp_path / f"1.{ending}").read_bytes() == (tmp_path / f"3.{ending}").read_bytes()
    assert [json.loads(line)["run"] for line in (tmp_path / "3.jsonl").read_text().splitlines()] == list(range(count))


@pytest.mark.slow
@pytest.mark.extra("cluster")
def test_a_cluster_writes_what_this_process_writes(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    for name, more in (("one", ()), ("cluster", ("--cluster", "local", "--workers", 2))):
        assert ask("simulate", "p.scenic", "-n", 20, "--steps", 3, "-o", f"{name}.jsonl", *more).code == 0
    assert (tmp_path / "one.jsonl").read_bytes() == (tmp_path / "cluster.jsonl").read_bytes()


def test_a_cluster_that_cannot_be_had_is_wrong_usage(ask, tmp_path, monkeypatch):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    monkeypatch.setitem(sys.modules, "distributed", None)
    found = ask("simulate", "p.scenic", "--cluster", "local", "-o", "runs.jsonl")
    assert found.code == 2
    assert "scenic-ref[cluster]" in found.err


@pytest.mark.slow
def test_what_processes_leave_to_the_machine_is_told(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(ODD)
    told = [ask("simulate", "p.scenic", "-n", 4, "--workers", workers, "-o", "runs.jsonl").err for workers in (1, 2)]
    lines = [[line for line in text.splitlines() if "the machine ran" in line] for text in told]
    assert lines[0] == lines[1]
    assert lines[0]


@pytest.mark.slow
def test_an_error_comes_after_the_simulations_before_it(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(FAILS)
    found = []
    for workers in (1, 2):
        done = ask("simulate", "p.scenic", "-n", 60, "--steps", 1, "--workers", workers, "-o", "runs.jsonl")
        assert done.code == 1
        assert "ZeroDivisionError" in done.err
        found.append((tmp_path / "runs.jsonl").read_text())
    assert found[0] == found[1]
    assert found[0].count("\n") > 0


@pytest.mark.slow
def test_exhausted_attempts_are_told_as_by_one_process(ask, tmp_path):
    (tmp_path / "p.scenic").write_text("ego = Object at (Range(0, 1), 0)\nrequire always simulation.currentTime < 2\n")
    one, two = (ask("simulate", "p.scenic", "-n", 3, "--max-attempts", 5, "--workers", workers, "-o", "runs.jsonl") for workers in (1, 2))
    assert one.code == two.code == 3
    assert one.err == two.err
    assert "no simulation in 5 attempts" in one.err


@pytest.mark.parametrize(("option", "value"), [("--workers", 2), ("--cluster", "local")])
def test_one_process_replays(ask, tmp_path, option, value):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    done = ask("simulate", "p.scenic", "--replay", "runs.jsonl", option, value)
    assert done.code == 2
    assert f"{option} cannot be given with --replay" in done.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("option", "value", "told"),
    [("--workers", "2", os.kill), ("--workers", "2", os.killpg), pytest.param("--cluster", "local", os.killpg, marks=pytest.mark.extra("cluster"))],
)
def test_an_interrupt_leaves_whole_simulations_and_no_process(tmp_path, start, option, value, told):
    """A terminal tells all processes of Ctrl-C: a cluster's workers once filled the screen with tracebacks."""
    (tmp_path / "p.scenic").write_text(PROGRAM.replace("        print(simulation.currentTime, x)\n", ""))
    command = [sys.executable, "-m", "scenic_ref", "simulate", "p.scenic", "-n", "1000000", "--steps", "9", option, value, "-o", "runs.jsonl"]
    path = tmp_path / "runs.jsonl"
    with start(command) as process:
        process.until(lambda: path.exists() and path.read_bytes().count(b"\n") >= 3)
        told(process.pid, signal.SIGINT)
        out, err = process.communicate()
    assert (process.returncode, out) == (130, "")
    assert "written as whole lines" in err.splitlines()[-1]
    assert "Traceback" not in err
    data = path.read_bytes()
    assert data.endswith(b"\n")
    runs = [json.loads(line)["run"] for line in data.splitlines()]
    assert runs == list(range(len(runs)))
