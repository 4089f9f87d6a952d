"""`scenic-ref fuzz`: programs are invented, what differs is made small and grouped, and a campaign can be interrupted and go on."""

from __future__ import annotations

import json
import re
import sys
import zlib
from collections import Counter
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from scenic_ref.api import loads
from scenic_ref.cli import run_command_line
from scenic_ref.cli.fuzz import seconds_in
from scenic_ref.conformance.diff.sequential_diff import DiffSettings, ProgramVerdict
from scenic_ref.conformance.fuzz import campaign
from scenic_ref.conformance.fuzz.causes import ENDED, OFTEN, OUR_BUG, Cause, causes_of, seen_often
from scenic_ref.conformance.fuzz.examination import (
    OUR_FAULT,
    CampaignSettings,
    FuzzedProgram,
    compare_program,
    examine,
    is_same_difference,
    words_of,
)
from scenic_ref.conformance.fuzz.themed_programs import KINDS, THEMES, AimedWriter, aimed_program, generate_themed_program
from scenic_ref.conformance.fuzz.triage import (
    CampaignFindings,
    findings_at,
    findings_in,
    findings_of,
    shipped_findings,
    to_toml,
)
from scenic_ref.conformance.fuzz.vector_draft import draft_of, passage_of
from scenic_ref.conformance.implementations import harness_client, line_process
from scenic_ref.conformance.implementations.environments import implementation
from scenic_ref.conformance.vector_files import read_file
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import (
    AttemptsExhausted,
    CheckError,
    ParseError,
    ProgramError,
    UsageError,
)

OTHER = """
from scenic_ref.conformance import Ourselves
from scenic_ref.conformance.implementations.protocol import Refused
from scenic_ref.conformance.implementations.harness_server import serve

class Other(Ourselves):
    name = "other 1"

    def scenes(self, task, count, *, seed, attempts):
        if {refuses!r} and {refuses!r} in task.program:
            raise Refused("run", "this is too much")
        for scene in super().scenes(task, count, seed=seed + 1000, attempts=attempts):
            {scene}
            yield scene

serve(Other())
"""


def other(folder: Path, refuses: str = "", scene: str = "pass") -> str:
    path = folder / "other.py"
    path.write_text(OTHER.format(refuses=refuses, scene=scene))
    return f"{sys.executable} {path}"


HEAD = 'name = "other 1"\nabout = "nothing"\n'


def finding(number: int = 0, **changes: object) -> FuzzedProgram:
    plain = FuzzedProgram(number, "aimed", "differ", "error", 1.0, "x", "words", "detail", None, None, "ego = Object\n", (), (), True)
    return replace(plain, **changes)  # type: ignore[arg-type]


def test_programs_are_functions_of_seed_and_number() -> None:
    programs = [generate_themed_program(4, number) for number in range(60)]
    assert programs == [generate_themed_program(4, number) for number in range(60)] != [generate_themed_program(5, number) for number in range(60)]
    assert {program.theme for program in programs} == set(THEMES)


def test_what_programs_are_about_takes_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    assert all(Counter(generate_themed_program(4, number).theme for number in range(start, start + 14)) == THEMES for start in (0, 14, 28))
    monkeypatch.setattr(AimedWriter, "program", lambda writer, theme: f"{theme} of {len(writer.themes)}")
    counts = Counter(program.text for number in range(7 * len(KINDS)) if (program := generate_themed_program(4, number)).theme == "aimed")
    assert counts == {f"{theme} of 14": 3 for theme in range(14)}, "42 aimed ones: three turns"
    turns = [[aimed_program(4, number) for number in range(start, start + 14)] for start in (0, 14)]
    assert sorted(turns[0]) == sorted(turns[1]) and turns[0] != turns[1]


@pytest.mark.slow
def test_aimed_programs_are_programs_and_draw_what_is_rare() -> None:
    texts = [aimed_program(1, number) for number in range(600)]
    wrong = Counter[str]()
    for text in texts:
        try:
            parse(text, "<aimed>", None)
        except (ParseError, CheckError) as error:
            wrong[error.message] += 1
    assert sum(wrong.values()) < 30, wrong
    together = "\n".join(texts)
    for rare in (
        "requireVisible Uniform(True, False)", "allowCollisions", "viewAngle", "positionStdDev", "override ego", "not visible", "apparently facing",
        "mutate", "require[", "TruncatedNormal", "Workspace", "orientation=", "interrupt when", "following", "do shuffle", "visible from",
        "beyond", "def f(a=", "f = lambda a=", "orientation=F", "p = A at",
    ):  # fmt: skip
        assert rare in together, rare


