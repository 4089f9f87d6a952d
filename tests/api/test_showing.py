"""What prompts and notebooks show of scenes and programs."""

from __future__ import annotations

import html
import pickle
import re
import subprocess
import sys
import traceback
from collections.abc import Callable

import matplotlib as mpl
import pytest
import scenic_ref
from scenic_ref.errors import UsageError
from scenic_ref.pictures.scene_figures import picture

mpl.use("agg")
HOSTILE = '</pre><script>alert("&")</script>'
PROGRAM = f"ego = Object at Range(0, 3) @ 0\nx = Object at 5 @ 5, with name '{HOSTILE}'\nparam t = '{HOSTILE}', u = 2\n"


def scenario(**settings) -> scenic_ref.Scenario:
    return scenic_ref.loads(PROGRAM, file="two.scenic", **settings)


def test_a_scenario_says_what_it_was_loaded_with() -> None:
    assert repr(scenario()) == "<scenario of two.scenic>"
    assert repr(scenario(readings={"soft": "scene"}, params={"u": 3})) == "<scenario of two.scenic: soft=scene, u = 3>"
    first = scenario()
    assert repr(first.condition_on(first.sample(), objects=(0,))) == "<scenario of two.scenic: something given>"
    assert repr(scenic_ref.loads("ego = new Object", dialect="scenic-3")).startswith("<scenario of <string>: dialect scenic-3")


def test_scenes_and_objects_are_a_line() -> None:
    scene = scenic_ref.loads("ego = Object at 1.5 @ 0\nObject at 5 @ 5\n").sample(7, 2)
    assert repr(scene) == "<scene 2 of seed 7, 1 attempt, 2 objects: ego, Object>"
    assert [repr(o) for o in scene.objects] == ["<Object ego at (1.5, 0), heading 0>", "<Object at (5, 5), heading 0>"]
    many = scenic_ref.loads("ego = Object\nfor i in range(1, 7):\n    Object at (3 * i) @ 0\n").sample()
    assert repr(many).endswith("7 objects: ego, Object, Object, Object, Object, ...>")


def test_a_page_has_the_picture_and_the_numbers_and_no_markup_of_the_program() -> None:
    scene = scenario().sample(3)
    page = scene._repr_html_()
    assert "data:image/png;base64," in page and "<td>ego</td>" in page and f"<td>{scene.ego.position.x:.6g}</td>" in page
    for text in (page, scenario()._repr_html_()):
        assert "<script" not in text and html.escape("<script>") in text
    assert len(re.findall("<tr><td>", page)) == 4, "two objects, two parameters"


def test_long_tables_say_how_much_is_left_out() -> None:
    page = scenic_ref.loads("ego = Object with viewDistance 500\nfor i in range(1, 40):\n    Object at (3 * i) @ 0\n").sample()._repr_html_()
    assert "and 10 more" in page and len(re.findall("<tr><td>", page)) == 30


def test_what_cannot_be_drawn_is_said_in_its_place() -> None:
    scene = scenic_ref.loads("ego = Object at 1e10 @ 0\n").sample()
    assert "cannot be drawn" in scene._repr_html_() and "<table>" in scene._repr_html_()
    with pytest.raises(UsageError, match="cannot be drawn"):
        scene.plot()


def test_scenes_are_drawn_in_the_axes_that_are_given() -> None:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    scene = scenario().sample()
    assert scene.plot(axes) is axes and len(axes.patches) >= 4
    assert scene.plot(ax=None).figure is not figure
    plt.close("all")


def test_many_scenes_in_one_figure() -> None:
    import matplotlib.pyplot as plt

    figure = scenario().plot(5, seed=2)
    assert [axes.get_title() for axes in figure.axes] == [f"seed 2, scene {k}" for k in range(5)]
    plt.close("all")


def test_a_scene_without_objects_has_a_picture() -> None:
    scene = scenic_ref.loads("param x = 3\n", profile="scenic-3").sample()
    assert picture([scene]).startswith(b"\x89PNG") and repr(scene) == "<scene 0 of seed 0, 1 attempt, 0 objects>"


