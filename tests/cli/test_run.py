"""`scenic-ref run`: the scenes it draws, and where they go."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from scenic_ref.cli import open_wall, scene_outputs
from scenic_ref.cli.run_report import Tally
from scenic_ref.cli.scene_outputs import write_all
from scenic_ref.cli.scene_run import lines_so_far
from scenic_ref.cli.session import Session
from scenic_ref.sampling.batch_sampler import portions
from scenic_ref.sampling.program_source import Source
from scenic_ref.sampling.scene_sampler import Job, drawing_of


def test_a_pipe_gets_one_scene_per_line_and_nothing_else(ask):
    found = ask("run", "random.scenic", "-n", 3, "--seed", 4)
    scenes = [json.loads(line) for line in found.out.splitlines()]
    assert found.code == 0
    assert [(s["schema"], s["seed"], s["scene"]) for s in scenes] == [("scenic-ref/scene/1", 4, k) for k in range(3)]
    assert [o["name"] for o in scenes[0]["objects"]] == ["ego", "other"]
    assert "3 scenes of seed 4" in found.err


def test_a_file_gets_what_a_pipe_gets(ask):
    piped = ask("run", "random.scenic", "-n", 3)
    filed = ask("run", "random.scenic", "-n", 3, "-o", "scenes.jsonl")
    assert filed.out == ""
    assert Path("scenes.jsonl").read_text() == piped.out == ask("run", "random.scenic", "-n", 3, "-o", "-").out


def test_scene_k_alone_is_line_k_of_many(ask):
    many = ask("run", "random.scenic", "-n", 4).out.splitlines(keepends=True)
    assert ask("run", "random.scenic", "--scene", 3).out == many[3]


@pytest.mark.slow
def test_the_number_of_workers_does_not_change_a_byte(ask):
    ask("run", "random.scenic", "-n", 40, "-o", "one.jsonl")
    found = ask("run", "random.scenic", "-n", 40, "-o", "three.jsonl", "--workers", 3)
    assert found.code == 0
    assert Path("one.jsonl").read_bytes() == Path("three.jsonl").read_bytes()


@pytest.mark.slow
def test_an_error_in_a_worker_arrives_as_that_error(ask):
    Path("sometimes.scenic").write_text("x = Range(0, 1)\nego = Object at (0, 0), with width (1 / int(x < 0.9))\n")
    alone = ask("run", "sometimes.scenic", "-n", 60)
    several = ask("run", "sometimes.scenic", "-n", 60, "--workers", 2)
    assert alone.code == several.code == 1
    assert "ZeroDivisionError" in alone.err
    assert alone.err == several.err
    assert alone.out == several.out != ""


@pytest.mark.slow
def test_resuming_gives_the_bytes_of_an_uninterrupted_run(ask):
    ask("run", "random.scenic", "-n", 9, "-o", "whole.jsonl")
    whole = Path("whole.jsonl").read_bytes()
    Path("torn.jsonl").write_bytes(whole[: len(whole) // 2])
    assert ask("run", "random.scenic", "-n", 9, "-o", "torn.jsonl", "--resume").code == 0
    assert Path("torn.jsonl").read_bytes() == whole
    assert ask("run", "random.scenic", "-n", 9, "-o", "new.jsonl", "--resume").code == 0
    assert Path("new.jsonl").read_bytes() == whole


@pytest.mark.parametrize(
    ("content", "options", "message"),
    [
        (b"hello\n", (), "line 1 is not a scene"),
        (b"[" * 100_000 + b"\n", (), "line 1 is not a scene"),
        (b'{"a":' * 3000 + b"\n", (), "line 1 is not a scene"),
        (b'{"schema": "x", "seed": 0, "scene": 0, "attempts": 1}\n', (), "not a scene of"),
        (None, ("--seed", 1), "holds scenes of seed 0, not 1"),
        ("second half", (), "line 1 is scene 1, not 0"),
        ("other program", (), "is not the one that this program"),
    ],
)
def test_only_a_file_of_the_same_run_is_resumed(ask, content, options, message):
    program = "ok.scenic" if content == "other program" else "random.scenic"
    ask("run", program, "-n", 2, "-o", "scenes.jsonl")
    if isinstance(content, bytes):
        Path("scenes.jsonl").write_bytes(content)
    elif content == "second half":
        Path("scenes.jsonl").write_bytes(Path("scenes.jsonl").read_bytes().splitlines(keepends=True)[1])
    before = Path("scenes.jsonl").read_bytes()
    found = ask("run", "random.scenic", "-n", 4, "-o", "scenes.jsonl", "--resume", *options)
    assert found.code == 2
    assert message in found.err
    assert Path("scenes.jsonl").read_bytes() == before


def test_a_program_error_leaves_an_older_output_alone(ask):
    Path("scenes.jsonl").write_text("precious\n")
    assert ask("run", "wrong.scenic", "-o", "scenes.jsonl").code == 1
    assert Path("scenes.jsonl").read_text() == "precious\n"


@pytest.mark.extra("parquet")
def test_a_parquet_table_has_one_row_per_object(ask):
    from pyarrow import parquet

    lines = ask("run", "random.scenic", "-n", 3).out.splitlines()
    assert ask("run", "random.scenic", "-n", 3, "-o", "scenes.parquet").code == 0
    rows = parquet.read_table("scenes.parquet").to_pylist()
    objects = [(s, o) for s in map(json.loads, lines) for o in s["objects"]]
    assert [(r["scene"], r["object"], r["name"], r["x"], r["y"], r["heading"]) for r in rows] == [
        (s["scene"], o["id"], o["name"], *o["position"], o["heading"]) for s, o in objects
    ]
    assert [r["properties"] for r in rows] == [o["properties"] for _, o in objects]
    assert not list(Path().glob(".*unfinished"))


@pytest.mark.extra("parquet")
def test_an_unfinished_parquet_table_leaves_nothing(ask):
    found = ask("run", "never.scenic", "-o", "scenes.parquet", "--max-attempts", 5)
    assert found.code == 3
    assert not list(Path().glob("*.parquet")) + list(Path().glob(".*unfinished"))


@pytest.mark.slow
@pytest.mark.extra("parquet")
@pytest.mark.parametrize(("count", "backend"), [(3, "interpreter"), (40, "batch")])
def test_a_stream_of_arrow_goes_to_standard_output(count, backend, ask):
    from pyarrow import ipc

    command = [sys.executable, "-m", "scenic_ref", "run", "random.scenic", "-n", str(count), "--backend", backend, "--format", "arrow"]
    read = ipc.open_stream(subprocess.run(command, capture_output=True, check=True).stdout).read_all()
    lines = ask("run", "random.scenic", "-n", count).out.splitlines()
    assert read["x"].to_pylist() == [o["position"][0] for s in map(json.loads, lines) for o in s["objects"]]


@pytest.mark.parametrize(
    ("more", "message"),
    [(("--format", "nope"), "there is no format nope"), (("--format", "arrow", "-o", "x.arrow"), "told by its ending"),
     (("--format", "arrow", "--backend", "enumerate"), "written as JSON")],
)  # fmt: skip
def test_a_format_that_cannot_be_had_is_refused(more, message, ask):
    found = ask("run", "ok.scenic", *more)
    assert found.code == 2
    assert message in found.err


def test_parquet_without_pyarrow_says_what_to_install(ask, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    found = ask("run", "ok.scenic", "-o", "scenes.parquet")
    assert found.code == 2
    assert "scenic-ref[parquet]" in found.err


@pytest.mark.parametrize(("suffix", "magic"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_plot_makes_a_picture(ask, suffix, magic):
    assert ask("run", "random.scenic", "-n", 2, "--plot", f"picture.{suffix}").code == 0
    assert Path(f"picture.{suffix}").read_bytes().startswith(magic)


def test_what_the_accepted_attempt_prints_goes_to_standard_error(ask):
    found = ask("run", "prints.scenic", "-n", 2)
    printed = re.findall(r"^x is (.*)$", found.err, re.MULTILINE)
    assert len(printed) == 2
    assert all(float(x) > 0.5 for x in printed)
    assert all(line.startswith("{") for line in found.out.splitlines())


def test_what_is_printed_before_an_error_is_shown_first(ask):
    found = ask("run", "prints_then_fails.scenic")
    assert found.err.startswith("before\nprogram error: nosuch is not defined")


def test_the_report_names_the_requirement_that_rejected_most_with_its_place(ask):
    found = ask("run", "random.scenic", "-n", 20)
    assert "attempts per scene" in found.err
    assert "100%  the requirement on line 4" in found.err
    assert "random.scenic:4: require x > 0.3" in found.err


def test_a_soft_requirement_that_held_too_seldom_is_noted_under_soft_run_only(ask):
    noted = ask("run", "soft.scenic", "-n", 100)
    scenes = [json.loads(line) for line in noted.out.splitlines()]
    held = sum(s["objects"][0]["properties"]["v"] < 0.1 for s in scenes)
    assert f"held in {held} of 100 scenes" in noted.err
    assert "soft.scenic:3" in noted.err
    assert "held in" not in ask("run", "soft.scenic", "-n", 100, "--reading", "soft=scene").err


def test_looking_at_a_soft_requirement_does_not_change_the_scenes(ask):
    text = "log = []\ndef count(x):\n    log.append(x)\n    return x < 0.1\nx = Range(0, 1)\nrequire[0.5] count(x)\nego = Object at (len(log), 0)\n"
    Path("counting.scenic").write_text(text)
    scenes = [json.loads(line) for line in ask("run", "counting.scenic", "-n", 30).out.splitlines()]
    assert {s["objects"][0]["position"][0] for s in scenes} == {0, 1}


def test_parameters_are_python_literals_or_text(ask):
    found = ask("run", "random.scenic", "-p", "time=12", "-p", "weather=RAIN", "-p", "list=[1, 2]")
    assert json.loads(found.out)["params"] == {"time": 12, "weather": "RAIN", "list": [1, 2]}


@pytest.mark.slow
@pytest.mark.parametrize("workers", ["1", "2"])
def test_an_interrupt_leaves_whole_lines_and_says_one(ask, start, workers):
    command = [sys.executable, "-m", "scenic_ref", "run", "random.scenic", "-n", "10000000", "-o", "scenes.jsonl", "--workers", workers]
    with start(command) as process:
        process.until(lambda: Path("scenes.jsonl").exists() and os.path.getsize("scenes.jsonl") > 0)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    data = Path("scenes.jsonl").read_bytes()
    told, *_, last = err.splitlines()
    written = re.match(r"([\d,]+) scenes so far, and ", told)
    assert (process.returncode, out) == (130, "") and written is not None
    assert 0 < int(written[1].replace(",", "")) == data.count(b"\n")
    assert last == "interrupted; scenes.jsonl holds whole lines, and `run --resume` continues it; nothing else was written"
    assert data.endswith(b"\n")
    assert all(json.loads(line)["scene"] == k for k, line in enumerate(data.splitlines()))


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 200])
def test_an_interrupt_tells_what_rejected_the_attempts_at_a_scene_that_was_not_found(ask, start, count):
    Path("seldom.scenic").write_text("ego = Object at Normal(0, 1) @ 0\nrequire ego.position.x > 30\n")
    command = [sys.executable, "-m", "scenic_ref", "run", "seldom.scenic", "-n", str(count), "--max-attempts", "1000000000"]
    before = sum(os.times()[2:4])
    subprocess.run([*command[:-1], "1"], capture_output=True, check=False)
    starting = sum(os.times()[2:4]) - before
    with start(command) as process:
        process.until(lambda: processor_time(process.pid) > starting + 4)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate()
    assert process.returncode == 130 and err.splitlines()[-1] == "interrupted"
    assert re.search(r"^0 scenes so far, and [1-9][\d,]* stuck attempts\nrequirements that rejected most", err, re.MULTILINE)
    assert "seldom.scenic:2: require ego.position.x" in err


def test_what_other_processes_found_behind_a_missing_scene_is_told_of():
    """Scenes 1 to 4 are there when the run is interrupted, scene 0 is not."""
    source = Source("p.scenic", "ego = Object at Range(0, 1) @ 0\nrequire ego.position.x > 0.9\n")
    drawing = drawing_of(source)
    open_wall()
    printed: list[str] = []
    behind = [[drawing.draw(0, index, 1000, printed)] for index in (1, 2)]
    portion = next(portions(source, Job(source, 0, 3, 5, 1000), "lines", None))
    drawing.scenario.batch.drawing = None
    stuck = sum((drawn.stuck for (drawn,) in behind), Counter()) + portion.stuck
    told = lines_so_far(drawing, Tally(), 0, [*behind, portion], 0, KeyboardInterrupt(), Session())
    assert told[0] == f"0 scenes so far, and {stuck.total()} stuck attempts; 4 scenes more were drawn, and not written"


@pytest.mark.parametrize("to", ["scenes.jsonl", "-"])
def test_an_interrupt_while_scenes_are_written_tells_how_many_were(ask, monkeypatch, to):
    sizes: list[int] = []

    def first_only(file: int, data: memoryview) -> None:
        if sizes:
            raise KeyboardInterrupt
        sizes.append(bytes(data).count(b"\n"))
        write_all(file, data)

    monkeypatch.setattr(scene_outputs, "write_all", first_only)
    monkeypatch.setattr(scene_outputs.LinesFile, "at_once", scene_outputs.PIPED_AT_ONCE)  # several pieces
    found = ask("run", "random.scenic", "-n", "512", "-o", to)
    lines = Path(to).read_text().splitlines() if to != "-" else found.out.splitlines()
    assert found.code == 130 and 0 < sizes[0] == len(lines) < 512
    told = rf"{sizes[0]} scenes so far, and \d+ stuck attempts; {512 - sizes[0]} scenes more were drawn, and not written\n"
    assert re.match(told, found.err)
    if to != "-":
        sizes.clear()
        found = ask("run", "random.scenic", "-n", "600", "-o", to, "--resume")
        now = Path(to).read_text().count("\n") - len(lines)
        assert found.code == 130 and now == sizes[0]
        assert found.err.startswith(f"{len(lines)} scenes were there already\n{now} scenes so far, and ")


def test_of_an_interrupted_table_nothing_is_written(ask, monkeypatch):
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(scene_outputs.TableOutput, "write_many", interrupt)
    found = ask("run", "random.scenic", "-n", "512", "-o", "scenes.npz")
    assert found.code == 130 and not Path("scenes.npz").exists()
    assert re.match(r"0 scenes so far, and \d+ stuck attempts; 512 scenes more were drawn, and not written\n", found.err)


def processor_time(pid: int) -> float:
    """Seconds of a processor that a process and those below it have used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    below = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK") + sum(processor_time(int(child)) for child in below)


