"""`scenic-ref map`: what is in a map, its picture, its faults, and maps that it makes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest


def test_a_map_is_made_and_told_about(ask, tmp_path: Path) -> None:
    made = ask("map", "--make", "crossing", "-p", "lanes=2", "-p", "signals=True", "x.xodr")
    assert (made.code, made.err) == (0, "")
    assert made.out.startswith("roads          4, with 32 lanes")
    told = json.loads(ask("map", "x.xodr", "--json").out)
    assert {name: told[name] for name in ("roads", "lanes", "lane_sections", "intersections", "four_way", "signals", "warnings")} == {
        "roads": 4, "lanes": 32, "lane_sections": 32, "intersections": 1, "four_way": 1, "signals": 4, "warnings": [],
    }  # fmt: skip
    assert told["maneuvers"] == {"straight": 8, "left": 4, "right": 4, "u_turn": 0, "merge": 0}
    assert told["bounds"] == [-80.0, -80.0, 80.0, 80.0]
    assert ask("map", "--make", "crossing", "-p", "lanes=2", "-p", "signals=True", "-").out == (tmp_path / "x.xodr").read_text()


def test_without_a_file_the_parameters_are_listed(ask) -> None:
    told = ask("map", "--make", "t")
    assert told.code == 0
    assert told.out.splitlines()[0] == "t: one junction of a street from West to East and one from the South"
    assert any(line.split()[:2] == ["radius", "6.0"] for line in told.out.splitlines())


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_picture(ask, tmp_path: Path, ending: str) -> None:
    picture = tmp_path / f"map.{ending}"
    assert ask("map", "--make", "t", "-p", "signals=True", "-p", "crosswalks=True", "-p", "bike_lanes=True", "x.xodr", "--plot", picture).code == 0
    assert picture.stat().st_size > 5000


def test_faults_are_found(ask, tmp_path: Path) -> None:
    assert ask("map", "--make", "t", "x.xodr", "--check").out.endswith("no faults were found\n")
    text = (tmp_path / "x.xodr").read_text()
    begin = text.index('<geometry s="0"', text.index('<road name="road 1"'))
    place = text.index('x="', begin) + 3
    end = text.index('"', place)
    (tmp_path / "y.xodr").write_text(f"{text[:place]}{float(text[place:end]) + 0.3}{text[end:]}")
    told = ask("map", "y.xodr", "--check", "--json")
    assert told.code == 1
    faults = json.loads(told.out)["faults"]
    assert sum("gap of 0.300 m" in fault for fault in faults) >= 4
    assert not [fault for fault in faults if fault.startswith("joints of lanes")]  # they are told one by one


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["map"], "which map? Name a file, or make one with --make"),
        (["map", "ok.scenic"], "ok.scenic is no usable OpenDRIVE map: line 1: it is no XML"),
        (["map", "none.xodr"], "the map none.xodr cannot be read: No such file or directory"),
        (["map", "--make", "blob"], "there is no kind of map 'blob': there are grid, crossing, t, roundabout, highway, suburb"),
        (["map", "--make", "t", "-p", "lanes=many", "x.xodr"], "lanes must be a whole number, not 'many'"),
        (["map", "--make", "t", "-p", "lane=1", "x.xodr"], "maps of the kind t have no parameter 'lane'"),
        (["map", "ok.scenic", "-p", "lanes=1"], "-p gives parameters of --make"),
        (["map", "--make", "t", "x.xodr", "--plot", "x.gif"], "--plot x.gif: pictures are written as .png, .pdf or .svg"),
        (["map", "--make", "t", "no/x.xodr"], "no/x.xodr cannot be written: there is no directory no"),
    ],
)
def test_wrong_usage_is_said(ask, arguments: list[str], message: str) -> None:
    told = ask(*arguments)
    assert (told.code, told.out) == (2, "")
    assert message in told.err