@pytest.mark.parametrize("call, said", [
    (lambda: scenic_ref.loads(3), "a program is a text, not 3"),  # type: ignore[arg-type]
    (lambda: scenic_ref.loads("examples/scene.scenic"), "examples/scene.scenic is a path, not the text of a program"),
    (lambda: scenic_ref.load(3), "a path is a text or a `pathlib.Path`, not 3"),  # type: ignore[arg-type]
    (lambda: scenario(params=3), 'params maps names to values, as in {"time": 12}, and is not 3'),
    (lambda: scenario(params={3: 4}), "params maps names to values"),
    (lambda: scenario(readings=["soft"]), "readings maps names to values"),
    (lambda: scenario(fuel="a"), "fuel is a whole number of at least 1, not 'a'"),
    (lambda: scenario(directory=3), "a directory is a text or a `pathlib.Path`, not 3"),
    (lambda: scenario().sample().plot(3), "ax is axes of matplotlib, or None for new ones, not 3"),
    (lambda: scenario().plot(0), "n is a whole number of at least 1, not 0"),
    (lambda: scenario().plot(101), "a picture holds 100 scenes at most, not 101"),
    (lambda: scenario().plot(1, seed="a"), "seed is a whole number, not 'a'"),
])  # fmt: skip
def test_wrong_arguments_are_usage_errors(call, said: str) -> None:
    with pytest.raises(UsageError) as problem:
        call()
    assert said in problem.value.message


def test_all_public_names_are_listed_before_they_are_used() -> None:
    command = "import scenic_ref; print(set(scenic_ref.__all__) <= set(dir(scenic_ref)))"
    assert subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True).stdout == "True\n"


def test_what_is_returned_is_told_in_a_line() -> None:
    text = "param a = Uniform(1, 2)\nbehavior B():\n    while True:\n        take 1\nego = Object with behavior B()\nrequire[0.5] True\n"
    scenario = scenic_ref.loads(text)
    run = scenario.simulate("still", 5)
    told = "<simulation 0 of seed 0, 1 object, 5 time steps (5 s), time limit: 5 time steps have passed>"
    assert repr(run.simulation) == told and repr(run).endswith(f"the last one accepted: {told}>")
    assert repr(run.simulation.moments[1]) == "<time step 1, 1 object, 1 agent acting>"
    assert repr(scenario.enumerate()) == "<2 outcomes, exact, of 4 runs; a run is accepted with probability 1>"
    assert repr(scenario.enumerate_simulations(steps=1)).startswith("<2 simulations, exact, of ")
    assert repr(scenario.infer("importance", 3)).startswith("<3 scenes by importance in ")
    assert repr(scenario.sample_many(1)) == "<1 scene, 0 of them drawn>"


@pytest.mark.parametrize(
    ("wrong", "last"),
    [
        (lambda s: s.sample_many(3, backend="interpeter"), "hint: did you mean interpreter?"),
        (lambda s: s.sample_many(3, backend="smc"), "hint: `infer` has it"),
        (lambda s: s.infer("scm", 3), "hint: did you mean smc?"),
        (lambda s: s.infer("gibbs", 3), "hint: the backends are importance, smc and mcmc"),
        (lambda s: s.simulate("kinematik"), "hint: did you mean kinematic?"),
        (lambda s: scenic_ref.loads("ego = Object", profile="papper"), "hint: did you mean paper?"),
        (lambda s: scenic_ref.loads("ego = Objct").sample(), "hint: did you mean Object?"),
    ],
)  # fmt: skip
def test_tracebacks_show_the_hint_once_also_from_other_processes(wrong: Callable[[scenic_ref.Scenario], object], last: str) -> None:
    with pytest.raises(scenic_ref.errors.ScenicError) as found:
        wrong(scenic_ref.loads("ego = Object"))
    for error in (found.value, pickle.loads(pickle.dumps(found.value))):
        assert "".join(traceback.format_exception(error)).splitlines()[-1] == last
        assert error.__notes__ == [last]


def test_a_directory_may_be_a_text(tmp_path):
    (tmp_path / "places.scenic").write_text("far = 30\n")
    text = "from places import far\nego = Object at far @ 0\n"
    assert scenic_ref.loads(text, directory=str(tmp_path)).sample().objects[0].position == (30, 0)
