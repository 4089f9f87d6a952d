"""Hostile programs: each ends in a clear error with its place in the source, and soon."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.semantics.store import errors

sys.path.insert(0, str(Path(__file__).parent))
fuzz = importlib.import_module("fuzz")
sys.path.pop(0)


def refused(text: str, error: type[errors.ScenicError], message: str, **options: object) -> errors.ScenicError:
    with pytest.raises(error) as caught:
        scenic_ref.loads(text, **options).sample(max_attempts=50)
    assert message in str(caught.value)
    assert not isinstance(caught.value, errors.InternalError)
    return caught.value


@pytest.mark.slow
def test_a_program_of_ten_thousand_lines_runs():
    lines = ["ego = Object at (0, 0)", "total = 0"] + [f"total += {i} % 7" for i in range(10_000)] + ["param total = total"]
    scene = scenic_ref.loads("\n".join(lines)).sample()
    assert scene.params["total"] == sum(i % 7 for i in range(10_000))


@pytest.mark.slow
@pytest.mark.parametrize("make", [
    lambda n: "x = " + "(" * n + "1" + ")" * n, lambda n: "x = " + "-" * n + "1", lambda n: "x = " + " + ".join(["1"] * n), lambda n: "x = " + "[" * n + "]" * n,
    lambda n: "x = " + "f(" * n + ")" * n, lambda n: "x = y" + ".y" * n, lambda n: "x = y" + "[0]" * n, lambda n: "x = " + "not " * n + "1",
    lambda n: "\n".join(" " * i + "if 1:" for i in range(n)), lambda n: "x = " + "lambda: " * n + "1", lambda n: "x = " + "1 if 1 else " * n + "1",
    lambda n: "x = " + "visible " * n + "r", lambda n: "x = " + "a at " * n + "b", lambda n: "x = f'" + "{" * n + "1" + "}" * n + "'",
])  # fmt: skip
def test_deep_nesting_gives_a_tree_or_an_error(make, effort):
    for n in (100, 5_000):
        text = "require False\n" + make(n) + "\n"

        def ends(text: str = text) -> None:
            with pytest.raises((errors.ProgramError, errors.AttemptsExhausted)):
                scenic_ref.loads(text).sample(max_attempts=1)

        assert effort(ends) < 200


def test_endless_loop_runs_out_of_fuel():
    error = refused("ego = Object\nwhile True: pass\n", errors.FuelExhausted, "endless loop", fuel=20_000)
    assert error.span.line == 2


def test_endless_recursion_is_stopped():
    refused("def f(x): return f(x + 1)\nego = Object\nf(0)\n", errors.RunError, "is called too deeply")


@pytest.mark.slow
def test_recursive_classes():
    refused("class A(A):\n    pass\nego = A\n", errors.RunError, "A is not defined")
    refused("class A:\n    b: A\nego = A\n", errors.RunError, "without end")


def test_region_of_zero_area_is_named_in_the_report():
    error = refused("ego = Object in CircularRegion((0, 0), 0)\n", errors.AttemptsExhausted, "no area")
    assert error.span.line == 1


def test_region_with_bad_coordinates():
    refused("ego = Object in PolygonalRegion([(0, 0), (1, 1)])\n", errors.RunError, "")
    refused("ego = Object in PolygonalRegion([(0, 0), (2, 2), (2, 0), (0, 2)])\n", errors.RunError, "")
    refused("ego = Object in CircularRegion((0, float('nan')), 1)\n", errors.RunError, "")
    refused("ego = Object in everywhere\n", errors.RunError, "")


def test_empty_uniform():
    assert refused("ego = Object\nx = Uniform()\n", errors.RunError, "has nothing to draw").span.line == 2
    refused("ego = Object\nx = Uniform(*[])\n", errors.RunError, "has nothing to draw")
    refused("ego = Object\nx = Discrete({})\n", errors.RunError, "has nothing to draw")


@pytest.mark.parametrize("number", ["float('nan')", "float('inf')", "1e308 * 10"])
def test_coordinates_that_are_not_numbers(number):
    assert refused(f"ego = Object at ({number}, 0)\n", errors.RunError, "must be finite").span.line == 1
    refused(f"ego = Object with width {number}\n", errors.RunError, "must be finite")
    refused(f"ego = Object with heading {number}\n", errors.RunError, "must be finite")


@pytest.mark.sampled(8)
@pytest.mark.parametrize("expression", [
    "10 ** 10 ** 10", "'a' * 10 ** 12", "[0] * 10 ** 12", "1 << 10 ** 10", "list(range(10 ** 12))", "sum(range(10 ** 12))", "'x'.ljust(10 ** 12)", "pow(7, 10 ** 9)",
    "[x for x in range(10 ** 12)]", "max(range(10 ** 12))", "f'{1:1000000000000}'", "'%1000000000000d' % 1", "format(1, '1000000000000d')", "bytes(10 ** 12)",
])  # fmt: skip
def test_operations_that_would_never_end_or_fill_the_memory(expression, effort):
    def ends() -> None:
        with pytest.raises(errors.ProgramError):
            scenic_ref.loads(f"ego = Object\nx = {expression}\n", fuel=100_000).sample()

    assert effort(ends) < 100


@pytest.mark.parametrize("expression", [
    "(1).__class__", "''.__class__.__mro__", "getattr(1, '__class__')", "'{0.__class__}'.format(1)", "'{x.__class__}'.format_map({'x': 1})", "(lambda: 0).__globals__",
    "[].__class__", "hasattr.__self__", "CircularRegion.__init__", "everywhere._x", "type(1).__base__", "print.__module__", "float.fromhex.__self__",
])  # fmt: skip
def test_private_names_are_out_of_reach(expression):
    with pytest.raises(errors.ProgramError):
        scenic_ref.loads(f"ego = Object\nx = {expression}\n").sample()


@pytest.mark.parametrize("name", ["open", "eval", "exec", "__import__", "compile", "globals", "locals", "vars", "input", "breakpoint", "exit", "dir", "memoryview"])
def test_dangerous_builtins_are_not_there(name):
    refused(f"ego = Object\nx = {name}\n", errors.RunError, f"{name} is not defined")


@pytest.mark.parametrize("name", ["os", "sys", "subprocess", "builtins", "importlib", "pathlib", "numpy", "ctypes"])
def test_python_modules_need_trust(name):
    error = refused(f"ego = Object\nimport {name}\n", errors.ImportRefused, "--trust")
    assert error.span.line == 2


def test_trusted_modules_are_imported(tmp_path):
    (tmp_path / "mine.py").write_text("def double(x):\n    return 2 * x\n")
    (tmp_path / "scene.scenic").write_text("from mine import double\nego = Object\nparam r = double(4)\n")
    with pytest.raises(errors.ImportRefused):
        scenic_ref.load(tmp_path / "scene.scenic").sample()
    assert scenic_ref.load(tmp_path / "scene.scenic", trust=True).sample().params == {"r": 8}


def test_modules_that_import_each_other(tmp_path):
    (tmp_path / "a.scenic").write_text("import b\nx = 1\n")
    (tmp_path / "b.scenic").write_text("import a\ny = 2\n")
    (tmp_path / "scene.scenic").write_text("import a, b\nego = Object\nparam r = a.x + b.y\n")
    assert scenic_ref.load(tmp_path / "scene.scenic").sample().params == {"r": 3}


def test_an_error_in_a_module_is_placed_there(tmp_path):
    (tmp_path / "a.scenic").write_text("x = 1\ny = nothing\n")
    (tmp_path / "scene.scenic").write_text("import a\nego = Object\n")
    with pytest.raises(errors.RunError) as caught:
        scenic_ref.load(tmp_path / "scene.scenic").sample()
    assert caught.value.span.file.endswith("a.scenic")
    assert caught.value.span.line == 2


@pytest.mark.parametrize("content", [b"\x00\x01", b"\xff\xfe", bytes(range(256))])
def test_binary_files_are_refused(tmp_path, content):
    (tmp_path / "x.scenic").write_bytes(content)
    with pytest.raises(errors.UsageError, match="not a text file"):
        scenic_ref.load(tmp_path / "x.scenic")


def test_directories_and_missing_files_are_refused(tmp_path):
    with pytest.raises(errors.UsageError, match="directory"):
        scenic_ref.load(tmp_path)
    with pytest.raises(errors.UsageError, match="no file"):
        scenic_ref.load(tmp_path / "missing.scenic")


def test_a_draw_inside_a_key_function_is_refused():
    refused("ego = Object\nx = sorted([1, 2], key=lambda v: Range(0, 1))\n", errors.RunError, "draws a random value")


def test_an_impossible_requirement_names_itself():
    error = refused("ego = Object\nx = Range(0, 1)\nrequire x > 2\n", errors.AttemptsExhausted, "50 attempts")
    assert error.span.line == 3
    assert isinstance(error, errors.AttemptsExhausted)
    assert error.stuck[0][1] == 50


def test_a_program_that_draws_nothing_before_it_fails_is_not_tried_again():
    error = refused("ego = Object\nrequire False\n", errors.AttemptsExhausted, "no scene is possible")
    assert isinstance(error, errors.AttemptsExhausted)
    assert error.attempts == 1
    assert "touching" in refused("ego = Object\nObject behind ego\n", errors.AttemptsExhausted, "ego and Object (object 1) intersect").hint


@pytest.mark.parametrize("program", [
    "ego = Object at (10**400, 0)", "ego = Object with width 10**400", "ego = Object facing 10**400", "ego = Object at (Range(0, 10**400), 0)",
    "ego = Object facing (10**400) deg",
])  # fmt: skip
def test_numbers_that_are_too_large_for_a_float(program):
    refused(program + "\n", errors.ProgramError, "")


def test_properties_are_not_set_with_an_equals_sign():
    assert refused("class Foo:\n    width = 7\nego = Foo\n", errors.RunError, "width").hint == "write width: ..."


def test_flags_are_booleans():
    refused("ego = Object with allowCollisions 'no'\n", errors.RunError, "must be True or False")
    refused("ego = Object\nrequire 3\n", errors.RunError, "boolean")


@pytest.mark.slow
def test_random_and_mutated_programs_never_end_in_an_internal_error():
    ends = fuzz.attacks(seed=2026, count=1900, maps=100)
    assert ends.total() == 2000
    assert ends["scene"] > 100
    assert len(ends) > 5