def test_aimed_programs_in_the_syntax_of_a_release_call_its_clock() -> None:
    texts = [aimed_program(1, number) for number in range(600)]
    released = [text for text in texts if text.startswith("# dialect: scenic-2.1\n")]
    assert any("simulation().currentTime" in text for text in released) and not any("simulation.currentTime" in text for text in released)
    assert any("simulation.currentTime" in text for text in texts)


@pytest.mark.parametrize(("feature", "kind", "same"), [
    ("objects[0].width & params.q", "distribution", True), ("objects[1].width", "distribution", True), ("objects[0].length", "distribution", False),
    ("objects[0].width & objects[0].length", "distribution", False), ("objects[2].width", "support", True), ("objects[0].width", "actions", False),
])
def test_a_smaller_program_differs_alike_in_one_of_two_features(feature: str, kind: str, same: bool) -> None:
    larger = ProgramVerdict("p", "differ", "distribution", "different", 9.0, "objects[3].width & params.z")
    assert is_same_difference(ProgramVerdict("p", "differ", kind, "different", 9.0, feature), larger) == same


@pytest.mark.slow
def test_a_planted_fault_is_found_and_made_small(tmp_path: Path) -> None:
    impl = other(tmp_path, refuses="mutate")
    settings = CampaignSettings(impl, seed=2, budget=2.0)
    number = next(n for n in range(500) if "mutate" in generate_themed_program(2, n).text and runs(generate_themed_program(2, n).text))
    with implementation(impl, 20.0, print) as there:
        found = examine(number, settings, there, frozenset())
        assert (found.verdict, found.kind, found.confirmed) == ("differ", "error", True) and "this is too much" in found.words
        assert found.minimal in ("ego = Object\nmutate\n", "ego = Object\nmutate ego\n"), found.minimal
        assert found.rules, "the rules of the smallest program"
        again = examine(number, settings, there, frozenset({(found.kind, found.words)}))
        assert again.verdict == "differ" and not again.minimal, "what was seen often is only counted"


def runs(text: str) -> bool:
    try:
        loads(text).rehearse()
    except ProgramError:
        return False
    return True


@pytest.mark.slow
def test_we_do_not_differ_from_ourselves(tmp_path: Path) -> None:
    settings = CampaignSettings(other(tmp_path), seed=14, budget=0.5)  # three are errors, which are told in no time
    with implementation(settings.impl, 60.0, print) as there:
        found = [examine(number, settings, there, frozenset()) for number in range(len(KINDS))]
    assert not [one for one in found if one.verdict == "differ"]
    assert sum(one.verdict == "agree" for one in found) >= 3, Counter(one.verdict for one in found)


BROKEN = """
import json, os, signal, sys, zlib

def say(id, **answer):
    print(json.dumps(dict(answer, id=id)), flush=True)

for line in sys.stdin:
    asked = json.loads(line)
    id, request = asked["id"], asked["request"]
    if request == "start":
        said = dict(name="broken", version="1", dialects=["paper"], capabilities=["scenes"], readings={})
        say(id, answer="started", protocol="scenic-ref/harness/1", **said)
    elif request == "compile":
        way = WAYS[zlib.crc32(asked["program"].encode()) % len(WAYS)]
        say(id, answer="compiled")
    elif request == "sample":
        scene = dict(params={}, ego=0, objects=[dict(position=[1, 2], heading=0.0, properties={})])
        exec(way)
        for _ in range(asked["count"]):
            say(id, answer="scene", scene=scene)
        say(id, answer="done")
"""
WAYS = {
    "pass": None, "os._exit(3)": "crashed", "os.kill(os.getpid(), 9)": "crashed", "print('hello', flush=True)": "garbled", "id -= 1": "garbled",
    "scene['objects'][0]['heading'] = float('nan')": "garbled", "open('big', 'wb').write(bytes(4 << 20))": "crashed",
    "open(HANGS, 'w').close(); signal.pause()": "timed out",
}  # fmt: skip
"""What a broken implementation does with a scene, and the kind of finding that it is."""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there are no limits of files")
def test_a_campaign_goes_on_whatever_breaks_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hangs, ways = tmp_path / "hangs", list(WAYS)

    class Clock:
        """The time of the limits, which passes only while the other side hangs."""

        now = 0.0

        def monotonic(self) -> float:
            self.now += 2.0 if hangs.exists() else 0.0
            return self.now

    for module in (harness_client, line_process):
        monkeypatch.setattr(module, "time", Clock())
    monkeypatch.setattr(line_process, "LARGEST_FOLDER", 1 << 20)
    settings = CampaignSettings("broken", seed=5, budget=0.2, shrinking=0.0)
    chosen: dict[str, int] = {}
    for number in range(400):
        text = generate_themed_program(settings.seed, number).text
        way = ways[zlib.crc32(text.encode()) % len(ways)]
        if way not in chosen and "simulation" not in text and "dialect" not in text and accepts(text):
            chosen[way] = number
    assert set(chosen) == set(ways)
    broken = BROKEN.replace("WAYS", repr(ways)).replace("HANGS", repr(str(hangs)))
    with harness_client.External([sys.executable, "-c", f"HANGS = {str(hangs)!r}\n{broken}"], seconds=1.0) as there:
        for way in (*ways, "pass"):
            hangs.unlink(missing_ok=True)
            found = examine(chosen[way], settings, there, frozenset())
            assert found.verdict == "differ" and (found.kind == WAYS[way] if WAYS[way] else found.kind not in WAYS.values()), way


