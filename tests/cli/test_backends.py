"""`scenic-ref run`: one file, byte for byte, whatever draws the scenes: backends, processes, a cluster, an interrupted run and its continuation."""

from __future__ import annotations

import json
import os
import random
import re
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from scenic_ref.semantics.syntax.nodes import Span

KILLS = int(os.environ.get("SCENIC_REF_KILLS", "2"))
"""How often a run is killed; SCENIC_REF_KILLS=20 for all of them."""
MANY = """\
x = Range(0, 1)
ego = Object at (x, 0)
Object at (5, Range(0, 3)), with c Uniform('a', 'b')
require x > 0.3
require[0.5] x > 0.5
param p = x
"""
PARQUET = pytest.param("parquet", marks=pytest.mark.extra("parquet"))


@pytest.mark.parametrize("suffix", ["jsonl", PARQUET, "npz"])
@pytest.mark.parametrize("program", ["random", "soft", "many"])
def test_both_backends_write_the_same_bytes(ask, program, suffix):
    Path("many.scenic").write_text(MANY)
    reports = []
    for backend in ("interpreter", "batch"):
        found = ask("run", f"{program}.scenic", "-n", 60, "--backend", backend, "-o", f"{backend}.{suffix}")
        assert found.code == 0
        reports.append(found.err.splitlines())
    assert Path(f"interpreter.{suffix}").read_bytes() == Path(f"batch.{suffix}").read_bytes()
    assert reports[0][1] == "drawn by the interpreter, as asked for"
    assert reports[1][1] == "drawn by the batch backend; 0 runs were left to the interpreter"
    assert reports[0][2:] == reports[1][2:]
    assert not list(Path().glob(".*unfinished"))


@pytest.mark.slow
@pytest.mark.parametrize(("workers", "suffix"), [(2, "npz"), (7, "jsonl")])
def test_the_number_of_processes_changes_neither_a_byte_nor_the_report(ask, workers, suffix):
    one = ask("run", "random.scenic", "-n", 500, "-o", f"one.{suffix}")
    several = ask("run", "random.scenic", "-n", 500, "-o", f"several.{suffix}", "--workers", workers)
    assert Path(f"one.{suffix}").read_bytes() == Path(f"several.{suffix}").read_bytes()
    assert one.err.splitlines()[1:] == several.err.splitlines()[1:]
    assert one.err.splitlines()[0].split(",")[:2] == several.err.splitlines()[0].split(",")[:2]


@pytest.mark.slow
@pytest.mark.extra("cluster")
def test_a_cluster_writes_what_this_process_writes(ask):
    ask("run", "random.scenic", "-n", 60, "-o", "one.jsonl")
    found = ask("run", "random.scenic", "-n", 60, "-o", "cluster.jsonl", "--cluster", "local", "--workers", 2)
    assert found.code == 0
    assert Path("one.jsonl").read_bytes() == Path("cluster.jsonl").read_bytes()


