"""docs/vectors.md: its examples are vectors that the loader reads, and it names every matcher, shape, law, phase and requirement."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from scenic_ref.conformance import Ourselves, judge
from scenic_ref.conformance.matchers import MATCHERS
from scenic_ref.conformance.matchers.distributions import FAMILIES, SHAPES
from scenic_ref.conformance.matchers.errors import PHASES, REQUIREMENTS
from scenic_ref.conformance.matchers.simulations import KINDS
from scenic_ref.conformance.vector_files import read_file

TEXT = (Path(__file__).parent.parent.parent / "docs" / "vectors.md").read_text("utf-8")
HEAD = 'chapter = "C"\n[[vector]]\nname = "v"\npaper = "p"\nprogram = "ego = Object"\n'


def kinds_in(block: str) -> set[str]:
    """The matchers of which a block holds one."""
    return {kind for kind in MATCHERS if f"[vector.{kind}]" in block or block.startswith(f"{kind} =")}


def blocks() -> list[str]:
    """The examples of matchers, each an indented block."""
    parts = [part.strip("\n") for part in TEXT.split("\n\n")]
    indented = [textwrap.dedent(part) for part in parts if all(line.startswith("    ") for line in part.splitlines())]
    return [block for block in indented if kinds_in(block) and "program =" not in block]


def whole_file() -> str:
    """The example of a whole file."""
    return textwrap.dedent(TEXT[TEXT.index("    chapter = ") : TEXT.index("\n| key |")])


@pytest.mark.parametrize("block", blocks())
def test_the_example_of_a_matcher_is_read(block: str) -> None:
    (vector,) = read_file("docs/vectors.md", HEAD + block)
    assert {vector.kind} == kinds_in(block)


def test_every_matcher_has_an_example() -> None:
    assert {kind for block in blocks() for kind in kinds_in(block)} == set(MATCHERS)


def test_the_example_of_a_file_holds() -> None:
    (vector,) = read_file("docs/vectors.md", whole_file())
    assert set(vector.texts) == {"paper", "scenic-2.1", "scenic-3"}
    assert judge(Ourselves(), vector).verdict.status == "passed"
    assert judge(Ourselves(), vector, "scenic-3").verdict.status == "passed"


@pytest.mark.parametrize("name", [*MATCHERS, *FAMILIES, *SHAPES, "any", *PHASES, *REQUIREMENTS, *KINDS])
def test_every_name_of_the_format_is_documented(name: str) -> None:
    assert f"`{name}`" in TEXT or f"`{name} =" in TEXT or f"### {name}" in TEXT