def accepts(text: str) -> bool:
    try:
        loads(text).sample(0, max_attempts=20)
    except (ProgramError, AttemptsExhausted):
        return False
    return True


@pytest.mark.slow
def test_a_program_whose_scene_is_an_error_is_no_fault_of_ours(tmp_path: Path) -> None:
    settings = CampaignSettings(other(tmp_path), budget=1.0)
    text = "scenario Begin():\n    setup:\n        ego = Object\nscenario Main():\n    compose:\n        do Begin()\n"
    with implementation(settings.impl, 60.0, print) as there:
        verdict = compare_program(text, there, settings, DiffSettings(1e-6, 0.3, 0, 1.0, 2))
    assert verdict.kind == "error" and "the scene has no ego" in verdict.detail, verdict


def test_the_risk_of_all_programs_together_is_that_of_the_campaign() -> None:
    settings = CampaignSettings("x", alpha=0.01)
    assert sum(settings.share(number) for number in range(10_000)) <= 0.01


def test_a_fault_of_ours_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    class Failing:
        dialects = ("paper",)

        def follows(self, reading: str, alternative: str) -> bool:
            raise ZeroDivisionError("a fault")

    monkeypatch.setattr(campaign, "others", [Failing()])
    found = campaign.examined_here(3, CampaignSettings("x", readings={"soft": "scene"}), frozenset())
    assert (found.kind, found.verdict) == ("our fault", "differ") and "ZeroDivisionError: a fault" in found.words and "follows" in found.detail


def test_findings_with_one_cause_are_told_once() -> None:
    small = finding(3, rules=("P-With",), properties=("viewAngle",))
    large = finding(1, rules=("P-With", "P-At"), properties=("foo", "viewAngle"), minimal="ego = Object at 1 @ 2, with viewAngle 3, with foo 2\n")
    another = finding(4, rules=("P-With",), properties=("requireVisible",))
    words = finding(5, words="other words")
    unconfirmed = finding(6, words="by chance", confirmed=False)
    causes = causes_of([large, small, another, words, unconfirmed])
    assert [(cause.smallest.number, cause.numbers) for cause in causes] == [(3, [3, 1]), (4, [4]), (5, [5])]
    (alone,) = causes_of([finding(7, kind="timed out", minimal="")])
    assert alone.numbers == [7], "no program at all is one that can be made no smaller"
    assert seen_often([alone.smallest] * OFTEN) == {("timed out", "words")}
    assert seen_often([small] * (OFTEN - 1)) == frozenset() and seen_often([small] * OFTEN) == {("error", "words")}


@pytest.mark.parametrize("verdict, words", [
    (ProgramVerdict("p", "differ", "error", "refused there: at 0x7f32ab line 3.5 of -2e-7"), "refused there: at # line # of #"),
    (ProgramVerdict("p", "differ", "support", "different; impossible: objects[1].position[0] is always 3"), "objects[#].position[#]"),
    (ProgramVerdict("p", "differ", "distribution", "different", 9.0, "params.q17 & objects[2].heading"), "# & objects[#].heading"),
    (ProgramVerdict("p", "agree", "distribution", "equivalent"), ""),
])
def test_words_are_without_what_is_of_one_program(verdict: ProgramVerdict, words: str) -> None:
    assert words_of(verdict) == words


