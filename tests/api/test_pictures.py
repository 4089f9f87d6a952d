"""Pictures of scenes: colours that can be told apart, what they mean, and names that lie on nothing else."""

from __future__ import annotations

import io
import itertools
import json
import math
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
import shapely
from scenic_ref.pictures.map_layers import DIM, FAINT, MOST_MARKS, MOST_POINTS, Laid, Window, map_features_in, marks
from scenic_ref.pictures.scene_figures import (
    CLASSES,
    EGO,
    QUIET,
    bounds_of,
    common_area,
    figure_of,
    may_be_mistaken,
    picture,
    room_for,
    views_of,
)

VISION = {
    "all three cones": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "no red ones": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "no green ones": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "no blue ones": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
"""What is left of a colour in linear RGB (Machado, Oliveira and Fernandes 2009, severity 1)."""
OTHERS = ("#d1495b", "#30638e", "#4f8a5b", "#b8860b", "#7b5ea7", "#3f8f8f", "#8c564b")
"""Colours that look different, to most people."""
APART = 15  # of CIE 1976: one that is seen at once is about 10


def least_difference(colours: tuple[str, ...], vision: str) -> float:
    """The difference of the two colours that are most alike, in CIE L*a*b*."""
    return min(float(np.linalg.norm(a - b)) for a, b in itertools.combinations([lab(colour, vision) for colour in colours], 2))


def lab(colour: str, vision: str) -> np.ndarray:
    """A colour as somebody with this vision sees it, in CIE L*a*b*."""
    values = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.array(VISION[vision]) @ np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ linear.clip(0, 1) / [0.9505, 1, 1.089]
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", VISION)
def test_colours_of_classes_are_told_apart_with(vision: str) -> None:
    assert least_difference((EGO, *CLASSES), vision) > APART


def test_colours_that_some_cannot_tell_apart_are_found() -> None:
    assert least_difference(OTHERS, "all three cones") > APART
    assert all(least_difference(OTHERS, vision) < APART for vision in list(VISION)[1:])


def legend_of(program: str) -> list[str]:
    """What stands below the picture of a scene."""
    figure = figure_of([scenic_ref.loads(program).sample()], None)
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_the_legend_has_what_is_to_be_seen() -> None:
    cars = "class Car:\n    requireVisible: False\nclass Tree(Car):\n    pass\nego = Car\nCar at 9 @ 0\nTree at 0 @ 9\n"
    assert legend_of(cars) == ["ego", "Car", "Tree"]
    assert legend_of(cars.replace("ego = Car", "ego = Car with viewAngle 1, with viewDistance 20")) == ["ego", "Car", "Tree", "what ego can see"]
    assert legend_of("ego = Object\n") == []
    long = legend_of(f"class {'A' * 300}:\n    pass\nego = Object\n{'A' * 300} at 9 @ 0\n")
    assert long == ["ego", "A" * 23 + "\N{HORIZONTAL ELLIPSIS}"]


def test_names_lie_on_nothing_else_if_there_is_room() -> None:
    """The boxes of names as `room_for` gives them, one after the other; six small objects leave room for all. Right below each would not do."""
    program = "ego = Object at Range(-9, 9) @ Range(-9, 9)\n" + "Object at Range(-9, 9) @ Range(-9, 9)\n" * 5
    badly_put = 0
    for scene in scenic_ref.loads(program).sample_many(20, seed=1):
        boxes = [bounds_of(o) for o in scene.objects]
        rooms: list[Window] = []
        for box in boxes:
            rooms.append(room_for(3.0, 0.8, box, [*boxes, *rooms], (-12, -12, 12, 12)))
        assert covered(rooms, boxes) < 0.01 * 3.0 * 0.8
        below = [((box[0] + box[2]) / 2, box[1] - 0.6) for box in boxes]
        badly_put += covered([(x - 1.5, y - 0.4, x + 1.5, y + 0.4) for x, y in below], boxes) > 0.1
    assert badly_put > 5


def covered(rooms: list[Window], boxes: list[Window]) -> float:
    """The largest area that a name shares with a box, or with another name."""
    return max(common_area(a, b) for a, b in itertools.chain(itertools.product(rooms, boxes), itertools.combinations(rooms, 2)))


@pytest.mark.parametrize("count", [1, 2, 3, 5, 7])
@pytest.mark.parametrize("program", ["ego = Object at 0 @ 0\ncar = Object at 3 @ 4, with requireVisible False\n", "ego = Object at 1e5 @ 1e5\n"])
def test_titles_stand_inside_of_the_picture(program: str, count: int) -> None:
    from matplotlib.image import imread

    pixels = imread(io.BytesIO(picture(list(scenic_ref.loads(program).sample_many(count, seed=10**80)), format="png", roads=None)))
    for edge in (pixels[:2], pixels[-2:], pixels[:, :2], pixels[:, -2:]):
        assert (edge == 1).all()


def test_a_line_leads_from_a_name_that_could_be_that_of_another_object() -> None:
    around = "".join(f"Object at {1.1 * x:g} @ {1.1 * y:g}\n" for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0))
    for text, leaders in ((f"ego = Object at 0 @ 40\nmiddle = Object at 0 @ 0\n{around}", 1), ("ego = Object\nmiddle = Object at 9 @ 9\n", 0)):
        scene = scenic_ref.loads(text).sample()
        lines = [line for axes in figure_of([scene], None).axes for line in axes.lines if line.get_color() == QUIET]
        ends = [(float(line.get_xdata()[-1]), float(line.get_ydata()[-1])) for line in lines]  # type: ignore[index]
        assert ends.count((0, 0)) == leaders