def test_a_reader_that_goes_away_is_no_error(ask, start):
    command = [sys.executable, "-m", "scenic_ref", "run", "ok.scenic", "-n", "100000"]
    with start(command) as process:
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == ""
        assert process.wait() == 0


def test_one_attempt_per_scene_is_one(ask):
    assert "3 scenes of seed 0 in 3 attempts, 1 attempt per scene," in ask("run", "ok.scenic", "-n", 3).err


def test_a_map_that_is_beside_the_program_is_told_with_how_to_name_it(ask):
    Path("programs").mkdir()
    for name, model in (("m.xodr", "scenic.domains.driving.model"), ("m.geojson", "site_map")):
        Path("programs", name).write_text("")
        Path("programs/p.scenic").write_text(f"param map = '{name}'\nmodel {model}\nego = Object\n")
        assert f"hint: {name} is beside the program: write localPath('{name}'), or give the path" in ask("run", "programs/p.scenic").err


def test_a_list_beside_an_at_sign_is_told_of_uniform(ask):
    Path("p.scenic").write_text("x = Uniform([1, 2, 3])\nego = Object at x @ 0\n")
    said = ask("run", "p.scenic").err
    assert "`@` stands between two numbers, not beside a list" in said and "hint: for one of its elements write `Uniform(*values)`" in said


@pytest.mark.parametrize(
    "command",
    [("run", "-n", 2), ("run", "--backend", "enumerate"), ("run", "--backend", "importance"), ("simulate", "--steps", 2), ("check",), ("trace",)],
    ids=lambda command: " ".join(map(str, command)),
)
def test_the_report_says_that_the_dialect_brought_its_profile(ask, command):
    Path("released.scenic").write_text("ego = new Object at (0, 0), with v Uniform(1, 2)\nrequire ego.v > 0\n")
    dialect = (command[0], "released.scenic", *command[1:], "--dialect", "scenic-3")
    brought = "the dialect scenic-3 brings the profile scenic-3"
    assert ask(*dialect).err.count(brought) == 1
    assert brought not in ask(*dialect, "--profile", "scenic-3").err
    assert brought not in ask(*dialect, "--profile", "paper").err
    assert "brings the profile" not in ask(command[0], "random.scenic", *command[1:]).err
