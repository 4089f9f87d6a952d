"""`take`, `wait`, `do`, `try ... interrupt when`, guards: a test for each sentence of Section "Statements" about them."""

from __future__ import annotations

import pytest
from scenic_ref.semantics.store.errors import CheckError, FuelExhausted, RunError, UncaughtException
from scenic_ref.simulators.loop import Failed

from .worlds import LIMIT, actions, behavior, simulated

LANE = "behavior Lane():\n    n = 0\n    while True:\n        n += 1\n        take n\n"
SAY = "behavior Say(word, times=1):\n    for i in range(times):\n        take word\n"


# Actions


def test_take_suspends_until_one_time_step_has_elapsed_then_invariants_are_checked_and_it_is_resumed():
    text = behavior("invariant: self.x < 2\ntake 'a'\nself.x = 1\ntake 'b'\nself.x = 2\ntake 'c'")
    assert actions(text) == ["rejected"]
    run = simulated(text)
    assert isinstance(run, Failed)
    assert (run.step, run.requirement.kind, run.requirement.text) == (3, "guard", "the invariant of B on line 3")
    assert actions(text.replace("= 2", "= 1")) == ["a", "b", "c", *[None] * 5, LIMIT]


def test_wait_takes_no_actions_in_this_step():
    assert actions(behavior("wait\ntake 1\nwait\ntake 2"), 4) == [None, 1, None, 2, LIMIT]


def test_lists_and_tuples_of_actions():
    assert actions(behavior("mine = [1, 2]\ntake mine\ntake (3,), 4\ntake []"), 3) == [(1, 2), (3, 4), None, LIMIT]


# Invoking other behaviors


def test_do_does_not_return_until_the_behavior_terminates():
    assert actions(behavior("do Say('a', 3)\ntake 'b'", SAY), 5) == ["a", "a", "a", "b", None, LIMIT]


def test_do_for_enforces_a_time_limit_in_steps_or_seconds():
    assert actions(behavior("do Lane() for 2 steps\ntake 'end'", LANE), 4) == [1, 2, "end", None, LIMIT]
    assert actions(behavior("do Lane() for 2 seconds\ntake 'end'", LANE), 6, timestep=0.5) == [1, 2, 3, 4, "end", None, LIMIT]
    assert actions(behavior("do Lane() for 0.3 seconds\ntake 'end'", LANE), 5, timestep=0.1) == [1, 2, 3, "end", None, LIMIT]
    assert 3 * 0.7 < 2.1
    assert actions(behavior("do Lane() for 2.1 seconds\ntake 'end'", LANE), 5, timestep=0.7) == [1, 2, 3, "end", None, LIMIT]


def test_do_until_adds_a_termination_criterion():
    assert actions(behavior("do Lane() until simulation.currentTime >= 3\ntake 'end'", LANE), 5) == [1, 2, 3, "end", None, LIMIT]


def test_when_do_returns_the_invariants_of_the_caller_are_checked():
    inner = "behavior Inner():\n    self.x = 1\n    wait\n    self.x = {}\n"
    text = behavior("invariant: self.x == 0\ndo Inner()\ntake 'on'", inner)
    assert actions(text.replace("{}", "0"), 3) == [None, "on", None, LIMIT]
    assert actions(text.replace("{}", "1"), 3) == ["rejected"]


def test_several_behaviors_at_a_time():
    assert actions(behavior("do Say('a'), Say('b', 3)\ntake 'end'", SAY), 5) == [("a", "b"), "b", "b", "end", None, LIMIT]


@pytest.mark.slow
def test_do_choose_picks_among_those_whose_preconditions_hold():
    options = "behavior P(n, ok):\n    precondition: ok\n    take n\n"
    text = behavior("do choose {P(1, True): 1, P(2, False): 100, P(3, True): 3}", options)
    found = [actions(text, 1, seed=seed)[0] for seed in range(400)]
    assert set(found) == {1, 3}
    assert 250 < found.count(3) < 345  # 300 expected; 6 standard deviations are 52
    assert actions(behavior("do choose P(1, False), P(2, False)", options)) == ["rejected"]


def test_do_shuffle_runs_all_of_them_in_random_order():
    text = behavior("do shuffle Say(1), Say(2), Say(3)\ntake 'end'", SAY)
    orders = {tuple(actions(text, 4, seed=seed)[:3]) for seed in range(80)}
    assert len(orders) == 6
    assert actions(text, 4)[3] == "end"


