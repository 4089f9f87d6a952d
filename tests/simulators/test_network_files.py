"""`Network.fromFile` in programs: a map beside the program's own, read before it runs."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.cli import answer
from scenic_ref.errors import UncaughtException
from scenic_ref.maps.making import made

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
    (tmp_path / "maps" / "town.xodr").write_text(made("crossing"))
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
        assert answer(["run", os.path.join(folder.name, f"{name}.scenic"), "-n", "3", "-o", f"{name}.jsonl"]) == 0


WRONG = {
    "not there": ("localPath('maps/none.xodr')", r"none\.xodr cannot be read: No such file or directory"),
    "broken": ("localPath('maps/broken.xodr')", r"broken\.xodr is no usable OpenDRIVE map: line 1: it is no XML"),
    "no OpenDRIVE": ("localPath('maps/town.net')", r"the map of a program is an OpenDRIVE file \(\.xodr\), not town\.net"),
    "computed": ("localPath('maps/' + 'town.xodr')", "maps are read before it runs"),
    "other": ("localPath('maps/town.xodr'), tolerance=1", "fromFile has no tolerance in this reference"),
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


def test_a_network_is_made_by_reading() -> None:
    with pytest.raises(UncaughtException, match="a Network is made by reading a map"):
        scenic_ref.loads("from scenic.domains.driving.roads import Network\nego = Object\nx = Network()\n").sample()
