"""`scenic-ref bench`: who is measured, what the figures are, and what is wrong usage."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from scenic_ref.benchmarks import measurement
from scenic_ref.benchmarks.bar_chart import bars
from scenic_ref.benchmarks.end_to_end import FEWEST, FIRST, LARGEST, Commands, RunCost, TimedCommand, WritingTask, numbers_of
from scenic_ref.benchmarks.figures import Cell, Figures, fit_exponent
from scenic_ref.benchmarks.growth import many_objects, many_polygons
from scenic_ref.benchmarks.implementations import Ours
from scenic_ref.benchmarks.own_sampler import SamplingTask, Skipped, TimedSampler, prepare
from scenic_ref.benchmarks.processes import Process
from scenic_ref.interpreter.runtime.optional_packages import is_installed

from .conftest import Ask

QUICK = ("--seconds", "0.02", "--repeat", "2")
FAKE = """#!{python}
import json, os, sys
if sys.argv[2] == "--version":
    print(json.dumps({{"version": "3.9.9"}}))
    sys.exit()
script, program, world, seed = sys.argv[1:]
assert "PYTHONPATH" not in os.environ
assert json.load(open(world)).keys() == {{"cells", "road", "curbs", "models", "colors", "weather"}}
text = open(program).read()
if "broken" in text:
    sys.exit("SyntaxError: broken")
print(json.dumps({{"prepare": 0.5}}), flush=True)
if "dies" in text:
    sys.exit("RejectionException: died")
for line in sys.stdin:
    print(json.dumps({{"scenes": 10, "attempts": 30, "seconds": 2.0, "peak": 2**20}}), flush=True)
"""


@pytest.fixture
def fake(tmp_path: Path) -> Path:
    """The python of an environment with a released implementation that draws five scenes per second, in three attempts each."""
    path = tmp_path / "fake_python"
    path.write_text(FAKE.format(python=sys.executable))
    path.chmod(0o755)
    return path


@pytest.fixture
def two_backends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure only what needs no compiling."""
    monkeypatch.setattr(measurement, "ours", lambda numba, torch, prune: iter([Ours("interpreter"), Ours("numpy")]))


def cells_of(path: Path) -> dict[tuple[str, str], dict]:
    return {(c["program"], c["implementation"]): c for c in json.loads(path.read_text())["cells"]}


@pytest.mark.slow
@pytest.mark.extra("fast")
@pytest.mark.extra("torch")
def test_all_backends_and_a_released_implementation_are_measured_side_by_side(ask: Ask, fake: Path, tmp_path: Path):
    answer = ask("bench", "random.scenic", *QUICK, "--against", f"scenic==3.9.9={fake}", "--prune", "--json", "out.json", "--plot", "out.png")
    assert answer.code == 0, answer.err
    data = json.loads((tmp_path / "out.json").read_text())
    cells = cells_of(tmp_path / "out.json")
    assert [name for _, name in cells] == ["interpreter", "numpy", "numba", "torch", "numpy --prune", "numba --prune", "scenic==3.9.9"]
    released = cells["random", "scenic==3.9.9"]
    assert released["scenes per second"] == {"median": 5.0, "min": 5.0, "max": 5.0}
    assert (released["attempts per scene"], released["peak MiB"], released["prepare seconds"], released["ratio"]) == (3.0, 1.0, 0.5, 1.0)
    for cell in cells.values():
        assert len(cell["samples"]) == 2
        assert cell["ratio"] == pytest.approx(cell["scenes per second"]["median"] / 5, rel=1e-4)
    for name in ("interpreter", "numpy", "numba", "torch"):
        assert cells["random", name]["attempts per scene"] == pytest.approx(1 / 0.7, rel=0.2 if name != "interpreter" else 0.8)
        assert cells["random", name]["peak MiB"] > 20
    assert data["ratios to"] == "scenic==3.9.9"
    assert data["geometric means"]["numba"] == {"ratio": cells["random", "numba"]["ratio"], "programs": 1}
    assert set(data["load"]) == {"before", "after"} and data["versions"]["numpy"] and data["machine"]["processors"]
    assert str(fake) not in (tmp_path / "out.json").read_text()
    assert "geometric means" in answer.out and "scenic==3.9.9" in answer.out
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.usefixtures("two_backends")
def test_without_a_released_implementation_ratios_are_to_the_interpreter(ask: Ask, tmp_path: Path):
    assert ask("bench", "ok.scenic", "prints.scenic", *QUICK, "--json", "out.json").code == 0
    cells = cells_of(tmp_path / "out.json")
    assert cells["ok", "interpreter"]["ratio"] == 1.0
    assert "the batch backend cannot draw from this program" in cells["prints", "numpy"]["skipped"]
    assert cells["prints", "interpreter"]["scenes per second"]["median"] > 0


