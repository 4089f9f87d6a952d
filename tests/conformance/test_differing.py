"""`scenic-ref diff`: each kind of difference is found, what is no difference is not, and the reading that explains one is named."""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from scenic_ref.api import Scenario, loads
from scenic_ref.cli import run_command_line
from scenic_ref.conformance.diff import sequential_diff
from scenic_ref.conformance.diff.simulation_differences import (
    Replayed,
    all_on_one_side,
    in_simulations,
    of_simulations,
)
from scenic_ref.conformance.implementations.line_process import ImplementationFault
from scenic_ref.conformance.implementations.protocol import Task
from scenic_ref.conformance.recorded_world import RecordedWorld, random_walk_world
from scenic_ref.interpreter.language.dialects import DIALECTS
from scenic_ref.semantics.readings import select
from scenic_ref.semantics.store.errors import AttemptsExhausted

OTHER = """
from dataclasses import replace
from scenic_ref.conformance import Ourselves
from scenic_ref.conformance.implementations.protocol import NeverAccepted, Refused, Unsupported
from scenic_ref.conformance.implementations.harness_server import serve

class Other(Ourselves):
    name = "other 1"
    dialects = {dialects!r}

    def follows(self, reading, alternative):
        return False

    def scenes(self, task, count, *, seed, attempts):
        for scene in super().scenes({task}, count, seed=seed + 1000, attempts=attempts):
            {scene}
            yield scene

    def simulations(self, task, steps, count, *, seed, attempts, world=None):
        for run in super().simulations({task}, steps, count, seed=seed + 1000, attempts=attempts, world=world):
            {run}
            yield run

serve(Other())
"""
COIN = "ego = Object at Discrete({{1: 2, 2: 1}}) @ 0\n"
DYNAMIC = """behavior B():
    take self.position.x, self.heading
    if self.position.x > 0:
        take "far", 1
    while True:
        take Discrete({{"left": 1, "right": 1}})
ego = Object at 0 @ 0, with behavior B
"""


