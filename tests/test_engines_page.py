"""The page on engines shows the code that they make."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.simulators.behaviors import translate_statements

PAGE = (Path(__file__).parent.parent / "docs" / "engines.md").read_text()


def listing(name: str) -> str:
    """The indented block behind a mark of the page."""
    block = PAGE.split(f"<!-- {name} -->\n\n")[1]
    lines = block[: re.search(r"\n(?=\S)", block).start()].splitlines()  # type: ignore[union-attr]
    return "\n".join(line.removeprefix("    ") for line in lines).rstrip() + "\n"


def words_of(text: str) -> list[str]:
    """The code without comments and spaces, line by line."""
    return [re.sub(r"\s+", "", line.partition("  #")[0]) for line in text.splitlines()]


def test_the_generator_of_the_page_is_what_the_behavior_becomes(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []

    def note(text: str, *rest: str) -> object:
        made.append(text)
        return compile(text, *rest)

    monkeypatch.setattr(translate_statements, "compile", note, raising=False)
    scenic_ref.loads(listing("behavior")).simulate("still", 2)
    (text,) = [text for text in made if text.startswith("def coroutine")]
    shown = words_of(listing("generated behavior"))
    for ours, theirs in zip(shown, words_of(text), strict=True):
        assert theirs.startswith(ours.removesuffix("...")), (ours, theirs)
        assert ours == theirs or ours.endswith("...")


@pytest.mark.extra("fast")
def test_the_compiled_columns_of_the_page_are_what_the_program_becomes(monkeypatch: pytest.MonkeyPatch) -> None:
    from scenic_ref.inference.batch.primitives import numba_kernels

    made: list[str] = []
    compiled = numba_kernels.compile_function_text

    def note(text: str, name: str, *rest: object) -> object:
        made.extend([text] if name == "evaluator" else [])
        return compiled(text, name, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(numba_kernels, "compile_function_text", note)
    batch = scenic_ref.loads(listing("columns")).batch
    assert batch is not None
    batch.compile()
    (text,) = made
    assert "".join(words_of(listing("generated columns"))) in "".join(words_of(text))