DRIVING = "behavior B():\n    while True:\n        wait\nego = Object with behavior B\nrequire always simulation.currentTime < 100\n"


@pytest.mark.slow
def test_time_steps_of_simulations_are_measured(ask: Ask, fake: Path, tmp_path: Path):
    lines = fake.read_text().splitlines()
    fake.write_text("\n".join("assert world == '30'" if "open(world)" in line else line for line in lines) + "\n")
    (tmp_path / "drive.scenic").write_text(DRIVING)
    arguments = ("--simulate", "--steps", "30", "--against", f"scenic==3.9.9={fake}", "--json", "out.json", "--plot", "out.png")
    answer = ask("bench", "drive.scenic", *QUICK, *arguments)
    assert answer.code == 0, answer.err
    data, cells = json.loads((tmp_path / "out.json").read_text()), cells_of(tmp_path / "out.json")
    assert [name for _, name in cells] == ["interpreter", "compiled", "scenic==3.9.9"]
    assert (data["counted"], data["options"]["steps"]) == ("time steps", 30)
    assert cells["drive", "scenic==3.9.9"]["time steps per second"]["median"] == 5.0
    assert cells["drive", "compiled"]["ratio"] > 2 * cells["drive", "interpreter"]["ratio"] > 0
    assert all(sample["scenes"] % 30 == 0 for sample in cells["drive", "compiled"]["samples"])
    assert "time steps/s" in answer.out and "numba" not in answer.err


def test_a_program_of_which_nothing_can_be_measured_is_a_failure(ask: Ask, tmp_path: Path):
    (tmp_path / "brök en.scenic").write_text("ego = (\n")
    answer = ask("bench", "brök en.scenic", *QUICK, "--end-to-end", "--format", "csv")
    assert answer.code == 1 and "nothing could be measured of brök en" in answer.err
    assert "this `(` is never closed" in answer.out


@pytest.mark.slow
@pytest.mark.usefixtures("two_backends")
def test_a_program_that_a_released_implementation_does_not_run_is_told(ask: Ask, fake: Path, tmp_path: Path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "ok.scenic").write_text("broken\n")
    (tmp_path / "there" / "soft.scenic").write_text("dies\n")
    rival = ("--against", f"scenic==3.9.9={fake}", "--released", "there")
    answer = ask("bench", "ok.scenic", "soft.scenic", "random.scenic", *QUICK, *rival, "--json", "out.json")
    assert answer.code == 0
    cells = cells_of(tmp_path / "out.json")
    assert cells["ok", "scenic==3.9.9"]["skipped"] == "SyntaxError: broken"
    assert cells["soft", "scenic==3.9.9"]["skipped"] == "RejectionException: died"
    assert cells["random", "scenic==3.9.9"]["skipped"] == "there is no random.scenic for this implementation"
    assert "ok, scenic==3.9.9: SyntaxError: broken" in answer.out


def test_wrong_usage_is_told_before_anything_is_measured(ask: Ask, fake: Path, tmp_path: Path):
    silent = tmp_path / "silent"
    silent.write_text("#!/bin/sh\n")
    silent.chmod(0o755)
    for arguments, said in (
        ((), "there is nothing to measure"),
        (("nosuch.scenic",), "there is no file nosuch.scenic"),
        (("ok.scenic", "--seconds", "0"), "--seconds must be a positive number"),
        (("ok.scenic", "--simulate", "--prune"), "--simulate measures programs, and goes with none of"),
        (("ok.scenic", "--simulate", "--steps", "0"), "--steps"),
        (("ok.scenic", "--against", "scenic=3.1.1"), "--against expects NAME==VERSION=PYTHON"),
        (("ok.scenic", "--against", "other==1=/bin/sh"), "--against knows how to measure scenic only"),
        (("ok.scenic", "--against", "scenic==3.1.1=/no/such/python"), "/no/such/python is not a program that can be run"),
        (("ok.scenic", "--against", f"scenic==3.1.1={tmp_path}"), "is not a program that can be run"),
        (("ok.scenic", "--against", f"scenic==3.1.1={silent}"), "does not report its version of scenic"),
        (("ok.scenic", "--against", f"scenic==3.1.1={fake}"), "holds scenic 3.9.9"),
        (("ok.scenic", "--against", f"scenic==3.9.9={fake}", "--released", "nosuch"), "holds none of the programs"),
        (("ok.scenic", "--json", "nosuch/out.json"), "there is no directory nosuch"),
        (("ok.scenic", "--json", "ok.scenic"), "is the program ok"),
        (("ok.scenic", "--plot", "out.gif"), "pictures are written as .png, .pdf or .svg"),
        (("--growth", "--plot", "out.png"), "--plot draws the figures of programs"),
        (("--end-to-end",), "there is nothing to measure"),
        (("p.scenic", "--format", "csv"), "--format says which files --end-to-end measures"),
        (("p.scenic", "--end-to-end", "--format", "xml"), "there is no format xml"),
        (("p.scenic", "--end-to-end", "--growth"), "goes with none of --prune, --growth and --against"),
    ):
        answer = ask("bench", *arguments)
        assert answer.code == 2, answer
        assert said in answer.err
        assert not answer.out


