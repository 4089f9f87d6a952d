"""Scenes outside of their run: pickled, as programs, and under the released names."""

from __future__ import annotations

import math
import pickle
import random
from pathlib import Path
from typing import Literal

import pytest
import scenic_ref
from scenic_ref import compat
from scenic_ref.data.scene import Scene
from scenic_ref.semantics.machine.values import Instance
from scenic_ref.semantics.space.vectors import Vector

RICH = """
workspace = Workspace(RectangularRegion((0, 0), 0.5, 80, 80))
behavior B(n):
    wait
class Car:
    model: {'a': [1, (2, 'b')]}
    other: None
    width: 2
ego = Car at (Range(1, 2), -2), facing Range(-200, 200) deg, with behavior B(3), with region CircularRegion((0, 0), 3), with v Vector(1, 2)
second = Object at (-5, 5), with far float('inf'), with mutationScale 0, with f VectorField('f', lambda p: 1)
Car at (9, 9), with other ego, with name_ 'unnamed', with requireVisible False
param weather = 'sun', words = {'b', 'a'}, none = set(), time = Range(0, 24), "no name" = [True, None]
mutate second
"""
SCENE = scenic_ref.loads(RICH).sample(1)


def of_the_paper(name: str) -> str:
    """The paper's name of a property that the dialects of the releases spell otherwise (reading `view-distance`)."""
    return "viewDistance" if name == "visibleDistance" else name


def told(scene: Scene, *without: str) -> list[object]:
    """What a scene says of its objects and parameters."""
    objects = [o.to_json() for o in scene.objects]
    for o in objects:
        o["properties"] = {of_the_paper(k): v for k, v in o["properties"].items() if k not in without}  # type: ignore[attr-defined]
    return [sorted(scene.to_json()["params"].items()), scene.ego_id, objects]  # type: ignore[attr-defined]


def test_a_pickled_scene_says_the_same() -> None:
    again = pickle.loads(pickle.dumps(SCENE))
    assert again.to_line() == SCENE.to_line()
    assert len(pickle.dumps(SCENE)) < 10_000
    assert again.ego["region"].contains_point(again.ego.position)
    assert repr(again.workspace) == repr(SCENE.workspace)


AWKWARD = scenic_ref.loads("""
ego = Object at (0, 0), with pair (3, 4), with pairs [(1, 2), ('a', (5, 6))], with cls Object, with classes (Object, [Point])
for i in range(2):
    car = Object at (5 + 3 * i, Range(5, 6))
Car = Object at (-9, 9)
param 'class' = (3, 4), 'True' = 1, at = {(1, 2): (3, 4)}, triple = (1, 2, 3)
""").sample(1)


@pytest.mark.parametrize("dialect", ["paper", "pldi19", "scenic-2.1", "scenic-3"])
def test_pairs_and_names_survive_in_the_program_of_a_scene(dialect: str) -> None:
    again = scenic_ref.loads(AWKWARD.to_scenic(dialect)).sample(7)
    assert told(again, "cls", "classes") == told(AWKWARD, "cls", "classes")
    assert again.params == AWKWARD.params and list(again.params) == ["class", "True", "at", "triple"]
    assert [o.name for o in again.objects] == ["ego", "car", "car", "Car"]


def test_a_name_that_the_program_of_a_scene_cannot_keep_is_told() -> None:
    scene = scenic_ref.loads("class Car:\n    pass\nego = Car at (0, 0)\nCar = Car at (5, 5)").sample()
    text = scene.to_scenic()
    assert "# Car: its name was Car" in text
    assert told(scenic_ref.loads(text).sample())[2][0] == told(scene)[2][0]


def test_a_pickled_scene_with_classes_says_the_same() -> None:
    assert pickle.loads(pickle.dumps(AWKWARD)).to_line() == AWKWARD.to_line()


