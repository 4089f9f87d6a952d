"""`scenic-ref trace`: the rules of a run, as text and as a page."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest


def test_a_trace_names_the_rules_that_fired_and_their_places(ask):
    out = ask("trace", "random.scenic").out
    for rule in ("E-Distributions (Distributions)", "S-Assignment (Variable Assignments)", "S-Require (Hard Requirements)", "T-Check"):
        assert rule in out
    assert "random.scenic:1: x = Range(0, 1)" in out
    assert "σ[x / " in out
    assert "O ∪ {<Object 0>}" in out


def test_the_log_density_is_that_of_the_draws(ask):
    out = ask("trace", "random.scenic").out
    expected = math.log(1 / 1) + math.log(1 / 3) + math.log(1 / 180)
    found = re.search(r"accepted: .*log density (\S+)", out)
    assert found is not None
    assert float(found.group(1)) == pytest.approx(expected, rel=1e-5)


def test_the_accepted_attempt_is_traced_unless_another_is_asked_for(ask):
    scene = json.loads(ask("run", "random.scenic", "--seed", 1, "--scene", 0).out)
    assert f"attempt {scene['attempts']}\n" in ask("trace", "random.scenic", "--seed", 1).out
    stuck = ask("trace", "never.scenic", "--attempt", 2)
    assert stuck.code == 0
    assert "attempt 2" in stuck.out
    assert "does not hold, so no rule applies" in stuck.out
    assert "stuck: the run is discarded" in stuck.out


def test_an_error_is_shown_after_the_rules_that_fired_before_it(ask):
    found = ask("trace", "prints_then_fails.scenic", "--all")
    assert found.code == 1
    assert "prints before" in found.out
    assert "nosuch is not defined" in found.err


def test_python_s_rules_and_default_values_are_shown_on_request(ask):
    short, long = ask("trace", "random.scenic").out, ask("trace", "random.scenic", "--all").out
    assert "P-Default" not in short
    assert "P-Default" in long
    assert "E-Compare" in long
    assert "are hidden; --all shows them" in short


def test_the_same_run_has_the_same_trace(ask):
    assert ask("trace", "random.scenic", "--all").out == ask("trace", "random.scenic", "--all").out


def test_the_page_is_self_contained_and_holds_the_whole_trace(ask):
    Path("tag.scenic").write_text('ego = Object at (0, 0), with note "</script>"\n')
    assert ask("trace", "tag.scenic", "--html", "trace.html").code == 0
    page = Path("trace.html").read_text()
    assert "http" not in page
    assert not re.search(r"<(?:link|img|iframe)|\bsrc=|@import|url\(", page)
    assert page.count("</script>") == 1
    data = json.loads(re.search(r"const trace = (.*);\n", page).group(1))  # type: ignore[union-attr]
    assert data["sources"]["tag.scenic"] == Path("tag.scenic").read_text()
    assert [e["number"] for e in data["events"]] == list(range(1, len(data["events"]) + 1))
    assert all(e["rule"] in data["rules"] for e in data["events"])


def test_a_page_that_cannot_be_written_is_wrong_usage(ask):
    assert ask("trace", "ok.scenic", "--html", "missing/trace.html").code == 2


def test_an_error_is_told_once(ask) -> None:
    Path("wrong.scenic").write_text("ego = Objct\n")
    found = ask("trace", "wrong.scenic")
    assert (found.out + found.err).count("Objct is not defined") == 1
    assert "the program is wrong" in found.out and "error: Objct is not defined" in found.err


@pytest.mark.parametrize(
    ("program", "shown"),
    [
        ("ego = Object\nx = [1]\nx.append(x)\ny = (x, 2)\n", "σ[y / ([1, [1, [1, "),
        ("ego = Object\nx = (1,)\nfor i in range(50):\n    x = (x, x)\n", "σ[x / ((((("),
        ("ego = Object\nx = {}\nfor i in range(50):\n    x = {1: x, 2: x}\n", "σ[x / dict with too many parts to write]"),
        ("ego = Object\nx = {}\nx[1] = x\ny = x\n", "σ[y / dict nested too deeply to write, or without end]"),
    ],
)
def test_values_without_end_are_cut_off(ask, program: str, shown: str):
    Path("endless.scenic").write_text(program)
    assert shown in ask("trace", "endless.scenic").out


def test_a_crowd_is_one_premise(ask):
    Path("crowd.scenic").write_text("for i in range(60):\n    Object at (2 * i, 3), with requireVisible False\nego = Object at (0, 0)\n")
    assert "no two of the 61 objects intersect: holds" in ask("trace", "crowd.scenic").out


@pytest.mark.parametrize("body", ["raise KeyError('x')", "return 5", "raise ValueError('y')"])
def test_a_value_that_cannot_be_written_is_told_by_its_kind(ask, body: str):
    Path("strange.scenic").write_text(f"class A(object):\n    def __repr__(self):\n        {body}\na = {{1: A()}}\nego = Object\n")
    found = ask("trace", "strange.scenic")
    assert found.code == 0 and "σ[a / dict " in found.out