@pytest.mark.slow
@pytest.mark.usefixtures("two_backends")
def test_an_interrupt_shows_and_writes_what_is_measured_so_far(ask: Ask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    asked = []

    def interrupted(self: Process, seconds: float) -> dict[str, float]:
        asked.append(seconds)
        if len(asked) > 3:
            raise KeyboardInterrupt
        return {"scenes": 4, "attempts": 8, "seconds": 2.0}

    monkeypatch.setattr(Process, "sample", interrupted)
    answer = ask("bench", "ok.scenic", "random.scenic", *QUICK, "--json", "out.json")
    assert answer.code == 130
    assert "these figures are what was measured so far" in answer.err
    data = json.loads((tmp_path / "out.json").read_text())
    assert data["interrupted"]
    assert [len(c.get("samples", [])) for c in data["cells"]] == [2, 1]
    assert {c["program"] for c in data["cells"]} == {"ok"}
    assert "random" not in answer.out and "numpy" in answer.out


def test_medians_ratios_and_means_are_what_they_are_called():
    def cell(program: str, contender: str, *rates: float) -> Cell:
        return Cell(program, contender, {"prepare": 1.0}, [{"scenes": r, "attempts": 2 * r, "seconds": 1.0} for r in rates])

    cells = [cell("a", "x", 1, 100, 4), cell("a", "y", 2), cell("b", "x", 9), cell("b", "y", 1), cell("c", "x", 7), Cell("c", "y", skipped="why")]
    figures = Figures(("x", "y"), "y", cells)
    assert [figures.ratio(c) for c in cells] == [2.0, 1.0, 9.0, 1.0, None, None]
    assert figures.means() == {"x": (pytest.approx(18**0.5), 2), "y": (1.0, 2)}
    assert cells[0].attempts == 2.0
    assert bars(figures, format="png") == bars(figures, format="png")


def test_the_power_of_growth_is_found():
    assert fit_exponent([(n, 3 * n**1.5) for n in (2, 10, 50)]) == pytest.approx(1.5)
    assert fit_exponent([(2, 1.0)]) is None


@pytest.mark.parametrize("text", [many_objects(5), many_polygons(50)])
def test_the_programs_that_grow_are_drawn_alike_by_the_backends_that_are_measured(text: str, tmp_path: Path):
    path = tmp_path / "5_things.scenic"
    path.write_text(text)
    counts = {backend: prepare(SamplingTask(str(path), backend, trust=True))[0](0, 20) for backend in ("interpreter", "numpy")}
    assert len(set(counts.values())) == 1
    assert counts["numpy"][0] == 20


def test_each_measurement_draws_other_scenes():
    asked = []

    def draw(start: int, count: int) -> tuple[int, int]:
        asked.extend(range(start, start + count))
        return count, 2 * count

    sampler = TimedSampler(draw, blocks=False)
    first = sampler.sample(0.0)
    assert (first["scenes"], first["attempts"]) == (1, 2)
    sampler.sample(0.0)
    assert asked == [1, 2]


@pytest.mark.slow
def test_what_the_whole_command_takes_is_measured_in_each_format(ask: Ask, tmp_path: Path):
    (tmp_path / "trusting.scenic").write_text("import colorsys\nego = Object at Range(0, colorsys.ONE_THIRD) @ 0\n")
    skipped = ask("bench", "trusting.scenic", *QUICK, "--end-to-end", "--format", "csv").out
    assert "so it needs --trust" in skipped and "run to csv" in skipped and "run to npz" not in skipped
    formats = ("--format", "jsonl", "--format", "npz")
    answer = ask("bench", "trusting.scenic", "--seconds", "0.05", "--repeat", "1", *formats, "--end-to-end", "--trust", "--json", "out.json")
    assert answer.code == 0 and "writing, ns/number" in answer.out, answer.err
    cells = cells_of(tmp_path / "out.json")
    written = [name for _, name in cells if name.startswith("run to ")]
    assert written == ["run to jsonl", "run to npz"] and len(cells) == 3
    for name in written:
        cell = cells["trusting", name]
        assert "skipped" not in cell and cell["numbers per scene"] > 4 and cell["peak MiB"] > 20
        assert cell["prepare seconds"] > 0.1, "the start of the command is no part of a scene"
        (sample,) = cell["samples"]
        assert 0 < sample["drawing"] < sample["seconds"]
        assert cell["drawing us/scene"] == pytest.approx(1e6 * sample["drawing"] / sample["scenes"], rel=1e-4)
        assert cell["writing us/scene"] == pytest.approx(1e6 * (sample["seconds"] - sample["drawing"]) / sample["scenes"], rel=1e-3)
    assert not list(tmp_path.glob("scenes.*")), "the files are gone"


def test_further_scenes_are_told_from_the_start():
    asked: list[int] = []

    def cost(count: int) -> RunCost:
        asked.append(count)
        return RunCost((3.0 if len(asked) == 1 else 0.5) + count / 100_000, count / 400_000, 7)

    sampler = TimedCommand(cost)
    found = sampler.sample(0.1)
    scenes = 16_000 - FEWEST
    further = {"seconds": pytest.approx(scenes / 100_000), "drawing": pytest.approx(scenes / 400_000)}
    assert found == {"scenes": scenes, **further, "start": pytest.approx(3.01), "peak": 7}, "the half second that each run takes is no part of it"
    assert asked == [FIRST, FEWEST, FEWEST, FIRST, 4 * FIRST, 16 * FIRST]
    assert sampler.sample(9)["scenes"] == scenes, "later measurements are of the same number"
    assert TimedCommand(lambda count: RunCost(0.0, 0.0, 0)).sample(1)["scenes"] <= LARGEST, "an end where a scene costs nothing"


def test_one_process_answers_the_command_again_and_again(tmp_path: Path):
    (tmp_path / "p.scenic").write_text("print('hello')\nego = Object at Range(0, 1) @ 0\n")
    (tmp_path / "quiet.scenic").write_text("ego = Object at Range(0, 1) @ 0\n")
    (tmp_path / "wrong.scenic").write_text("ego = Object at nosuch\n")
    with Commands(WritingTask(str(tmp_path / "p.scenic"), "npz"), str(tmp_path)) as commands:
        first, later = commands.cost(20), commands.cost(20)
        assert later.seconds < first.seconds, "the start, which takes a second or so"
        assert later.drawing == 0, "a program that prints is drawn by the interpreter"
        assert later.memory > 2**24
        assert not (tmp_path / "scenes.npz").exists()
    with Commands(WritingTask(str(tmp_path / "quiet.scenic"), "npz"), str(tmp_path)) as commands:
        first, many = commands.cost(FIRST), commands.cost(2 * FIRST)
        assert 0 < many.drawing < many.seconds
        if is_installed("numba"):
            assert first.drawing > 20 * many.drawing, "what draws is compiled in the first run, which takes seconds"
    with Commands(WritingTask(str(tmp_path / "wrong.scenic"), "npz"), str(tmp_path)) as commands, pytest.raises(Skipped, match="nosuch"):
        commands.cost(20)
    with Commands(WritingTask(str(tmp_path / "p.scenic"), "npz"), str(tmp_path)) as commands:
        commands.running.kill()
        commands.running.wait()
        with pytest.raises(Skipped, match="the command ended with -9"):
            commands.cost(20)


def test_numbers_are_counted(tmp_path: Path):
    (tmp_path / "p.scenic").write_text("ego = Object at Range(0, 1) @ 0\n")
    one = numbers_of(WritingTask(str(tmp_path / "p.scenic"), "npz"))
    (tmp_path / "p.scenic").write_text("ego = Object at Range(0, 1) @ 0, with foo 3, with bar 'x', with baz (1, 2, 3)\n")
    assert numbers_of(WritingTask(str(tmp_path / "p.scenic"), "npz")) == one + 4


def test_what_writing_costs_is_what_a_run_takes_beside_drawing():
    figures = Figures(("numba", "run to npz"), "numba")
    draws, writes = Cell("p", "numba"), Cell("p", "run to npz", {"numbers": 50})
    draws.take({"scenes": 1000, "attempts": 1000, "seconds": 0.009})
    for seconds, drawing in ((0.009, 0.006), (0.005, 0.002), (0.004, 0.001)):
        writes.take({"scenes": 1000, "seconds": seconds, "drawing": drawing, "start": 2.0})
    figures.cells = [draws, writes]
    found = figures.writing(writes)  # of the medians, whatever drawing alone took
    assert found is not None and (found.share, found.per_number) == (pytest.approx(1.5), pytest.approx(60))
    slow = Cell("q", "run to npz", {"numbers": 50})
    slow.take({"scenes": 1000, "seconds": 9.0, "drawing": 0.0, "start": 2.0})
    assert figures.writing(slow) is None, "the interpreter drew"
    assert figures.writing(draws) is None and writes.attempts is None and writes.prepare == 2.0
