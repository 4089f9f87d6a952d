"""Warnings name what is most likely a slip, and nothing else: no example has one, and no vector without reason."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import pytest
from scenic_ref.api import load, loads
from scenic_ref.api.diagnostics import warnings_about
from scenic_ref.api.program_loader import scenario_of
from scenic_ref.conformance import load_vectors
from scenic_ref.interpreter.language.lint import DEGREES, NO_EFFECT, ONE_VALUE, UNKNOWN, UNUSED
from scenic_ref.semantics.store.errors import ScenicError

ONE = "Uniform draws one of its arguments, and this is one: always the whole list"
EXAMPLES = Path(__file__).parents[2] / "examples"


def warned(text: str, directory: Path | None = None) -> list[tuple[int, int, str, str]]:
    """The places, sentences and hints of the warnings about a program."""
    return [(w.span.line, w.span.column, w.message, w.hint) for w in warnings_about(loads(text, file="p.scenic", directory=directory))]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ego = Object with widht 5\n", (1, 19, "nothing reads the property widht", "did you mean width?")),
        ("ego = Object at (0, 0),\n    with  lenght 5\n", (2, 11, "nothing reads the property lenght", "did you mean length?")),
        ("class A:\n    viewdistance: 5\nego = A\n", (2, 5, "nothing reads the property viewdistance", "did you mean viewDistance?")),
        ("class A:\n    taste: 5\nego = A with tatse 3\n", (3, 14, "nothing reads the property tatse", "did you mean taste?")),
        ("behavior B():\n    take 1\nego = Object with behaviour B()\n", (3, 19, "nothing reads the property behaviour", "did you mean behavior?")),
        ("import math\nego = Object\n", (1, 8, "nothing uses the import math", "remove it")),
        ("import math\nfrom math import sin\nego = Object at sin(0) @ 0\n", (1, 8, "nothing uses the import math", "remove it")),
        ("import math\nimport math as m\nego = Object at m.sin(0) @ 0\n", (1, 8, "nothing uses the import math", "remove it")),
        ("import math; import math as m\nego = Object at m.sin(0) @ 0\n", (1, 8, "nothing uses the import math", "remove it")),
        ("x = 'a\x0cb'\nimport math\nego = Object\n", (2, 8, "nothing uses the import math", "remove it")),
        ("# a\u2028b\nimport math\nego = Object\n", (2, 8, "nothing uses the import math", "remove it")),
        ("\ufeffimport math as h\nego = Object\n", (1, 8, "nothing uses the import h", "remove it")),
        ("from math import sin, cos\nego = Object with width cos(0)\n", (1, 18, "nothing uses the import sin", "remove it")),
        ("ego = Object facing 90\n", (1, 21, "headings are in radians, and 90 is more than a full turn", "for degrees write 90 deg")),
        (
            "ego = Object facing Range(-180, 90)\n",
            (1, 21, "headings are in radians, and -180 is more than a full turn", "for degrees write Range(-180, 90) deg"),
        ),
        ("class A:\n    heading: -45\nego = A\n", (2, 14, "headings are in radians, and -45 is more than a full turn", "for degrees write -45 deg")),
        ("ego = Object with tag Uniform([1, 2])\n", (1, 31, ONE, "write the values themselves: Uniform(1, 2, 3), or Uniform(*values)")),
        ("xs = [1, 2]\nego = Object at (Uniform(xs), 0)\n", (2, 26, ONE, "write Uniform(*xs)")),
        ("xs = [i for i in (1, 2)]\nego = Object with tag Uniform(xs)\n", (2, 31, ONE, "write Uniform(*xs)")),
        (
            "def f():\n    gap = 3\n    return gap\ndef g():\n    return gap\nego = Object\n",
            (5, 12, "gap is not defined", "only f on line 1 has a variable of that name, its own"),
        ),
        (
            "behavior B():\n    speed = 3\n    take speed\nscenario Main():\n    setup:\n        ego = Object with a speed, with b B()\n",
            (6, 29, "speed is not defined", "only B on line 1 has a variable of that name, its own"),
        ),
        (
            "def f():\n    return (lambda a: a)(a)\nego = Object\n",
            (2, 26, "a is not defined", "only the lambda on line 2 has a variable of that name, its own"),
        ),
        (
            "def f():\n    return nosuch\nego = Object\n",
            (2, 12, "nosuch is not defined", "assign it first, or import it; a text stands in quotation marks"),
        ),
        (
            "model scenic.domains.driving.model\nbehavior B():\n    take SetBrakAction(1)\nego = Car with behavior B()\n",
            (3, 10, "SetBrakAction is not defined", "did you mean SetBrakeAction?"),
        ),
        ("import math as m\nmath = 3\nego = Object with width math\n", (1, 8, "nothing uses the import m", "remove it")),
    ],
)
def test_a_slip_is_warned_about(text: str, expected: tuple[int, int, str, str]) -> None:
    assert warned(text) == [expected]


@pytest.mark.parametrize(
    "text",
    [
        "ego = Object with color 'red'\n",
        "ego = Object with taste 3\n",  # whoever reads the scene may want it
        "ego = Object with widht 5\nparam x = ego.widht\n",
        "ego = Object with widht 5\nparam x = getattr(ego, 'widht')\n",
        "class A:\n    widht: 5\n    width: self.widht\nego = A with widht 3\n",
        "ego = Object with height 3\nObject at (9, 9), with visibleDistance 3\n",
        "import math\nego = Object with width math.pi\n",
        "import math as _m\nego = Object\n",
        "from math import *\nego = Object\n",
        "from __future__ import annotations\nego = Object\n",
        "class A:\n    weight: 3\nego = A\n",
        "ego = Object facing 6.28\n",
        "ego = Object facing 90 deg\n",
        "def f(a, *b, c=1, **d):\n    e = [g for g in b]\n    try:\n        h = a\n    except ValueError as i:\n        raise i\n"
        "    return e, c, d, h, later, ego\nlater = 3\nego = Object\n",
        "from nosuch import *\ndef f():\n    return g\nego = Object\n",
        "scenario Main():\n    setup:\n        ego = Object\n        speed = 3\n    compose:\n        wait\nbehavior B():\n    take speed\n",
        "import mars\nego = Object\n",  # it makes a workspace
        "gap = 3\ndef f():\n    def g():\n        return gap + wide + 1\n    wide = 2\n    return g()\nego = Object at (f(), 0)\n",
        "def f():\n    global gap\n    gap = 3\ndef g():\n    return gap\nego = Object\n",
        "def f():\n    n = 1\n    def g():\n        nonlocal n\n        n = 2\n    return n\nego = Object\n",
        "f = lambda x: [x + y for y in (1, 2)]\nego = Object\n",
        "xs = [1, 2]\nxs = Range(0, 1)\nego = Object with width Uniform(xs)\n",
        "xs = [1, 2]\ndef f(xs):\n    return Uniform(xs)\nego = Object\n",
        "xs = (1, 2)\nego = Object with width Uniform(*xs)\n",
        "import math; import cmath; y: math = 2; z: cmath = 3\nego = Object\n",
    ],
)
def test_what_may_be_meant_is_not_warned_about(text: str) -> None:
    assert warned(text) == []


def test_a_module_beside_the_program_is_not_warned_about_and_one_that_does_something_is_used(tmp_path: Path) -> None:
    (tmp_path / "acts.scenic").write_text("import math\nparam a = 1\nObject at (9, 9), with widht 3\n")
    (tmp_path / "defines.scenic").write_text("import math\nclass Bus:\n    widths: 3\n")
    assert warned("import acts\nego = Object\n", tmp_path) == []
    (tmp_path / "defines.scenic").write_text("class Bus:\n    widths: 3\n")
    assert warned("import defines\nego = Object\n", tmp_path) == [(1, 8, "nothing uses the import defines", "remove it")]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("path", sorted(EXAMPLES.rglob("*.scenic")), ids=lambda path: str(path.relative_to(EXAMPLES)))
def test_no_example_is_warned_about(path: Path) -> None:
    try:
        assert warnings_about(load(path)) == []
    except ScenicError:
        pytest.fail("the example cannot be read") if "released" not in path.parts else None




@pytest.mark.slow
def test_vectors_are_warned_about_imports_that_they_do_not_use_and_what_they_are_about_alone() -> None:
    wrong = []
    others: set[tuple[str, str]] = set()
    for vector in load_vectors():
        for dialect, text in vector.texts.items():
            try:
                warnings = warnings_about(loads(text, dialect=dialect))
            except ScenicError:
                continue
            for warning in warnings:
                if warning.kind != UNUSED:
                    others.add((vector.name, warning.kind))
                    continue
                name = warning.message.removeprefix("nothing uses the import ")
                if re.search(rf"\b{name}\b", re.sub(r"^\s*(import|from)\b.*", "", text, flags=re.MULTILINE)):
                    wrong.append((vector.name, dialect, warning.message))
    assert wrong == []
    assert others == {
        ("refused-a-local-variable-before-it-is-bound", UNKNOWN), ("uniform-of-one-list", ONE_VALUE),
        ("uniform-of-an-unpacked-list", ONE_VALUE), ("headings-as-properties-wrapped", DEGREES),
        ("behavior-without-do", NO_EFFECT), ("scenario-without-do", NO_EFFECT), ("reading-take-in-monitor", NO_EFFECT),
    }  # fmt: skip


PARAMS = "param weight = 4\nego = Object with width globalParameters.weight, with length globalParameters.get('deep', 1)\n"
ONLY_WRITTEN = "it is written with the scenes, and a simulator is told of it; the program does nothing with it"


@pytest.mark.parametrize(
    ("text", "given", "expected"),
    [
        (PARAMS, ["wieght"], [("wieght", "did you mean weight?")]),
        (PARAMS, ["weight", "deep"], []),
        ("ego = Object\n", ["weather"], [("weather", ONLY_WRITTEN)]),
        ("ego = Object at weather @ 0\nweather = 3\n", ["weather"], [("weather", ONLY_WRITTEN)]),  # a variable is no parameter
        ("model gtaLib\nego = Car\n", ["weathr", "time"], [("weathr", "did you mean weather?")]),
        ("scenario Main():\n    setup:\n        param depth = 3\n        ego = Object\n", ["depth"], []),
        ("model scenic.domains.driving.model\nego = Car\n", ["mpa"], [("mpa", "did you mean map?")]),
    ],
)
def test_a_parameter_that_nothing_reads_is_warned_about(text: str, given: list[str], expected: list[tuple[str, str]]) -> None:
    scenario = scenario_of(text, params=dict.fromkeys(given, 2))
    assert [(w.message, w.hint, w.span.line) for w in warnings_about(scenario)] == [
        (f"nothing reads or sets the parameter {name}", hint, 0) for name, hint in expected
    ]


def test_a_map_that_no_module_reads_is_warned_about() -> None:
    (found,) = warnings_about(scenario_of("ego = Object\n", params={"map": "a.xodr"}))
    assert found.hint.startswith("the program has none of the modules that read it: scenic.domains.driving.model, site_map")


def test_python_warns_the_caller_of_parameters_that_nothing_reads_and_the_scene_has_them_all_the_same(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match=r"^nothing reads or sets the parameter wieght: did you mean weight\?$") as found:
        scenario = loads(PARAMS, params={"wieght": 3})
    assert found[0].filename == __file__
    assert scenario.sample().params["wieght"] == 3
    (tmp_path / "p.scenic").write_text(PARAMS)
    with pytest.warns(UserWarning, match="wieght") as found:
        load(tmp_path / "p.scenic", params={"wieght": 3})
    assert found[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        loads(PARAMS, params={"weight": 3})
        loads("model nosuch\n", params={"weight": 3})  # the error comes with the first scene


@pytest.mark.parametrize("dialect", ["paper", "scenic-2.1", "scenic-3"])
def test_names_of_conditions_and_values_of_simulations_are_looked_at(dialect: str) -> None:
    new, released = ("new " if dialect == "scenic-3" else ""), dialect != "paper"
    record = "record gapp\n" if released else ""
    text = f"ego = {new}Object\nterminate when speedd > 3\nrequire eventually nosuch\n{record}"
    found = [w.message for w in warnings_about(loads(text, file="p.scenic", dialect=dialect))]
    assert found == [f"{name} is not defined" for name in ("speedd", "nosuch", "gapp")[: 2 + released]]


@pytest.mark.parametrize(
    "text",
    [
        "param maps = 3\nego = Object\n",  # no module of the program reads `map`
        "param Map = 3\nego = Object with width globalParameters.Map\n",
        "model scenic.domains.driving.model\nparam weather = 3, timestep = 0.1, render = True, lap = 3\nego = Car\n",
        "behavior A():\n    take 1\nbehavior A():\n    take 2\nbehavior B(f):\n    f()\nego = Object with behavior B(print)\n",
        "monitor M:\n    wait\nego = Object\n",
        "behavior B():\n    while True:\n        if self.speed > 3: take 1\n        else: wait\nego = Object with behavior B(), with speed 1\n",
        "behavior B():\n    while True:\n        try: do C()\n        interrupt when self.speed > 3: take 1\nbehavior C(): take 2\n"
        "ego = Object with behavior B(), with speed 1\n",
        "# dialect: scenic-3\nbehavior B():\n    while True:\n        wait for 2 steps\nego = new Object with behavior B()\n",
        "def f(x):\n    while True: x += 1\nego = Object facing 6\nb = Object at (9, 9)\nrequire (apparent heading of ego) < 6\n",
        "ego = Object\nb = Object at (9, 9)\nrequire (distance from ego to b) < 90 and (relative heading of b) < 6\n",
    ],
)
def test_what_is_read_or_run_is_not_warned_about(text: str) -> None:
    assert warned(text) == []