def test_do_shuffle_respects_preconditions_as_they_are_at_that_time():
    options = "behavior First():\n    self.x = 1\n    take 'first'\nbehavior Second():\n    precondition: self.x == 1\n    take 'second'\n"
    assert {tuple(actions(behavior("do shuffle Second(), First()", options), 2, seed=s)) for s in range(20)} == {("first", "second", LIMIT)}


# Interrupts


def test_conditions_are_checked_at_each_time_step_and_while_none_holds_the_body_executes():
    text = behavior("try:\n    do Lane()\ninterrupt when simulation.currentTime in (1, 3):\n    take 'i'", LANE)
    assert actions(text, 6) == [1, "i", 2, "i", 3, 4, LIMIT]


def test_lower_blocks_preempt_those_above_even_their_handlers():
    text = behavior(
        "try:\n    do Lane()\ninterrupt when simulation.currentTime == 1:\n    do Say('pass', 3)\n"
        "interrupt when simulation.currentTime == 2:\n    do Say('avoid', 2)",
        LANE + SAY,
    )
    assert actions(text, 8) == [1, "pass", "avoid", "avoid", "pass", "pass", 2, 3, LIMIT]


def test_upper_blocks_do_not_preempt_those_below():
    text = behavior(
        "try:\n    do Lane()\ninterrupt when simulation.currentTime == 2:\n    do Say('first', 1)\n"
        "interrupt when simulation.currentTime == 1:\n    do Say('last', 3)",
        LANE + SAY,
    )
    assert actions(text, 6) == [1, "last", "last", "last", 2, 3, LIMIT]


def test_interrupts_of_the_outer_statement_take_precedence():
    text = behavior(
        "done = False\ntry:\n    try:\n        do Lane()\n    interrupt when simulation.currentTime in (1, 2):\n        do Say('inner', 2)\n"
        "interrupt when simulation.currentTime == 2 and not done:\n    take 'outer'\n    done = True",
        LANE + SAY,
    )
    assert actions(text, 6) == [1, "inner", "outer", "inner", 2, 3, LIMIT]


def test_invariants_of_the_suspended_behavior_are_checked_when_the_handler_completes():
    inner = "behavior Inner():\n    invariant: self.x == 0\n    while True:\n        take 'in'\n"
    text = behavior("try:\n    do Inner()\ninterrupt when simulation.currentTime == 1:\n    self.x = 1\n    take 'i'\n    self.x = {}", inner)
    assert actions(text.replace("{}", "0"), 4) == ["in", "i", "in", "in", LIMIT]
    run = simulated(text.replace("{}", "1"), 4)
    assert isinstance(run, Failed)
    assert (run.step, run.requirement.text) == (2, "the invariant of Inner on line 2")


@pytest.mark.parametrize("where", ["body", "handler"])
def test_exceptions_of_the_body_and_of_handlers_are_caught_by_except(where):
    fail = "raise ValueError('x')"
    body, handler = (fail, "pass") if where == "body" else ("do Lane()", fail)
    text = f"try:\n    {body}\ninterrupt when simulation.currentTime == 1:\n    {handler}\nexcept ValueError:\n    take 'caught'\ntake 'end'"
    text = behavior(text, LANE)
    assert actions(text, 4) == (["caught", "end", None, None, LIMIT] if where == "body" else [1, "caught", "end", None, LIMIT])


def test_a_guard_violation_can_be_caught_and_rejects_otherwise():
    inner = "behavior Inner():\n    precondition: self.x == 1\n    take 'in'\n"
    text = "try:\n    do Inner()\ninterrupt when False:\n    pass\nexcept {}:\n    take 'caught'"
    for name in ("PreconditionViolation", "GuardViolation", "Exception"):
        assert actions(behavior(text.format(name), inner), 2) == ["caught", None, LIMIT]
    assert actions(behavior(text.format("InvariantViolation"), inner), 2) == ["rejected"]
    assert actions(behavior("do Inner()", inner), 2) == ["rejected"]


@pytest.mark.parametrize("where", ["body", "handler"])
def test_any_block_may_abort_the_entire_statement(where):
    body, handler = ("take 1\n    abort", "pass") if where == "body" else ("do Lane()", "abort")
    text = behavior(f"try:\n    {body}\ninterrupt when simulation.currentTime == 1:\n    {handler}\ntake 'end'", LANE)
    assert actions(text, 3) == [1, "end", None, LIMIT]


