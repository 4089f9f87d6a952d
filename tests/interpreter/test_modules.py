"""Modules: `__all__`, relative names, packages, and imports of what does not exist."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.api import loads
from scenic_ref.semantics.python.imports import package_of, path_of, sibling_module_key
from scenic_ref.semantics.store.errors import (
    ImportRefused,
    ProgramError,
    RunError,
    ScenicError,
    UncaughtException,
)


def params(folder: Path, files: dict[str, str], program: str, **options: object) -> dict[str, object]:
    """The parameters of a program among these files."""
    for name, text in {**files, "program.scenic": program}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return dict(scenic_ref.load(folder / "program.scenic", **options).sample().params)  # type: ignore[arg-type]


LISTED = "x = 1\n_y = 2\nz = 3\nclass Box(Object):\n    width: 5\n"


@pytest.mark.parametrize("statement", ["from lib import *", "model lib", "from .lib import *"])
@pytest.mark.parametrize("ending", ["scenic", "py"])
def test_a_star_imports_what_all_says(tmp_path, statement, ending):
    text = LISTED if ending == "scenic" else LISTED[: LISTED.index("class")]
    program = f"{statement}\nego = Object\nparam r = [x, _y]\n"
    files = {f"lib.{ending}": f"{text}__all__ = ['x']\n__all__ += ['_y']\n"}
    assert params(tmp_path, files, program, trust=True) == {"r": [1, 2]}
    with pytest.raises(RunError, match="z is not defined"):
        params(tmp_path, files, f"{program}param s = z\n", trust=True)


def test_without_all_a_star_imports_what_does_not_begin_with_an_underscore(tmp_path):
    files = {"lib.scenic": LISTED}
    assert params(tmp_path, files, "from lib import *\nego = Box\nparam r = x + z\n") == {"r": 4}
    with pytest.raises(RunError, match="_y is not defined"):
        params(tmp_path, files, "from lib import *\nego = Box\nparam r = _y\n")


@pytest.mark.parametrize(("listed", "message"), [
    ("3", "is not a list of names"), ("[1]", "is not a list of names"), ("'x'", "is not a list of names"), ("['w']", "the module lib has no w"),
    ("[Uniform('x', 'x')]", "is not a list of names"),
])  # fmt: skip
def test_an_all_that_is_none(tmp_path, listed, message):
    with pytest.raises(RunError, match=message) as found:
        params(tmp_path, {"lib.scenic": f"x = 1\n__all__ = {listed}\n"}, "pass\nfrom lib import *\nego = Object\n")
    assert found.value.span.line == 2


TREE = {
    "top.scenic": "v = 'top'\n",
    "b.scenic": "v = 'b of the program'\n",
    "sub/a.scenic": "from .b import *\nfrom . import c\nfrom .deep import d\nfrom ..top import v as above\nimport b as absolute\n"
    "def late():\n    from .c import v\n    return v\n",
    "sub/b.scenic": "v = 'sub/b'\n",
    "sub/c.scenic": "v = 'sub/c'\n",
    "sub/deep/d.scenic": "from ..b import v\nfrom ...top import v as above\nfrom .. import c\n",
}


def test_relative_names_begin_in_the_folder_of_the_importing_module(tmp_path):
    program = """
