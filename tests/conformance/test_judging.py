"""`scenic-ref conformance --impl`: known, new and stale differences, kept results, and environments of releases."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from scenic_ref.cli import run_command_line
from scenic_ref.conformance import Ourselves, judge, known_differences, load_vectors, results
from scenic_ref.conformance.diff.explanations import explain_failure, is_same_reason
from scenic_ref.conformance.implementations import environments
from scenic_ref.conformance.implementations.harness_client import External
from scenic_ref.conformance.implementations.protocol import SceneRecord, Task
from scenic_ref.conformance.picture_boxes import look_different
from scenic_ref.errors import UsageError
from scenic_ref.semantics.readings import select

VECTORS = {v.name: v for v in load_vectors()}


def ask(capfd: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run_command_line(["conformance", *arguments])
    out, err = capfd.readouterr()
    return code, out, err


@pytest.fixture
def wrong(tmp_path: Path) -> str:
    """A command: this reference, but objects are one metre further to the East."""
    path = tmp_path / "wrong.py"
    path.write_text(
        "from scenic_ref.conformance import Ourselves\nfrom scenic_ref.conformance.implementations.harness_server import serve\n"
        "class Wrong(Ourselves):\n    name = 'wrong 1'\n    def scenes(self, task, count, *, seed, attempts):\n"
        "        for scene in super().scenes(task, count, seed=seed, attempts=attempts):\n"
        "            for found in scene['objects']:\n                found['position'][0] += 1\n            yield scene\nserve(Wrong())\n"
    )
    return f"{sys.executable} {path}"


@pytest.mark.slow
def test_a_difference_is_new_then_known_then_stale(capfd: pytest.CaptureFixture[str], tmp_path: Path, wrong: str) -> None:
    code, out, _ = ask(capfd, "--impl", wrong, "--vector", "at-vector", "--vector", "facing-heading")
    assert code == 1 and "differences that are not known: 1" in out
    assert f"scenic-ref conformance --vector at-vector --impl '{wrong}'" in out
    table = tmp_path / "known.toml"
    table.write_text('[[difference]]\nimplementations = ["wrong 1"]\nvectors = ["at-vector"]\nclass = "bug"\nwhy = "It is moved."\npassage = "x"\n')
    code, out, _ = ask(capfd, "--impl", wrong, "--vector", "at-vector", "--vector", "facing-heading", "--known", str(table), "-v")
    assert code == 0 and out.count("failed: at-vector (") == 1 and out.count("passed: facing-heading (") == 1
    assert f"--vector at-vector --impl '{wrong}'    #" in out
    code, out, _ = ask(capfd, "--impl", wrong, "--vector", "at-vector", "--known", str(table))
    assert code == 0 and "known differences of wrong 1: 1 bug" in out
    table.write_text(table.read_text().replace('"at-vector"', '"facing-heading"'))
    code, out, _ = ask(capfd, "--impl", wrong, "--vector", "facing-heading", "--known", str(table))
    assert code == 1 and "listed as a difference, and it is none: facing-heading" in out


@pytest.mark.slow
def test_results_are_kept_and_compared(capfd: pytest.CaptureFixture[str], tmp_path: Path, wrong: str) -> None:
    kept = tmp_path / "results.json"
    ask(capfd, "--impl", wrong, "--vector", "at-vector", "--vector", "facing-heading", "--results", str(kept))
    lines = json.loads(kept.read_text())["results"]
    assert lines["facing-heading"] == "passed" and lines["at-vector"].startswith("failed: ")
    assert len(kept.read_text().splitlines()) == len(lines) + 2
    code, out, _ = ask(capfd, "--impl", wrong, "--vector", "at-vector", "--against", str(kept))
    assert code == 0, out
    kept.write_text(kept.read_text().replace('"facing-heading": "passed"', '"facing-heading": "skipped: no"'))
    code, out, _ = ask(capfd, "--impl", wrong, "--vector", "facing-heading", "--against", str(kept))
    assert code == 1 and "changed: facing-heading: was skipped: no; is passed" in out


@pytest.mark.slow
def test_wrong_usage_is_said_before_anything_runs(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for arguments, words in (
        (["--known", "x.toml"], "--known needs --impl"),
        (["--results", "x.json"], "--results needs --impl"),
        (["--impl", "scenic==1.0"], "there is no adapter for scenic 1.0"),
        (["--impl", "no-such-program-at-all"], "there is no program 'no-such-program-at-all'"),
        (["--impl", "'"], "cannot be read"),
        (["--impl", ""], "there is no command"),
        (["--impl", f"{sys.executable} -c 'import sys; sys.exit(3)'"], "does not say its name: crashed: exit code 3"),
        (["--impl", f"{sys.executable} -c 'print(5); input()'"], "does not say its name: garbled"),
        (["--impl", sys.executable, "--seconds", "nan"], "--seconds is the time for an answer"),
        (["--impl", sys.executable, "--seconds", "0"], "--seconds is the time for an answer"),
        (["--impl", sys.executable, "--results", str(tmp_path / "no" / "x.json")], "x.json"),
        (["--impl", sys.executable, "--results", "x.txt"], ".json"),
        (["--impl", sys.executable, "--results", "x.json", "--json", "x.json"], "x.json is the report"),
        (["--impl", sys.executable, "--known", str(tmp_path / "no.toml")], "there is no file"),
        (["--impl", sys.executable, "--known", str(tmp_path)], "is a directory, not a list of differences"),
        (["--impl", sys.executable, "--against", str(tmp_path / "no.json")], "there is no file"),
    ):
        code, _, err = ask(capfd, "--vector", "at-vector", *arguments)
        assert code == 2 and words in err, (arguments, err)


WRONG = {
    "not TOML": ("[[", "is not TOML"), "too many brackets": (f"x = {'[' * 100_000}", "is not TOML"),
    "something else": ("[other]\n", "nothing but [[difference]]"),
    "an unknown key": ("[[difference]]\nfoo = 1\n", "difference 0"),
    "an unknown class": (
        '[[difference]]\nimplementations=["a 1"]\nvectors=["b"]\nclass="odd"\nwhy="w"\npassage="p"\n', "there is no class 'odd'"
    ),
    "a reading that is none": (
        '[[difference]]\nimplementations=["a 1"]\nvectors=["b"]\nclass="reading"\nreading="soft = maybe"\nwhy="w"\npassage="p"\n',
        "no reading 'soft = maybe'",
    ),
    "a class reading without one": (
        '[[difference]]\nimplementations=["a 1"]\nvectors=["b"]\nclass="reading"\nwhy="w"\npassage="p"\n', "`reading` is for the class reading"
    ),
    "a vector twice": (
        '[[difference]]\nimplementations=["a 1"]\nvectors=["b"]\nclass="bug"\nwhy="w"\npassage="p"\n' * 2, "b is listed twice for a 1"
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_lists_of_differences_are_read_strictly(case: str) -> None:
    text, words = WRONG[case]
    with pytest.raises(UsageError) as raised:
        known_differences.differences_in(text, "known.toml")
    assert words in str(raised.value)


@pytest.mark.parametrize(("text", "words"), [
    ("{", "is not JSON"), ("[" * 100_000, "is not JSON"), ("{}", "is no file of results"), ('{"schema": 1}', "is no file of results"),
])  # fmt: skip
def test_a_file_of_results_that_is_none_is_refused(text: str, words: str) -> None:
    with pytest.raises(UsageError) as raised:
        results.parse_results(text, "results.json")
    assert words in str(raised.value)


def test_the_list_that_ships_is_about_vectors_and_beside_the_results_that_ship() -> None:
    shipped, kept = known_differences.shipped_differences(), results.shipped_results()
    assert set(kept) == {"scenic 2.1.0", "scenic 3.1.1"}
    for name, lines in kept.items():
        listed = {v for d in shipped if name in d.implementations for v in d.vectors}
        wrong = {v for v, line in lines.items() if results.status_in(line) in ("failed", "errored")}
        assert listed == wrong, (name, listed ^ wrong)
        assert set(lines) == set(VECTORS), set(lines) ^ set(VECTORS)


def test_the_example_of_the_documentation_is_a_list_of_differences() -> None:
    page = (Path(__file__).parent.parent.parent / "docs" / "harness.md").read_text()
    found = known_differences.differences_in(page.partition("```toml\n")[2].partition("```")[0], "harness.md")
    assert len(found) == 1 and found[0].vectors <= VECTORS.keys()


def test_the_differences_that_ship_name_vectors_that_are_there() -> None:
    assert not {v for d in known_differences.shipped_differences() for v in d.vectors} - VECTORS.keys()


def test_differences_of_one_class_and_reason_are_one_cause_with_its_smallest_program_first() -> None:
    vectors = {vector.name: vector for vector in load_vectors()}
    found = known_differences.causes(known_differences.shipped_differences())
    assert len({(cause.class_, cause.why, *cause.readings) for cause in found}) == len(found) < len(known_differences.shipped_differences())
    listed = {name for difference in known_differences.shipped_differences() for name in difference.vectors}
    assert {name for cause in found for name in cause.smallest_first(vectors)} == listed
    for cause in found:
        first, *others = cause.smallest_first(vectors)
        failing = {name: sum(name in d.vectors for d in cause.differences for _ in d.implementations) for name in (first, *others)}
        lines = {name: next(iter(vectors[name].texts.values())).strip().count("\n") for name in (first, *others)}
        assert all((-failing[first], lines[first]) <= (-failing[name], lines[name]) for name in others)


def test_scenes_look_different_if_one_side_has_none_or_they_stand_elsewhere() -> None:
    here, beside, around = [[(0, 0, 0, 1, 1)]], [[(0, 0, 0.1, 1, 1)]], [[(x, 0, 0, 1, 1)] for x in range(5)]
    assert look_different(here, []) and look_different([], here) and look_different(here, beside)
    assert not look_different(here, here) and not look_different([], [])
    assert not look_different(around, around[1:]) and look_different(around, around[2:])


def test_results_are_the_same_without_addresses_and_places() -> None:
    vector = VECTORS["at-vector"]
    told = judge(Failing("at 0x7f12345678 (140170341771792) in /tmp/scenic-ref-1/x y"), vector)
    assert results.verdict_line(told) == "errored: RuntimeError: at 0x... (0x...) in ... y"


class Failing(Ourselves):
    def __init__(self, words: str) -> None:
        self.words = words

    def scenes(self, *_: object, **__: object):  # type: ignore[override]
        raise RuntimeError(self.words)


EXPLAINED = {
    "object-definition-is-a-side-effect": ("scenic-2.1", "object-order = ego-first"),
    "members-of-objects": ("scenic-3", "distance-method = box"),
    "scenario-definition": ("scenic-3", "only-scenario = begins"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", EXPLAINED)
def test_the_reading_that_explains_a_difference_is_found(name: str) -> None:
    profile, reading = EXPLAINED[name]
    id, _, alternative = reading.partition(" = ")
    vector = VECTORS[name]
    verdict = vector.matcher.match(Under(id, alternative), vector.task(profile))
    assert verdict.status == "failed"
    assert explain_failure(vector, profile, verdict.reason, select(profile)) == {id: alternative}
    assert explain_failure(vector, profile, verdict.reason, select("paper")) is None
    assert explain_failure(vector, profile, "ego.position is [77, 77], not [0, 0]", select(profile)) is None


class Under(Ourselves):
    """This reference under another reading."""

    def __init__(self, id: str, alternative: str) -> None:
        self.more = {id: alternative}

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        return super().scenes(replace(task, readings={**task.readings, **self.more}), count, seed=seed, attempts=attempts)


def test_reasons_are_alike_by_their_values() -> None:
    assert is_same_reason("ego.heading is 0.5, not 1.0", "ego.heading is 0.50000000001, not 1.0")
    assert not is_same_reason("ego.heading is 0.5, not 1.0", "ego.heading is 0.6, not 1.0")
    assert is_same_reason("refused in phase run: this", "refused: that") and not is_same_reason("refused: that", "ego.heading is 1, not 2")
    assert not is_same_reason("refused instead of never accepted: a", "refused: b")
    assert is_same_reason("params.x is 3, which is none of the outcomes", "params.x is 4, which is none of the outcomes")


def test_an_environment_is_made_once_and_whole_or_not_at_all(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    said: list[str] = []
    asked: list[tuple[str, ...]] = []

    def fails(python: Path, packages: tuple[str, ...]) -> None:
        asked.append(packages)
        raise UsageError("pip could not install it")

    monkeypatch.setattr(environments.venv, "create", lambda folder, **_: (folder / "bin").mkdir())
    monkeypatch.setattr(environments, "install", fails)
    with pytest.raises(UsageError, match="pip could not"):
        environments.implementation("scenic==2.1.0", say=said.append)
    assert list((tmp_path / "scenic-ref").iterdir()) == []
    monkeypatch.setattr(environments, "install", lambda python, packages: asked.append(packages))
    made = environments.implementation("scenic==2.1.0", say=said.append)
    assert isinstance(made, External) and made.profile == select("scenic-2.1")
    assert asked == [("setuptools<81", "wheel")] * 2 + [("--no-build-isolation", "scenic==2.1.0")]
    assert said[0].startswith("making an environment with scenic 2.1.0 in ")
    environments.implementation("scenic==2.1.0")
    assert len(asked) == 3 and len(list((tmp_path / "scenic-ref").iterdir())) == 1


def test_pip_says_why_it_failed(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"(?s)pip could not install .*No matching distribution found"):
        environments.install(Path(sys.executable), ("--no-index", "no-such-package-at-all"))


@pytest.mark.slow
def test_this_reference_is_judged_through_its_own_protocol() -> None:
    with External([sys.executable, "-m", "scenic_ref.conformance.implementations.harness_server"]) as served:
        assert served.name == Ourselves.name and served.follows("soft", "scene")
        verdicts = [judge(served, vector).verdict for vector in list(VECTORS.values())[::40] if vector.kind != "density"]
    assert {v.status for v in verdicts} == {"passed"}, verdicts