@pytest.mark.parametrize("text, holds", [
    ("ego = Object at 1 @ 2, at 3 @ 4\n", 'error = { phase = "resolve", line = 1, class = "SpecifiedTwice", rule = "R-SpecifiedTwice" }'),
    ("ego = Object at 1 @ 2, facing 3 deg\nparam p = 3\n", "params = { p = 3 }"),
    ("ego = Object at Uniform(1, 2) @ 5, with foo 3\n", "foo = 3"),
])
def test_drafts_are_vectors(text: str, holds: str, tmp_path: Path) -> None:
    draft = draft_of(Cause(finding(minimal=text, rules=("P-At",)), [0]), "finding-01", CampaignSettings("x", readings={"soft": "scene"}))
    assert draft is not None and holds in draft
    (vector,) = read_file("draft.toml", draft)
    assert vector.name == "finding-01" and vector.readings == {"soft": "scene"}


@pytest.mark.parametrize("kind", ENDED)
def test_what_ends_the_process_has_no_draft_and_no_passage(kind: str) -> None:
    cause = Cause(finding(kind=kind, minimal="# dialect: scenic-2.1\n", rules=("T-Mutate",)), [0])
    assert draft_of(cause, "finding-01", CampaignSettings("x")) is None and passage_of(cause).startswith("none: ")


def test_what_no_matcher_says_has_no_draft() -> None:
    never_accepted = "ego = Object at Range(1, 2) @ 3\nrequire ego.position.x > 4\n"
    assert draft_of(Cause(finding(minimal=never_accepted, kind="acceptance"), [0]), "finding-01", CampaignSettings("x")) is None