@pytest.mark.parametrize("dialect", ["paper", "scenic-2.1", "scenic-3"])
def test_the_program_of_a_scene_makes_that_scene(dialect: str) -> None:
    text = SCENE.to_scenic(dialect)
    left_out = ("behavior", "f", "mutationScale")
    for seed in (0, 5):
        assert told(scenic_ref.loads(text).sample(seed), *left_out) == told(SCENE, *left_out)
    assert text.count("# ") == (3 if dialect == "paper" else 4)
    assert all(f": {name} was " in text for name in left_out)


REFERRING = scenic_ref.loads("""
ego = Object at (Range(0, 1), 0), with next None, with me None, with all None, with viewDistance 60
for i in range(2):
    car = Object at (5 + 3 * i, 5), with before ego, with one Uniform(ego, car if i else ego)
Object at (0, 9), with twice (car, [car, {'a': ego}])
last = Object at (0, -9), with place (Point at (1, 1))
ego.next, ego.me, ego.all = last, ego, [last, (ego, 'x')]
param who = last, both = [car, ego]
""")


def holding(scene: Scene) -> list[object]:
    """Which objects of a scene hold which others, by their numbers in the scene."""
    ids = {o.made: o.id for o in scene.objects}

    def told_of(value: object) -> object:
        match value:
            case Instance(number=number):
                return f"object {ids.get(number)}"
            case list() | tuple():
                return [told_of(v) for v in value]
            case dict():
                return {k: told_of(v) for k, v in value.items()}
            case _:
                return value

    left_out = ("place", "behavior", "velocity")
    kept = [{of_the_paper(k): told_of(v) for k, v in sorted(o.properties.items()) if k not in left_out} for o in scene.objects]
    return [*kept, {k: told_of(v) for k, v in scene.params.items()}]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("dialect", ["paper", "pldi19", "scenic-2.1", "scenic-3"])
@pytest.mark.parametrize("backend", ["interpreter", "batch"])
def test_an_object_that_holds_another_one_holds_it_in_the_program_of_the_scene(backend: Literal["interpreter", "batch"], dialect: str) -> None:
    for scene in REFERRING.sample_many(12, 3, backend=backend):
        text = scene.to_scenic(dialect)
        again = scenic_ref.loads(text).sample(7)
        assert holding(again) == holding(scene)
        assert again.to_scenic(dialect) == text.replace("# last: place was <Point 4>\n", "")
        assert ("visibleDistance" in text) == dialect.startswith("scenic")


def test_of_a_pickled_scene_only_the_text_of_what_objects_hold_is_left() -> None:
    text = pickle.loads(pickle.dumps(REFERRING.sample(3))).to_scenic()
    assert "# ego: next was <Object" in text and "ego.next" not in text


def test_a_point_that_is_no_object_of_the_scene_is_told() -> None:
    scene = scenic_ref.loads("p = Point at (1, 1)\nego = Object at (0, 0), with both None\nego.both = [ego, p]").sample()
    assert "# ego: both was [<Object 1>, <Point 0>]" in scene.to_scenic()


@pytest.mark.sampled(8)
@pytest.mark.parametrize("path", sorted(Path("examples/gallery").glob("*.scenic")), ids=lambda path: path.stem)
def test_scenes_of_the_gallery_as_programs(path: Path) -> None:
    scene = scenic_ref.load(path).sample(2)
    unwritten = {name for o in scene.objects for name, v in o.to_json()["properties"].items() if isinstance(v, dict) and "repr" in v}  # type: ignore[attr-defined]
    again = scenic_ref.loads(scene.to_scenic()).sample()
    assert told(again, "mutationScale", *unwritten)[1:] == told(scene, "mutationScale", *unwritten)[1:]


PROGRAM = "ego = new Object at (Range(0, 1), 0), with c 3\nparam t = Uniform('day', 'night')\nrequire ego.x > 0.5\n"


