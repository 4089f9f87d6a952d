"""`check --samples` on samples of other samplers: their names and digits, what cannot be, no scenes at all."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

PROGRAM = (
    "x = Range(0, 1)\nego = Object at (x / 3, 0), facing Range(-1, 1), with v Uniform(1, 2, 3), with w 1 / 3\n"
    "Object at (5, Range(200, 201)), with requireVisible False\n"
)


@pytest.fixture
def files(ask):
    Path("p.scenic").write_text(PROGRAM)
    assert ask("run", "p.scenic", "-n", 2000, "--seed", 5, "-o", "s.jsonl").code == 0
    return ask


def changed(change: Callable[[dict], None], *, to: str = "t.jsonl", every: int = 1) -> None:
    """Write the samples, of which some are changed, to another file."""
    scenes = [json.loads(line) for line in Path("s.jsonl").read_text().splitlines()]
    for scene in scenes[every - 1 :: every]:
        change(scene)
    Path(to).write_text("".join(json.dumps(scene) + "\n" for scene in scenes))


def with_numbers(change: Callable[[float], float]) -> Callable[[dict], None]:
    def of(value):
        if isinstance(value, float):
            return change(value)
        if isinstance(value, list):
            return [of(v) for v in value]
        return {k: of(v) for k, v in value.items()} if isinstance(value, dict) else value

    return lambda scene: scene.update(of({k: v for k, v in scene.items() if k != "schema"}))


ROUNDINGS = {
    "six decimals": lambda v: round(v, 6), "six digits": lambda v: float(f"{v:.6g}"), "float32": lambda v: float(np.float32(v)),
    "nine decimals": lambda v: round(v, 9),
}


@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_rounded_samples_are_not_different(files, rounding):
    changed(with_numbers(ROUNDINGS[rounding]))
    assert files("check", "p.scenic", "--samples", "t.jsonl").code == 5
    if rounding != "nine decimals":
        assert files("check", "p.scenic", "--samples", "t.jsonl", "--tolerance", 1e-9).code == 1


def test_three_digits_are_different_unless_the_tolerance_says_otherwise(files):
    changed(with_numbers(lambda v: float(f"{v:.3g}")))
    found = files("check", "p.scenic", "--samples", "t.jsonl")
    assert found.code == 1
    assert "objects[0].properties.w is always 0.333333333, but 0.333 in sample 1 (line 1)" in found.out
    assert files("check", "p.scenic", "--samples", "t.jsonl", "--tolerance", 0.005).code == 5


def test_a_difference_of_the_law_is_seen_through_rounding(files):
    Path("q.scenic").write_text(PROGRAM.replace("Range(-1, 1)", "Range(-0.8, 1)"))
    files("run", "q.scenic", "-n", 2000, "--seed", 6, "-o", "s.jsonl")
    changed(with_numbers(lambda v: round(v, 6)))
    assert files("check", "p.scenic", "--samples", "t.jsonl").code == 1


@pytest.mark.slow
def test_a_finite_program_is_compared_with_rounded_samples(ask):
    Path("p.scenic").write_text("a = Uniform(1/3, 2/3, 1)\nego = Object at (a, 100/7)\nObject at (a, 3 + a), with v 1/a, with requireVisible False\n")
    ask("run", "p.scenic", "-n", 2000, "--seed", 5, "-o", "s.jsonl")
    for rounding in ROUNDINGS.values():
        changed(with_numbers(rounding))
        assert ask("check", "p.scenic", "--samples", "t.jsonl", "--detect-tv", 0.15).code == 0


# Names


def test_classes_of_the_plane_have_their_name_here_unless_the_program_has_them(files):
    changed(lambda scene: [o.update({"class": "Object2D"}) for o in scene["objects"]])
    assert files("check", "p.scenic", "--samples", "t.jsonl").code == 5
    Path("q.scenic").write_text("class Object2D:\n    v: 1\n" + PROGRAM.replace("ego = Object", "ego = Object2D"))
    found = files("check", "q.scenic", "--samples", "s.jsonl")
    assert (found.code, "objects[0].class is always Object2D, but Object in sample 1" in found.out) == (1, True)


def test_features_and_classes_can_be_mapped_and_ignored(files):
    def foreign(scene):
        for o in scene["objects"]:
            o["class"] = "Thing"
        ego = scene["objects"][0]
        ego["properties"]["speedy"] = ego["properties"].pop("v")
        ego["width"] = 1.25

    changed(foreign)
    command = ("check", "p.scenic", "--samples", "t.jsonl")
    found = files(*command)
    assert (found.code, "objects[0].class is always Object, but Thing in sample 1" in found.out) == (1, True)
    options = ("--map", "Thing=Object", "--map", "speedy=v", "--ignore", "0.width")
    found = files(*command, *options)
    assert found.code == 5
    assert "only one side" not in found.out
    assert "--ignore 0.width --map Thing=Object --map speedy=v" in found.out.splitlines()[-1]
    replayed = found.out.splitlines()[-1].removeprefix("replay: scenic-ref ").split()
    assert files(*replayed) == found
    assert files(*command, "--ignore", "class", "--ignore", "objects[*].width").code == 5
    changed(lambda scene: scene["objects"][0]["properties"].update({"speedy": scene["objects"][0]["properties"].pop("v") + 1}))
    assert files(*command, "--map", "speedy=v").code == 1  # what is mapped is compared


def test_names_that_are_nowhere_are_refused(files):
    for option, hint in ((("--ignore", "0.widht"), "objects[0].width"), (("--map", "Objekt=Object"), "Object"), (("--map", "x"), "A=B")):
        found = files("check", "p.scenic", "--samples", "s.jsonl", *option)
        assert (found.code, hint in found.err) == (2, True)


# What cannot be


@pytest.mark.sampled(8)
@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", "1e999"])
@pytest.mark.parametrize("place", ["objects[0].position[0]", "objects[1].heading", "objects[0].properties.v"])
def test_a_number_that_is_none_is_a_difference_with_its_place(files, place, value):
    lines = Path("s.jsonl").read_text().splitlines()
    scene = json.loads(lines[70])
    holder = scene["objects"][int(place[8])]
    if "position" in place:
        holder["position"][0] = "HERE"
    elif "heading" in place:
        holder["heading"] = "HERE"
    else:
        holder["properties"]["v"] = "HERE"
    lines[70] = json.dumps(scene).replace('"HERE"', value)
    Path("t.jsonl").write_text("\n\n".join(lines) + "\n")
    found = files("check", "p.scenic", "--samples", "t.jsonl")
    assert found.code == 1
    number = {"NaN": "nan", "-Infinity": "-inf"}.get(value, "inf")
    assert f"{place} is {number} in sample 71 (line 141)" in found.out or f"{place} is always 0, but {number} in sample 71 (line 141)" in found.out


def test_a_number_that_is_none_in_a_table_is_a_difference(files):
    Path("t.csv").write_text("0.x,1.y\n0.25,200.5\nnan,200.5\n")
    found = files("check", "p.scenic", "--samples", "t.csv")
    assert (found.code, "objects[0].position[0] is nan in sample 2 (line 3)" in found.out) == (1, True)


def test_a_value_outside_the_support_is_a_proof_however_rare(files):
    changed(lambda scene: scene["objects"][0]["position"].__setitem__(0, 0.4), every=1999)
    found = files("check", "p.scenic", "--samples", "t.jsonl")
    assert found.code == 1
    assert "objects[0].position[0] is between 0 and 0.333333333, but 0.4 in sample 1999 (line 1999)" in found.out
    changed(lambda scene: scene["objects"][0]["properties"].update(v=2.5), every=1999)
    found = files("check", "p.scenic", "--samples", "t.jsonl")
    assert (found.code, "objects[0].properties.v is one of 1, 2, 3, but 2.5 in sample 1999" in found.out) == (1, True)


def test_a_position_outside_its_region_is_a_proof(ask):
    Path("p.scenic").write_text("ego = Object in CircularRegion((0, 0), 5)\n")
    ask("run", "p.scenic", "-n", 1500, "-o", "s.jsonl")
    assert ask("check", "p.scenic", "--samples", "s.jsonl").code == 5
    changed(lambda scene: scene["objects"][0].update(position=[4, 4]), every=1400)
    found = ask("check", "p.scenic", "--samples", "t.jsonl")
    assert (found.code, "boundaryDistance(0, its region) is at least 0, but -0.656854249 in sample 1400" in found.out) == (1, True)


def test_values_that_are_right_alone_and_wrong_together_are_a_proof(ask):
    Path("p.scenic").write_text("a = Uniform(0, 1)\nb = Uniform(0, 1)\nego = Object with a a, with b b, with c 1 - a\n")
    ask("run", "p.scenic", "-n", 600, "-o", "s.jsonl")
    changed(lambda scene: scene["objects"][0]["properties"].update(c=scene["objects"][0]["properties"]["a"]), every=600)
    found = ask("check", "p.scenic", "--samples", "t.jsonl")
    assert (found.code, "the values in sample 600 (line 600), each of which is possible, have probability 0 together" in found.out) == (1, True)


# No scenes


@pytest.mark.parametrize(("name", "text"), [("t.jsonl", ""), ("t.jsonl", "\n\n"), ("t.csv", "0.x\n")])
def test_no_scenes_where_scenes_are_likely_are_a_difference(files, name, text):
    Path(name).write_text(text)
    found = files("check", "p.scenic", "--samples", name, "--junit", "r.xml")
    assert found.code == 1
    assert "the samples hold no scene, though the program gives one in 1 attempts on average" in found.out
    assert Path("r.xml").exists()


def test_no_scenes_of_a_program_that_gives_none_are_no_difference(ask):
    Path("p.scenic").write_text("x = Range(0, 1)\nego = Object with v x\nrequire x > 2\n")
    Path("t.jsonl").write_text("")
    assert ask("check", "p.scenic", "--samples", "t.jsonl").code == 3


def test_scenes_of_a_program_that_gives_none_are_a_difference(files):
    Path("q.scenic").write_text("x = Range(0, 1)\nego = Object with v x\nrequire x > 2\n")
    found = files("check", "q.scenic", "--samples", "s.jsonl")
    assert (found.code, "the program has no scenes, but the samples do" in found.out) == (1, True)
