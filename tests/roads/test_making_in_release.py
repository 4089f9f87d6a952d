"""Maps that are made are read by the released implementation as what they are. It does not know of traffic on the left: see `test_making`."""

from __future__ import annotations

import json
import math
import os
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from scenic_ref.interpreter.runtime.cache_folders import cache_place
from scenic_ref.roads.map_generator import generate_map

from .test_making import CASES
from .walked import DRIVEN, Map, ends_of

PYTHON = cache_place() / "scenic-3.1.1-python-3.11" / "bin" / "python"
RIGHT = [case for case in CASES if not case[1].get("left_hand")]
READ = """
import collections, json, sys, warnings
from scenic.domains.driving.roads import Network
warnings.simplefilter("error")
for path in sys.argv[1:]:
    network = Network.fromFile(path, useCache=False, writeCache=False)
    ways = [way for place in network.intersections for way in place.maneuvers]
    print(json.dumps({
        "roads": len(network.roads), "lanes": len(network.lanes), "intersections": len(network.intersections),
        "three": sum(place.is3Way for place in network.intersections), "four": sum(place.is4Way for place in network.intersections),
        "signalized": sum(place.isSignalized for place in network.intersections), "turns": collections.Counter(way.type.name for way in ways),
    }))
"""
TURN = math.radians(20)


def expected(read: Map, signals: bool) -> dict[str, object]:
    """What the released implementation should say of a map."""
    own = [id for id, road in read.roads.items() if road.get("junction") == "-1"]
    ways = [id for id in read.roads.keys() - own if any(lane.type in DRIVEN for lane in read.sections[id][0].values())]
    legs = Counter(len({road for junction, road, _ in read.mouths() if junction == id}) for id in read.junctions)
    lanes = sum(lane.type in DRIVEN and (section == 0 or "predecessor" not in lane.links)
                for id in (*own, *ways) for section, found in enumerate(read.sections[id]) for lane in found.values())  # fmt: skip
    turns = ["LEFT_TURN" if read.turned(id) >= TURN else "RIGHT_TURN" if read.turned(id) <= -TURN else "STRAIGHT" for id in ways]
    assert all(ends_of(read, id)[0][0] != ends_of(read, id)[1][0] for id in ways)
    return {
        "roads": len(own), "lanes": lanes, "intersections": len(read.junctions), "three": legs[3], "four": legs[4],
        "signalized": len(read.junctions) * signals, "turns": Counter(turns),
    }  # fmt: skip


@pytest.mark.slow
def test_the_release_finds_the_roads_and_turns_that_were_meant(tmp_path: Path):
    if not PYTHON.exists():
        pytest.skip("this system has no environment of scenic 3.1.1")
    texts = [generate_map(kind, **parameters) for kind, parameters in RIGHT]
    paths = [tmp_path / f"{index}.xodr" for index in range(len(texts))]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text)
    run = subprocess.run([PYTHON, "-c", READ, *paths], capture_output=True, text=True, env={**os.environ, "MPLCONFIGDIR": str(tmp_path)}, check=False)
    assert run.returncode == 0, run.stderr
    answers = [json.loads(line) for line in run.stdout.splitlines()]
    for case, text, answer in zip(RIGHT, texts, answers, strict=True):
        assert answer == expected(Map(text), bool(case[1].get("signals"))), case
