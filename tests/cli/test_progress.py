"""What a run says of the time that it will take."""

from __future__ import annotations

import pytest
from scenic_ref.cli import progress
from scenic_ref.cli.progress import Progress


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_a_run_that_takes_hours_says_so_once_and_names_a_better_backend(clock, capsys):
    with Progress(1_000) as shown:
        clock[0] += 20
        shown.drawn(400_000)
        assert not capsys.readouterr().err
        clock[0] += 20
        shown.drawn(400_000)
        told = capsys.readouterr().err
        assert "it will take 5.5 hours more: of 800,000 attempts 2 gave a scene; --backend smc or mcmc would do better" in told
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