@pytest.mark.slow
def test_a_campaign_is_reported_and_goes_on(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "campaign"
    words = ["fuzz", "--impl", other(tmp_path, scene='scene["objects"][0]["width"] = 77'), "-o", str(folder), "--time", "1", "--workers", "1"]
    words += ["--shrinking", "1", "--budget", "1"]
    code = run_command_line(words)
    out, err = capfd.readouterr()
    assert code in (0, 1) and re.search(r"[0-9] causes?[.,]", out), err
    lines = (folder / "campaign.jsonl").read_text().splitlines()
    assert len(lines) >= 2 and json.loads(lines[0])["implementation"] == "other 1"
    assert run_command_line(words) == 2 and "holds a campaign already" in capfd.readouterr()[1]
    with open(folder / "campaign.jsonl", "a") as journal:
        journal.write('{"number": 99')  # a line that was being written
    assert run_command_line([*words, "--resume"]) in (0, 1)
    capfd.readouterr()
    numbers = [json.loads(line)["number"] for line in (folder / "campaign.jsonl").read_text().splitlines()[1:]]
    assert numbers == list(range(len(numbers))) and len(numbers) >= len(lines)
    assert run_command_line([*words, "--resume", "--seed", "5"]) == 2 and "other settings" in capfd.readouterr()[1]
    ElementTree.parse(folder / "junit.xml")
    assert "<h1>other 1: " in (folder / "report.html").read_text()
    for found in (folder / "findings").glob("*.scenic"):
        assert found.read_text()


@pytest.mark.parametrize(("text", "seconds"), [("7200", 7200), ("2h", 7200), ("90m", 5400), ("1.5s", 1.5)])
def test_lengths_of_time(text: str, seconds: float) -> None:
    assert seconds_in(text, at_least=0.01) == seconds


@pytest.mark.slow
def test_what_was_decided_of_a_finding_stays_and_is_reported(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "campaign"
    impl = other(tmp_path, scene='scene["objects"][0]["position"] = [77.0, 5.0]')
    first = [number for number in range(40) if (text := generate_themed_program(0, number).text).count("\n") < 9 and runs(text)][:2]
    settings = CampaignSettings(impl, budget=1.0, shrinking=5.0)
    folder.mkdir()
    journal = campaign.Journal(folder / "campaign.jsonl", settings, "other 1", resume=False)
    with implementation(impl, 20.0, print) as there:
        for number in first:
            journal.add(examine(number, settings, there, frozenset()))
    words = ["fuzz", "--impl", impl, "-o", str(folder), "--resume", "--time", "0"]
    assert run_command_line(words) == 1
    capfd.readouterr()
    path = folder / "findings.toml"
    (found, *_) = before = findings_at(path)
    assert (found.class_, found.why, found.is_judged) == ("undecided", "", False) and "position" in found.words, found
    assert found.there and all(scene[0][:2] == (77.0, 5.0) for scene in found.there) and len(found.here) == len(found.there)
    text = path.read_text().replace('class = "undecided"\nwhy = ""', 'class = "bug"\nwhy = "it was moved"', 1)
    path.write_text(text)
    assert run_command_line(words) == 1
    assert "bug)" in capfd.readouterr()[0]
    assert path.read_text() == text and findings_at(path)[1:] == before[1:]
    page = (folder / "report.html").read_text()
    assert "<b>bug</b>: it was moved" in page and "data:image/png;base64," in page
    path.write_text(text.replace('class = "bug"', 'class = "bgu"'))
    assert run_command_line(words) == 2
    assert "findings.toml, finding 1: there is no class 'bgu': there are reading, bug" in capfd.readouterr()[1]


@pytest.mark.parametrize("program", ["ego = Object\n", "x = '''\n", "# \x7f \u2028 \\ \" ü\n", "a\r\n\tb\n"])
def test_findings_are_read_as_they_were_written(program: str) -> None:
    found = findings_of([Cause(finding(minimal=program, reading={"soft": "scene"}, here=[[(1.0, 2.0, 0.5, 1.0, 2.0)]], there=[[]]), [0])], [])
    assert found[0].class_ == "reading" and found[0].reading == "soft = scene"
    campaign = CampaignFindings("other 1", "two\nlines", found)
    assert findings_in(to_toml(campaign), "f.toml") == campaign


@pytest.mark.parametrize("text, said", [
    ("x = 1", "name is missing"), ("= 1", "is not TOML"), (f"x = {'[' * 100_000}", "is not TOML"),
    (HEAD + "x = 1", "no key x"), (HEAD + "finding = 1", "tables"),
    (HEAD + "[[finding]]\nnumber = -1", "at least 0"), (HEAD + "[[finding]]\nnumber = 1", "kind is missing"),
])
def test_findings_that_are_none_are_refused(text: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        findings_in(text, "f.toml")


@pytest.mark.parametrize("name", [campaign.name for campaign in shipped_findings()])
def test_what_was_found_in_the_releases_is_told_with_its_class(name: str) -> None:
    (campaign,) = [c for c in shipped_findings() if c.name == name]
    assert "programs of seed" in campaign.about
    followed = {"invalid-parameters": "stuck", "no-ego": "allowed", "condition-truth": "any"}
    judged = [found for found in campaign.findings if found.is_judged]
    assert all(found.class_ != "undecided" for found in judged) and len({found.topic for found in judged}) > 5
    for found in judged:
        if found.kind == "error" and found.detail.startswith("refused"):  # a program here, as the finding says
            loads(found.program, readings=followed).rehearse()


def test_a_fault_of_ours_is_a_finding_without_a_draft() -> None:
    (cause,) = causes_of([finding(kind=OUR_FAULT)])
    assert cause.class_ == OUR_BUG and draft_of(cause, "finding-01", CampaignSettings("x")) is None


@pytest.mark.parametrize("text", [
    "", "no JSON\n", "[" * 100_000 + "\n", '{"format": "other"}\n', '{"format": "scenic-ref/campaign/1"}\n{"number": 1}\n',
])  # fmt: skip
def test_a_journal_that_is_none_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "campaign.jsonl"
    path.write_text(text)
    with pytest.raises(UsageError, match="is not a campaign"):
        campaign.Journal(path, CampaignSettings("x"), "other 1", resume=True)


@pytest.mark.slow
@pytest.mark.parametrize("words, said", [
    (["--time", "0"], "--time is a length of time such as 600, 90m or 2h, not '0' (0 is for --resume)"),
    (["--time", "2d"], "not '2d'"), (["--time", ""], "not ''"), (["--time", "-1h"], "not '-1h'"), (["--time", "nan"], "not 'nan'"),
    (["--profile", "nothing"], "nothing"), (["--alpha", "7"], "alpha is a probability"),
])
def test_wrong_usage(words: list[str], said: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["fuzz", "--impl", other(tmp_path), "-o", str(tmp_path / "c"), *words]) == 2
    assert said in capfd.readouterr()[1]
