"""The network that is read from a map is that of the released implementation, but for what `EXPLAINED` lists.

Not compared: traffic on the left (the release reads `rule="LHT"` as traffic on the right), speed limits, bike lanes and positions of signals,
which the release does not have.
"""

from __future__ import annotations

import ast
import json
import os
import random
import subprocess
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from scenic_ref.roads import read_map
from scenic_ref.roads.map_generator import generate_map
from scenic_ref.roads.map_summary import faults

from . import described
from .comparing import Described, Difference, differences, of_ours, points_of
from .test_making import ALL, BARE
from .test_making_in_release import PYTHON

SMALL = {"rows": 2, "columns": 2}
WALKED = {"sidewalks": True, "shoulders": True, "signals": True}
MAPS: list[tuple[str, dict[str, float]]] = [
    ("grid", SMALL), ("grid", {**ALL, "rows": 1, "columns": 2}), ("grid", {**WALKED, **SMALL, "one_way": True}),
    ("grid", {**BARE, **SMALL, "lanes": 3, "block": 120.0}), ("grid", {**BARE, **SMALL, "lanes": 2, "one_way": True}),
    ("crossing", {}), ("crossing", {**ALL, "lanes": 2}), ("crossing", {**WALKED, "lanes": 3}), ("crossing", {"lanes": 4}),
    ("crossing", {"legs": 3, "lanes": 2}), ("crossing", {**ALL, "legs": 3}), ("crossing", {**BARE, "radius": 1.0}),
    ("t", {}), ("t", {**ALL, "lanes": 2}), ("t", {"lanes": 3, "shoulders": True}), ("t", {**BARE, "lanes": 4}),
    ("t", {**BARE, "lane_width": 3.1, "radius": 15.0}),
    ("roundabout", {}), ("roundabout", ALL), ("roundabout", {**WALKED, "lanes": 2, "island": 30.0}),
    ("roundabout", {**BARE, "legs": 3, "lanes": 3, "island": 30.0}),
    ("highway", {}), ("highway", {"lanes": 1, "shoulders": False}), ("highway", {"lanes": 3}), ("highway", {"lanes": 4, "shoulders": False}),
    ("suburb", SMALL), ("suburb", {**SMALL, "seed": 1}), ("suburb", {**WALKED, **SMALL, "seed": 2}),
    ("suburb", {**BARE, "seed": 3, "rows": 3, "columns": 2}),
    ("suburb", {**ALL, **SMALL, "seed": 9, "lanes": 2, "block": 130.0}),
]  # fmt: skip
REF_POINTS = 200
"""Into how many points the release takes each piece of a reference line apart. It sets edges across the chord to the next point, so that
those far from a curved reference line end decimetres too early or too late with its default of 20."""
LINES = ("centerline", "leftEdge", "rightEdge", "curb")
LIMITS = {**dict.fromkeys(LINES, 0.05), "outline": 0.01, "roadDirection": 0.04, "nominalDirectionsAt": 0.04}
"""Metres, parts of an area and radians that count as the same; other areas may differ by `AREA`."""
AREA = 0.01


@dataclass(frozen=True)
class Explained:
    """Something that the release says differently: of what kinds of elements, what, when, and why ours stays as it is."""

    kinds: tuple[str, ...]
    what: tuple[str, ...]
    when: Callable[[Difference, Described], bool]
    reason: str

    def of(self, difference: Difference, ours: Described) -> bool:
        return difference.kind in self.kinds and difference.what in self.what and self.when(difference, ours)


def lanes_of_groups(difference: Difference, ours: Described) -> int:
    """How many lanes the group that a difference is about has, or the larger group of the road."""
    about = ours[difference.element]
    groups = about.get("laneGroups", [difference.element])
    return max(len(ours[group]["lanes"]) for group in groups)


def one_of_several(difference: Difference, ours: Described) -> bool:
    """Whether a lane has several ways on, and the release names one of them as what comes next."""
    lane = ours[difference.element].get("lane", difference.element)
    ways = [over for _, _, over, _ in ours[lane]["maneuvers"]]
    return len(ways) > 1 and difference.theirs.replace("section", "from section" if lane != difference.element else "section") in ways


def only_where_they_end_together(difference: Difference, ours: Described) -> bool:
    """Whether the release misses only maneuvers into the same lane."""
    end = ast.literal_eval(difference.element.split(" ", 2)[2])[3]
    missed = [way for way in difference.ours if way not in difference.theirs]
    return len(difference.ours) == len(difference.theirs) + len(missed) and all(way[3] == end for way in missed)


