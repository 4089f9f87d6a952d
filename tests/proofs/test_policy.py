"""The policy of `proofs/dynamics/Policy.v` and that of the machine do the same in a thousand simulations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random

import pytest
import scenic_ref
from scenic_ref.semantics.dynamics import policy
from scenic_ref.semantics.store.errors import AttemptsExhausted
from scenic_ref.simulators.loop import Failed

from .coq import Term, evaluated, needs_coq

GOES_ON, TERMINATES, FAILS = range(3)
TURNS = ("Goes_on", "Terminates", "Fails")
COUNT = 1000


@dataclass(frozen=True)
class Moment:
    """What the coroutines do in a time step, and what holds in it: a `time_step` of the theory."""

    compose: int
    is_over: bool
    always: tuple[bool, ...]
    eventually: tuple[bool, ...]
    monitors: tuple[int, ...]
    behaviors: tuple[tuple[int, int], ...]


def history(random: Random) -> tuple[Moment, ...]:
    """Some time steps with the same conditions, monitors and agents; in some of them several things happen, so that their order shows."""
    always, eventually, monitors, agents = random.randrange(3), random.randrange(3), random.randrange(3), random.randint(1, 3)

    def moment() -> Moment:
        often = random.choice((1, 1, 1, 10))

        def turn() -> int:
            return random.choices((GOES_ON, TERMINATES, FAILS), (40, 3 * often, 2 * often))[0]

        return Moment(
            turn(), random.random() < 0.1, tuple(random.random() < 1 - 0.05 * often for _ in range(always)),
            tuple(random.random() < 0.6 for _ in range(eventually)),
            tuple(turn() for _ in range(monitors)), tuple((turn(), random.randrange(5)) for _ in range(agents)),
        )  # fmt: skip

    return tuple(moment() for _ in range(random.randint(1, 4)))


def in_coq(moments: Sequence[Moment]) -> str:
    """The simulation as a term of the theory."""

    def listed(values: Sequence[object]) -> str:
        return f"[{'; '.join(str(value).lower() if isinstance(value, bool) else str(value) for value in values)}]"

    steps = [
        f"Build_time_step nat {TURNS[m.compose]} {str(m.is_over).lower()} {listed(m.always)} {listed(m.eventually)} "
        f"{listed([TURNS[t] for t in m.monitors])} {listed([f'({TURNS[t]}, {a})' for t, a in m.behaviors])}"
        for m in moments
    ]
    return f"simulation 0 {listed([False] * len(moments[0].eventually))} {listed(steps)}"


def in_scenic(moments: Sequence[Moment]) -> str:
    """The program whose coroutines do this; after it, all goes on and all conditions hold. The comments name the steps of the policy."""
    body = "require {0}[t] != 2 # {1}\n{2}if {0}[t] == 1: terminate\n{2}"
    inner = " " * 8

    def script(turns: Sequence[object], after: object) -> str:
        return f"({', '.join(map(str, (*turns, after)))},)"

    def loop(turns: Sequence[int], step: int, last: str, indent: str) -> str:
        return f"{indent}for t in range(9):\n{indent}    " + body.format(script(turns, GOES_ON), step, indent + "    ") + last + "\n"

    lines = []
    for number in range(len(moments[0].behaviors)):
        actions = script([m.behaviors[number][1] for m in moments], 9)
        lines.append(f"behavior B{number}():\n" + loop([m.behaviors[number][0] for m in moments], 5, f"take {actions}[t]", " " * 4))
    lines.append("scenario Main():\n    setup:\n")
    for number in range(len(moments[0].behaviors)):
        lines.append(f"{inner}{'ego = ' if number == 0 else ''}Object at {5 * number} @ 0, with behavior B{number}\n")
    for number in range(len(moments[0].always)):
        lines.append(f"{inner}require always {script([m.always[number] for m in moments], True)}[simulation.currentTime] # 2\n")
    for number in range(len(moments[0].eventually)):
        lines.append(f"{inner}require eventually {script([m.eventually[number] for m in moments], True)}[simulation.currentTime] # 4\n")
    lines.append(f"{inner}terminate when {script([m.is_over for m in moments], False)}[simulation.currentTime]\n")
    for number in range(len(moments[0].monitors)):
        lines.append(f"{inner}monitor M{number}:\n" + loop([m.monitors[number] for m in moments], 3, "wait", inner + "    "))
    lines.append("    compose:\n" + loop([m.compose for m in moments], 1, "wait", inner))
    return "".join(lines)


def by_the_machine(moments: Sequence[Moment]) -> tuple[list[list[int]], object]:
    """The actions of each time step and how the simulation ended; of one that is thrown away, when, and at which step of the policy."""
    text = in_scenic(moments)
    failed: list[Failed] = []
    scenario = scenic_ref.loads(text, readings={"time-unit": "steps"})
    try:
        found = scenario.simulate("still", steps=len(moments), max_attempts=1, on_failed=failed.append, backend="interpreter").simulation
    except AttemptsExhausted:
        line = text.splitlines()[failed[0].requirement.span.line - 1]
        return [], ("Thrown_away", failed[0].step, int(line[-1]))
    acted = [[moment.actions[number][0] for number in sorted(moment.actions)] for moment in found.moments if moment.actions]
    return acted, "Still_running" if found.result == "time limit" else ("Over", len(acted))


def by_the_theory(told: Term) -> tuple[list[list[int]], object]:
    """The same of what Coq says: in which of its steps the policy ends a simulation, or finds a `require eventually`, is not told by the machine."""
    actions, ending = told
    if ending == "Still_running":
        return actions, ending
    kind, time, step = ending
    return ([], (kind, time, 4 if step == 6 else step)) if kind == "Thrown_away" else (actions, (kind, time))


def some(count: int) -> list[tuple[Moment, ...]]:
    random = Random(17)
    return [history(random) for _ in range(count)]


Asked = list[tuple[tuple[Moment, ...], tuple[list[list[int]], object]]]


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> Asked:
    """A thousand simulations, and what Coq says of them."""
    histories = some(COUNT)
    told = evaluated(["dynamics.Policy"], [f"[{'; '.join(map(in_coq, histories))}]"], tmp_path_factory.mktemp("policy"))[0]
    return [(moments, by_the_theory(one)) for moments, one in zip(histories, told, strict=True)]


def differences(asked: Asked) -> Iterator[tuple[Moment, ...]]:
    """The simulations that go another way in the machine."""
    return (moments for moments, end in asked if by_the_machine(moments) != end)


@pytest.mark.slow
@needs_coq
def test_the_policies_agree(asked: Asked) -> None:
    assert list(differences(asked)) == []
    kinds = Counter(end[1] if isinstance(end[1], str) else f"{end[1][0]} {end[1][2:] or ''}" for _, end in asked)  # type: ignore[index]
    expected = {"Still_running", "Over ", *(f"Thrown_away ({step},)" for step in (1, 2, 3, 4, 5))}
    assert kinds.keys() == expected and min(kinds.values()) >= 20, kinds


def without(number: int) -> Callable[[pytest.MonkeyPatch], None]:
    """A policy that leaves out one of its steps."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        def left_out(frame: policy.Step, result: object, stack: object, state: object) -> object:
            return policy.advance_policy(frame, f"D-Policy-{number}", stack, state)  # type: ignore[arg-type]

        patch.setitem(policy.STEPS, number, left_out)  # type: ignore[arg-type]

    return plant