def test_a_name_could_be_that_of_an_object_that_is_nearly_as_near() -> None:
    spot, box = (1.1, 0.0, 3.0, 0.5), (0.0, 0.0, 1.0, 1.0)
    assert not may_be_mistaken(spot, box, [(0.0, 1.1, 1.0, 2.1), (9.0, 0.0, 10.0, 1.0)])
    assert may_be_mistaken(spot, box, [(3.2, 0.0, 4.0, 1.0)])
    assert may_be_mistaken(spot, box, [(1.1, 0.7, 3.0, 1.7)])


def test_letters_that_no_font_has_are_no_reason_to_warn(recwarn: pytest.WarningsRecorder) -> None:
    scene = scenic_ref.loads("ego = Object\n").sample()
    (named,) = scene.objects
    picture([replace(scene, objects=(replace(named, name="ünï \N{AUTOMOBILE}"),))], format="png", roads=None)
    assert not recwarn.list


def test_what_ego_sees_is_shown_in_all_scenes_of_a_picture_or_in_none() -> None:
    far = scenic_ref.loads("ego = Object\nObject at 60 @ 0, with requireVisible False\n").sample()
    near = scenic_ref.loads("ego = Object\nObject at 6 @ 0\n").sample()
    assert [bool(view) for view in views_of([near])] == [False]
    assert [bool(view) for view in views_of([far, near])] == [True, True]
    assert [len(axes.patches) for axes in figure_of([far, near], None).axes] == [6, 6]


def site_in(folder: Path, features: list[tuple[str, str, object]]) -> scenic_ref.Scenario:
    """A program on a map of one's own with these features: a name, a kind, coordinates."""
    entries = [{"type": "Feature", "properties": {"name": n}, "geometry": {"type": kind, "coordinates": c}} for n, kind, c in features]
    (folder / "s.geojson").write_text(json.dumps({"type": "FeatureCollection", "crs": None, "features": entries}))
    (folder / "p.scenic").write_text("param map = localPath('s.geojson')\nmodel site_map\nego = Object at 10 @ 10\n")
    return scenic_ref.load(folder / "p.scenic")


def square(side: float) -> list[list[list[float]]]:
    return [[[0, 0], [side, 0], [side, side], [0, side], [0, 0]]]


