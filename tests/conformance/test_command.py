"""`scenic-ref conformance`: its table, its report, its exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from scenic_ref.cli import run_command_line
from scenic_ref.conformance import Ourselves, load_vectors
from scenic_ref.conformance.implementations.protocol import Task
from scenic_ref.conformance.judge import Result
from scenic_ref.conformance.reports import UNREACHABLE, report_json, rules_missing
from scenic_ref.conformance.verdict import PASSED, errored_verdict, failed_verdict, skipped_verdict
from scenic_ref.semantics.rules import RULES

VECTORS = load_vectors()


def ask(capfd: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run_command_line(["conformance", *arguments])
    out, err = capfd.readouterr()
    return code, out, err


def test_a_chapter_is_run_and_counted(capfd: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ask(capfd, "--chapter", "plumbing")
    number = sum("Plumbing" in v.chapter for v in VECTORS)
    assert code == 0
    assert out.splitlines()[0].split() == ["vectors", "passed", "failed", "skipped", "errored", "chapter"]
    assert out.splitlines()[2].split()[:5] == [str(number), str(number), "0", "0", "0"]
    assert out.splitlines()[-1].startswith("rules fired: 2 of ")


def test_several_vectors_are_listed_on_request(capfd: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ask(capfd, "--vector", "front-of", "--vector", "at-vector", "-v")
    assert code == 0
    assert "passed: front-of (" in out
    assert "passed: at-vector (" in out
    assert "all chapters" in out


def test_on_a_terminal_there_is_a_table_and_a_progress_bar(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    code, out, _ = ask(capfd, "--vector", "front-of", "--vector", "at-vector")
    assert code == 0
    assert 'Appendix "Operators"' in out
    assert "all chapters" in out
    assert out.rstrip().endswith(f"rules fired: 3 of {len(RULES) - len(UNREACHABLE)}")


def test_a_vector_that_is_not_given_in_a_dialect_is_skipped(capfd: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ask(capfd, "--vector", "plumbing-other-dialect", "--dialect", "scenic-3", "-v")
    assert code == 0
    assert "skipped: plumbing-other-dialect" in out
    assert "the program is not given in scenic-3" in out


def test_what_fails_is_told_with_its_reason_and_the_command_that_runs_it_alone(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def nothing(self: Ourselves, task: Task, count: int, *, seed: int, attempts: int) -> object:
        return iter(())

    monkeypatch.setattr(Ourselves, "scenes", nothing)
    code, out, _ = ask(capfd, "--vector", "front-of", "--dialect", "scenic-3")
    assert code == 1
    assert "failed: front-of (" in out
    assert "gave 0 scenes, and 3 were asked for" in out
    assert "scenic-ref conformance --vector front-of --dialect scenic-3" in out


def test_a_crash_is_no_failure_of_the_language(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(self: Ourselves, task: Task, count: int, *, seed: int, attempts: int) -> object:
        raise RuntimeError("broken")

    monkeypatch.setattr(Ourselves, "scenes", crash)
    code, out, _ = ask(capfd, "--vector", "front-of")
    assert code == 1
    assert "errored: front-of" in out
    assert "RuntimeError: broken" in out


def test_the_report_goes_to_a_file_or_to_standard_output(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "report.json"
    assert ask(capfd, "--vector", "front-of", "--json", str(path))[0] == 0
    found = json.loads(path.read_text())
    assert found["schema"] == "scenic-ref/conformance/1"
    assert found["totals"] == {"passed": 1, "failed": 0, "skipped": 0, "errored": 0}
    assert found["rules"]["shown"] == ["O-FrontOf"]
    assert [r["name"] for r in found["results"]] == ["front-of"]
    code, out, _ = ask(capfd, "--vector", "front-of", "--json", "-")
    assert (code, json.loads(out)) == (0, found)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--vector", "fronnt-of"], "there is no vector fronnt-of"),
        (["--chapter", "cooking"], "no such vector in a chapter whose title contains 'cooking'"),
        (["--vector", "front-of", "--dialect", "klingon"], "there is no dialect 'klingon'"),
        (["--vector", "front-of", "--json", "/nowhere/report.json"], "cannot be written"),
        (["--colour"], "No such option"),
    ],
)
def test_wrong_usage_has_exit_code_2(capfd: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    code, _, err = ask(capfd, *arguments)
    assert code == 2
    assert message in err


def test_the_chapters_are_told_a_line_each(capfd: pytest.CaptureFixture[str]) -> None:
    _, _, err = ask(capfd, "--chapter", "cooking")
    titles = [line.strip() for line in err.splitlines() if line.startswith("    ")]
    assert titles == list(dict.fromkeys(v.chapter for v in VECTORS))
    named = [part.strip() for title in titles for part in title.split(",") if part.strip().startswith(("Table", "Figure"))]
    assert len(named) == len(set(named)), "of the paper's tables and figures each stands in one chapter"


def test_only_what_passed_shows_its_rules() -> None:
    vectors = [v for v in VECTORS if v.fires]
    verdicts = (PASSED, failed_verdict("x"), skipped_verdict("y"), errored_verdict("z"))
    results = [Result(v, "paper", verdicts[number % 4]) for number, v in enumerate(vectors)]
    found = report_json("someone", results)
    assert found["totals"] == {s: sum(v.status == s for v in (r.verdict for r in results)) for s in ("passed", "failed", "skipped", "errored")}
    assert set(RULES) - {rule for r in results if r.verdict is PASSED for rule in r.vector.fires} >= set(rules_missing(results))
    assert rules_missing([]) != ()
