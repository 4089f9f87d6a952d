"""`Network.fromFile` in programs: a map beside the program's own, read before it runs."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.cli import run_command_line
from scenic_ref.errors import UncaughtException
from scenic_ref.roads.map_generator import generate_map

PROGRAM = """from scenic.domains.driving.roads import Network
town = Network.fromFile(localPath('maps/town.xodr'), useCache=False, ref_points=40)
lane = Uniform(*town.lanes)
ego = Object on lane, with regionContainedIn town.drivableRegion
param crossings = len(town.intersections), same = town is Network.fromFile(localPath('maps/town.xodr')), network = isinstance(town, Network)
"""
MODEL = """param map = localPath('maps/town.xodr')
model scenic.domains.driving.model
again = Network.fromFile(globalParameters.map)
ego = Car on again.lanes[0]
param same = again is network, network = isinstance(network, Network)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "town.xodr").write_text(generate_map("crossing"))
    (tmp_path / "maps" / "broken.xodr").write_text("<")
    (tmp_path / "town.scenic").write_text(PROGRAM)
    (tmp_path / "model.scenic").write_text(MODEL)
    return tmp_path


def test_the_path_is_seen_from_the_program(folder: Path) -> None:
    program = scenic_ref.load(folder / "town.scenic")
    one_by_one, many = (list(program.sample_many(12, backend=backend)) for backend in ("interpreter", "batch"))
    assert [s.to_json() for s in one_by_one] == [s.to_json() for s in many]
    assert one_by_one[0].params == {"crossings": 1, "same": True, "network": True}
    assert scenic_ref.loads(PROGRAM, directory=folder).sample().params["same"] is True


def test_the_map_of_the_program_can_be_read_again(folder: Path) -> None:
    for given in ({}, {"map": str(folder / "maps/town.xodr")}):
        params = scenic_ref.load(folder / "model.scenic", params=given).sample().params
        assert (params["same"], params["network"]) == (True, True)


def test_the_command_reads_it_before_files_are_closed_to_the_program(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder.parent)
    for name in ("town", "model"):
        assert run_command_line(["run", os.path.join(folder.name, f"{name}.scenic"), "-n", "3", "-o", f"{name}.jsonl"]) == 0


