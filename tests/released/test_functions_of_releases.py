"""Functions and parameters that the releases give to every program: they say what operators say, and mean the same in every backend."""

from __future__ import annotations

import json

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import ScenicError

SETTING = """# dialect: scenic-3
F = VectorField('f', lambda p: 30 deg)
R = CircularRegion((0, 0), 50)
S = PolygonalRegion([(0, 0), (4, 0), (4, 4)])
L = PolylineRegion([(0, 0), (4, 0), (4, 4)])
v = Vector(1, 2)
ego = new Object at (0, 0), facing 20 deg
o = new Object at (5, Range(5, 6)), facing 40 deg
q = new Object at (12, 8), facing 10 deg
"""

SAME = {
    "RelativeHeading(o)": "relative heading of o",
    "RelativeHeading(o, 10 deg)": "relative heading of o from 10 deg",
    "RelativeHeading(X=o, Y=q)": "relative heading of o from q",
    "ApparentHeading(o)": "apparent heading of o",
    "ApparentHeading(o, (3, 3))": "apparent heading of o from (3, 3)",
    "RelativePosition(o)": "relative position of o",
    "RelativePosition(o, q)": "relative position of o from q",
    "DistanceFrom(o)": "distance from o",
    "DistanceFrom(o, None)": "distance from o",
    "DistanceFrom(o, q)": "distance from o to q",
    "DistancePast((1, 1))": "distance past (1, 1)",
    "DistancePast((1, 1), o)": "distance past (1, 1) of o",
    "AngleTo(o)": "angle to o",
    "AngleFrom(o, q)": "angle from o to q",
    "AngleFrom(Y=o)": "angle to o",
    "Follow(F, (1, 1), 3).position": "(follow F from (1, 1) for 3).position",
    "FieldAt(F, (1, 1))": "F at (1, 1)",
    "OffsetAlong((1, 1), 30 deg, (1, 2))": "(1, 1) offset along 30 deg by (1, 2)",
    "RelativeTo((1, 2), (3, 4))": "(1, 2) relative to (3, 4)",
    "Front(o).position": "(front of o).position",
    "BackLeft(o).position": "(back left of o).position",
    "CanSee(ego, o)": "ego can see o",
    "Intersects(o, q)": "o intersects q",
    "o in Visible(R)": "o in visible R",
    "(12, 8) in NotVisible(R)": "(12, 8) in not visible R",
    "(12, 8) in VisibleFromOp(R, o)": "(12, 8) in R visible from o",
    "ego.canSee(o, occludingObjects=tuple([]))": "ego can see o",
    "ego.canSee(o, [])": "ego can see o",
    "ego.canSee(o, debug=False)": "ego can see o",
    "o.toHeading()": "o.heading",
    "o.relativePosition((1, 2))": "((1, 2) relative to o).position",
    "v.azimuthTo(Vector(2, 3))": "angle from v to (2, 3)",
    "v.offsetLocally(30 deg, Vector(1, 2))": "v offset along 30 deg by (1, 2)",
    "F.valueAt(v)": "F at v",
    "R.intersects(S, triedReversed=True)": "R.intersects(S)",
    "v in R.intersect(S, triedReversed=False)": "v in R.intersect(S)",
    "v in S.union(S, buf=0)": "v in S",
    "(1, 0.5) in PolygonalRegion.unionAll([S, S], buf=0)": "True",
    "min([o, q], key=DistanceFrom).position": "o.position",
    "min([o, q], key=ego.distanceTo).position": "o.position",
    "list(map(DistanceFrom, [o, q]))": "[distance from o, distance from q]",
}


@pytest.mark.parametrize("said", SAME)
def test_a_function_says_what_an_operator_says(said: str) -> None:
    text = SETTING + f"param one = {said}\nparam other = {SAME[said]}\n"
    for scene in scenic_ref.loads(text).sample_many(3, seed=4, backend="interpreter"):
        found = scene.to_json()["params"]
        assert json.dumps(found["one"]) == json.dumps(found["other"])  # type: ignore[index]


def test_the_batch_backend_draws_the_same_scenes() -> None:
    asked = [said for said in SAME if said.startswith(("Rel", "App", "Dist", "Angle", "Follow", "Off", "CanSee", "ego.canSee"))]
    text = SETTING + "".join(f"param p{i} = {said}\n" for i, said in enumerate(asked))
    scenario = scenic_ref.loads(text + "require DistanceFrom(o) > 7.2\n")
    several = [list(scenario.sample_many(20, seed=2, backend=backend)) for backend in ("interpreter", "batch")]
    assert [scene.to_json() for scene in several[0]] == [scene.to_json() for scene in several[1]]