def test_abort_ends_the_innermost_statement_only():
    text = "try:\n    do Lane() until simulation.currentTime == 1\n    take 'on'\ninterrupt when simulation.currentTime == 9:\n    abort"
    assert actions(behavior(text, LANE), 3) == [1, "on", None, LIMIT]


def test_else_and_finally_belong_to_the_statement_as_in_python():
    text = "try:\n    take 1\ninterrupt when False:\n    pass\nexcept ValueError:\n    pass\nelse:\n    take 'else'\nfinally:\n    take 'finally'"
    assert actions(behavior(text), 4) == [1, "else", "finally", None, LIMIT]


def test_loops_and_functions_around_an_interrupt():
    text = behavior(
        "for k in range(3):\n    try:\n        take k\n        if k == 1:\n            break\n    interrupt when False:\n        pass\ntake 'end'"
    )
    assert actions(text, 4) == [0, 1, "end", None, LIMIT]
    assert actions(behavior("try:\n    take 1\n    return\ninterrupt when False:\n    pass\ntake 2"), 3) == [1, None, None, LIMIT]


# What is wrong


def test_errors_have_their_place():
    with pytest.raises(RunError, match="invokes behaviors and scenarios, not a scalar") as found:
        actions(behavior("do 3"))
    assert found.value.span.line == 3
    with pytest.raises(UncaughtException, match="ZeroDivisionError"):
        actions(behavior("take 1 / 0"))
    with pytest.raises(FuelExhausted, match="endless loop") as endless:
        actions(behavior("while True:\n    pass"), fuel=10_000)
    assert endless.value.hint == "time passes only where something is taken, waited for or done; raise --fuel if it really takes that long"
    with pytest.raises(RunError, match="invokes itself too deeply"):
        actions(behavior("do B()"))
    with pytest.raises(RunError, match="no agent that could run"):
        actions("behavior B():\n    wait\nego = Object at (0, 0)\nmonitor M:\n    do B()")
    with pytest.raises(CheckError, match="`take` cannot stand"):
        actions("ego = Object at (0, 0)\ntake 1")


# Found by reading

ONES = "behavior Inner():\n    while True:\n        take 1\n"


def test_an_interrupt_fires_again_while_its_condition_holds():
    """ "In the next step, we will resume [...], unless we are still within 5 meters of an object, in which case the interrupt will fire again"."""
    text = behavior("try:\n    do Inner()\ninterrupt when simulation.currentTime < 3:\n    take 9", ONES)
    assert actions(text, 5) == [9, 9, 9, 1, 1, LIMIT]
    text = behavior("do Inner() for 2 steps\nwhile True:\n    take 2", ONES)
    outer = "behavior C():\n    try:\n        do B()\n    interrupt when simulation.currentTime == 1:\n        take 9\n        take 9\n"
    outer = text.replace("ego = ", outer + "ego = ")
    assert actions(outer.replace("with behavior B", "with behavior C"), 5) == [1, 9, 9, 2, 2, LIMIT]


def test_inner_conditions_are_checked_when_an_outer_handler_completes():
    inner = "behavior Inner():\n    try:\n        while True:\n            take 1\n    interrupt when True:\n        take 5\n"
    text = behavior("try:\n    do Inner()\ninterrupt when simulation.currentTime == 1:\n    take 9", inner)
    assert actions(text, 4) == [5, 9, 5, 5, LIMIT]
    text = behavior("n = 0\ntry:\n    do Inner()\ninterrupt when True:\n    n += 1", inner)
    assert actions(text, 3) == [5, 5, 5, LIMIT]


def test_the_limit_of_do_returns_through_the_invariants_of_the_caller():
    inner = "behavior Inner():\n    self.x = 1\n    while True:\n        take 1\n"
    text = behavior("invariant: self.x == 0\ndo Inner() for 2 steps\nself.x = 0\ntake 7", inner)
    assert actions(text) == ["rejected"]
    inner = "behavior Inner():\n    self.x = 1\n    wait\n    self.x = 0\n    wait\n"
    both = behavior("invariant: self.x == 0\ndo Inner(), Inner()\nself.x = 0", inner)
    assert actions(both, 3) == [None, None, None, LIMIT]


def test_exceptions_of_conditions_can_be_caught_in_every_step():
    condition = "simulation.currentTime > 0 and 1 / 0 > 1"
    own = f"try:\n    while True:\n        take 1\ninterrupt when {condition}:\n    pass\nexcept ZeroDivisionError:\n    take 3"
    assert actions(behavior(own), 3) == [1, 3, None, LIMIT]
    outer = f"try:\n    try:\n        while True:\n            take 1\n    interrupt when {condition}:\n        pass\n"
    outer += "except ZeroDivisionError:\n    take 3"
    assert actions(behavior(outer), 3) == [1, 3, None, LIMIT]


