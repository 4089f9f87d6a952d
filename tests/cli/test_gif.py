"""`scenic-ref simulate --gif`; and what is left when a simulation is interrupted, or a disk is full."""

from __future__ import annotations

import io
import json
import signal
import stat
import sys
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from PIL import Image
from scenic_ref.pictures.movies import MOST_FRAMES, frames_of, movie
from scenic_ref.pictures.scene_figures import CLASSES, EGO
from scenic_ref.semantics.store.errors import UsageError

MOVING = """
ego = Object at (0, 0), with velocity (3, 0)
Object at (10, {y}), with velocity (-1, 0)
"""
ORANGE, BLUE = (tuple(255 - 0.6 * (255 - int(colour[k : k + 2], 16)) for k in (1, 3, 5)) for colour in (EGO, CLASSES[0]))
"""About the colours inside of the boxes of ego and of the other object, on an empty ground."""


def simulated(steps=20, timestep=0.1, text=MOVING, y=5):
    return scenic_ref.loads(text.replace("{y}", str(y))).simulate("kinematic", steps, timestep=timestep).simulation


def frames(data):
    image = Image.open(io.BytesIO(data))
    found = []
    for k in range(image.n_frames):
        image.seek(k)
        found.append((image.info["duration"], np.asarray(image.convert("RGB")).astype(int)))
    return found


def middle_of(picture, colour):
    """Where the pixels of about this colour are: column and row, or None."""
    rows, columns = np.nonzero(np.abs(picture - np.array(colour)).max(axis=2) < 25)
    return (columns.mean(), rows.mean()) if len(rows) > 10 else None


@pytest.mark.slow
def test_the_objects_move_as_the_simulator_says():
    found = frames(movie(simulated(), "title"))
    assert len(found) == 21
    orange, blue = ([middle_of(picture, colour) for _, picture in found] for colour in (ORANGE, BLUE))
    scale = (blue[0][0] - orange[0][0]) / 10  # pixels per metre, from the distance at first
    assert orange[20][0] - orange[0][0] == pytest.approx(6 * scale, abs=scale / 5)
    assert blue[20][0] - blue[0][0] == pytest.approx(-2 * scale, abs=scale / 5)
    assert orange[0][1] - blue[0][1] == pytest.approx(5 * scale, abs=scale / 5)  # north is up


@pytest.mark.parametrize(
    ("steps", "timestep", "shown", "duration"),
    [(20, 0.1, 21, 100), (7, 1.0, 8, 1000), (100, 0.01, 26, 40), (3, 0.04, 4, 40), (101, 0.01, 27, 40), (0, 0.1, 1, 1000), (2, 1e6, 3, 655_350)],
)
def test_frames_take_as_long_as_the_time_steps_and_the_last_a_second(steps, timestep, shown, duration):
    found = frames_of(simulated(steps, timestep))
    assert len(found) == shown
    assert found[0].duration == duration
    assert (found[-1].step, found[-1].duration) == (steps, 1000)
    if timestep < 100:
        assert sum(frame.duration for frame in found) == pytest.approx(1000 + 1000 * steps * timestep, abs=11)


def test_long_simulations_have_fewer_frames():
    found = frames_of(simulated(5000))
    assert len(found) <= MOST_FRAMES
    assert sum(frame.duration for frame in found) == 501_000


def test_objects_made_on_the_way_appear_when_they_exist():
    text = (
        "scenario Sub():\n    setup:\n        Object at (10, 5)\n        terminate when simulation.currentTime > 10\n"
        "scenario Main():\n    setup:\n        ego = Object at (0, 0), with velocity (1, 0), with viewDistance 100\n"
        "    compose:\n        wait\n        wait\n        wait\n        do Sub()\n"
    )
    simulation = simulated(8, text=text)
    assert [len(moment.objects) for moment in simulation.moments] == [1, 1, 1, 2, 2, 2, 2, 2, 2]
    assert [middle_of(picture, BLUE) is not None for _, picture in frames(movie(simulation, ""))] == [False] * 3 + [True] * 6


def test_coordinates_that_no_picture_can_show_are_an_error():
    with pytest.raises(UsageError, match="cannot be drawn"):
        movie(simulated(y=1e10, text="ego = Object at (0, 0), with velocity (0, {y})"), "")


