"""Which lanes lead to which, and which are beside which, is what `ad_map_access` says, a reader that shares no code with ours or the release.

It leaves out lanes of ramps (`entry`, `exit`, `onRamp`, `offRamp`), on which cars drive in the standard (ASAM OpenDRIVE, "Lane type").
"""

from __future__ import annotations

import json
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import pytest
from scenic_ref.conformance.implementations.environments import MADE, Release, make
from scenic_ref.interpreter.runtime.cache_folders import cache_place
from scenic_ref.roads import read_map
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.network import Lane, LaneSection, Network
from scenic_ref.semantics.store.errors import UsageError

from .test_network_in_release import MAPS

SCRIPT = Path(__file__).parent / "contacts.py"
PACKAGE = Release("", (("ad_map_access==3.0.0",),))
Place = tuple[str, int, int]
"""A road, the number of one of its sections, and the number of a lane."""
Contacts = dict[Place, dict[str, set[Place]]]


def python() -> Path:
    """The Python of an environment with `ad_map_access`, which is made once."""
    folder = cache_place() / "ad_map_access-3.0.0"
    if not (folder / MADE).exists():
        try:
            make(folder, Path("bin", "python"), PACKAGE, print)
        except UsageError as problem:
            pytest.skip(f"this system has no environment of ad_map_access: {problem}")
    return folder / "bin" / "python"


def of_ours(network: Network) -> Contacts:
    """What our network says."""
    number = {section: i for road in network.allRoads for i, part in enumerate(road.sections) for section in part.lanes}

    def place(section: LaneSection) -> Place:
        return str(section.road.id), number[section], section.openDriveID

    ends: dict[Lane, list[Lane]] = {}
    for way in (way for crossing in network.intersections for way in crossing.maneuvers if way.connectingLane is not None):
        ends.setdefault(way.connectingLane, []).append(way.endLane)
    found: Contacts = {}
    for lane in network.lanes:
        ways = [way.connectingLane or way.endLane for way in lane.maneuvers] + ends.get(lane, [])
        after = [{place(section)} for section in lane.sections[1:]] + [{place(way.sections[0]) for way in ways}]
        for section, following in zip(lane.sections, after, strict=True):
            sides = {"left": section._laneToLeft, "right": section._laneToRight}
            found[place(section)] = {"next": following, **{side: set() if s is None else {place(s)} for side, s in sides.items()}}
    for one in found:
        found[one]["before"] = {other for other in found if one in found[other]["next"]}
    return found


def of_theirs(told: dict[str, dict[str, object]]) -> Contacts:
    """What the other reader says of lanes on which cars drive, in the direction of traffic; sides only on the same road, as it gives others too."""
    place = {id: (str(int(id) // 10000), int(id) // 100 % 100 - 1, int(id) % 100 - 50) for id in told}
    drivable = {id for id, lane in told.items() if lane["type"] in ("NORMAL", "INTERSECTION")}
    found: Contacts = {}
    for id in drivable:
        towards: dict[str, set[Place]] = {name: set() for name in ("SUCCESSOR", "PREDECESSOR", "LEFT", "RIGHT", "OVERLAP")}
        for where, other in told[id]["contacts"]:  # type: ignore[attr-defined]
            if other in drivable and (where in ("SUCCESSOR", "PREDECESSOR") or place[other][0] == place[id][0]):
                towards[where].add(place[other])
        names = ("SUCCESSOR", "PREDECESSOR", "LEFT", "RIGHT") if not told[id]["reversed"] else ("PREDECESSOR", "SUCCESSOR", "RIGHT", "LEFT")
        found[place[id]] = dict(zip(("next", "before", "left", "right"), (towards[name] for name in names), strict=True))
    return found


def types(path: Path) -> dict[Place, str]:
    """What the file says that each lane is for."""
    sections = {(road.get("id"), i): part for road in ET.parse(path).iter("road") for i, part in enumerate(road.iter("laneSection"))}
    return {(str(road), i, int(lane.get("id", ""))): str(lane.get("type")) for (road, i), part in sections.items() for lane in part.iter("lane")}


def compared(paths: list[Path]) -> Iterator[tuple[Path, Contacts, Contacts]]:
    """For each map what ours says of the lanes that the other reader has, and what that says."""
    run = subprocess.run([python(), SCRIPT, *paths], capture_output=True, text=True, check=True)
    told = json.loads(run.stdout.splitlines()[-1])
    for path in paths:
        ramps = {lane for lane, type in types(path).items() if type in ("entry", "exit", "onRamp", "offRamp")}
        ours, theirs = of_ours(read_map(path)), of_theirs(told[str(path)])
        assert not ramps & theirs.keys()
        yield path, {lane: {where: there - ramps for where, there in of.items()} for lane, of in ours.items() if lane not in ramps}, theirs


@pytest.mark.slow
@pytest.mark.skipif(sys.version_info[:2] != (3, 11), reason="this system has no environment of ad_map_access: it is for Python 3.11")
def test_the_lanes_meet_as_another_reader_says(tmp_path: Path):
    paths = [tmp_path / f"{number}.xodr" for number in range(len(MAPS))]
    for path, (kind, parameters) in zip(paths, MAPS, strict=True):
        path.write_text(generate_map(kind, **parameters))
    lanes = 0
    for _, ours, theirs in compared(paths):
        assert ours == theirs
        lanes += len(theirs)
    assert lanes > 1000
