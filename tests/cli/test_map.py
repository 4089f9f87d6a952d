"""`scenic-ref map`: what is in a map, its picture, its faults, and maps that it makes."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from scenic_ref.roads.map_generator import KINDS


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


LISTED = re.compile(r"(\w+) +(\S+) +(True or False|a whole number from (\S+) to (\S+)|a number from (\S+) to (\S+))  ")


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_limits_that_are_listed_are_those_that_hold(ask, kind: str) -> None:
    """Both ends of each range are legal values of their own, what is beyond them is refused with the same words, and so is another type."""
    rows = ask("map", "--make", kind).out.splitlines()[3:]
    assert len(rows) == len(KINDS[kind].parameters)
    for row in rows:
        name, default, values, *ends = LISTED.match(row).groups()  # type: ignore[union-attr]
        parameter = KINDS[kind].parameters[name]
        assert str(parameter.default) == default
        least, most = (float(end) for end in ends if end) if any(ends) else (None, None)
        wrong = ["yes"] if least is None else [least - 1, most + 1, "many"] if "whole" not in values else [int(least) - 1, 2 * int(most), 1.5]
        for value in wrong:
            told = ask("map", "--make", kind, "-p", f"{name}={value}", "-")
            assert told.code == 2 and f"{name} must be {values}, not {value!r}" in told.err
        for value in (True, False) if least is None else (parameter.least, parameter.most):
            assert parameter.checked(name, type(parameter.default)(value)) == value


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
        (["map", "none.xodr"], "there is no map none.xodr"),
        (["map", "--make", "blob"], "there is no kind of map 'blob': there are grid, crossing, t, roundabout, highway, suburb"),
        (["map", "--make", "t", "-p", "lanes=many", "x.xodr"], "lanes must be a whole number from 1 to 4, not 'many'"),
        (["map", "--make", "t", "-p", "lane=1", "x.xodr"], "maps of the kind t have no parameter 'lane'"),
        (["map", "ok.scenic", "-p", "lanes=1"], "-p gives parameters of --make"),
        (["map", "ok.geojson", "-p", "crs=metres"], "there is no parameter crs: of a map of one's own there is map_crs"),
        (["map", "--make", "t", "x.geojson"], "--make writes road maps, .xodr files, and x.geojson is no name of one"),
        (["map", "--make", "t", "x.xodr", "--plot", "x.gif"], "--plot x.gif: pictures are written as .png, .pdf or .svg"),
        (["map", "--make", "t", "no/x.xodr"], "no/x.xodr cannot be written: there is no directory no"),
    ],
)
def test_wrong_usage_is_said(ask, arguments: list[str], message: str) -> None:
    told = ask(*arguments)
    assert (told.code, told.out) == (2, "")
    assert message in told.err


@pytest.mark.parametrize("command", ["run", "check", "simulate"])
def test_what_is_strange_about_a_map_is_told_where_it_is_used(ask, tmp_path: Path, command: str) -> None:
    road = (
        '<road id="{id}" length="100" junction="-1"><planView><geometry s="0" x="{x}" y="{y}" hdg="{hdg}" length="100"><line/></geometry></planView>'
        '<lanes><laneSection s="0"><right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection>'
        "</lanes></road>"
    )
    crossing = road.format(id=1, x=0, y=0, hdg=0) + road.format(id=2, x=50, y=-50, hdg=1.5707963267948966)
    (tmp_path / "cross.xodr").write_text(f"<OpenDRIVE>{crossing}</OpenDRIVE>")
    (tmp_path / "a.scenic").write_text("param map = localPath('cross.xodr')\nmodel scenic.domains.driving.model\nego = Car\n")
    found = ask(command, tmp_path / "a.scenic", *(() if command == "check" else ("-o", tmp_path / "o.jsonl")))
    assert found.code == 0
    assert "note: the map has roads that overlap: road1 and road2 in 12.2 m²" in found.err
