"""What a run says of the time that it will take."""

from __future__ import annotations

from pathlib import Path

import pytest
from scenic_ref.api import loads
from scenic_ref.cli import progress_bar
from scenic_ref.cli.progress_bar import Progress
from scenic_ref.cli.scene_run import BatchForesight, SceneRequest
from scenic_ref.sampling.scene_sampler import Drawing


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [1000.0]
    monkeypatch.setattr(progress_bar.time, "monotonic", lambda: now[0])
    return now


def test_a_run_that_takes_hours_says_so_once_and_names_a_better_backend(clock, capsys):
    with Progress(1_000) as shown:
        clock[0] += 20
        shown.drawn(400_000)
        assert not capsys.readouterr().err
        clock[0] += 20
        shown.drawn(400_000)
        told = capsys.readouterr().err
        assert "it will take 5.5 hours more: of 800,000 attempts 2 gave a scene; --backend smc or mcmc would do better, since" in told
        clock[0] += 100
        shown.drawn(400_000)
        assert not capsys.readouterr().err


def test_a_run_that_is_soon_done_or_has_no_rare_requirement_names_no_backend(clock, capsys):
    with Progress(100) as shown:
        clock[0] += 40
        shown.drawn(100, 50)
        assert not capsys.readouterr().err
    with Progress(1_000_000) as shown:
        clock[0] += 40
        shown.drawn(200, 100)
        told = capsys.readouterr().err
        assert "hours more" in told
        assert "backend" not in told


def test_a_first_scene_that_does_not_come_is_told_of(clock, capsys):
    with Progress(200) as shown:
        clock[0] += 50
        shown.stuck(90_000)
        assert "at least 2.8 hours more: of 90,000 attempts 0 gave a scene" in capsys.readouterr().err


def test_a_single_scene_has_a_bar_when_it_takes_a_while(clock, monkeypatch):
    monkeypatch.setattr(progress_bar.sys.stderr, "isatty", lambda: True, raising=False)
    with Progress(1) as shown:
        shown.stuck(10)
        assert shown.bar is None
        clock[0] += 3
        shown.stuck(1_000)
        assert shown.bar is not None
    with Progress(2) as shown:
        assert shown.bar is not None


class Seen:
    """A run of which no scene is there yet."""

    def __init__(self, runs: int, probability: float | None) -> None:
        self.made, self.likely, self.asked = runs, probability, 0

    def runs(self) -> int:
        return self.made

    def probability(self) -> float | None:
        self.asked += 1
        return self.likely


def test_before_the_first_scene_the_time_is_guessed_from_the_probability(clock, capsys):
    seen = Seen(4_000_000, 1e-6)
    with Progress(1_000, foresight=seen) as shown:
        clock[0] += 40
        shown.foretell()
        shown.foretell()
        told = capsys.readouterr().err
    assert "it will take about 2.8 hours more: about one run in 1,000,000 is accepted; --backend smc or mcmc would do better" in told
    assert told.count("note") == seen.asked == 1


def test_what_is_likely_to_be_done_soon_is_not_told_of(clock, capsys):
    with Progress(10, foresight=Seen(4_000_000, 1e-6)) as shown:
        clock[0] += 40
        shown.foretell()
    assert not capsys.readouterr().err


def test_what_nobody_can_guess_is_told_of_by_the_attempts(clock, capsys):
    with Progress(10, foresight=Seen(5_000, None)) as shown:
        clock[0] += 40
        shown.foretell()
    assert not capsys.readouterr().err
    with Progress(100, foresight=Seen(5_000, None)) as shown:
        clock[0] += 400
        shown.foretell()
    assert "at least 11.1 hours more: of 5,000 attempts 0 gave a scene" in capsys.readouterr().err


def test_what_is_known_before_the_first_scene_comes_from_the_graph():
    """Nothing before something was drawn, without making the graph; then the runs, and a guess that is right within a factor of two."""
    text = "xs = [Range(0, 1) for i in range(4)]\nego = Object at xs[0] @ 0\nrequire xs[0] + xs[1] + xs[2] + xs[3] < 0.4\n"
    drawing = Drawing(loads(text))
    seen = BatchForesight(drawing, SceneRequest(0, 10, 0, 100_000, None, None, 1, False))
    assert seen.runs() == 0
    assert "_lifted" not in vars(drawing.scenario)
    block = drawing.batch.block(0, 0, 10)
    assert seen.runs() == block.runs > 1_000
    assert 0.5 < (seen.probability() or 0) / (0.4**4 / 24) < 2


def test_nothing_is_known_of_a_program_that_has_no_graph():
    drawing = Drawing(loads("ego = Object at (max(*Uniform([1, 2], [2, 3, Range(3, 4)])), 0)\n"))
    assert drawing.scenario.not_lifted is not None
    seen = BatchForesight(drawing, SceneRequest(0, 10, 0, 100_000, None, None, 1, False))
    assert (seen.runs(), seen.probability()) == (0, None)


@pytest.mark.parametrize(("command", "on_terminal", "delay"), [("run", True, 0), ("check", True, 0), ("run", False, 0), ("run", True, 1000)])
def test_a_word_is_said_on_a_terminal_of_a_first_run_that_takes_long(ask, monkeypatch, command, on_terminal, delay):
    monkeypatch.setattr(progress_bar, "LONG_FOR_ONE_RUN", delay)
    Path("endless.scenic").write_text("ego = Object\nwhile True:\n    pass\n")
    monkeypatch.setattr("sys.stderr.isatty", lambda: on_terminal, raising=False)
    found = ask(command, "endless.scenic", "--fuel", 200_000)
    assert found.code == 1 and "is this an endless loop?" in found.err
    said = "the program is run once before anything else, which takes a while; after 200,000 steps it is given up (--fuel)"
    assert found.err.count(said) == (on_terminal and delay == 0)