def test_a_cluster_that_is_not_there_is_wrong_usage(ask, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    found = ask("run", "ok.scenic", "-n", 20, "--cluster", "local")
    assert found.code == 2
    assert "scenic-ref[cluster]" in found.err


@pytest.mark.slow
@pytest.mark.parametrize("kill", range(KILLS))
def test_a_killed_run_resumes_to_the_same_bytes(ask, start, kill):
    """Killed with SIGKILL as soon as a random share of the file is there, resumed, killed again, and resumed to its end."""
    Path("many.scenic").write_text(MANY)
    ask("run", "many.scenic", "-n", 12_000, "-o", "whole.jsonl")
    whole = Path("whole.jsonl").read_bytes()
    chance = random.Random(f"{kill} {os.environ.get('SCENIC_REF_SEED', '0')}")
    command = [sys.executable, "-m", "scenic_ref", "run", "many.scenic", "-n", "12000", "-o", "killed.jsonl", "--resume"]
    size = 0
    for workers in ("1", "2"):
        limit = chance.uniform(size, len(whole))
        with start([*command, "--workers", workers]) as process:
            process.until(lambda limit=limit: Path("killed.jsonl").exists() and os.path.getsize("killed.jsonl") >= limit)
            process.send_signal(signal.SIGKILL)
            process.communicate()
        size = os.path.getsize("killed.jsonl")
    assert ask("run", "many.scenic", "-n", 12_000, "-o", "killed.jsonl", "--resume").code == 0
    assert Path("killed.jsonl").read_bytes() == whole


@pytest.mark.slow
def test_a_run_by_the_interpreter_is_resumed_by_the_batch_backend(ask):
    ask("run", "random.scenic", "-n", 40, "-o", "whole.jsonl", "--backend", "interpreter")
    whole = Path("whole.jsonl").read_bytes()
    Path("torn.jsonl").write_bytes(whole[: len(whole) // 3])
    found = ask("run", "random.scenic", "-n", 40, "-o", "torn.jsonl", "--resume", "--plot", "picture.svg")
    assert (found.code, Path("torn.jsonl").read_bytes()) == (0, whole)
    assert "13 scenes were there already" in found.err
    assert "drawn by the batch backend" in found.err


def test_a_few_scenes_are_left_to_the_interpreter_and_more_are_not(ask):
    assert "drawn by the interpreter, since fewer than 10 scenes were asked for" in ask("run", "random.scenic", "-n", 9).err
    assert "drawn by the batch backend" in ask("run", "random.scenic", "-n", 10).err
    assert ask("run", "random.scenic", "--scene", 5, "--backend", "batch").out == ask("run", "random.scenic", "--scene", 5).out


def test_the_report_says_why_a_program_cannot_be_drawn_from_many_at_a_time(ask):
    Path("says.scenic").write_text('print("hello")\nego = Object at (Range(0, 1), 0)\n')
    for backend in ((), ("--backend", "batch")):
        found = ask("run", "says.scenic", "-n", 12, *backend)
        assert found.code == 0
        assert found.err.count("hello\n") == 12
        assert "drawn by the interpreter, since the batch backend cannot draw from this program: says.scenic:1:1: the program prints" in found.err


@pytest.mark.parametrize(("n", "workers"), [(60, 1), (60, 2), (1, 1)])
def test_that_no_scene_is_possible_is_said_at_once(ask, n, workers):
    """Where bounds of the values show it; the interpreter alone makes all attempts."""
    Path("never.scenic").write_text("x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 2\n")
    found = ask("run", "never.scenic", "-n", n, "--workers", workers)
    assert (found.code, found.out) == (3, "")
    assert "no scene is possible: the requirement on line 3 fails, whatever is drawn" in found.err
    alone = ask("run", "never.scenic", "-n", 60, "--backend", "interpreter", "--max-attempts", 9)
    assert alone.code == 3
    assert "no scene in 9 attempts" in alone.err


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_the_batch_backend_goes_on_with_a_few_scenes_that_need_many_attempts(ask, workers):
    Path("seldom.scenic").write_text("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.998\n")
    found = ask("run", "seldom.scenic", "-n", 5, "--workers", workers, "--seed", 5)
    assert found.code == 0
    assert "drawn by the batch backend" in found.err
    attempts = [json.loads(line)["attempts"] for line in found.out.splitlines()]
    assert attempts[0] <= 1000 < max(attempts), "the first one was found by the interpreter"
    assert f"5 scenes of seed 5 in {sum(attempts):,} attempts" in found.err
    assert found.out == ask("run", "seldom.scenic", "-n", 5, "--seed", 5, "--backend", "batch").out


def test_attempts_are_as_many_as_are_allowed_whoever_makes_them(ask):
    contradiction = "x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 0.7\nrequire x < 0.6\n"
    for program, tried in ((contradiction, (999, 1000, 1001, 3000)), (f"print(1)\n{contradiction}", (1200,))):
        Path("contradiction.scenic").write_text(program)
        for attempts in tried:
            found = ask("run", "contradiction.scenic", "--max-attempts", attempts)
            assert (found.code, found.out) == (3, "")
            assert f"no scene in {attempts:,} attempts" in found.err
            assert found.err.count("no scene in") == 1 and found.err.splitlines().count("1") <= 1


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize(
    ("text", "options", "code"),
    [
        ("x = Range(0, 1)\nego = Object at (0, 0), with width (1 / int(x < 0.9))\n", (), 1),
        ("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.7\n", ("--max-attempts", 9), 3),
        ("x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 0.99999\n", ("--max-attempts", 9), 3),
    ],
)
def test_errors_come_at_the_same_scene_in_the_same_words(ask, text, options, code, workers):
    Path("fails.scenic").write_text(text)
    one_by_one = ask("run", "fails.scenic", "-n", 60, *options, "--backend", "interpreter")
    many = ask("run", "fails.scenic", "-n", 60, *options, "--backend", "batch", "--workers", workers)
    assert one_by_one.code == code
    assert many == one_by_one


@pytest.mark.slow
def test_a_table_without_scenes_is_an_empty_table(ask):
    for backend in ("interpreter", "batch"):
        assert ask("run", "random.scenic", "-n", 0, "-o", f"{backend}.npz", "--backend", backend).code == 0
    assert Path("interpreter.npz").read_bytes() == Path("batch.npz").read_bytes()
    assert np.load("batch.npz")["x"].shape == (0,)


@pytest.mark.parametrize("suffix", [PARQUET, "npz"])
def test_a_table_is_there_whole_or_not_at_all(ask, suffix):
    Path("fails.scenic").write_text("x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.7\n")
    Path(f"scenes.{suffix}").write_text("precious\n")
    assert ask("run", "fails.scenic", "-n", 60, "--max-attempts", 3, "-o", f"scenes.{suffix}").code == 3
    assert Path(f"scenes.{suffix}").read_text() == "precious\n"
    assert not list(Path().glob(".*unfinished"))


def test_soft_requirements_are_looked_at_in_the_first_scenes_of_many(ask, monkeypatch):
    from scenic_ref.sampling import batch_sampler

    monkeypatch.setattr(batch_sampler, "MOST_LOOKED_AT", 25)
    found = ask("run", "soft.scenic", "-n", 40)
    scenes = [json.loads(line) for line in found.out.splitlines()]
    held = sum(s["objects"][0]["properties"]["v"] < 0.1 for s in scenes[:25])
    assert f"held in {held} of 25 scenes" in found.err


@pytest.mark.parametrize(
    ("held", "known", "noted"), [(0, 1, False), (0, 9, False), (0, 10, True), (240, 500, False), (210, 500, True), (300, 500, False)]
)
def test_a_soft_requirement_is_noted_if_chance_would_seldom_make_it_so_rare(held, known, noted):
    """False alarm: at most 1e-3. All of ten coins fall on one side in 1 of 1,024; 240 or fewer of 500 in 1 of 5, 210 or fewer in 1 of 5,000."""
    from scenic_ref.cli.run_report import soft_lines
    from scenic_ref.sampling.scene_sampler import Softness

    assert bool(soft_lines([Softness(Span("a.scenic", 1, 1, 1, 9), 0.5, held, known)], {})) is noted


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run a.scenic -o b.jsonl", "; b.jsonl holds whole lines, and `run --resume` continues it; nothing else was written"),
        ("run a.scenic -o a.npz --output=b", "; b holds whole lines, and `run --resume` continues it; nothing else was written"),
        ("run a.scenic -ob.ndjson -n 3", "; b.ndjson holds whole lines, and `run --resume` continues it; nothing else was written"),
        ("run a.scenic -o b.jsonl --scene 3", "; b.jsonl holds whole lines; nothing else was written"),
        ("run a.scenic -o missing.jsonl", "; missing.jsonl was not written"), ("run a.scenic -o b.jsonl -o b.npz", "; b.npz was not written"),
        ("run a.scenic -o -", ""), ("run a.scenic", ""),
        ("run a.scenic --backend smc -o b.jsonl", "; nothing was written"), ("simulate a.scenic", "; no simulation was finished"),
    ],
)
def test_an_interrupt_says_which_file_there_is(words, said, tmp_path, monkeypatch):
    from scenic_ref.cli import interruption

    monkeypatch.chdir(tmp_path)
    for name in ("b", "b.jsonl", "b.ndjson"):
        Path(name).touch()
    assert interruption(words.split()) == f"interrupted{said}"
    assert interruption(["fuzz", *words.split()[1:]], "what was found is kept") == "interrupted; what was found is kept"


@pytest.mark.slow
def test_an_interrupt_ends_several_processes_at_once_and_leaves_whole_lines(ask, start):
    command = [sys.executable, "-m", "scenic_ref", "run", "random.scenic", "-n", "10000000", "-o", "scenes.jsonl", "--workers", "2"]
    with start(command) as process:
        process.until(lambda: Path("scenes.jsonl").exists() and os.path.getsize("scenes.jsonl") >= 10**6)
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate()
    data = Path("scenes.jsonl").read_bytes()
    assert (process.returncode, out) == (130, "")
    assert err.count("interrupted") == 1 and "requirements that rejected most" in err and "Traceback" not in err
    assert data.endswith(b"\n")
    assert all(json.loads(line)["scene"] == k for k, line in enumerate(data.splitlines()))


# Pruning


def test_pruned_scenes_are_the_same_from_both_backends_and_say_so(ask):
    program = Path(__file__).parent.parent.parent / "examples" / "gallery" / "single_car.scenic"
    for backend in ("batch", "interpreter"):
        found = ask("run", program, "-n", 12, "--prune", "--backend", backend, "-o", f"{backend}.jsonl")
        assert found.code == 0
        assert "pruning was on: other scenes than without it" in found.err
        assert "ego: containment: 35,026 -> 31,935 m2" in found.err
    assert Path("batch.jsonl").read_bytes() == Path("interpreter.jsonl").read_bytes()
    assert all(json.loads(line)["pruned"] is True for line in Path("batch.jsonl").read_text().splitlines())


def test_a_file_of_pruned_scenes_is_resumed_with_pruning_only(ask):
    program = Path(__file__).parent.parent.parent / "examples" / "gallery" / "single_car.scenic"
    assert ask("run", program, "-n", 3, "--prune", "-o", "scenes.jsonl").code == 0
    assert ask("run", program, "-n", 5, "-o", "scenes.jsonl", "--resume").code == 2
    assert ask("run", program, "-n", 5, "--prune", "-o", "scenes.jsonl", "--resume").code == 0
    assert ask("run", program, "-n", 5, "--prune", "-o", "all.jsonl").code == 0
    assert Path("scenes.jsonl").read_bytes() == Path("all.jsonl").read_bytes()


def test_where_nothing_can_be_pruned_the_report_says_why(ask):
    Path("plain.scenic").write_text("ego = Object at (Range(0, 1), 0)\n")
    found = ask("run", "plain.scenic", "-n", 2, "--prune", "-o", "scenes.jsonl")
    assert found.code == 0
    assert "pruning found nothing to prune" in found.err
    assert ask("run", "plain.scenic", "-n", 2, "-o", "plain.jsonl").code == 0
    assert Path("scenes.jsonl").read_bytes() == Path("plain.jsonl").read_bytes()
    assert ask("run", "plain.scenic", "--prune", "--backend", "enumerate").code == 2


def test_the_report_says_where_runs_are_left_to_the_interpreter(ask):
    ordered = "def middle(p):\n    return sorted([p.x, p.y, 0.3])[1]\n"
    Path("sorts.scenic").write_text(f"{ordered}f = VectorField('f', middle)\nego = Object at Range(0, 1) @ Range(0, 1), facing f\n")
    first, where = ask("run", "sorts.scenic", "-n", "40", "-o", "scenes.jsonl").err.splitlines()[1:3]
    assert re.fullmatch(r"drawn by the batch backend; \d+ runs were left to the interpreter", first) and "; 0 runs" not in first
    place, often = re.fullmatch(r"(.*) \(so are (\d+) of 512 other runs\)", where).groups()
    assert place == "left at sorts.scenic:4:7: what is drawn decides what happens"
    assert 350 < int(often) < 512  # all orders of x, y and 0.3 but the traced one are left; the likeliest, 0.3 < x < y, has probability 0.245
