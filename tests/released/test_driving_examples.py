"""The programs of `examples/driving` in the dialects of the releases: they compile, have the releases' scenes, and run as long as there.

They are written in `scenic-3`, in the style of the programs that come with the releases, and converted for 2.1. What the releases said of them, on
our default map, was written by `record_driving.py`: scenes, and how a simulation of 100 time steps in their Newtonian simulator ended.
"""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import scenic_ref
from scenic_ref.inference.comparison.exact_laws import DEFAULT_ALPHA
from scenic_ref.interpreter.language.conversion import convert
from scenic_ref.interpreter.language.modules import library_of
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.simulators.worlds import WORLDS
from scipy.stats import ks_2samp

HERE = Path(__file__).parent
PROGRAMS = sorted((HERE.parent.parent / "examples" / "driving").glob("*.scenic"))
SCENES = 60
"""Scenes of the releases, for each program."""
OURS = 400
STEPS = 100
ENDS = {
    "timeLimit": "time limit", "scenarioComplete": "terminated", "terminatedByMonitor": "terminated", "simulationTerminationCondition": "terminated",
}  # fmt: skip
"""How the releases call what ends a simulation."""
DIALECTS = ("scenic-3", "scenic-2.1")


def in_dialect(program: Path, dialect: str) -> str:
    """The text of a program in a dialect."""
    text = program.read_text(encoding="utf-8")
    if dialect == "scenic-3":
        return text
    read = parse(text, str(program), "scenic-3")
    return convert(read, dialect, library_of(read, worlds=WORLDS, model=None, trust=False, directory=program.parent, dialect="scenic-3"))


@cache
def recorded(dialect: str) -> dict[str, Any]:
    """What the release said."""
    return json.loads((HERE / f"driving-{dialect}.json").read_text(encoding="utf-8"))


def features(x: float, y: float, heading: float) -> tuple[float, ...]:
    """The place and the direction of an object; rounded, since the release draws curves with fewer points."""
    return round(x, 1), round(y, 1), round(math.sin(heading), 1), round(math.cos(heading), 1)


def least_p_value(ours: list[list[list[float]]], theirs: list[list[list[float]]]) -> float:
    """The least p-value of two-sample Kolmogorov-Smirnov tests of the features of each object, times their number."""
    assert {len(scene) for scene in ours} == {len(scene) for scene in theirs}
    samples = [[[features(*o) for o in scene] for scene in scenes] for scenes in (ours, theirs)]
    values = [
        float(ks_2samp(*([scene[o][i] for scene in scenes] for scenes in samples)).pvalue) for o in range(len(ours[0])) for i in range(4)
    ]  # fmt: skip
    return min(1.0, min(values) * len(values))


def compared(program: Path, dialect: str, theirs: dict[str, Any], road_map: str | None = None) -> dict[str, object]:
    """Our verdict on a program beside the release's, the evidence that scenes differ, and both ends of a simulation."""
    params = {} if road_map is None else {"map": road_map}
    try:
        scenario = scenic_ref.loads(in_dialect(program, dialect), dialect=dialect, profile=dialect, params=params)
        scenes = list(scenario.sample_many(OURS, seed=0, max_attempts=20_000))
        run = scenario.simulate("kinematic", STEPS, 0, max_attempts=1000).simulation
    except AttemptsExhausted as problem:
        return {"ours": f"no scene: {problem}"[:120], "theirs": theirs["verdict"], "message": theirs.get("message", "")}
    found: dict[str, object] = {"ours": "ok", "theirs": theirs["verdict"], "end": (run.result, len(run.moments) - 1)}
    if theirs["verdict"] == "ok":
        drawn = [[[o.position[0], o.position[1], o.heading] for o in scene.objects] for scene in scenes]
        found |= {"p": least_p_value(drawn, theirs["objects"]), "end there": (ENDS[theirs["end"]], theirs["steps"])}
    return found | ({"message": theirs["message"]} if "message" in theirs else {})


EXPLAINED: dict[tuple[str, str], str] = {
    ("scenic-2.1", "pedestrian_crossing"): "withinDistanceToAnyPedestrians' is not defined",
    ("scenic-2.1", "badly_parked_car"): "scenes",  # its roadDirection is 0 on shoulders, that of 3.1.1 and ours is the traffic's
}
"""What the releases do otherwise, by dialect and program: a part of what they say of it, or "scenes" where theirs have another distribution."""
ALPHA = DEFAULT_ALPHA / 100
"""The risk of a false alarm for each program in each dialect; a rival with another lane half of the time is noticed (the second test)."""


QUICK = ("composed", "follow_trajectory", "lane_ends_of_maneuver")
CASES = [pytest.param(p, marks=() if p.stem in QUICK else pytest.mark.slow, id=p.stem) for p in PROGRAMS]


@pytest.mark.slow
@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("program", CASES)
def test_the_program_is_there_what_it_is_here(program: Path, dialect: str):
    result = compared(program, dialect, recorded(dialect)[program.stem])
    explained = EXPLAINED.get((dialect, program.stem))
    assert result["ours"] == "ok"
    if result["theirs"] != "ok":
        assert explained is not None
        assert explained in str(result["message"])
        return
    assert (result["p"] < ALPHA) is (explained == "scenes")  # type: ignore[operator]
    assert result["end"][0] == result["end there"][0]  # type: ignore[index]


def test_the_comparison_of_scenes_notices_other_lanes():
    theirs = recorded("scenic-3")["follow_trajectory"]["objects"]
    text = next(p for p in PROGRAMS if p.stem == "follow_trajectory").read_text(encoding="utf-8")
    wrong = text.replace("Uniform(*network.intersections)", "Uniform(network.intersections[0], *network.intersections[:2])")
    scenes = scenic_ref.loads(wrong, dialect="scenic-3", profile="scenic-3").sample_many(OURS, seed=0)
    assert least_p_value([[[o.position[0], o.position[1], o.heading] for o in scene.objects] for scene in scenes], theirs) < ALPHA
