"""The models of other simulators under their released names, on roads without these simulators; colors."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import scenic_ref
from scenic_ref.errors import UncaughtException
from scenic_ref.simulators.worlds.driving import STAND_INS
from scenic_ref.simulators.worlds.gta.data import COLOR_WEIGHTS

CARLA = "model scenic.simulators.carla.model\n"
PROGRAM = """param carla_map = 'Town01', weather = 'ClearNoon', map_options = {}
MODEL
behavior Drive():
    try:
        do FollowLaneBehavior(target_speed=6)
    interrupt when withinDistanceToAnyObjs(self, 8):
        take SetBrakeAction(1.0)
ego = Car on road, with blueprint 'vehicle.lincoln.mkz_2017', with rolename 'hero', with color Color(0, 0.5, 1), with behavior Drive
Car ahead of ego by 20
require (distance from ego to intersection) > 30
terminate when simulation().currentTime > 40
"""


@pytest.mark.slow
@pytest.mark.parametrize("model", STAND_INS)
def test_a_program_of_the_driving_library_is_the_same_under_every_model(model: str) -> None:
    ours, theirs = (
        scenic_ref.loads(PROGRAM.replace("MODEL", f"model {name}"), dialect="scenic-2.1", profile="scenic-2.1")
        for name in ("scenic.domains.driving.model", model)
    )
    assert [without_own(s.to_json(), model) for s in ours.sample_many(5)] == [without_own(s.to_json(), model) for s in theirs.sample_many(5)]
    runs = [scenario.simulate("kinematic", 60).simulation for scenario in (ours, theirs)]
    ended = [{name: value for name, value in pose.items() if name not in OWN.get(model, ())} for pose in runs[1].moments[-1].objects]
    assert list(runs[0].moments[-1].objects) == ended
    assert runs[1].scene.params["carla_map"] == "Town01"


OWN = {"scenic.simulators.newtonian.driving_model": ("controls_shown", "throttle", "brake", "steer", "hand_brake", "reverse")}
"""The properties that a model's vehicles have beside those of the driving library, as released."""


def without_own(scene: dict[str, Any], model: str) -> dict[str, Any]:
    """A scene without the properties that only the model has."""
    for one in scene["objects"]:
        for name in OWN.get(model, ()):
            one["properties"].pop(name, None)
    return scene


def test_what_stands_on_the_road() -> None:
    text = f"{CARLA}ego = Car on road\nTrash on road\nCone on road\nMotorcycle on road\nBus on road\nDebris on visible road\n"
    scene = scenic_ref.loads(text).sample()
    assert [(o.class_name, o.width, o.length) for o in scene.objects[1:]] == [
        ("Trash", 0.5, 0.5), ("Cone", 0.5, 0.5), ("Motorcycle", 1, 2), ("Bus", 2.5, 10), ("Debris", 0.5, 0.5),
    ]  # fmt: skip
    moved = scenic_ref.loads(text).simulate("kinematic", 3).simulation
    assert moved.moments[0].objects == moved.moments[-1].objects


REFUSED = {
    "x = blueprints.carModels[0]": "blueprints.carModels", "Pedestrian on sidewalk, with behavior WalkBehavior(1)": "WalkBehavior",
    "class Tram(CarlaActor):\n    width: 2\nTram on road": "CarlaActor",
}  # fmt: skip


@pytest.mark.parametrize("text", REFUSED)
def test_what_only_carla_can_do_is_refused_by_its_name(text: str) -> None:
    with pytest.raises(UncaughtException, match=f"{REFUSED[text]} needs its simulator, which this reference does not know: "):
        scenic_ref.loads(f"{CARLA}ego = Car\n{text}\n").sample()


@pytest.mark.slow
def test_the_commands_tell_what_a_model_stands_for(tmp_path: Path) -> None:
    for model, told in (("scenic.simulators.carla.model", True), ("scenic.domains.driving.model", False)):
        (tmp_path / "p.scenic").write_text(f"model {model}\nego = Car\n")
        for command in ("run", "simulate"):
            line = [sys.executable, "-m", "scenic_ref", command, tmp_path / "p.scenic", "-o", tmp_path / "o.jsonl"]
            done = subprocess.run(line, capture_output=True, text=True, check=True)
            assert (f"note: {model} stands for the driving library without CARLA" in done.stderr) is told
            assert done.stderr.count("note: ") == told + 1
            assert "note: the program names no map" in done.stderr


def test_colors_are_those_of_the_released_library() -> None:
    text = """model scenic.domains.driving.model
from scenic.simulators.utils.colors import Color
given = Color.withBytes([10, 20, 30])
ego = Car on road, with color Color.defaultCarColor()
Car on road, with color Color.uniformColor()
Car on road, with color Color(Range(0.5, 1), 0, 0.25)
param given = given, green = given.g, bytes = Color.realToByte((0.1, 0.5, 1)), same = given == (10 / 255, 20 / 255, 30 / 255), red = ego.color.r
"""
    program = scenic_ref.loads(text)
    scenes = list(program.sample_many(40, backend="batch"))
    assert [s.to_json() for s in scenes] == [s.to_json() for s in program.sample_many(40, backend="interpreter")]
    for scene in scenes:
        assert scene.params["given"] == pytest.approx((10 / 255, 20 / 255, 30 / 255))
        assert (scene.params["green"], scene.params["bytes"], scene.params["same"]) == (20 / 255, (26, 128, 255), True)
        popular, anything, made = (o["color"] for o in scene.objects)
        assert popular in COLOR_WEIGHTS
        assert scene.params["red"] == popular[0]  # type: ignore[index]
        assert all(0 <= part <= 1 for part in anything)  # type: ignore[attr-defined]
        assert 0.5 <= made[0] <= 1 and made[1:] == (0, 0.25)  # type: ignore[index]
    assert len({scene.objects[0]["color"] for scene in scenes}) > 4
    assert scenes[0].to_json()["objects"][2]["properties"]["color"][1:] == [0, 0.25]  # type: ignore[index]
    again = scenic_ref.loads(scenes[0].to_scenic("paper")).sample()
    assert [o["color"] for o in again.objects] == [o["color"] for o in scenes[0].objects]
