"""`scenic-ref simulate`."""

from __future__ import annotations

import json
import re

PROGRAM = """
behavior B():
    x = Range(0, 1)
    take x
    require x < 0.5
    take 2
ego = Object at (0, 0), with behavior B
terminate when simulation.currentTime == 3
scenario Other():
    setup:
        Object at (5, 0)
"""


def test_simulations_are_lines_of_json_and_the_report_says_what_rejected(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    done = ask("simulate", "p.scenic", "-n", "5", "-o", "runs.jsonl")
    assert done.code == 0
    runs = [json.loads(line) for line in (tmp_path / "runs.jsonl").read_text().splitlines()]
    assert [run["run"] for run in runs] == [0, 1, 2, 3, 4]
    assert all(run["result"] == "terminated" and run["steps"][1]["actions"] == {"0": [2]} for run in runs)
    assert "5 simulations of seed 0 in" in done.err
    assert "the requirement on line 5 (in time step 1)" in done.err
    alone = ask("simulate", "p.scenic", "--run", "3")
    assert json.loads(alone.out) == runs[3]


def test_the_page_holds_the_simulations_and_needs_nothing_else(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM + "param p = '</script>'\n")
    assert ask("simulate", "p.scenic", "-n", "3", "-o", "runs.jsonl", "--html", "page.html").code == 0
    page = (tmp_path / "page.html").read_text()
    assert page.count("</script>") == 1
    assert "http" not in page.replace("http-equiv", "")
    data = json.loads(page.split("const data = ", 1)[1].split(";\nconst at", 1)[0])
    assert [run["run"] for run in data["runs"]] == [0, 1, 2]
    assert data["runs"][0]["steps"][0]["doing"] == {"0": "B(), line 4"}
    assert data["runs"][0]["steps"][-1]["events"] == ["a termination condition is true (line 8)"]


def test_the_scenario_can_be_named(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    counts = [len(json.loads(ask("simulate", "p.scenic", *more).out)["scene"]["objects"]) for more in ((), ("--scenario", "Other"))]
    assert counts == [1, 2]
    assert ask("simulate", "p.scenic", "--scenario", "Nobody").code == 2
    drawn = [len(json.loads(ask("run", "p.scenic", "-o", "-", *more).out)["objects"]) for more in ((), ("--scenario", "Other"))]
    assert drawn == [1, 2]
    assert [ask("check", "p.scenic", "--scenario", name).code for name in ("Other", "Nobody")] == [0, 2]


def test_wrong_usage(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    for arguments, message in (
        (("--simulator", "carla"), "the simulators are still, kinematic, pymunk"),
        (("--simulator", "kinematic", "--dt", "0"), "positive number of seconds"),
        (("--run", "1", "-n", "2"), "--run asks for a single simulation"),
        (("-o", "runs.parquet"), "simulations are written as .jsonl"),
        (("-o", "nowhere/runs.jsonl"), "there is no directory"),
        (("-o", "p.scenic"), "the program itself"),
    ):
        done = ask("simulate", "p.scenic", *arguments)
        assert done.code == 2
        assert message in done.err


def test_an_error_in_the_middle_leaves_whole_lines(ask, tmp_path):
    (tmp_path / "p.scenic").write_text("behavior B():\n    take 1 / (Uniform(0, 1, 1, 1) + 0)\nego = Object at (0, 0), with behavior B")
    done = ask("simulate", "p.scenic", "-n", "50", "--steps", "1", "-o", "runs.jsonl")
    assert done.code == 1
    assert "ZeroDivisionError" in done.err
    for line in (tmp_path / "runs.jsonl").read_text().splitlines():
        json.loads(line)


def test_what_the_finished_attempt_prints_is_shown(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(
        "x = Range(0, 1)\nprint('begun')\nbehavior B():\n    print('acts', simulation.currentTime)\n    require x < 0.5\n    take 1\n"
        "ego = Object at (0, 0), with behavior B\n"
    )
    done = ask("simulate", "p.scenic", "-n", "4", "--steps", "1", "-o", "runs.jsonl")
    assert done.code == 0 and "attempts" in done.err and "4 simulations" in done.err
    assert done.err.count("begun") == 4 and done.err.count("acts 0") == 4
    assert "begun" not in done.out


def test_an_interrupted_file_of_simulations_is_resumed_to_the_same_bytes(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    assert ask("simulate", "p.scenic", "-n", "6", "-o", "whole.jsonl").code == 0
    whole = (tmp_path / "whole.jsonl").read_bytes()
    lines = whole.splitlines(keepends=True)
    for kept in (b"", b"".join(lines[:2]), b"".join(lines[:4]) + lines[4][:50], whole):
        (tmp_path / "torn.jsonl").write_bytes(kept)
        done = ask("simulate", "p.scenic", "-n", "6", "-o", "torn.jsonl", "--resume")
        assert done.code == 0, done.err
        assert (tmp_path / "torn.jsonl").read_bytes() == whole
    assert "6 simulations were there already" in done.err and "0 simulations of seed 0" in done.err


def test_only_a_file_of_the_same_simulations_is_resumed(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    assert ask("simulate", "p.scenic", "-n", "3", "-o", "runs.jsonl").code == 0
    before = (tmp_path / "runs.jsonl").read_bytes()
    assert ask("run", "p.scenic", "-n", "1", "-o", "scenes.jsonl").code == 0
    (tmp_path / "nested.jsonl").write_text("[" * 100_000 + "\n")
    for arguments, message in (
        (("-o", "nested.jsonl"), "its line 1 is not a simulation"),
        (("-o", "runs.jsonl", "--seed", "1"), "it holds simulations of seed 0, not 1"),
        (("-o", "runs.jsonl", "--dt", "0.5"), "its simulation 2 is not the one that this program and these options give"),
        (("-o", "scenes.jsonl"), "its line 1 is not a simulation"),
        (("-o", "runs.jsonl", "--html", "page.html"), "--html and --gif cannot be given with --resume"),
        (("-o", "runs.jsonl", "--run", "1"), "it cannot be combined with --run"),
        (("-o", "-"), "--resume needs a file to continue"),
        (("--replay", "runs.jsonl", "-o", "again.jsonl"), "--resume cannot be given with --replay"),
    ):
        count = () if {"--run", "--replay"} & {*arguments} else ("-n", "4")
        done = ask("simulate", "p.scenic", *count, "--resume", *arguments)
        assert done.code == 2
        assert message in done.err
    assert (tmp_path / "runs.jsonl").read_bytes() == before


def test_backends_give_the_same_file_and_what_is_left_to_the_machine_is_told(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(PROGRAM)
    odd = "def f(n):\n    param y = n\n    return n\nbehavior B:\n    param x = 1\n    take 1\nbehavior C:\n    take f(1)\n    take f(2)\n"
    (tmp_path / "odd.scenic").write_text(odd + "ego = Object with behavior B\nother = Object at (3, 3), with behavior C\n")
    for name in ("p", "odd"):
        found = [ask("simulate", f"{name}.scenic", "-n", "3", "-o", "-", "--backend", backend) for backend in ("compiled", "interpreter")]
        assert found[0].out == found[1].out
        assert ("the machine ran all of the behavior or monitor, more slowly: `param` on line 5" in found[0].err) is (name == "odd")
        told = re.search(r"the machine ran the function f \(line 1\), in \d+% of the time: `param` on line 2", found[0].err)
        assert bool(told) is (name == "odd")
        assert "the machine ran" not in found[1].err
    assert ask("simulate", "p.scenic", "--backend", "fast").code == 2
