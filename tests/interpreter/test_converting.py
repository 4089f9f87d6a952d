"""`convert`: a program in another dialect is the same program, with its comments, or is refused with its place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from scenic_ref.conformance import ConformanceVector, load_vectors
from scenic_ref.conformance.implementations.reference import Ourselves
from scenic_ref.conformance.judge import judge
from scenic_ref.interpreter.language.conversion import convert
from scenic_ref.interpreter.language.modules import library_of
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import ParseError
from scenic_ref.simulators.worlds import WORLDS


def converted(text: str, target: str, dialect: str | None = None) -> str:
    program = parse(text, "p.scenic", dialect)
    library = library_of(program, worlds=WORLDS, model=None, trust=False, directory=None, dialect=dialect)
    return convert(program, target, library)


OLD = """\
# A car, and another one.

class Car:
    width: 2  # metres
    # of a sedan
    length: 4

monitor Watch:
    # every time step
    wait

ego = Car  # at the origin
other = Car left of ego by 1, facing -(5 deg) relative to ego


def far(c):
    '''Whether it is far.'''
    # computed
    return (distance to c) > Range(1, 2) * 3

if in initial scenario:
    require[0.5] other can see ego
# The end.
"""
NEW = """\
# dialect: scenic-3
# A car, and another one.

class Car:
    width: 2  # metres
    # of a sedan
    length: 4

monitor Watch():
    # every time step
    wait
require monitor Watch()

ego = new Car  # at the origin
other = new Car left of ego by 1, facing ((-(5 deg)) relative to ego)


def far(c):
    'Whether it is far.'
    # computed
    return (distance to c) > (Range(1, 2) * 3)

if (initial scenario):
    require[0.5] (other can see ego)
# The end.
"""


def test_a_program_is_written_with_its_comments() -> None:
    assert converted(OLD, "scenic-3") == NEW
    assert converted(NEW, "scenic-3") == NEW


def test_and_back() -> None:
    assert converted(converted(NEW, "paper"), "scenic-3") == NEW


def test_degrees_of_a_term_keep_their_value() -> None:
    assert converted("ego = new Object\nx = [2 ** 3 deg, 1 @ 2 deg, -y deg]\n", "paper", "scenic-3") == (
        "ego = Object\nx = [(2 ** 3) deg, (1 deg) @ (2 deg), -(y deg)]\n"
    )
    assert converted("ego = Object\nx = [2 ** 3 deg, 1 @ 2 deg, -y deg]\n", "scenic-3") == (
        "# dialect: scenic-3\nego = new Object\nx = [2 ** (3 deg), 1 @ (2 deg), -(y deg)]\n"
    )


def test_an_argument_of_a_specifier_reaches_as_far_as_in_the_releases() -> None:
    text = "f = VectorField('f', (lambda p: 1))\nego = Object at 1 @ 2 if b else 3 @ 4\nx = f at 1 @ 2 if b else 3\n"
    assert converted(text, "paper", "scenic-2.1") == (
        "f = VectorField('f', (lambda p: 1))\nego = Object at ((1 @ 2) if b else (3 @ 4))\nx = (f at (1 @ 2)) if b else 3\n"
    )


def test_intervals_of_the_gallery_become_ranges() -> None:
    text = "import mars\nego = Rover at (0, 2) @ 3\nGoal at (1, 2) @ 2\nx = (3, 'a')\n"
    assert converted(text, "paper", "pldi19") == (
        "import mars\nfrom mars import *\nego = Rover at (Range(0, 2) @ 3)\nGoal at (Range(1, 2) @ 2)\nx = Range(3, 'a')\n"
    )


@pytest.mark.parametrize(
    "text, source, target, line, said",
    [
        (
            "ego = Object\nbehavior B():\n    try:\n        x = relative position of ego\n    except ValueError:\n        pass\n",
            "scenic-2.1", "paper", 4, "`relative position of` belongs to dialects scenic-2.1 and scenic-3",
        ),
        ("ego = new Object\nx = [1, new Object]\n", "scenic-3", "paper", 2, "an object without specifiers"),
        ("monitor M(n):\n    wait\nego = new Object\nrequire monitor M(3)\n", "scenic-3", "scenic-2.1", 4, "without arguments"),
        ("monitor M():\n    wait\nego = new Object\n", "scenic-3", "scenic-2.1", 1, "this one is not required"),
        ("ego = Object at (0, 0)\nx = [(1, 2)]\n", "paper", "pldi19", 2, "a pair"),
    ],
)  # fmt: skip
def test_what_the_other_dialect_cannot_say_is_refused_with_its_place(text: str, source: str, target: str, line: int, said: str) -> None:
    with pytest.raises(ParseError) as refused:
        converted(text, target, source)
    assert refused.value.span.line == line
    assert said in refused.value.message


VECTORS = [v for v in load_vectors() if "paper" in v.texts and v.kind in ("values", "probabilities", "simulations") and not v.files]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("vector", VECTORS[::9], ids=lambda v: v.name)
def test_converted_programs_mean_the_same(vector: ConformanceVector) -> None:
    other = replace(vector, texts={"scenic-3": converted(vector.texts["paper"], "scenic-3")})
    assert judge(Ourselves(), other, dialect="scenic-3").verdict.status == "passed"


@pytest.mark.sampled(8)
@pytest.mark.parametrize("path", sorted(Path("examples").rglob("*.scenic")), ids=str)
def test_the_examples_can_be_written_in_the_dialects_of_the_releases_and_back(path: Path) -> None:
    program = parse(path.read_text(encoding="utf-8"), str(path))
    library = library_of(program, worlds=WORLDS, model=None, trust=False, directory=path.parent, dialect=None)
    for target in ("scenic-2.1", "scenic-3"):
        text = convert(program, target, library)
        own = program.dialect if program.dialect.startswith("scenic") else "paper"
        again = convert(parse(text, str(path)), own, library)
        assert convert(parse(again, str(path)), target, library) == text


def test_the_text_is_that_of_the_releases() -> None:
    text = "class A:\n    r: (1, 2)\nego = A at (0, 0), facing 1 if True else 2\nrequire ego is in CircularRegion((0, 0), 5)\n"
    assert converted(text, "scenic-2.1") == (
        "# dialect: scenic-2.1\nclass A:\n    r: (1, 2)\nego = A at (0, 0), facing (1 if True else 2)\nrequire ego in CircularRegion((0, 0), 5)\n"
    )
    with pytest.raises(ParseError, match="a monitor of dialect scenic-3 has parentheses"):
        parse("monitor M:\n    wait\n", dialect="scenic-3")


@pytest.mark.parametrize("specifiers", ["", " at where", " at where, facing 10 deg"])
def test_an_object_of_a_class_that_is_a_variable_is_refused_for_2_1(specifiers: str) -> None:
    text = f"def made(kind, where):\n    return new kind{specifiers}\nego = made(Object, 1 @ 2)\n"
    program = parse(text, "p.scenic", "scenic-3")
    with pytest.raises(ParseError, match=r"dialect scenic-2\.1 cannot say this"):
        convert(program, "scenic-2.1", {})
    assert "new kind" in convert(program, "scenic-3", {})