def test_scripts_for_the_released_implementations_change_one_import(tmp_path: Path) -> None:
    path = tmp_path / "p.scenic"
    path.write_text(PROGRAM)
    found = []
    for _ in range(2):
        random.seed(3)
        scenario = compat.scenarioFromFile(str(path), params={"w": 5})
        scene, iterations = scenario.generate(maxIterations=100)
        assert iterations >= 1 and scene.egoObject.x == scene.objects[0].position.x > 0.5
        assert (scene.egoObject.c, scene.params["w"]) == (3, 5)
        scenario.conditionOn(scene=scene, objects=(0,), params={"t": "day"})
        others, _ = scenario.generateBatch(12)
        assert {(s.egoObject.x, s.params["t"]) for s in others} == {(scene.egoObject.x, "day")}
        found.append((scene.egoObject.position, [s.params for s in others]))
    assert found[0] == found[1]


def test_a_scene_can_be_given_twice_under_the_released_names() -> None:
    random.seed(5)
    for _ in range(10):
        scenario = compat.scenarioFromString("ego = new Object at (Range(0, 1), 0)\nb = new Object at (Range(5, 9), Range(0, 3))\nrequire b.y > 2")
        scene, _ = scenario.generate()
        scenario.conditionOn(scene, objects=(0,))
        scenario.conditionOn(scene, objects=(1,))
        other, _ = scenario.generate()
        assert [o.position for o in other.objects] == [o.position for o in scene.objects]


@pytest.mark.parametrize(("new", "to_b"), [("new ", 3.5), ("", 5.0)])
def test_objects_under_the_released_names(new: str, to_b: float) -> None:
    program = f"class Car:\n    width: 3\nego = {new}Car at (0, 0)\nb = {new}Car at (5, 0), facing 90 deg, with width 1, with length 3\n"
    scene, _ = compat.scenarioFromString(program).generate()
    ego, b = scene.objects
    assert (type(ego).__name__, isinstance(ego, compat.Object), b.heading) == ("Car", True, math.pi / 2)
    assert (ego.position.distanceTo((3, 4)), ego.position.distanceTo(b.position), ego.position.distanceTo(b)) == (5, 5, to_b)
    assert ego.position.angleTo(b) == -math.pi / 2
    assert [tuple(corner) for corner in ego.corners] == [(1.5, 0.5), (-1.5, 0.5), (-1.5, -0.5), (1.5, -0.5)]
    assert ego.position == Vector(0, 0) == ego.position == (0, 0) and hash(ego.position) == hash(Vector(0, 0))
    again = pickle.loads(pickle.dumps(ego))
    assert (type(again).__name__, again.position) == ("Car", ego.position)


def test_the_older_dialect_under_the_released_names() -> None:
    scene, _ = compat.scenarioFromString("# dialect: pldi19\nego = Object at (1, 2) @ 3").generate()
    assert 1 <= scene.egoObject.x <= 2


def test_the_released_names_of_errors(tmp_path: Path) -> None:
    old = compat.scenarioFromString("ego = Object at (0, 0)\nrequire ego.x > Range(0, 1)")
    assert old.scenario.program.dialect == "scenic-2.1"
    with pytest.raises(compat.RejectionException, match="in 10 iterations"):
        old.generate(maxIterations=10)
    with pytest.raises(compat.ScenicSyntaxError):
        compat.scenarioFromString("ego = = 3")
    with pytest.raises(compat.InvalidScenarioError, match="two-dimensional"):
        compat.scenarioFromString(PROGRAM, mode2D=False)
    with pytest.raises(AttributeError, match="has no property zz"):
        _ = compat.scenarioFromString(PROGRAM).generate()[0].egoObject.zz


BOXES = """
param a = Range(1, 2), b = 'x', c = Range(0, 1) + 1
ego = NEW Object at Vector(0, 0), with width 2, with length 4, facing 30 deg
NEW Object at Vector(5, 5)
workspace = Workspace(CircularRegion(Vector(0, 0), 30))
"""