WRONG = {
    "not there": ("localPath('maps/none.xodr')", r"there is no map .*none\.xodr"),
    "broken": ("localPath('maps/broken.xodr')", r"broken\.xodr is no usable OpenDRIVE map: line 1: it is no XML"),
    "no OpenDRIVE": ("localPath('maps/town.net')", r"the map of a program is an OpenDRIVE file \(\.xodr\), not town\.net"),
    "computed": ("localPath('maps/' + 'town.xodr')", "maps are read before it runs"),
    "other": ("localPath('maps/town.xodr'), radius=1", "fromFile has no radius in this reference"),
    "too far": ("localPath('maps/town.xodr'), tolerance=99", "the tolerance of a map is a number of metres from 0 to 10"),
    "computed tolerance": ("localPath('maps/town.xodr'), tolerance=1 + 1", "that is written as a number: maps are read before it runs"),
    "negative": ("localPath('maps/town.xodr'), tolerance=-1", "the tolerance of a map is a number of metres from 0 to 10, not -1"),
    "in words": ("localPath('maps/town.xodr'), tolerance='wide'", "is a number of metres from 0 to 10, not 'wide'"),
    "nothing": ("3", "maps are read before it runs"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_map_is_an_error_at_the_call_that_can_be_caught(name: str, folder: Path) -> None:
    call, message = WRONG[name]
    head = "from scenic.domains.driving.roads import Network\nego = Object\n"
    with pytest.raises(UncaughtException, match=message) as told:
        scenic_ref.loads(f"{head}town = Network.fromFile({call})\n", directory=folder).sample()
    assert told.value.span.line == 3
    caught = f"{head}param ok = False\ntry:\n    town = Network.fromFile({call})\nexcept (ValueError, TypeError):\n    param ok = True\n"
    assert scenic_ref.loads(caught, directory=folder).sample().params["ok"] is True


NEAR = """{}model scenic.domains.driving.model
lane = network.lanes[0]
edge = lane.rightEdge.pointAlongBy(20)
off = Point at edge offset along lane.heading_at(edge) by 0.3 @ 0
other = {}
ego = Object
param there = network.roadAt(off) is not None, also = other.roadAt(off) is not None, metres = [network.tolerance, other.tolerance]
"""


@pytest.mark.parametrize(
    ("options", "other", "params"),
    [
        ("", "network", (False, False, [0.05, 0.05])),
        ("param map_options = {'tolerance': 0.5, 'ref_points': 40, 'fill_gaps': False}\n", "network", (True, True, [0.5, 0.5])),
        ("param map_options = dict(useCache=True, tolerance=0.5)\n", "network", (True, True, [0.5, 0.5])),
        ("", "Network.fromFile(localPath('maps/bare.xodr'), tolerance=0.5)", (False, True, [0.05, 0.5])),
        ("", "Network.fromOpenDrive(localPath('maps/bare.xodr'), 20, tolerance=0.5, elide_short_roads=True)", (False, True, [0.05, 0.5])),
        ("param map_options = {'tolerance': 0.5}\n", "Network.fromFile(globalParameters.map)", (True, True, [0.5, 0.5])),
    ],
)
def test_the_tolerance_of_a_map_is_given_by_its_options(options: str, other: str, params: tuple[object, ...], folder: Path) -> None:
    (folder / "maps" / "bare.xodr").write_text(generate_map("crossing"))
    text = NEAR.format(f"param map = localPath('maps/bare.xodr')\n{options}", other)
    found = scenic_ref.loads(text, directory=folder).sample().params
    assert (found["there"], found["also"], found["metres"]) == params


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("{'tolerence': 1}", "there is no map option 'tolerence'"), ("{'tolerance': 'wide'}", "is a number of metres from 0 to 10"),
        ("{'tolerance': True}", "is a number of metres"), ("{'tolerance': -1}", "from 0 to 10, not -1"),
        ("{'tolerance': 2 + 3}", "must be a dictionary of texts and constants"), ("[3]", "must be a dictionary"),
    ],
)  # fmt: skip
def test_map_options_that_mean_nothing_are_refused(options: str, message: str) -> None:
    with pytest.raises(scenic_ref.errors.ScenicError, match=message) as told:
        scenic_ref.loads(f"x = 3\nparam map_options = {options}\nmodel scenic.domains.driving.model\nego = Car\n").sample()
    assert (told.value.span.file, told.value.span.line) == ("<string>", 2)
    if "tolerence" in options:
        assert "tolerance" in told.value.hint


def test_map_options_from_outside_are_refused_where_the_program_names_its_model() -> None:
    with pytest.raises(scenic_ref.errors.ScenicError, match="not 'wide'") as told:
        scenic_ref.loads("x = 3\nmodel scenic.domains.driving.model\n", params={"map_options": {"tolerance": "wide"}}).sample()
    assert (told.value.span.file, told.value.span.line) == ("<string>", 2)


@pytest.mark.parametrize("call", ["Network.fromPickle('a.snet')", "network.dumpPickle('a.snet', 1, 2)"])
def test_pickles_are_refused_with_what_to_do_instead(call: str) -> None:
    text = f"model scenic.domains.driving.model\nego = Car\nx = {call}\n"
    with pytest.raises(UncaughtException, match=r"may run whatever is in it.*Network\.fromFile reads an OpenDRIVE file"):
        scenic_ref.loads(text).sample()


def test_the_type_of_a_maneuver_can_be_asked_for_by_its_lanes() -> None:
    text = """model scenic.domains.driving.model
ego = Car
ways = [m for i in network.intersections for m in i.maneuvers]
param same = all([ManeuverType.guessTypeFromLanes(m.startLane, m.endLane, m.connectingLane) is m.type for m in ways])
m = [m for m in ways if m.type is ManeuverType.LEFT_TURN][0]
param wide = ManeuverType.guessTypeFromLanes(m.startLane, m.endLane, m.connectingLane, turnThreshold=3).name
param merge = ManeuverType.guessTypeFromLanes(m.startLane, m.endLane, None).name
network.show(labelIncomingLanes=True, showCurbArrows=True)
"""
    assert scenic_ref.loads(text).sample().params == {"same": True, "wide": "STRAIGHT", "merge": "STRAIGHT"}
    with pytest.raises(UncaughtException, match="takes lanes"):
        scenic_ref.loads(f"{text}x = ManeuverType.guessTypeFromLanes(3, 4, None)\n").sample()


def test_a_network_is_made_by_reading() -> None:
    with pytest.raises(UncaughtException, match="a Network is made by reading a map"):
        scenic_ref.loads("from scenic.domains.driving.roads import Network\nego = Object\nx = Network()\n").sample()