def test_scenes_show_the_features_of_a_map_of_ones_own_whatever_draws_them(tmp_path: Path) -> None:
    features = [("posts", "Point", [9, 9]), ("wall", "LineString", [[8, 8], [12, 8]]), ("far", "Point", [900, 900]), ("yard", "Polygon", square(20))]
    scenario = site_in(tmp_path, features)
    window = (6.0, 6.0, 14.0, 14.0)
    for scene in (scenario.sample(), *scenario.sample_many(1, backend="batch"), pickle.loads(pickle.dumps(scenario.sample()))):
        found = [(one.kind, one.faint, one.dim) for one in map_features_in(scene.site, window)]
        assert found == [("areas", FAINT[3], DIM[3]), ("lines", FAINT[1], DIM[1]), ("points", FAINT[0], DIM[0])]
        assert picture([scene]) != picture([replace(scene, site=None)])


def test_names_and_directions_of_a_map_stand_inside_of_its_features_and_on_nothing_else() -> None:
    window, height = (0.0, 0.0, 40.0, 40.0), 1.0
    yard, lane = shapely.box(0, 0, 40, 20), shapely.box(4, 2, 30, 12)
    found = [
        Laid("areas", yard, "", "", "yard"), Laid("areas", lane, "", "", "lane", -math.pi / 2),
        Laid("areas", shapely.box(38, 38, 39, 39), "", "", "too small"),
        Laid("lines", shapely.LineString([(2, 30), (38, 30)]), "", "", "wall"), Laid("points", shapely.Point(20, 35), "", "", "post"),
    ]  # fmt: skip
    object_ = (4.0, 2.0, 20.0, 12.0)
    made = marks(found, window, [object_], lambda text: 0.6 * len(text), height)
    placed = {mark.text: (mark.x, mark.y) for mark in made}
    assert sorted(placed) == ["", "lane", "post", "wall", "yard"]
    assert covered([(x - 1, y - 0.5, x + 1, y + 0.5) for x, y in placed.values()], [object_]) == 0
    assert lane.contains(shapely.Point(placed["lane"])) and lane.contains(shapely.Point(placed[""]))
    assert yard.difference(lane).contains(shapely.Point(placed["yard"]))
    assert placed["wall"][1] == 31 and placed["post"] == (20, 36)
    [arrow] = [mark.ahead for mark in made if not mark.text]
    assert arrow == pytest.approx((1, 0), abs=1e-9), "to the East"


def test_the_names_of_a_crowded_map_take_no_longer(tmp_path: Path) -> None:
    squares = [Laid("areas", shapely.box(k % 50, k // 50, k % 50 + 0.9, k // 50 + 0.9), "", "", f"n{k}") for k in range(2500)]
    found = [Laid("areas", shapely.box(0, 0, 50, 50), "", "", "yard"), *squares]
    assert 0 < len(marks(found, (0.0, 0.0, 50.0, 50.0), [], lambda text: 0.1 * len(text), 0.2)) <= MOST_MARKS


def test_a_crowded_map_is_drawn_without_its_smallest_features(tmp_path: Path) -> None:
    crowd = [(f"p{k}", "Point", [k % 20, k // 20 % 20]) for k in range(MOST_POINTS + 5)]
    found = map_features_in(site_in(tmp_path, [*crowd, ("yard", "Polygon", square(20))]).sample().site, (0.0, 0.0, 20.0, 20.0))
    assert found[0].kind == "areas" and len(found) <= MOST_POINTS


@pytest.mark.parametrize("format", ["png", "svg", "pdf"])
def test_pictures_are_the_same_bytes_every_time(format: str) -> None:
    """Also the names inside of an SVG file, which the library draws at random where it may."""
    scenes = list(scenic_ref.loads("ego = Object\nObject at 3 @ 3\n").sample_many(2, 0))
    assert picture(scenes, format=format) == picture(scenes, format=format)