from sub import a
import sub.deep.d as d
from .sub.c import v as c
ego = Object
param r = [a.v, a.c.v, a.d.v, a.above, a.absolute.v, a.late()]
param same = a.d is d and d.c is a.c
"""
    expected = ["sub/b", "sub/c", "sub/b", "top", "b of the program", "sub/c"]
    assert params(tmp_path, TREE, program) == {"r": expected, "same": True}


def test_a_module_runs_once_however_it_is_named(tmp_path):
    files = {"log.scenic": "times = []\n", "sub/a.scenic": "from ..log import times\ntimes.append(1)\n", "sub/b.scenic": "from . import a\n"}
    program = "import sub.a\nfrom .sub import a, b\nfrom sub.a import times\nfrom .log import times as t\nego = Object\nparam r = [times, t]\n"
    assert params(tmp_path, files, program) == {"r": [[1], [1]]}


def test_a_relative_name_is_no_module_from_elsewhere(tmp_path):
    for text in ("from .math import sqrt", "from .mars import Rover", "from . import math", "from .sub.math import sqrt"):
        with pytest.raises(UncaughtException, match=r"there is no module|has no"):
            params(tmp_path, TREE, f"{text}\nego = Object\n")
    program = "try:\n    from .math import pi\nexcept ImportError:\n    import math\nego = Object\nparam r = math.floor(2.5)\n"
    assert params(tmp_path, TREE, program) == {"r": 2}


def test_python_modules_beside_the_importing_module_need_trust(tmp_path):
    files = {"sub/a.scenic": "from .helper import three\n", "sub/helper.py": "three = 3\n"}
    program = "from sub.a import three\nego = Object\nparam r = three\n"
    with pytest.raises(ImportRefused, match=r"sub\.helper runs Python code"):
        params(tmp_path, files, program)
    assert params(tmp_path, files, program, trust=True) == {"r": 3}


@pytest.mark.parametrize("text", [
    "import nope", "from nope import x", "from math import nope", "from .nope import x", "from sub.a import nope", "import sub.nope",
])  # fmt: skip
@pytest.mark.parametrize("kind", ["ImportError", "Exception"])
def test_what_does_not_exist_can_be_caught(tmp_path, text, kind):
    program = f"r = 'imported'\ntry:\n    {text}\nexcept {kind} as problem:\n    r = str(problem)\nego = Object\nparam r = r\n"
    found = params(tmp_path, TREE, program)["r"]
    assert isinstance(found, str) and ("there is no module" in found or "has no nope" in found)


def test_a_module_that_is_refused_cannot_be_caught(tmp_path):
    with pytest.raises(ImportRefused, match="needs --trust"):
        params(tmp_path, {}, "try:\n    import os\nexcept ImportError:\n    pass\nego = Object\n")


def test_a_module_that_fails_is_not_imported(tmp_path):
    files = {"bad.scenic": "x = 1\nraise ValueError('bad')\n"}
    program = "def attempt():\n    try:\n        import bad\n        return bad.x\n    except ValueError as problem:\n        return str(problem)\n"
    assert params(tmp_path, files, f"{program}ego = Object\nparam r = [attempt(), attempt()]\n") == {"r": ["bad", "bad"]}


@pytest.mark.parametrize(("text", "hint"), [
    ("from math import sqr", "did you mean sqrt?"), ("import maths", "did you mean math?"), ("from sub.a import lat", "did you mean late?"),
    ("from numpy import arry", "give --trust"),
])  # fmt: skip
def test_the_error_names_the_nearest_name(tmp_path, text, hint):
    with pytest.raises(RunError) as found:
        params(tmp_path, TREE, f"{text}\nego = Object\n")
    assert hint in found.value.hint
    assert found.value.span.line == 1


def test_an_unknown_name_of_a_trusted_module(tmp_path):
    program = "try:\n    from json import nope\nexcept ImportError as problem:\n    r = str(problem)\nego = Object\nparam r = r\n"
    assert params(tmp_path, {}, program, trust=True) == {"r": "the module json has no nope in this reference"}
    program = program.replace("from json import nope", "import json.nope")
    assert params(tmp_path, {}, program, trust=True) == {"r": "there is no module json.nope"}


def test_keys():
    assert [sibling_module_key("b", level, ".sub.deep") for level in (1, 2, 3, 4)] == [".sub.deep.b", ".sub.b", ".b", "..b"]
    assert [sibling_module_key("", level, ".") for level in (1, 2)] == [".", ".."]
    assert [package_of(key) for key in (".a", ".sub.a", "..a", "..sub.deep.a", "math")] == [".", ".sub", "..", "..sub.deep", "."]
    assert [path_of(key) for key in (".a", ".sub.a", "..a", "..sub.deep.a")] == ["a.scenic", "sub/a.scenic", "../a.scenic", "../sub/deep/a.scenic"]


@pytest.mark.parametrize("dialect", ["paper", "scenic-2.1"])
def test_a_module_knows_its_name_and_its_file_but_not_where_the_program_stands(tmp_path, dialect):
    told = "told = [__name__, __file__]\n"
    files = {"lib.scenic": told, "sub/lib.scenic": f"from .deep import other\n{told}", "sub/deep/other.scenic": told}
    program = "import lib, sub.lib\nego = Object\n" + told + "param r = [told, lib.told, sub.lib.told, sub.lib.other.told, lib.__name__]\n"
    assert params(tmp_path, files, program, dialect=dialect)["r"] == [
        ["__main__", "program.scenic"], ["lib", "lib.scenic"], ["sub.lib", "sub/lib.scenic"], ["sub.deep.other", "sub/deep/other.scenic"], "lib",
    ]  # fmt: skip


def test_what_is_only_for_the_main_program_is_not_run_by_an_import(tmp_path):
    main = "if __name__ == '__main__':\n    ego = Object at 1 @ 2\n"
    assert params(tmp_path, {"lib.scenic": f"{main}x = 3\n"}, "from lib import x\nego = Object\nparam r = [x, ego.position.x]\n") == {"r": [3, 0]}
    assert scenic_ref.loads(main).sample().objects[0].position.x == 1


def test_a_program_from_a_text_has_a_name_and_no_file():
    assert scenic_ref.loads("ego = Object\nparam r = __name__\n").sample().params == {"r": "__main__"}
    with pytest.raises(RunError, match="__file__ is not defined"):
        scenic_ref.loads("ego = Object\nparam r = __file__\n").sample()
    with pytest.raises(RunError, match="name is not defined") as found:
        scenic_ref.loads("ego = Object\nparam r = name\n").sample()
    assert "__name__" not in found.value.hint


@pytest.mark.parametrize(
    "text",
    ["from scenic.domains.driving.workspace import DrivingWorkspace", "import scenic.syntax.veneer", "model scenic.simulators.webots.model"],
)
def test_a_module_of_the_releases_that_is_not_here_is_named(tmp_path, text):
    with pytest.raises(UncaughtException) as found:
        params(tmp_path, {}, f"{text}\nego = Object\n")
    assert f"the module {text.split()[1]} of the released implementations is outside this reference" in str(found.value)
    assert ("world models are scenic.simulators.gta.model" in found.value.hint) is text.startswith("model")  # it lists no inner modules
    assert "missing" not in found.value.hint and "paths" not in found.value.hint
    assert found.value.span.line == 1
    with pytest.raises(UncaughtException, match=r"scenic\.simulators\.gta\.modle") as found:
        params(tmp_path, {}, "model scenic.simulators.gta.modle\nego = Object\n")
    assert found.value.hint == "did you mean scenic.simulators.gta.model?"


@pytest.mark.parametrize("module", ["newtonian", "newtonian.simulator", "webots"])
def test_a_simulator_can_be_imported_and_named_and_not_called(module: str) -> None:
    name = "WebotsSimulator" if module == "webots" else "NewtonianSimulator"
    text = f"from scenic.simulators.{module} import {name}\nego = new Object\n"
    assert loads(f"{text}simulator {name}(timestep=0.1)\n", dialect="scenic-3").sample().ego.position == (0, 0)
    with pytest.raises(ProgramError, match="scenic-ref simulate --simulator NAME"):
        loads(f"{text}x = {name}()\n", dialect="scenic-3").sample()


WHY_OUTSIDE = {
    "scenic.simulators.carla.sensors": "write `model scenic.domains.driving.model`",
    "scenic.simulators.webots.model": "a simulator that",
    "scenic.core.geometry": "a part of theirs",
}


@pytest.mark.parametrize(("module", "why"), WHY_OUTSIDE.items())
def test_a_module_of_the_releases_that_is_not_here_says_why(module: str, why: str) -> None:
    with pytest.raises(ScenicError, match=why):
        loads(f"model {module}\nego = Object\n").sample(seed=0)


@pytest.mark.parametrize("program", ["import random\nego = Object\nx = random.uniform(0, 1)\n", "from random import uniform\nego = Object\n"])
def test_draws_of_python_say_what_to_write(program: str) -> None:
    with pytest.raises(ScenicError, match="has no uniform") as found:
        loads(program).sample(seed=0)
    assert "Range" in found.value.hint


@pytest.mark.parametrize("statement", ["import town", "from .town import x", "from town import *", "from . import town"])
def test_the_program_is_no_module(tmp_path, statement):
    (tmp_path / "town.scenic").write_text("import lib\nego = Object\n")
    (tmp_path / "lib.scenic").write_text(f"x = 1\n{statement}\n")
    with pytest.raises(UncaughtException, match=r"its file is that of the program itself, which cannot be imported") as caught:
        scenic_ref.load(tmp_path / "town.scenic").sample()
    assert (caught.value.span.file.endswith("lib.scenic"), caught.value.span.line) == (True, 2)
    (tmp_path / "town.scenic").write_text("import math\nego = Object with width math.cos(0)\n")
    (tmp_path / "town.scenic").rename(tmp_path / "math.scenic")
    assert scenic_ref.load(tmp_path / "math.scenic").sample().ego.width == 1


OWN_EGO = "ego = Object at (1, 1), with allowCollisions True\ny = ego.position.x\ndef where(): return ego.position.x\n"
HAS_EGO = "ego = Object at (5, 5)\n"


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        (HAS_EGO + "import m\nparam r = (ego.position.x, m.ego.position.x, m.y)", (5, 1, 1)),
        ("import m\nparam r = (ego.position.x, m.ego.position.x, m.y)", (1, 1, 1)),
        (HAS_EGO + "from m import ego as other\nparam r = (ego.position.x, other.position.x)", (5, 1)),
        ("from m import ego as other\nparam r = (ego.position.x, other.position.x)", (1, 1)),
        (HAS_EGO + "from m import *\nparam r = (ego.position.x, y)", (5, 1)),
        ("from m import *\nparam r = (ego.position.x, y)", (1, 1)),
        (HAS_EGO + "from m import ego\nparam r = ego.position.x", 1),
        ("import m\nego = Object at (5, 5)\nparam r = (ego.position.x, m.ego.position.x, m.where())", (5, 1, 5)),
        (HAS_EGO + "import n\nparam r = (ego.position.x, n.ego.position.x, n.m.ego.position.x)", (5, 2, 1)),
        ("import n\nparam r = (ego.position.x, n.ego.position.x, n.m.ego.position.x)", (2, 2, 1)),
        (HAS_EGO + "try:\n    import bad\nexcept ValueError:\n    pass\nparam r = ego.position.x", 5),
        (HAS_EGO + "import without\nparam r = (ego.position.x, without.where(), hasattr(without, 'ego'))", (5, 5, False)),
    ],
)
def test_the_ego_of_a_module_is_its_own_unless_the_program_has_none(program: str, expected: object, tmp_path: Path) -> None:
    """Reading `ego-of-modules`."""
    files = {
        "m": OWN_EGO, "bad": OWN_EGO + "raise ValueError('x')\n", "without": "def where(): return ego.position.x\n",
        "n": "import m\nego = Object at (2, 2), with allowCollisions True\n", "p": program,
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / f"{name}.scenic").write_text(text)
    scene = scenic_ref.load(tmp_path / "p.scenic").sample()
    assert scene.params["r"] == expected
    assert scene.ego.position.x == (expected[0] if isinstance(expected, tuple) else expected)


@pytest.mark.parametrize("program", ["import m as ego\n", "from m import y as ego\n"])
def test_what_is_imported_as_ego_must_be_an_object(program: str, tmp_path: Path) -> None:
    (tmp_path / "m.scenic").write_text(OWN_EGO)
    (tmp_path / "p.scenic").write_text(program + "ego = Object\n")
    with pytest.raises(RunError) as raised:
        scenic_ref.load(tmp_path / "p.scenic").sample()
    assert raised.value.message == "ego must be an Object"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("scenario Main():\n    setup:\n        ego = Object at (5, 5), with tag 'p'\n        from m import ego\n        param r = ego.tag\n", "m"),
        ("scenario Main():\n    setup:\n        from m import ego\n        param r = ego.tag\n", "m"),
        ("ego = Object at (5, 5), with tag 'p'\ndef f():\n    from m import ego\n    return ego.tag\nparam r = f() + ego.tag\n", "mm"),
        ("ego = Object at (5, 5), with tag 'p'\nfrom m import ego\nparam r = ego.tag\n", "m"),
        ("from m import ego as other\nego = Object at (5, 5), with tag 'p'\nparam r = other.tag + ego.tag\n", "mp"),
    ],
)
def test_an_ego_that_is_imported_by_its_name_is_the_scenes(tmp_path, before, after):
    (tmp_path / "m.scenic").write_text("ego = Object at (9, 9), with tag 'm'\n")
    scene = scenic_ref.loads(before, directory=str(tmp_path)).sample()
    assert scene.params["r"] == after
    assert scene.ego.properties["tag"] == after[-1]