def test_abort_leaves_out_else():
    text = "try:\n    take 1\n    abort\ninterrupt when False:\n    pass\nexcept ValueError:\n    pass\nelse:\n    take 'else'\ntake 'end'"
    assert actions(behavior(text), 3) == [1, "end", None, LIMIT]


def test_no_draw_is_numbered_as_another_one():
    before = "behavior X():\n    take 'x'\n    self.x = Uniform(1, 2, 3, 4)\n"
    before += "behavior XX():\n    p = Uniform(1, 2, 3, 4)\n    take (self.x, p)[0] == p\n"
    text = behavior("do X(), Y()\ndo XX(), Y()", before + "behavior Y():\n    wait\n")
    found = [actions(text, 3, seed=seed)[1] for seed in range(80)]
    assert 4 < found.count(True) < 45  # 20 expected; 6 standard deviations are 23


def test_an_invariant_is_checked_where_a_handler_of_the_behavior_s_own_begins_after_its_take():
    """"The behavior is suspended until one time step has elapsed; then its invariants are checked": it goes on with the handler."""
    body = "invariant: self.x == 0\ntry:\n    self.x = 1\n    take 'a'\ninterrupt when simulation.currentTime == 1:\n    take 'handler'\n"
    run = simulated(behavior(body))
    assert isinstance(run, Failed)
    assert (run.step, run.requirement.text) == (1, "the invariant of B on line 3")
    assert actions(behavior(body + "except InvariantViolation:\n    self.x = 0\n    take 'caught'"), 2) == ["a", "caught", LIMIT]
    assert actions(behavior(body.replace("self.x = 1", "self.x = 0")), 2) == ["a", "handler", LIMIT]


def test_it_is_not_checked_there_while_the_behavior_waits_for_another():
    """What was suspended is what it invoked: "when the do statement returns, the invariants of the calling behavior are checked"."""
    inner = "behavior Inner():\n    self.x = 1\n    take 'inner'\n    self.x = 0\n"
    body = "invariant: self.x == 0\ntry:\n    do Inner()\ninterrupt when simulation.currentTime == 1:\n    self.x = 0\n    take 'handler'\n"
    assert actions(behavior(body, inner), 3) == ["inner", "handler", None, LIMIT]
    assert actions(behavior(body, inner), 3, readings={"invariant-of-caller": "every-step"}) == ["rejected"]


def test_finally_runs_on_the_way_out_of_its_own_block():
    """Reading `finally-of-coroutines`: also by `abort` and `terminate`, which take effect when it is done."""
    assert actions(behavior("try:\n    terminate\nfinally:\n    take 1")) == [1, "terminated"]
    inner = "try:\n    try:\n        abort\n    finally:\n        take 1\ninterrupt when False:\n    pass\ntake 2"
    assert actions(behavior(inner), 2) == [1, 2, LIMIT]


def test_except_and_else_blocks_may_abort_the_entire_statement():
    """`except` and `else` blocks as well, and only the innermost statement."""
    head = "try:\n    {}\ninterrupt when False:\n    wait\n"
    caught = head.format("raise ValueError('x')") + "except ValueError:\n    take 'caught'\n    abort\n    take 'never'\ntake 'end'"
    assert actions(behavior(caught), 2) == ["caught", "end", LIMIT]
    otherwise = head.format("pass") + "except ValueError:\n    pass\nelse:\n    abort\ntake 'end'"
    assert actions(behavior(otherwise), 1) == ["end", LIMIT]
    inner = "try:\n" + "".join(f"    {line}\n" for line in caught.splitlines()) + "interrupt when False:\n    wait\ntake 'outer'"
    assert actions(behavior(inner), 3) == ["caught", "end", "outer", LIMIT]


@pytest.mark.parametrize("wrong", [1, 2, 3])
@pytest.mark.parametrize("word", ["precondition", "invariant"])
def test_each_of_three_guards_is_checked(word: str, wrong: int):
    guards = "".join(f"{word}: {n != wrong}\n" for n in (1, 2, 3))
    run = simulated(behavior(f"{guards}take 1"))
    assert isinstance(run, Failed)
    assert run.requirement.text == f"the {word} of B on line {wrong + 2}"
