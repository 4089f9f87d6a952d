"""`check --format` and `check --strict`: what is wrong with a program, for editors and continuous integration, with the documented exit codes."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

WARNED = "import math\nego = Object with widht 5\n"


def written(text: str) -> str:
    """The name of a file with the program."""
    Path("p.scenic").write_text(text)
    return "p.scenic"


@pytest.mark.parametrize("form", ["text", "json", "github", "sarif"])
@pytest.mark.parametrize(
    ("text", "strict", "code"),
    [("ego = Object\n", True, 0), (WARNED, False, 0), (WARNED, True, 1), ("ego = Objct\n", False, 1), ("ego = (\n", False, 1)],
)
def test_the_exit_code_is_the_same_in_every_format(ask, form: str, text: str, strict: bool, code: int) -> None:
    assert ask("check", written(text), "--format", form, *(["--strict"] if strict else [])).code == code


def test_warnings_are_told_on_standard_error_and_the_answer_is_ok(ask) -> None:
    found = ask("check", written(WARNED))
    assert found.out == "ok\n" and found.err.count("warning: ") == 2
    assert "2 | ego = Object with widht 5\n  |                   ^^^^^\n  = hint: did you mean width?" in found.err
    found = ask("check", "p.scenic", "--strict")
    assert (found.out, found.err.splitlines()[-1]) == ("", "not ok: with --strict a warning is an error")


def test_run_tells_a_warning_in_a_line(ask) -> None:
    assert "warning: p.scenic:2:19: nothing reads the property widht: did you mean width?\n" in ask("run", written(WARNED)).err


def test_json_has_places_and_hints(ask) -> None:
    found = ask("check", written(f"{WARNED}x = Rnage(1, 2)\n"), "--format", "json")
    document = json.loads(found.out)
    assert document["schema"] == "scenic-ref/diagnostics/1" and found.err == ""
    told = [(d["severity"], d["line"], d["column"], d["end_column"], d["hint"]) for d in document["diagnostics"]]
    assert told == [
        ("error", 3, 5, 10, "did you mean Range?"), ("warning", 1, 8, 12, "remove it"), ("warning", 2, 19, 24, "did you mean width?"),
    ]  # fmt: skip


def test_annotations_escape_what_ends_them(ask) -> None:
    Path("50%,a.scenic").write_text("raise ValueError('100%\\nof it')\n")
    line = ask("check", "50%,a.scenic", "--format", "github").out
    assert line == "::error file=50%25%2Ca.scenic,line=1,endLine=1,col=1,endColumn=31,title=program error::ValueError: 100%25%0Aof it\n"
    assert ask("check", written("ego = Object\n"), "--format", "github").out == ""


def test_sarif_has_a_rule_for_each_kind(ask) -> None:
    run = json.loads(ask("check", written(WARNED), "--format", "sarif", "--strict").out)["runs"][0]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert [rules[r["ruleIndex"]] for r in run["results"]] == [r["ruleId"] for r in run["results"]] == ["unused-import", "unread-property"]
    assert {r["level"] for r in run["results"]} == {"error"}
    place = run["results"][1]["locations"][0]["physicalLocation"]
    assert place == {"artifactLocation": {"uri": "p.scenic"}, "region": {"startLine": 2, "startColumn": 19, "endLine": 2, "endColumn": 24}}


@pytest.mark.parametrize(
    ("name", "address"),
    [
        ("brök en.scenic", "br%C3%B6k%20en.scenic"), ("a:b.scenic", "a%3Ab.scenic"), ("50%#?.scenic", "50%25%23%3F.scenic"),
        (b"\xff.scenic", "%FF.scenic"),
    ],
)
def test_sarif_has_the_addresses_of_files(ask, name, address) -> None:
    path = Path(os.fsdecode(name))
    path.write_text(WARNED)
    for given, expected in ((path, address), (path.resolve(), f"{Path.cwd().as_uri()}/{address}")):
        found = json.loads(ask("check", str(given), "--format", "sarif").out)["runs"][0]["results"]
        assert {r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for r in found} == {expected}


def test_a_format_that_there_is_not_and_samples_with_a_format_are_wrong_usage(ask) -> None:
    found = ask("check", written("ego = Object\n"), "--format", "jsn")
    assert found.code == 2 and "did you mean json?" in found.err
    assert ask("check", "p.scenic", "--samples", "s.jsonl", "--strict").code == 2


@pytest.mark.parametrize("form", ["json", "sarif", "github", "text"])
def test_half_a_character_can_be_told(ask, form: str) -> None:
    answer = ask("check", written('raise ValueError("\\ud800 x")\nego = Object\n'), "--format", form)
    assert answer.code == 1 and "ud800 x" in answer.out + answer.err


def test_run_tells_the_first_warnings_and_how_many_there_are(ask) -> None:
    text = "ego = Object\n" + "".join(f"Object at (0, {3 * k}), with widht 5\n" for k in range(1, 13))
    said = ask("run", written(text), "-n", "1").err
    assert said.count("nothing reads the property widht") == 10 and "and 2 more warnings" in said
    assert ask("check", written(text)).err.count("nothing reads the property widht") == 12


def test_a_parameter_that_nothing_reads_is_told_without_a_place(ask) -> None:
    program = written("param speed = 3\nego = Object\n")
    assert "warning: nothing reads or sets the parameter speeed: did you mean speed?\n" in ask("run", program, "-p", "speeed=4").err
    found = ask("check", "p.scenic", "-p", "speeed=4")
    assert found.err == "warning: nothing reads or sets the parameter speeed\n  = hint: did you mean speed?\n"
    (told,) = json.loads(ask("check", "p.scenic", "-p", "speeed=4", "--format", "json").out)["diagnostics"]
    assert (told["kind"], told["file"], "line" in told) == ("unread parameter", "p.scenic", False)
    assert ask("check", "p.scenic", "-p", "speeed=4", "--strict").code == 1
