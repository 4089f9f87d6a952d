"""Machines whose policy is wrong on purpose: for each, named vectors fail that hold on the right one."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from scenic_ref.conformance import Ourselves, judge, load_vectors
from scenic_ref.semantics.dynamics import (
    choose_and_shuffle,
    endings,
    guards,
    interrupts,
    invocations,
    policy,
    scenarios,
)
from scenic_ref.semantics.machine.simulation_state import TOP, simulation_of
from scenic_ref.semantics.space.distributions import Discrete

VECTORS = {v.name: v for v in load_vectors() if v.steps is not None}
Patch = Callable[[pytest.MonkeyPatch], None]


def exchanged(number: int) -> Patch:
    """A step of the policy after the one that should follow it."""

    def patch(monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(policy, "STEPS", {**policy.STEPS, number: policy.STEPS[number + 1], number + 1: policy.STEPS[number]})

    return patch


def replaced(module: object, name: str, function: object, *others: object) -> Patch:
    """A function of the machine replaced by another one, also where other modules have imported it."""

    def patch(monkeypatch: pytest.MonkeyPatch) -> None:
        for one in (module, *others):
            monkeypatch.setattr(one, name, function)

    return patch


interruptible, check_interrupts, has_passed = interrupts.interruptible, interrupts.check_interrupts, interrupts.has_passed
choose, guards_of, ended_by_monitor = choose_and_shuffle.choose, guards.guards_of, policy.ended_by_monitor
begin_scenarios = scenarios.begin_scenarios


def earlier_clauses_first(node, clauses, body, stack, state):
    return interruptible(node, tuple(reversed(clauses)), body, stack, state)


def no_clauses_but_the_last(node, clauses, body, stack, state):
    return interruptible(node, clauses[-1:], body, stack, state)


def inner_statements_first(process, stack, state, place=None, clause=None):
    """Only the innermost statement is asked."""
    frames = [k for k, frame in enumerate(process.frames) if isinstance(frame, interrupts.Interruptible)]
    return check_interrupts(process, stack, state, frames[0] if place is None and frames else place, clause)


def all_enabled(frame, stack, state):
    return choose(frame._replace(enabled=tuple(range(len(frame.picking.options)))), stack, state)


def alike(weights):
    return Discrete(tuple((k, 1) for k, _ in weights))


def without_preconditions(dynamic, scope):
    first, second = guards_of(dynamic, scope)
    return first._replace(conditions=()), second


def without_invariants(dynamic, scope):
    first, second = guards_of(dynamic, scope)
    return first, second._replace(conditions=())


def ends_all(number, state):
    return ended_by_monitor(TOP, state)


def conditions_of_all(state):
    for number, running in simulation_of(state).scenarios.items():
        yield from ((number, place, one) for place, one in enumerate(running.always))
        yield from ((number, place, one) for place, one in enumerate(running.eventually))


def one_step_longer(deadline, frame, state):
    return has_passed(deadline._replace(time=deadline.time + 1), frame, state)


def only_the_first(node, invocations, *rest, **more):
    return begin_scenarios(node, invocations[:1], *rest, **more)


MACHINES: dict[str, tuple[Patch, tuple[str, ...]]] = {
    "always conditions before compose blocks": (exchanged(1), ("step-1-before-step-2",)),
    "monitors before always conditions": (exchanged(2), ("step-2-before-step-3",)),
    "the flag before monitors": (exchanged(3), ("step-3-before-step-4",)),
    "behaviors before the flag": (exchanged(4), ("step-4-before-step-5",)),
    "the flag a second time before behaviors": (exchanged(5), ("step-5-before-step-6", "terminate-in-a-behavior")),
    "actions are returned before the flag is looked at": (exchanged(6), ("step-6-before-step-7", "terminate-in-a-behavior")),
    "earlier clauses win": (
        replaced(interrupts, "interruptible", earlier_clauses_first),
        ("lower-clauses-take-precedence", "lower-clauses-interrupt-handlers", "three-clauses-in-order-of-priority"),
    ),
    "only one clause": (replaced(interrupts, "interruptible", no_clauses_but_the_last), ("three-clauses-in-order-of-priority",)),
    "outer statements are not asked": (
        replaced(interrupts, "check_interrupts", inner_statements_first),
        ("outer-interrupts-take-precedence", "outer-interrupts-suspend-inner-handlers"),
    ),
    "overrides are never reverted": (
        replaced(endings, "revert_override", lambda override, number, state: state),
        ("override-of-a-property", "override-of-a-behavior", "nested-overrides", "override-ends-with-an-aborted-scenario"),
    ),
    "preconditions are ignored by do choose": (
        replaced(choose_and_shuffle, "choose", all_enabled),
        ("do-choose-with-one-disabled", "do-choose-with-one-enabled", "do-choose-with-weights-and-one-disabled", "do-shuffle-respects-preconditions"),
    ),
    "weights are ignored": (replaced(choose_and_shuffle, "Discrete", alike), ("do-choose-with-weights", "do-choose-with-weights-and-one-disabled")),
    "preconditions are not checked": (
        replaced(guards, "guards_of", without_preconditions, invocations, scenarios),
        ("a-precondition-that-does-not-hold", "preconditions-know-arguments-and-self"),
    ),
    "invariants are checked when behaviors begin, not when they go on": (
        replaced(guards, "guards_on_resumption", lambda stack, state: (), interrupts),
        ("an-invariant-after-an-action", "an-invariant-of-the-caller-when-do-returns", "an-invariant-of-the-suspended-behavior"),
    ),
    "invariants are not checked when behaviors begin": (
        replaced(guards, "guards_of", without_invariants, invocations, scenarios), ("an-invariant-when-the-behavior-begins",),
    ),
    "require eventually is not looked at": (
        replaced(policy, "never_held", lambda running: None), ("require-eventually-that-never-holds", "step-6-checks-eventually-conditions"),
    ),
    "a monitor ends the whole simulation": (replaced(policy, "ended_by_monitor", ends_all), ("a-monitor-ends-its-sub-scenario",)),
    "a monitor ends nothing": (replaced(policy, "ended_by_monitor", lambda number, state: state), ("a-monitor-runs-in-parallel",)),
    "requirements of suspended scenarios count": (replaced(policy, "conditions", conditions_of_all), ("suspended-scenarios-are-not-running",)),
    "limits are a step too long": (
        replaced(interrupts, "has_passed", one_step_longer), ("do-for-steps", "do-for-seconds", "reading-do-for-zero-steps"),
    ),
    "only the first of several scenarios": (
        replaced(scenarios, "begin_scenarios", only_the_first, invocations), ("a-scenario-makes-objects", "parallel-scenarios-of-different-lengths"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", MACHINES)
def test_the_vectors_find_a_wrong_machine(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    patch, names = MACHINES[what]
    assert names
    patch(monkeypatch)
    verdicts = {name: judge(Ourselves(), VECTORS[name]).verdict.status for name in names}
    assert verdicts == dict.fromkeys(names, "failed")
