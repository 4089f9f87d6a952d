"""The documentation is complete and true: every command, option, rule, reading, exit code and outcome stands in it, and lines are not too long."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import io
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import get_args

import numpy as np
import pytest
import scenic_ref
import typer
from PIL import Image
from scenic_ref import semantics
from scenic_ref.cli import INTERRUPTED
from scenic_ref.cli.app import EXIT_CODES, app
from scenic_ref.cli.check import EXIT_CODES as VERDICTS
from scenic_ref.interpreter.runtime import program_run
from scenic_ref.semantics.machine.config import Config, Value
from scenic_ref.semantics.machine.outcome import Outcome
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.rules import CATALOGUE
from scenic_ref.semantics.store import errors
from typer.core import TyperCommand

ROOT = Path(__file__).parent.parent
WIDEST, LONG_WORD = 100, 80
TEXTS = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "proofs/README.md", "tests/README.md", "examples/paper/dynamic/README.md")]
FOLDERS = sorted(path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith((".", "site", "build", "demo")))
TEXTS += sorted((ROOT / "docs").glob("*.md"))


@pytest.fixture(scope="module")
def generate() -> ModuleType:
    """The script that writes docs/reference/."""
    found = importlib.util.spec_from_file_location("generate", ROOT / "docs" / "generate.py")
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT / "docs")
        found.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def pages(generate: ModuleType) -> dict[str, str]:
    """The generated pages."""
    return {**{name: page() for name, page in generate.PAGES.items()}, **generate.command_pages()}


def sections(page: str) -> dict[str, str]:
    """The parts of a page by their headings."""
    return {part.partition("\n")[0].strip("`"): part for part in re.split(r"^## ", page, flags=re.MULTILINE)[1:]}


def commands() -> dict[str, TyperCommand]:
    """The commands of the application."""
    return getattr(typer.main.get_command(app), "commands")  # noqa: B009 (of a group alone)


def test_every_command_has_its_help_with_every_option(pages: dict[str, str]):
    assert {"run", "simulate", "bench"} < set(commands())
    for name, command in commands().items():
        text = pages[f"commands/{name}.md"]
        assert f"[`scenic-ref {name}`](commands/{name}.md)" in pages["commands.md"]
        for parameter in command.params:
            assert all(option in text for option in parameter.opts if option.startswith("-")), parameter.name
        for option in ("--debug", "--help"):
            assert option in text


def test_a_new_command_gets_its_help(generate: ModuleType):
    grown = typer.Typer(rich_markup_mode=None)
    grown.command("one")(lambda: None)

    @grown.command("newest")
    def newest(colour: str = "red") -> None:
        """Paint it."""

    assert "| [`scenic-ref newest`](commands/newest.md) | Paint it. |" in generate.commands_page(grown)
    assert "--colour" in generate.command_pages(grown)["commands/newest.md"]


def test_every_rule_has_its_row(pages: dict[str, str]):
    rows = {line.split("`")[1]: line for line in pages["rules.md"].splitlines() if line.startswith("| `")}
    assert set(rows) == {rule.id for rule in CATALOGUE}
    assert all(f"<code>{rule.code}</code>" in rows[rule.id].replace("<wbr>", "") for rule in CATALOGUE)


def test_every_reading_has_its_section_with_every_alternative(pages: dict[str, str]):
    found = sections(pages["readings.md"])
    assert set(found) == {*READINGS, "How the profiles were measured"}
    assert all(f"- **`{name}`**" in found[r.id] for r in READINGS.values() for name in r.alternatives)


def test_every_reading_with_alternatives_has_its_line_in_the_table_of_measurements(pages: dict[str, str]):
    table = sections(pages["readings.md"])["How the profiles were measured"]
    assert all((f"| [`{r.id}`](#{r.id}) |" in table) == (not r.is_note) for r in READINGS.values())
    assert "`rejected-simulation`, 2.1.0: Command line and API differ." in table
    assert "`boolean-random`, 3.1.1: Ours is another." in table


def family(kind: type) -> Iterator[type]:
    """A class and all that are derived from it."""
    yield kind
    for derived in kind.__subclasses__():
        yield from family(derived)


def test_every_exit_code_is_documented(pages: dict[str, str]):
    used = {0, INTERRUPTED, *VERDICTS.values(), *(kind.exit_code for kind in family(errors.ScenicError))}  # type: ignore[attr-defined]
    assert used == set(EXIT_CODES)
    for page in (pages["commands.md"], (ROOT / "docs" / "errors.md").read_text()):
        assert all(f"\n| {code} | " in page for code in used)


def test_the_classes_of_errors_are_those_of_a_module_of_their_own():
    names = {kind.__name__ for kind in family(errors.ScenicError) if kind.__module__ == errors.__name__}
    public = importlib.import_module("scenic_ref.errors")
    assert {name: getattr(public, name) for name in names} == {name: getattr(errors, name) for name in names}


def test_every_class_of_error_is_documented():
    page = (ROOT / "docs" / "errors.md").read_text()
    names = {kind.__name__ for kind in family(errors.ScenicError)}
    abstract = {"ScenicError", "ProgramError", "ResolutionError"}
    assert not {name for name in names - abstract if f"`{name}`" not in page}


def test_every_page_stands_in_the_table_of_contents(generate: ModuleType):
    contents = (ROOT / "mkdocs.yml").read_text()
    pages = {path.name for path in (ROOT / "docs").glob("*.md")} | {f"reference/{name}" for name in generate.PAGES}
    assert not {page for page in pages if f": {page}\n" not in contents}


def test_every_picture_of_a_page_is_made_and_every_picture_that_is_made_is_shown(generate: ModuleType, pages: dict[str, str]):
    shown = {name for page in pages.values() for name in re.findall(r"!\[[^]]*\]\(([^)]+)\)", page)}
    by_hand = {name for path in TEXTS for name in re.findall(r"!\[[^]]*\]\(reference/([^)]+)\)", path.read_text())}
    assert shown | by_hand == {name for name, _ in generate.pictures()}


@pytest.mark.parametrize("path", [path for path in TEXTS if path.parent.name != "tests"], ids=lambda path: str(path.relative_to(ROOT)))
def test_the_code_that_a_page_names_is_there(path: Path):
    text = path.read_text()
    files = set(re.findall(r"[` ]((?:%s)/[a-z_0-9/.-]*[a-z_0-9/])[` )]" % "|".join(FOLDERS), text))  # noqa: UP031
    assert not {name for name in files if not (ROOT / name).exists() and not (ROOT / "tests" / name).exists()}
    for name in set(re.findall(r"`(scenic_ref(?:\.[a-z_]+)+)[`(]", text)):
        module, _, attribute = name.rpartition(".")
        assert importlib.util.find_spec(name) is not None or hasattr(importlib.import_module(module), attribute)


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_a_page_imports_is_there(path: Path):
    for module, names in re.findall(r"^ *from (scenic_ref[a-z_.]*) import ([A-Za-z_, ]+)$", path.read_text(), re.MULTILINE):
        for name in names.split(","):
            assert hasattr(importlib.import_module(module), name.strip())


# docs/machine.md

MACHINE = (ROOT / "docs" / "machine.md").read_text()


def test_every_outcome_has_its_row():
    outcomes = [kind.__name__ for kind in get_args(Outcome)]
    assert f"Outcome = {' | '.join(outcomes)}\n" in MACHINE
    assert all(f"\n| `{name}(" in MACHINE for name in outcomes)


def test_every_part_of_the_dynamic_rules_is_named():
    parts = {path.name for path in (ROOT / "semantics" / "dynamics").glob("*.py") if path.name != "__init__.py"}
    assert not {name for name in parts if f"`semantics/dynamics/{name}`" not in MACHINE}


def test_the_frames_that_the_page_names_are_there():
    names = set(re.findall(r"`([A-Z][a-z]+[A-Za-z]*)`", MACHINE[MACHINE.index("## Time") : MACHINE.index("## Layers")]))
    code = "\n".join(path.read_text() for path in Path(inspect.getfile(semantics)).parent.rglob("*.py"))
    assert len(names) > 10
    assert not {name for name in names if f"class {name}(" not in code}


def test_the_run_that_the_page_shows_is_what_happens(monkeypatch: pytest.MonkeyPatch):
    """Control, stack and rule wherever a dynamic rule fires."""
    lines: list[str] = []

    def watched(config: Config) -> Outcome:
        outcome = step(config)
        rule = getattr(outcome, "rule", "")
        if rule.startswith("D-"):
            if rule in ("D-Policy-1", "D-Setup"):
                lines.append(f"time step {len([line for line in lines if line.startswith('time step')])}")
            lines.append(f"  {rule:13}{shown(config.control):11}{' '.join(frames(config.stack))}")
        return outcome

    step = program_run.step
    monkeypatch.setattr(program_run, "step", watched)
    program = re.search(r"```scenic\n(.*?)```", MACHINE, re.DOTALL)
    listing = re.search(r"```text\n(.*?)```", MACHINE, re.DOTALL)
    assert program is not None and listing is not None
    scenic_ref.loads(program[1]).simulate("still", steps=5, backend="interpreter")
    assert listing[1].splitlines() == lines


def shown(control: object) -> str:
    """What is in control: the kind of node, or of value."""
    if isinstance(control, Value):
        return "pass" if control.value is None else type(control.value).__qualname__
    return type(control).__qualname__


def frames(stack: tuple) -> Iterator[str]:
    """The kinds of frames, the innermost first."""
    while stack:
        frame, stack = stack
        yield type(frame).__name__


# Lines


def too_long(text: str) -> list[str]:
    """The lines that are too long, but for tables and code, which cannot be wrapped, and for words such as addresses."""
    found, code = [], False
    for line in text.splitlines():
        code ^= line.lstrip().startswith("```")
        exempt = code or line.startswith(("|", "    ")) or max(map(len, line.split()), default=0) > LONG_WORD
        if len(line) > WIDEST and not exempt:
            found.append(line)
    return found


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_lines_are_not_too_long(path: Path):
    assert not too_long(path.read_text())


def test_lines_of_generated_pages_are_not_too_long(pages: dict[str, str]):
    assert not {name: found for name, text in pages.items() if (found := too_long(text))}


def test_a_line_that_is_too_long_is_seen():
    words = "word " * 25
    assert too_long(f"{words}\n- {words}\n```\n{words}\n```\n| {words} |\n[x](http://{'a' * 100})\n") == [words, f"- {words}"]


def test_every_region_field_and_distribution_has_an_example_that_runs(pages: dict[str, str]) -> None:
    """The docstrings end with them."""
    page = pages["constructors.md"]
    titles = re.findall(r"^### (\w+)$", page, re.MULTILINE)
    examples = re.findall(r"^```scenic\n(.+)\n```$", page, re.MULTILINE)
    assert len(titles) == len(examples) == len(set(titles)) > 15
    for title, example in zip(titles, examples, strict=True):
        assert title in example
        text = example if "ego" in example else f"{example}\nego = Object"
        assert scenic_ref.loads(text).sample().ego is not None


@pytest.mark.slow
def test_the_pictures_of_the_readme_are_current() -> None:
    """Pixel by pixel, with the libraries of constraints.txt: a car that stands elsewhere is a small part of a picture."""
    found = importlib.util.spec_from_file_location("showcase", ROOT / "docs" / "showcase.py")
    assert found is not None and found.loader is not None
    showcase = importlib.util.module_from_spec(found)
    found.loader.exec_module(showcase)
    for name, make in showcase.MADE.items():
        old, new = (ROOT / "docs" / "images" / name).read_bytes(), make()
        assert f"docs/images/{name}" in (ROOT / "README.md").read_text() and len(new) < 700_000
        if name.endswith(".svg"):
            assert old == new, f"`make showcase` writes another {name}"
        else:
            before, after = (pixels(data) for data in (old, new))
            assert before.shape == after.shape and (before == after).all(), f"`make showcase` writes another {name}"


def pixels(data: bytes) -> np.ndarray:
    """The colours of the last picture, and of the first one of a GIF, by how many pictures there are."""
    image = Image.open(io.BytesIO(data))
    count = getattr(image, "n_frames", 1)
    frames = []
    for number in (0, count - 1):
        image.seek(number)
        frames.append(np.asarray(image.convert("RGB"), dtype=float))
    return np.stack([*frames, np.full_like(frames[0], count)])