class Asking:
    """A folder of programs, and what `diff` says of them beside an implementation that is ours but for one thing."""

    def __init__(self, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
        self.folder = folder
        self.capfd = capfd
        self.programs = folder / "programs"
        self.programs.mkdir()

    def other(self, task: str = "task", scene: str = "pass", run: str = "pass", dialects: Sequence[str] = tuple(DIALECTS)) -> str:
        path = self.folder / "other.py"
        path.write_text(OTHER.format(task=task, scene=scene, run=run, dialects=tuple(dialects)))
        return f"{sys.executable} {path}"

    def __call__(self, program: str, impl: str, *more: str) -> tuple[int, dict[str, object]]:
        path = self.programs / "program.scenic"
        path.write_text(program.replace("{{", "{").replace("}}", "}"))
        code, out, err = self.said(str(path), "--impl", impl, "--json", "-", "--detect-tv", "0.3", "--steps", "5", *more)
        lines = out.splitlines()
        assert len(lines) == 1, err
        return code, json.loads(lines[0])

    def said(self, *words: str) -> tuple[int, str, str]:
        code = run_command_line(["diff", *words])
        out, err = self.capfd.readouterr()
        return code, out, err


@pytest.fixture
def ask(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Asking:
    return Asking(tmp_path, capfd)


@pytest.mark.slow
@pytest.mark.parametrize("program", [COIN, DYNAMIC, COIN + "require ego.position.x > 1\n", "ego = Object at 3 @ 4\n"])
def test_we_agree_with_ourselves(ask: Asking, program: str) -> None:
    code, verdict = ask(program, ask.other())
    assert (code, verdict["verdict"]) == (0, "agree"), verdict
    parts = ["distribution", "acceptance", *(["actions"] if program == DYNAMIC else [])]
    assert verdict["kind"] == ", ".join(parts)


@pytest.mark.slow
def test_scenes_that_cannot_be(ask: Asking) -> None:
    code, verdict = ask(COIN, ask.other(scene='scene["objects"][0]["position"][1] = 1'))
    assert code == 1 and verdict["verdict"] == "differ" and verdict["kind"] == "support" and verdict["evidence"] == "certain"
    assert "objects[0].position[1] is always 0, but 1 in sample 1" in str(verdict["detail"]) and verdict["reading"] is None


@pytest.mark.slow
def test_another_distribution(ask: Asking) -> None:
    code, verdict = ask(COIN, ask.other(scene='scene["objects"][0]["position"][0] = 2 - (scene["scene"] > 4)'))
    assert code == 1 and (verdict["kind"], verdict["feature"]) == ("distribution", "objects[0].position[0]")


@pytest.mark.slow
@pytest.mark.parametrize(("program", "changed", "agree"), [
    ("param f = lambda x: x\n", 'scene["params"]["f"] = {"repr": "<function>"}', True),
    ("param d = {{'a': 3, 'b': [1, abs]}}\n", 'scene["params"]["d"]["b"][1] = {"repr": "<abs>"}', True),
    ("param d = {{'a': 3, 'b': abs}}\n", 'scene["params"]["d"]["a"] = {"repr": "<3>"}', False),
    ("param x = 3\n", 'scene["params"]["x"] = {"repr": "nan"}', False),
    ("param t = f'{{Range}}'\n", 'scene["params"]["t"] = "<class Range>"', True),
    ("param t = '<b>'\n", 'scene["params"]["t"] = "<class Range>"', False),
])
def test_how_a_value_without_a_json_form_is_printed_is_no_difference(ask: Asking, program: str, changed: str, agree: bool) -> None:
    code, verdict = ask(COIN + program, ask.other(scene=changed))
    assert (code, verdict["verdict"]) == ((0, "agree") if agree else (1, "differ")), verdict


@pytest.mark.slow
def test_another_acceptance(ask: Asking) -> None:
    program = COIN + "require ego.position.x > 1\n"
    code, verdict = ask(program, ask.other(scene='scene["attempts"] += 0 if task.prune else 3'))
    assert code == 1 and (verdict["kind"], verdict["feature"]) == ("acceptance", "attempts")
    code, verdict = ask(program, ask.other(scene='scene["attempts"] = scene["attempts"] if not task.prune else 1'))
    assert code == 0, "one that prunes, but not when it counts"


@pytest.mark.slow
@pytest.mark.parametrize("id, alternative, program", [
    ("soft", "scene", "ego = Object at Uniform(0, 1, 2, 3) @ 0\nrequire[0.5] ego.position.x > 2\n"),
    ("object-order", "ego-first", "Object at 5 @ 5\nego = Object at 1 @ 1\n"),
])
def test_the_reading_under_which_they_agree_is_named(ask: Asking, id: str, alternative: str, program: str) -> None:
    code, verdict = ask(program, ask.other(task=f"replace(task, readings={{'{id}': '{alternative}'}})"))
    assert code == 1 and verdict["reading"] == {id: alternative}, verdict
    code, verdict = ask(program, ask.other(task=f"replace(task, readings={{'{id}': '{alternative}'}})"), "--reading", f"{id}={alternative}")
    assert code == 0, verdict


@pytest.mark.slow
def test_a_reading_that_explains_the_first_scene_alone_is_not_named(ask: Asking) -> None:
    changed = 'scene["objects"][0]["width"] = 1 + (scene["scene"] > 3)'
    other = ask.other(task="replace(task, readings={'object-order': 'ego-first'})", scene=changed)
    code, verdict = ask("Object at 5 @ 5\nego = Object at 1 @ 1\n", other)
    assert code == 1 and verdict["reading"] is None, verdict


@pytest.mark.slow
def test_a_difference_stays_one_though_the_other_ends_while_a_reading_is_sought(ask: Asking) -> None:
    changed = 'scene["objects"][0]["position"][1] = 1 if scene["scene"] < 3 else __import__("os")._exit(3)'
    code, verdict = ask(COIN, ask.other(scene=changed))
    assert code == 1 and verdict["kind"] == "support" and "but 1 in sample 1" in str(verdict["detail"]), verdict


@pytest.mark.slow
def test_errors_here_and_there(ask: Asking) -> None:
    wrong = "ego = Object at 1 @ 1, at 2 @ 2\n"
    code, verdict = ask(wrong, ask.other())
    assert (code, verdict["verdict"], verdict["kind"]) == (0, "agree", "error")
    code, verdict = ask(wrong, ask.other(task="replace(task, program='ego = Object at 1 @ 1')"))
    assert code == 1 and str(verdict["detail"]).endswith("; a program there")
    code, verdict = ask("ego = Object at 1 @ 1\n", ask.other(task="replace(task, program='ego = Object at 1 @ 1, at 2 @ 2')"))
    assert code == 1 and "refused in phase resolve there, and a program here" in str(verdict["detail"])
    code, verdict = ask(wrong, ask.other(task="replace(task, program='ego = Object at x')"))
    assert code == 1 and "refused in phase run there" in str(verdict["detail"]), "another phase"
    code, verdict = ask("ego = = 3\n", ask.other())
    assert (code, verdict["verdict"]) == (5, "skipped"), "it may be no error in another dialect"
    code, verdict = ask("ego = = 3\n", ask.other(), "--dialect", "paper")
    assert (code, verdict["verdict"], verdict["kind"]) == (0, "agree", "error")


def test_a_scene_without_ego_is_an_error_of_both(ask: Asking) -> None:
    code, verdict = ask("scenario Main():\n    compose:\n        wait\n", ask.other())
    assert (code, verdict["verdict"], verdict["kind"]) == (0, "agree", "error"), verdict
    assert "the scene has no ego" in str(verdict["detail"])


@pytest.mark.slow
def test_programs_without_scenes(ask: Asking) -> None:
    never = COIN + "require ego.position.x > 5\n"
    code, verdict = ask(never, ask.other())
    assert (code, verdict["verdict"], verdict["kind"]) == (0, "agree", "acceptance")
    code, verdict = ask(never, ask.other(task="replace(task, program=task.program.replace('> 5', '> 1'))"))
    assert (code, verdict["verdict"]) == (1, "differ"), "no scene here"
    code, verdict = ask(COIN, ask.other(task="replace(task, program=task.program + 'require ego.position.x > 5')"))
    assert (code, verdict["kind"]) == (1, "acceptance"), "no scene there"


@pytest.mark.slow
def test_other_actions(ask: Asking) -> None:
    code, verdict = ask(DYNAMIC, ask.other(run='run["steps"][2]["actions"]["0"] = ["elsewhere"]'))
    assert code == 1 and verdict["kind"] in ("support", "actions") and "step 2, object 0" in str(verdict["detail"])
    code, verdict = ask(DYNAMIC, ask.other(run='run["result"] = "terminated"'))
    assert code == 1 and "params.result" in str(verdict["detail"])
    code, verdict = ask(DYNAMIC, ask.other(task="replace(task, program=task.program.replace('1, ', '9, '))"))
    assert code == 1 and verdict["kind"] == "actions" and "step 3, object 0" in str(verdict["detail"]), "a draw within a behavior"
    code, verdict = ask(DYNAMIC, ask.other(task="replace(task, program=task.program.replace('take Disc', 'take 1 / 0, Disc'))"))
    assert code == 1 and verdict["kind"] == "error" and "refused there when it was simulated" in str(verdict["detail"])


@pytest.mark.slow
def test_what_breaks_there_has_its_own_verdict_and_the_next_program_goes_on(ask: Asking) -> None:
    (ask.programs / "a.scenic").write_text("ego = Object at 1 @ 1\n")
    (ask.programs / "b.scenic").write_text("ego = Object at 2 @ 1\n")
    kept = ask.folder / "verdicts.jsonl"
    impl = ask.other(scene="import os; '1 @ 1' in task.program and os._exit(3)")
    code, out, err = ask.said(str(ask.programs), "--impl", impl, "--json", str(kept))
    assert code == 1 and "1 agree, 1 differ" in out, err
    first = json.loads(kept.read_text().splitlines()[0])
    assert (first["verdict"], first["kind"]) == ("differ", "crashed")


def test_what_cannot_be_said_is_skipped_and_told(ask: Asking) -> None:
    code, verdict = ask("import mars\nego = Object at 1 @ 1\n", ask.other())
    assert (code, verdict["verdict"]) == (5, "skipped")
    assert verdict["detail"] == "it imports mars, and this reference has a world of its own of that name"


@pytest.mark.slow
def test_a_program_goes_into_the_dialect_of_the_other_with_its_modules(ask: Asking) -> None:
    (ask.programs / "lib.scenic").write_text("class Parcel:\n    weight: 3\nParcel at 9 @ 9\n")
    code, verdict = ask("import lib\nego = lib.Parcel at 1 @ 1\n", ask.other(dialects=("scenic-3",)))
    assert (code, verdict["verdict"]) == (0, "agree"), verdict
    seen = 'assert "new lib.Parcel at" in task.program and task.files'
    code, verdict = ask("import lib\nego = lib.Parcel at 1 @ 1\n", ask.other(dialects=("scenic-3",), scene=seen))
    assert code == 0, verdict


@pytest.mark.parametrize("words, said", [
    (["--impl", "no-such-program", "."], "there is no program 'no-such-program'"),
    (["--impl", "python", "empty"], "holds no programs"),
    (["--impl", "python", "a.scenic", "--budget", "0"], "--budget is the time for a program, not 0"),
    (["--impl", "python", "a.scenic", "--alpha", "2"], "alpha is a probability"),
    (["--impl", "python", "a.scenic", "--json", "a.scenic"], "a.scenic is the program a.scenic"),
    (["--impl", "python", "missing.scenic"], "missing.scenic"),
])
def test_wrong_usage(ask: Asking, words: list[str], said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ask.folder)
    (ask.folder / "empty").mkdir()
    (ask.folder / "a.scenic").write_text("ego = Object\n")
    words = [ask.other() if word == "python" else word for word in words]
    code, out, err = ask.said(*words)
    assert code == 2 and said in err and not out


def test_the_looks_share_the_risk() -> None:
    alphas: list[float] = []

    def inconclusive(here: object, alpha: float) -> sequential_diff.ProgramVerdict:
        alphas.append(alpha)
        return sequential_diff.ProgramVerdict("p", "inconclusive", "distribution")

    settings = sequential_diff.DiffSettings(0.01, 0.1, 0, 1.0, 1)
    sizes: list[int] = []

    def grow(wanted: int) -> bool:
        sizes.append(wanted)
        return len(sizes) < 8

    program = sequential_diff.AskedProgram("p", sequential_diff.Task("", "paper"), lambda readings: loads("ego = Object"))
    found = sequential_diff.sequential_verdict(program, loads("ego = Object"), None, settings, grow, inconclusive)  # type: ignore[arg-type]
    assert found.verdict == "inconclusive" and sum(alphas) <= settings.alpha and len(alphas) == 7
    assert sizes == [1, 100, 300, 900, 2700, 8100, 24300, 30000]


def test_readings_that_are_selected_explain_no_difference() -> None:
    """A program in scenic-3 is compared under its profile: what explains a difference is another alternative than those."""
    tried: list[dict[str, str]] = []

    def load(readings: dict[str, str]) -> Scenario:
        tried.append(dict(readings))
        return loads("# dialect: scenic-3\nego = new Object")

    def differ(here: object, alpha: float) -> sequential_diff.ProgramVerdict:
        return sequential_diff.ProgramVerdict("p", "differ", "distribution")

    other = SimpleNamespace(profile=select("scenic-2.1"))
    program = sequential_diff.AskedProgram("p", sequential_diff.Task("", "scenic-3"), load)  # type: ignore[arg-type]
    found = sequential_diff.sequential_verdict(program, load({}), other, sequential_diff.DiffSettings(0.01, 0.1, 0, 60.0, 1), lambda _: True, differ)  # type: ignore[arg-type]
    selected = select("scenic-3")
    assert found.reading is None
    assert tried[1] == {id: one for id, one in select("scenic-2.1").items() if one != selected[id]}
    assert not any(selected[id] == one for readings in tried for id, one in readings.items())


def test_the_recorded_world_is_the_same_for_every_run() -> None:
    scenario = loads("behavior B():\n    while True:\n        take self.position.x\nego = Object at 1 @ 2, with behavior B\n")
    world = random_walk_world(scenario.sample(0), 5, 7)
    assert world == random_walk_world(scenario.sample(0), 5, 7) != random_walk_world(scenario.sample(0), 5, 8)
    simulator = RecordedWorld(world)
    for index in range(2):  # the second begins at the beginning
        steps = scenario.simulate(simulator, 4, 0, index).simulation.moments
        where = [world[k].get("0", {"position": [1.0, 2.0]})["position"][0] for k in range(4)]  # type: ignore[index]
        assert [moment.actions[0][0] for moment in steps[:4]] == pytest.approx(where)


SELDOM = "x = Uniform(0, 1, 2, 3)\nbehavior B():\n    take x\nego = Object at 0 @ 0, with behavior B\nrequire eventually x == 0\n"
NEVER = "behavior B():\n    take Range(0, 1)\nego = Object at 0 @ 0, with behavior B\nrequire eventually Range(0, 1) > 2\n"


def replayed(text: str, **changes: object) -> Replayed:
    """The simulations of a program whose scenes are kept after a rejection, two of them for each simulation."""
    scenario = loads(text, readings={"rejected-simulation": "retry"})
    settings = sequential_diff.DiffSettings(1e-9, 0.3, 0, 60.0, 2, attempts=200)._replace(**changes)
    return Replayed(scenario, random_walk_world(scenario.sample(0), 2, 7), settings)


def test_simulations_that_are_tried_in_vain_are_no_difference() -> None:
    """Of two scenes neither has x = 0 in 9 of 16 simulations: none of the others is another one because of that."""
    here, there = replayed(SELDOM), replayed(SELDOM, seed=1)
    theirs = there.first(40)
    assert len(here.first(40)) == 40 and 20 < len(here.missed) < 100 and not here.is_impossible
    found = of_simulations("p", here, theirs, 3, None, 1e-9)
    assert found.verdict != "differ"


@pytest.mark.parametrize(("found", "verdict"), [(1, "inconclusive"), (35, "differ")])
def test_that_one_side_has_no_simulation_is_a_difference_if_chance_would_not_make_it_so(found: int, verdict: str) -> None:
    others = replayed(SELDOM).first(found)
    ours = of_simulations("p", replayed(NEVER), others, 0, None, 1e-9)
    assert (ours.verdict, ours.kind) == (verdict, "acceptance") and "and there are simulations there" in ours.detail
    assert ours.evidence == pytest.approx(math.log10(math.comb(9 + len(others), 10)))
    assert of_simulations("p", replayed(NEVER), [], 1, None, 1e-9).verdict == "agree"


@pytest.mark.parametrize(("missed", "verdict"), [(1, "inconclusive"), (10, "inconclusive"), (100, "differ")])
def test_so_is_that_the_other_side_has_none(missed: int, verdict: str) -> None:
    """We miss more than half ourselves: that the others miss ten is no wonder, that they miss a hundred is one."""
    found = of_simulations("p", replayed(SELDOM), [], missed, None, 1e-9)
    assert (found.verdict, found.kind, found.detail) == (verdict, "acceptance", "no simulation is accepted there, and there are simulations here")


class Silent:
    """An implementation that does not answer when it is to simulate; its answers before are given."""

    profile: Mapping[str, str] = {}

    def __init__(self, before: Sequence[object], kind: str) -> None:
        self.before, self.kind = list(before), kind

    def simulations(self, *_: object, **__: object) -> list[object]:
        before, self.before = self.before, []
        if not before:
            raise ImplementationFault(self.kind, "no answer within 10 s")  # type: ignore[arg-type]
        return before


@pytest.mark.parametrize(("text", "before", "kind", "verdict"), [
    (NEVER, 0, "timed out", "inconclusive"), (SELDOM, 0, "timed out", None), (NEVER, 0, "crashed", None), (NEVER, 1, "timed out", None),
])
def test_no_answer_says_something_only_where_there_is_a_simulation(text: str, before: int, kind: str, verdict: str | None) -> None:
    scenario = replayed(text).scenario
    program = sequential_diff.AskedProgram("p", Task(text, "paper"), lambda _: scenario)
    other = Silent(replayed(SELDOM).first(before) if before else [], kind)
    settings = sequential_diff.DiffSettings(1e-9, 0.3, 0, 60.0, 2, attempts=200, explained=False)
    if verdict is None:
        with pytest.raises(ImplementationFault, match=kind):
            in_simulations(program, scenario, other, settings)  # type: ignore[arg-type]
    else:
        found = in_simulations(program, scenario, other, settings)  # type: ignore[arg-type]
        assert (found.verdict, found.kind) == (verdict, "acceptance") and "no answer within 10 s" in found.detail


def test_what_is_tried_in_vain_ends_with_the_time() -> None:
    seldom = replayed(SELDOM, seconds=0.0)
    with suppress(AttemptsExhausted):
        seldom.first(100)
    assert len(seldom.missed) == 1


def test_a_side_that_misses_all_by_chance_is_as_rare_as_is_said() -> None:
    """Of 20,000 pairs that miss 9 of 16 at most 20 alarms are expected at a risk of 1e-3; 45 or more of Poisson(20) have probability 1e-6. To leave
    out what our side missed itself would make (9/16)^10 of them alarms, 63.
    """
    numbers = random.Random(20261127)
    alarms = 0
    for _ in range(20_000):
        ours = missed = 0
        while ours < 30:
            hit = numbers.random() < 7 / 16
            ours, missed = ours + hit, missed + (not hit)
        theirs = [numbers.random() < 7 / 16 for _ in range(10)]
        alarms += not any(theirs) and all_on_one_side(10, ours, missed) <= 1e-3
    assert alarms < 45


def test_where_none_is_possible_one_try_shows_it() -> None:
    sure = replayed("ego = Object at 0 @ 0\nrequire eventually 1 == 2\n")
    found = of_simulations("p", sure, replayed(SELDOM).first(1), 0, None, 1e-9)
    assert found.verdict == "differ" and math.isinf(found.evidence) and len(sure.missed) == 1
