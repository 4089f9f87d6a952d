"""The plugin for pytest: programs beside a test, tests that are run for many scenes, and scenes that failed."""

from __future__ import annotations

import inspect
import json
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.inference.batch import Batch
from scenic_ref.testing import failed_scenes, plugin

pytest_plugins = ["pytester"]
ROOT = Path(__file__).parent.parent.parent
LOADED = Batch  # so that runs of pytest in this process, which forget what they import, forget nothing of the package
PROGRAM = "x = Range(0, 1)\nego = Object at x @ 0\nparam time = 3\n"
TESTS = """
import pytest

@pytest.mark.scenic("car.scenic", scenes=5, seed=5)
def test_left(scene):
    assert scene.ego.position.x < 0.5
"""
FAILED = [1, 4]
"""The scenes of seed 5 for which that fails, of the first five."""

Run = Callable[..., pytest.RunResult]


@pytest.fixture
def run(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs pytest with nothing but its own plugins and ours, in a folder with a program."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    (pytester.path / "car.scenic").write_text(PROGRAM)

    def started(*arguments: str, **texts: str) -> pytest.RunResult:
        for name, text in texts.items():
            (pytester.path / f"{name}.py").write_text(text)
        return pytester.runpytest_inprocess("-p", "scenic_ref.testing.plugin", "--strict-markers", *arguments)

    return started


def order(result: pytest.RunResult) -> list[tuple[int, int]]:
    """The seeds and numbers of the scenes in the order of the run, by the lines of `-v`."""
    found = (re.search(r"\[scene (\d+) of seed (-?\d+)\] (?:PASSED|FAILED|ERROR)", line) for line in result.outlines)
    return [(int(match[2]), int(match[1])) for match in found if match is not None]


def files(pytester: pytest.Pytester) -> list[dict[str, object]]:
    """What is kept."""
    return [json.loads(path.read_text()) for path in sorted((pytester.path / ".pytest_cache" / "d" / "scenic").glob("*"))]


# What is run


def test_a_test_is_run_for_each_scene(run: Run):
    result = run("-v", test_a=TESTS)
    result.assert_outcomes(passed=3, failed=2)
    assert order(result) == [(5, number) for number in range(5)]
    scenario = scenic_ref.loads(PROGRAM)
    assert [n for n in range(5) if scenario.sample(5, n).ego.position.x >= 0.5] == FAILED  # type: ignore[union-attr]


def test_the_fixture_loads_files_beside_the_test_and_texts(run: Run, pytester: pytest.Pytester):
    inner = pytester.mkdir("inner")
    (inner / "lib.scenic").write_text("x = 7\n")
    (inner / "own.scenic").write_text("import lib\nego = Object at lib.x @ 0\n")
    (inner / "test_b.py").write_text(
        "from pathlib import Path\n"
        "def test_a_file(scenic): assert scenic('own.scenic').sample().ego.position.x == 7\n"
        "def test_a_path(scenic): assert scenic(Path('own.scenic')).sample().ego.position.x == 7\n"
        "def test_a_text(scenic): assert scenic('import lib\\nego = Object at lib.x @ 1').sample().ego.position.y == 1\n"
        "def test_options(scenic): assert scenic('../car.scenic', params={'time': 4}).sample().params['time'] == 4\n"
        "def test_two_words(scenic): assert scenic('ego = Object').sample().ego.width == 1\n"
    )
    run("inner").assert_outcomes(passed=5)


def test_the_command_line_wins_over_the_marker_and_that_over_the_settings(run: Run, pytester: pytest.Pytester):
    pytester.makeini("[pytest]\nscenic_scenes = 3\nscenic_seed = 8\n")
    text = "import pytest\n@pytest.mark.scenic('car.scenic'%s)\ndef test_x(scene): pass\n"
    assert order(run("-v", test_a=text % "")) == [(8, 0), (8, 1), (8, 2)]
    assert order(run("-v", test_a=text % ", scenes=1, seed=-4")) == [(-4, 0)]
    assert order(run("-v", "--scenic-scenes", "2", "--scenic-seed", "6", test_a=text % ", scenes=1, seed=-4")) == [(6, 0), (6, 1)]


def test_without_settings_there_are_ten_scenes_of_seed_0(run: Run):
    text = "import pytest\n@pytest.mark.scenic('car.scenic')\ndef test_x(scene): pass\n"
    assert order(run("-v", test_a=text)) == [(0, number) for number in range(10)]


def test_markers_of_module_class_and_function_add_up(run: Run):
    text = (
        "import pytest\npytestmark = pytest.mark.scenic('car.scenic', seed=3)\n@pytest.mark.scenic(scenes=2, params={'time': 5})\nclass TestX:\n"
        "    def test_x(self, scene): assert scene.params['time'] == 5\n    @pytest.mark.scenic(scenes=1)\n    def test_y(self, scene): pass\n"
        "    @pytest.mark.parametrize('n', [1, 2])\n    def test_z(self, scene, n): pass\n    def test_w(self): pass\n"
    )
    result = run("-v", test_a=text)
    result.assert_outcomes(passed=8)
    assert order(result)[:3] == [(3, 0), (3, 1), (3, 0)]


def test_a_fixture_of_the_users_own_with_that_name_is_theirs(run: Run):
    run(test_a="import pytest\n@pytest.fixture\ndef scene(): return 7\ndef test_x(scene): assert scene == 7\n").assert_outcomes(passed=1)


# What is kept


def test_failing_scenes_are_kept_and_run_first_whatever_is_asked_for_and_forgotten_once_they_pass(run: Run, pytester: pytest.Pytester):
    run(test_a=TESTS)
    kept_ = files(pytester)
    assert sorted(one["number"] for one in kept_) == FAILED  # type: ignore[type-var]
    one = next(found for found in kept_ if found["number"] == 4)
    assert one["test"] == "test_a.py::test_left"
    assert one["seed"] == 5
    assert one["program"] == str(pytester.path / "car.scenic")
    assert one["scene"]["scene"] == 4  # type: ignore[index]
    assert order(run("-v", "--scenic-seed", "8", "--scenic-scenes", "1")) == [(5, 1), (5, 4), (8, 0)]
    assert order(run("-v"))[:3] == [(5, 1), (5, 4), (5, 0)]
    run(test_a=TESTS.replace("< 0.5", "< 0.6"))
    assert [found["number"] for found in files(pytester)] == [4]
    run(test_a=TESTS.replace("< 0.5", "< 2"))
    assert files(pytester) == []
    assert order(run("-v")) == [(5, number) for number in range(5)]


def test_scenes_that_were_not_run_stay_kept(run: Run, pytester: pytest.Pytester):
    run(test_a=TESTS)
    run("test_a.py::test_left[scene 1 of seed 5]").assert_outcomes(failed=1)
    run("--collect-only")
    assert len(files(pytester)) == 2


def test_last_failed_knows_them(run: Run):
    run(test_a=TESTS)
    assert order(run("-v", "--lf")) == [(5, 1), (5, 4)]


def test_a_scene_that_fails_with_one_parameter_and_passes_with_another_is_kept(run: Run, pytester: pytest.Pytester):
    text = TESTS.replace("def test_left(scene)", "@pytest.mark.parametrize('most', [0.5, 2])\ndef test_left(scene, most)").replace("< 0.5", "< most")
    run(test_a=text)
    assert sorted(found["number"] for found in files(pytester)) == FAILED  # type: ignore[type-var]


def test_without_pytests_cache_nothing_is_kept(run: Run, pytester: pytest.Pytester):
    result = run("-p", "no:cacheprovider", test_a=TESTS)
    result.assert_outcomes(passed=3, failed=2)
    assert not (pytester.path / ".pytest_cache").exists()
    assert "again: scenic-ref run" in result.stdout.str()
    assert "kept in" not in result.stdout.str()


def test_what_is_broken_in_the_cache_is_passed_over(run: Run, pytester: pytest.Pytester):
    run(test_a=TESTS)
    folder = pytester.path / ".pytest_cache" / "d" / "scenic"
    good = json.loads(next(folder.glob("*.json")).read_text())
    for number, text in enumerate(("", "[]", "{", "[" * 100_000, "\udcff", json.dumps({**good, "number": -1}), json.dumps({**good, "test": 3}))):
        (folder / f"z{number}.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    assert order(run("-v"))[:3] == [(5, 1), (5, 4), (5, 0)]


def test_only_some_scenes_are_kept_of_a_test(run: Run, pytester: pytest.Pytester):
    run("--scenic-scenes", "30", test_a=TESTS.replace("< 0.5", "< 0"))
    assert len(files(pytester)) == failed_scenes.MOST_KEPT == 20


def test_a_folder_that_cannot_be_written_keeps_nothing(run: Run, pytester: pytest.Pytester):
    (pytester.path / ".pytest_cache").write_text("in the way")
    run("-p", "no:warnings", test_a=TESTS).assert_outcomes(passed=3, failed=2)


@pytest.mark.slow
def test_processes_of_xdist_keep_and_run_them_as_one_does(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    (pytester.path / "car.scenic").write_text(PROGRAM)
    (pytester.path / "test_a.py").write_text(TESTS)
    command = ("-p", "scenic_ref.testing.plugin", "-p", "xdist.plugin", "-n", "2", "--scenic-seed")
    pytester.runpytest_subprocess(*command, "5").assert_outcomes(passed=3, failed=2)
    assert sorted(found["number"] for found in files(pytester)) == FAILED  # type: ignore[type-var]
    pytester.runpytest_subprocess(*command, "8", "--scenic-scenes", "1").assert_outcomes(passed=1, failed=2)


# What is told


def test_a_failure_shows_the_scene_and_the_command_that_draws_it_again(run: Run, pytester: pytest.Pytester):
    text = TESTS.replace("seed=5", "seed=5, profile='scenic-3', readings={'soft': 'paper'}, params={'time': 4, 'name': 'it\\'s', 'n': '3'}")
    result = run(test_a=text.replace(", readings={'soft': 'paper'}", ""))
    said = result.stdout.str()
    assert "scene 1 of seed 5 of car.scenic\n<scene 1 of seed 5, 1 attempt, 1 object: ego>\n  <Object ego at (" in said
    again = next(line for line in result.outlines if line.startswith("again: ")).removeprefix("again: ")
    assert "kept in .pytest_cache/d/scenic/test_left-" in said
    drawn = subprocess.run(again.replace("scenic-ref", f"{sys.executable} -P -m scenic_ref"), shell=True, capture_output=True, text=True, check=True)
    record = next(found for found in files(pytester) if found["number"] == 1)
    assert json.loads(drawn.stdout) == record["scene"]


def test_of_a_text_the_call_is_told(run: Run):
    text = "import pytest\n@pytest.mark.scenic('ego = Object at Range(0, 1) @ 0', scenes=1, seed=2, params={'a': 1})\ndef test_x(scene): assert 0\n"
    assert "again: scenic_ref.loads(..., params={'a': 1}).sample(2, 0)" in run(test_a=text).stdout.str()


def test_after_too_many_attempts_what_is_told_gives_up_as_soon(run: Run):
    text = "import pytest\n@pytest.mark.scenic('ego = Object\\nrequire Range(0, 1) > 2', scenes=1, max_attempts=7)\ndef test_x(scene): pass\n"
    said = run(test_a=text).stdout.str()
    assert "no scene in 7 attempts" in said
    assert "again: scenic_ref.loads(...).sample(0, 0, max_attempts=7)" in said


def test_an_error_of_a_program_has_its_place_there_and_not_the_lines_of_the_package(run: Run, pytester: pytest.Pytester):
    (pytester.path / "bad.scenic").write_text("x = 1\nego = Object at nosuch\n")
    text = (
        "import pytest\n@pytest.mark.scenic('bad.scenic', scenes=1)\ndef test_x(scene): pass\n"
        "def test_y(scenic):\n    scenic('bad.scenic').sample()\ndef test_z(scenic):\n    scenic('x = (\\n')\n"
    )
    result = run(test_a=text)
    said, _, _ = result.stdout.str().partition("short test summary")  # which pytest cuts short, but where CI is set
    result.assert_outcomes(errors=1, failed=2)
    assert said.count("bad.scenic:2:17: ego = Object at nosuch") == 2 and said.count("hint: assign it first") == 2
    assert "premises.py" not in said and "scenario.py" not in said
    assert "premises.py" in run("--full-trace", "-k", "test_y").stdout.str()
    assert files(pytester) == []  # the fault is no scene's


def test_a_program_without_scenes_says_so_and_which(run: Run, pytester: pytest.Pytester):
    (pytester.path / "never.scenic").write_text("ego = Object at Range(0, 1) @ 0\nrequire ego.position.x > 0.99999\n")
    text = "import pytest\n@pytest.mark.scenic('never.scenic', scenes=1, max_attempts=3)\ndef test_x(scene): pass\n"
    said = run(test_a=text).stdout.str()
    assert "no scene in 3 attempts" in said
    assert "scene 0 of seed 0 of never.scenic" in said


@pytest.mark.parametrize(
    ("marker", "argument", "message"),
    [
        ("'nosuch.scenic', scenes=1", "scene", "there is no file"), ("scenes=1", "scene", "needs a program"),
        ("'a.scenic', 3", "scene", "takes one program"),
        ("'car.scenic', scenes=0", "scene", "at least one scene"), ("'car.scenic', scenes='3'", "scene", "scenes='3': a whole number is expected"),
        ("'car.scenic', seed=0.5", "scene", "seed=0.5: a whole number is expected"), ("'car.scenic', scene=3", "scene", "there is no option scene"),
        ("3", "scene", "a program is the name of a file, or a text, not 3"), ("'car.scenic', max_attempts=0", "scene", "max_attempts=0"),
        ("'car.scenic'", "scenic", "must take the fixture `scene`"),
    ],
)  # fmt: skip
def test_a_wrong_marker_is_told(run: Run, marker, argument, message):
    result = run(test_a=f"import pytest\n@pytest.mark.scenic({marker})\ndef test_x({argument}): pass\n")
    assert message in result.stdout.str()
    assert "INTERNALERROR" not in result.stdout.str()
    assert result.parseoutcomes().get("passed", 0) == 0


def test_a_wrong_option_or_setting_is_told(run: Run, pytester: pytest.Pytester):
    assert "a whole number from 1 is expected, not '0'" in run("--scenic-scenes", "0", test_a=TESTS).stderr.str()
    pytester.makeini("[pytest]\nscenic_scenes = many\n")
    assert "scenic_scenes = many: a whole number is expected" in run(test_a=TESTS.replace("scenes=5, ", "")).stdout.str()


def test_the_fixture_without_the_marker_says_what_it_needs(run: Run):
    assert "the fixture `scene` needs the marker scenic" in run(test_a="def test_x(scene): pass\n").stdout.str()


def test_the_marker_is_listed(run: Run):
    assert "@pytest.mark.scenic(program, scenes=10, seed=0" in run("--markers").stdout.str()


# What it costs


def test_the_options_of_a_program_are_those_of_load():
    assert set(plugin.LOADED_BY) == set(inspect.signature(scenic_ref.load).parameters) - {"path"}


def test_pytest_finds_the_plugin_and_it_loads_nothing_that_no_test_asks_for(tmp_path):
    entries = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]["pytest11"]
    assert entries == {"scenic": plugin.__name__}
    code = (
        "import sys, pytest; pytest.main(['--collect-only', '-q', '-p', 'scenic_ref.testing.plugin', '.']); "
        "print(*(n for n in sys.modules if n.startswith(('scenic_ref', 'numpy', 'scipy', 'shapely', 'lark'))))"
    )
    variables = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    said = subprocess.run([sys.executable, "-P", "-c", code], cwd=tmp_path, env=variables, capture_output=True, text=True, check=True).stdout
    assert set(said.splitlines()[-1].split()) == {"scenic_ref", "scenic_ref.testing", "scenic_ref.testing.plugin", "scenic_ref.testing.failed_scenes"}


# What is documented


def test_the_example_of_the_page_does_what_it_says(run: Run, pytester: pytest.Pytester):
    page = (ROOT / "docs" / "testing.md").read_text()
    (program,) = re.findall(r"^```scenic\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    first, second = re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    (pytester.path / "crossing.scenic").write_text(program)
    run(test_crossing=first).assert_outcomes(passed=21)
    run("test_more.py", test_more="import pytest\n" + second).assert_outcomes(passed=100)
    (shown,) = re.findall(r"^(scene 4 of seed 5 of .*?^)again", page, re.DOTALL | re.MULTILINE)
    run("test_wrong.py", test_wrong=first.replace("scene.objects[1].position.y > scene.ego.position.y", "scene.index != 4")).stdout.fnmatch_lines(
        [line.replace("[", "[[]") for line in shown.splitlines()]
    )
    assert all(f"`{name}`" in page for name in plugin.LOADED_BY)
    assert f"At most {failed_scenes.MOST_KEPT} are kept" in page


def test_a_wrong_marker_is_an_error_of_that_test_alone(run: Run) -> None:
    text = """
import pytest
@pytest.mark.scenic("cra.scenic")
def test_no_file(scene): pass
@pytest.mark.scenic("car.scenic", scens=3)
def test_no_option(scene): pass
@pytest.mark.scenic("car.scenic")
def test_no_fixture(): pass
@pytest.mark.scenic("car.scenic", scenes=2)
def test_good(scene): pass
def test_other(): pass
"""
    result = run(test_a=text)
    result.assert_outcomes(passed=3, errors=3)
    assert "During handling" not in result.stdout.str()
    result.stdout.fnmatch_lines_random([
        "the marker scenic of test_no_file: there is no file cra.scenic; did you mean car.scenic?",
        "the marker scenic of test_no_option: there is no option scens of a program; *",
        "test_no_fixture has the marker scenic, and must take the fixture `scene`: def test_no_fixture(scene)",
        "ERROR test_a.py::test_no_file*",
    ])  # fmt: skip