@pytest.mark.parametrize("new, near, far", [("new ", 3.3674539287354204, 5.830127018922194), ("", 5.0, 7.0710678118654755)])
def test_distances_and_points_are_those_of_the_release(new: str, near: float, far: float) -> None:
    """The numbers are those that Scenic 3.1.1 and 2.1.0 give."""
    scene, _ = compat.scenarioFromString(BOXES.replace("NEW ", new)).generate()
    ego, other = scene.objects
    assert ego.distanceTo(compat.Vector(5, 0)) == pytest.approx(near)
    assert ego.distanceTo(other) == ego.distanceTo(other.position) == pytest.approx(far)
    assert ego.containsPoint((0.5, 0)) and not ego.containsPoint(other)
    assert scene.workspace.containsPoint(other.position) and not scene.workspace.containsPoint((30, 1))


def test_parameters_of_a_scenario_have_values_or_distributions() -> None:
    params = compat.scenarioFromString(BOXES.replace("NEW", "new"), params={"more": 3}).params
    assert (params["b"], params["more"], str(params["a"])) == ("x", 3, "Range(low=1.0, high=2.0)")
    assert not isinstance(params["c"], float)


def test_a_scenario_goes_on_after_a_failure() -> None:
    scenario = compat.scenarioFromString("ego = new Object\nrequire Range(0, 1) > 0.7\n")
    found = []
    for _ in range(60):
        try:
            found.append(scenario.generate(maxIterations=1))
        except compat.RejectionException:
            found.append(None)
    assert None in found and any(found)


KEPT = """kept = [float('inf'), frozenset([1, 2]), frozenset(), range(3), range(9, 1, -2), b'a\\xff', set(), {1, 2}, (1, 2), (3,), Vector(1, 2),
    CircularRegion((0, 0), 3), SectorRegion((0, 0), 3, 1, 2), RectangularRegion((0, 0), 1, 2, 3), everywhere, nowhere, 10 ** 5000]
"""


@pytest.mark.parametrize("dialect", ["paper", "pldi19", "scenic-2.1", "scenic-3"])
@pytest.mark.parametrize("name", [
    "Point", "OrientedPoint", "Object", "Vector", "Workspace", "CircularRegion", "SectorRegion", "RectangularRegion", "float", "frozenset", "range",
    "bytes", "set", "tuple", "everywhere", "nowhere",
])  # fmt: skip
def test_a_class_may_have_the_name_of_a_built_in(name: str, dialect: Literal["paper", "pldi19", "scenic-2.1", "scenic-3"]) -> None:
    program = f"workspace = Workspace(CircularRegion((0, 0), 50))\n{KEPT}class {name}:\n    foo: kept\nego = {name} at (5, 5)\nparam kept = kept\n"
    scene = scenic_ref.loads(program).sample()
    text = scene.to_scenic(dialect)
    again = scenic_ref.loads(text).sample()
    assert "#" not in text.removeprefix("# dialect")
    assert [repr_of(again.params["kept"]), repr_of(again.ego["foo"])] == [repr_of(scene.params["kept"]), repr_of(scene.ego["foo"])]
    assert (again.ego.class_name, repr(again.workspace)) == (name, repr(scene.workspace))


def repr_of(kept: object) -> tuple[str, int]:
    """The elements, and the last one, which is too long for `repr`."""
    assert isinstance(kept, list)
    return repr(kept[:-1]), kept[-1]


def test_values_of_classes_of_the_program_stand_in_comments() -> None:
    scene = scenic_ref.loads("""
import enum
class S(str):
    def __repr__(self): return 'wrong'
class I(int): pass
class L(list): pass
class E(enum.IntEnum):
    a = 1
ego = Object with a S('x'), with b I(3), with c L([1]), with d E.a, with e [S('y')], with f Object
""").sample()
    text = scene.to_scenic()
    assert [line.split(" was ")[0] for line in text.splitlines()[:-1]] == [f"# ego: {name}" for name in "abcdef"]
    assert scenic_ref.loads(text).sample().ego.class_name == "Object"