@pytest.mark.slow
def test_two_hundred_steps_of_ten_objects_take_less_than_about_15_seconds_of_a_processor(effort):
    text = "ego = Object at (0, 0), with velocity (1, 0)\n" + "".join(f"Object at (0, {3 * k}), with velocity ({k}, 0)\n" for k in range(1, 10))
    simulation = simulated(200, text=text)
    shown: list[object] = []
    assert effort(lambda: shown.extend(frames(movie(simulation, "many")))) < 150
    assert len(shown) == 201


def test_the_command_writes_the_first_simulation_and_says_so(ask, tmp_path):
    (tmp_path / "p.scenic").write_text(MOVING.replace("{y}", "Range(5, 8)"))
    many = ask("simulate", "p.scenic", "--simulator", "kinematic", "--steps", 5, "-n", 3, "-o", "runs.jsonl", "--gif", "many.gif")
    one = ask("simulate", "p.scenic", "--simulator", "kinematic", "--steps", 5, "-o", "run.jsonl", "--gif", "one.gif")
    assert (many.code, one.code) == (0, 0)
    assert "many.gif shows the first simulation" in many.err
    assert "shows" not in one.err
    assert (tmp_path / "many.gif").read_bytes() == (tmp_path / "one.gif").read_bytes()
    again = ask("simulate", "p.scenic", "--simulator", "kinematic", "--replay", "run.jsonl", "-o", "again.jsonl", "--gif", "again.gif")
    assert again.code == 0
    assert (tmp_path / "again.gif").read_bytes() == (tmp_path / "one.gif").read_bytes()
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--gif", "p.scenic"), "is the program itself"),
        (("--gif", "nowhere/a.gif"), "there is no directory"),
        (("--gif", "a.gif", "-o", "a.gif"), "-o a.gif: simulations are written as .jsonl"),
        (("--gif", "a.html", "--html", "a.html"), "a.html is the page"),
    ],
)
def test_wrong_places_are_found_first(ask, tmp_path, arguments, message):
    (tmp_path / "p.scenic").write_text(MOVING.replace("{y}", "5"))
    done = ask("simulate", "p.scenic", *arguments)
    assert (done.code, done.out) == (2, "")
    assert message in done.err
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("option", ["-o", "--html", "--gif"])
def test_a_full_disk_is_a_clear_error(ask, tmp_path, option):
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    (tmp_path / "p.scenic").write_text(MOVING.replace("{y}", "5"))
    done = ask("simulate", "p.scenic", "--steps", 2, *(() if option == "-o" else ("-o", "runs.jsonl")), option, "/dev/full")
    assert done.code == 2
    assert "/dev/full cannot be written: No space left on device" in done.err
    assert stat.S_ISCHR(Path("/dev/full").stat().st_mode)
    assert not list(Path("/dev").glob(".full*"))


@pytest.mark.slow
def test_an_interrupt_leaves_whole_simulations_and_says_how_many(tmp_path, start):
    (tmp_path / "p.scenic").write_text(MOVING.replace("{y}", "Range(5, 8)"))
    command = [sys.executable, "-m", "scenic_ref", "simulate", "p.scenic", "-n", "1000000", "--steps", "20", "-o", "runs.jsonl", "--gif", "run.gif"]
    path = tmp_path / "runs.jsonl"
    with start(command) as process:
        process.until(lambda: path.exists() and path.read_bytes().count(b"\n") >= 3)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
    assert (process.returncode, out) == (130, "")
    *report, last = err.splitlines()
    assert report[0].split(" of seed")[0].endswith("simulations")
    assert report[-1] == "run.gif shows the first simulation"
    data = path.read_bytes()
    assert data.endswith(b"\n")
    runs = [json.loads(line)["run"] for line in data.splitlines()]
    assert runs == list(range(len(runs)))
    assert len(runs) - 1 <= int(last.split("; ")[1].split(" ")[0].replace(",", "")) <= len(runs)  # a signal may come between writing and counting
    assert "written as whole lines" in last
    assert (tmp_path / "run.gif").read_bytes().startswith(b"GIF8")