def test_a_heading_relative_to_a_field_waits_for_the_position() -> None:
    text = SETTING + "p = new Object at (30, Range(0, 1)), facing RelativeTo(10 deg, F)\nparam h = p.heading\n"
    assert scenic_ref.loads(text).sample(1).params["h"] == pytest.approx(0.6981317)


@pytest.mark.parametrize("name", ["Left", "Visible", "Follow", "Front", "Intersects"])
def test_a_name_of_the_program_comes_first(name: str) -> None:
    text = f"# dialect: scenic-3\ndef {name}(x):\n    return 7 + x\nego = new Object\nparam x = {name}(1)\n"
    assert scenic_ref.loads(text).sample().params["x"] == 8


@pytest.mark.parametrize("dialect", ["paper", "pldi19"])
def test_the_dialects_of_the_paper_do_not_have_them(dialect: str) -> None:
    with pytest.raises(ScenicError, match="DistanceFrom is not defined"):
        scenic_ref.loads("ego = Object\nparam x = DistanceFrom((1, 2))", dialect=dialect).sample()


REFUSED = {
    "ego.canSee(o, occludingObjects=[q])": "no object hides another",
    "ego.canSee(o, occludingObjects=3)": "no object hides another",
    "ego.canSee(o, hidden=True)": "canSee() takes (other, occludingObjects, debug)",
    "DistanceFrom()": "DistanceFrom() takes (X, Y)",
    "DistanceFrom(o, q, 3)": "DistanceFrom() takes (X, Y)",
    "RelativeHeading('north')": "relative heading of",
    "AltitudeTo(o)": "AltitudeTo() is three-dimensional",
    "S.union(R, buf=1)": "buf= is outside this reference",
    "PolygonalRegion.unionAll([S], buf=2)": "buf= is outside this reference",
    "S.polygon.simplify(1)": "a shape has no attribute simplify",
    "S.polygon.coords": "ask for those of its exterior",
    "L.lineString.exterior": "a LineString has no exterior",
    "S.polygon.contains(3)": "compared with another one",
    "S.polygon.geometry": "has no attribute geometry",
    "R.polygon": "has no attribute polygon",
}


@pytest.mark.parametrize("said", REFUSED)
def test_what_would_change_the_meaning_is_refused_by_its_name(said: str) -> None:
    with pytest.raises(ScenicError) as found:
        scenic_ref.loads(SETTING + f"param x = {said}\n").sample()
    assert REFUSED[said] in found.value.message


SHAPES = {
    "S.polygon.centroid.x": 8 / 3, "S.polygon.centroid.y": 4 / 3, "len(list(S.polygon.exterior.coords))": 4, "S.polygon.area": 8.0,
    "S.polygon.bounds": [0.0, 0.0, 4.0, 4.0], "S.polygon.exterior.coords[0]": [0.0, 0.0], "S.polygon.length": 8 + 32**0.5,
    "S.polygon.contains((3, 1))": True, "S.polygon.contains(Vector(-1, 1))": False, "S.polygon.contains(S.polygon.centroid)": True,
    "S.polygon.intersects(L.lineString)": True, "S.polygon.distance((8, 0))": 4.0, "S.polygon.is_empty": False, "S.polygon.geom_type": "Polygon",
    "S.polygon.interiors": [], "S.polygon.centroid.coords[0][1]": 4 / 3, "S.polygon.boundary.length": 8 + 32**0.5,
    "L.lineString.length": 8.0, "L.lineString.coords[1]": [4.0, 0.0], "L.lineString.interpolate(5).y": 1.0, "L.lineString.project((4, 3))": 7.0,
    "L.lineString.xy[0]": [0.0, 4.0, 4.0], "PolygonalRegion(polygon=S.polygon).area": 8.0, "PolylineRegion(polyline=L.lineString).length": 8.0,
    "ego.polygon.area": 1.0, "q.polygon.centroid.x": 12.0, "S.polygon.convex_hull.area": 8.0, "S.polygon.envelope.area": 16.0,
    "S.polygon.contains(q)": False, "S.polygon.covers(S)": True, "S.polygon.within(S.polygon)": True,
    "S.polygon.contains(S.polygon.representative_point())": True, "S.polygon == S.polygon": True,
    "ego._boundingPolygon == ego.polygon": True,
}  # fmt: skip


@pytest.mark.parametrize("said", SHAPES)
def test_the_shape_of_a_region_says_what_shapely_says(said: str) -> None:
    scene = scenic_ref.loads(SETTING + f"param x = {said}\n").sample(1)
    assert scene.to_json()["params"]["x"] == pytest.approx(SHAPES[said])  # type: ignore[index]