@pytest.mark.slow
@needs_coq
@pytest.mark.parametrize("number", [2, 4, 6])
def test_a_policy_without_one_of_its_steps_is_noticed(number: int, asked: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    without(number)(monkeypatch)
    assert any(differences(asked[:150]))


@pytest.mark.slow
@needs_coq
@pytest.mark.parametrize("number", [1, 2, 3, 4, 5, 6])
def test_two_steps_in_the_wrong_order_are_noticed(number: int, asked: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = policy.STEPS[number], policy.STEPS[number + 1]
    monkeypatch.setitem(policy.STEPS, number, second)
    monkeypatch.setitem(policy.STEPS, number + 1, first)
    assert any(differences(asked[:150]))


@needs_coq
def test_the_other_reading_is_noticed(tmp_path: Path) -> None:
    """Under reading `behaviors-after-terminate` = stop, a behavior that fails after another has terminated the scenario does not run."""
    moment = Moment(GOES_ON, False, (), (), (), ((TERMINATES, 1), (FAILS, 2)))
    assert by_the_theory(evaluated(["dynamics.Policy"], [in_coq([moment])], tmp_path)[0]) == ([], ("Thrown_away", 0, 5)) == by_the_machine([moment])
    stopped = scenic_ref.loads(in_scenic([moment]), readings={"time-unit": "steps", "behaviors-after-terminate": "stop"})
    assert stopped.simulate("still", steps=1, max_attempts=1, backend="interpreter").simulation.result != "time limit"