EXPLAINED = [
    Explained(("network",), ("crossings", "walkable area"), lambda d, _: d.ours > d.theirs, "the release makes no crosswalks"),
    Explained(("network",), ("sidewalks", "shoulders", "sidewalk area", "shoulder area"), lambda d, _: d.ours > d.theirs,
        "the release has sidewalks and shoulders only on a side with lanes: none in the corners where a road of the junction has but a sidewalk"),
    Explained(("road",), ("sidewalks",), lambda d, _: set(d.ours) > set(d.theirs), "the same: yet a road's are documented as all sidewalks of it"),
    Explained(("place",), ("elementAt", "sidewalkAt", "shoulderAt"), lambda d, _: "more of" in d.ours and d.theirs is None,
        "the same: nothing is at a point there"),
    Explained(("group",), ("lanes",), lambda d, _: d.element.endswith("backward") and sorted(d.ours) == sorted(d.theirs),
        "against the direction of the road the release begins at its middle, though lane 0 is documented as the one closest to the curb"),
    Explained(("group",), ("lanes",), lambda d, _: sorted(d.ours) == sorted(d.theirs) and not all("from section 0" in lane for lane in d.ours),
        "the release puts a lane that begins along the road last, wherever it is"),
    Explained(("group",), ("centerline",), lambda d, ours: lanes_of_groups(d, ours) > 1,
        "that of one of the lanes in the release ('rather arbitrary')"),
    Explained(("group",), ("has a bike lane",), lambda d, _: d.ours, "the release has no bike lanes"),
    Explained(("group",), ("curb",), lambda d, ours: ours[d.element]["has a bike lane"], "the same: it has the curb at their inner edge"),
    Explained(("group", "road"), ("leftEdge", "rightEdge", "curb"), lambda d, ours: lanes_of_groups(d, ours) >= 3,
        "the release looks one lane aside from an innermost lane, which is no edge of three; nor are edges followed where lanes begin or end"),
    Explained(("shoulder",), LINES, lambda d, ours: len(ours[d.element.rsplit(" ", 2)[0]]["sections"]) > 1,
        "the release joins a road's shoulders by the number of their lane, which changes where a lane begins or ends beside them"),
    Explained(("sidewalk",), ("area",), lambda d, _: d.theirs > d.ours and (d.amount or 0.0) < 0.015,
        "the ends of the release's pieces are askew where they bend: by 3.6 % of a small corner with 50 points, 1.2 % with 200"),
    Explained(("section",), ("direction of leftEdge", "direction of rightEdge"), lambda d, _: True,
        "the road's own in the release, though edges are documented as directed along the traffic near them, as it does for roads"),
    Explained(("lane", "lane section", "group"), ("predecessor",), lambda d, _: d.ours is not None and d.theirs is None,
        "the release links lanes and groups that come out of an intersection in one direction only"),
    Explained(("lane", "lane section"), ("successor",), one_of_several, "of several ways on the release names the last one, ours the straightest"),
    Explained(("intersection",), ("conflictingManeuvers",), only_where_they_end_together,
        "where two lanes end in the same point it depends on rounding in the release whether their middles intersect"),
]  # fmt: skip


def significant(difference: Difference) -> bool:
    """Whether a difference is more than how curves are drawn."""
    return difference.amount is None or difference.amount > LIMITS.get(difference.what, AREA)


def of_release(asked: dict[str, dict[str, object]], folder: Path) -> dict[str, Described]:
    """What the release says of maps, in its environment; the questions are left in the folder."""
    (folder / "asked.json").write_text(json.dumps(asked))
    command, env = [PYTHON, described.__file__, folder / "asked.json"], {**os.environ, "MPLCONFIGDIR": str(folder)}
    run = subprocess.run(command, capture_output=True, text=True, env=env, check=False)
    assert run.returncode == 0, run.stderr
    return {name: found for line in run.stdout.splitlines() for name, found in json.loads(line).items()}


@pytest.mark.slow
def test_networks_are_those_of_the_release_but_for_what_is_explained(tmp_path: Path):
    if not PYTHON.exists():
        pytest.skip("this system has no environment of scenic 3.1.1")
    draw = random.Random(0)
    ours: dict[str, Described] = {}
    asked: dict[str, dict[str, object]] = {}
    for number, (kind, parameters) in enumerate(MAPS):
        path = tmp_path / f"{number}.xodr"
        path.write_text(generate_map(kind, **parameters))
        network = read_map(path)
        assert list(faults(network)) == []
        lanes, anywhere = points_of(network, draw)
        ours[path.stem] = of_ours(network, lanes, anywhere)
        asked[path.stem] = {"path": str(path), "lanes": lanes, "anywhere": anywhere, "ref_points": REF_POINTS}
    theirs = of_release(asked, tmp_path)
    unexplained: list[tuple[object, Difference]] = []
    used = Counter[str]()
    for name, mine in ours.items():
        for difference in filter(significant, differences(mine, theirs[name])):
            reason = next((one.reason for one in EXPLAINED if one.of(difference, mine)), None)
            if reason is None:
                unexplained.append((MAPS[int(name)], difference))
            else:
                used[reason] += 1
    kinds = sorted({(difference.kind, difference.what) for _, difference in unexplained})
    assert not unexplained, f"{kinds}: {len(unexplained)} differences, of them {unexplained[:5]}"
    assert {one.reason for one in EXPLAINED} == used.keys(), "explanations of what is no longer different"
