"""Modular scenarios: setup, compose, composition, `override`, the initial scenario (paper, Section "Compositional Scenarios" and "Statements")."""

from __future__ import annotations

import pytest
from scenic_ref.semantics.store.errors import RunError, UncaughtException, UsageError
from scenic_ref.simulators.loop import Failed, Simulated

from .worlds import LIMIT, actions, simulated

NOW = "simulation.currentTime"


def main(compose: str, before: str = "", setup: str = "ego = Object at (0, 0), with x 0") -> str:
    """A program with a scenario Main of these blocks."""

    def block(text: str) -> str:
        return "".join(f"        {line}\n" for line in text.split("\n"))

    return f"{before}\nscenario Main():\n    setup:\n{block(setup)}" + (f"    compose:\n{block(compose)}" if compose else "")


def steps_and_objects(text: str, steps: int = 10, **options: object) -> list[object]:
    """How many objects there are at the start of each time step, and how the run ended."""
    run = simulated(text, steps, **options)  # type: ignore[arg-type]
    return ["rejected"] if isinstance(run, Failed) else [*(len(moment.objects) for moment in run.moments), run.result]


PARKED = "scenario Parked(x=10):\n    setup:\n        car = Object at (x, 0)\n"


def test_the_initial_scenario_is_main_or_the_one_that_is_named():
    text = "ego = Object at (0, 0)\nscenario Other():\n    setup:\n        Object at (5, 0)\n"
    assert steps_and_objects(text, 1) == [1, 1, LIMIT]
    assert steps_and_objects(text, 1, scenario="Other") == [2, 2, LIMIT]
    assert steps_and_objects(main("", PARKED), 1) == [1, 1, LIMIT]
    assert steps_and_objects(main("", PARKED, "ego = Object at (0, 0)\nObject at (3, 0)"), 1) == [2, 2, LIMIT]
    with pytest.raises(UsageError, match="no scenario Nobody"):
        simulated(text, 1, scenario="Nobody")


def test_parallel_composition_runs_scenarios_at_the_same_time():
    text = main("do Parked(), Parked(20)", PARKED)
    assert steps_and_objects(text, 3) == [3, 3, 3, 3, LIMIT]


def test_sequential_composition_and_time_limits():
    text = main("while True:\n    do Parked(10 * (1 + simulation.currentTime)) for 2 seconds", PARKED)
    assert steps_and_objects(text, 5) == [2, 2, 3, 3, 4, 4, LIMIT]
    text = main("do Parked() for 2 seconds\nwait", PARKED)
    assert steps_and_objects(text, 6) == [2, 2, 2, 2, "terminated"]


def test_variables_of_a_sub_scenario_can_be_read_even_by_the_condition_that_ends_it():
    compose = f"sub = Parked(15)\ndo sub until sub.car.position.x == 15 and {NOW} == 2\nrequire sub.car.position.x == 15\nwait"
    assert steps_and_objects(main(compose, PARKED)) == [2, 2, 2, 2, "terminated"]
    assert steps_and_objects(main("sub = Parked()\ndo sub until sub.car.position.x == 10", PARKED)) == [2, "terminated"]


def test_setup_runs_when_the_scenario_begins_to_execute():
    text = main("sub = Parked()\nwait\nwait\ndo sub for 1 steps", PARKED)
    assert steps_and_objects(text) == [1, 1, 2, 2, "terminated"]


def test_a_scenario_without_compose_block_only_checks_its_conditions():
    sub = f"scenario Sub():\n    setup:\n        terminate when {NOW} == 2\n"
    assert steps_and_objects(main("do Sub()\nwait", sub)) == [1, 1, 1, 1, "terminated"]
    sub = f"scenario Sub():\n    setup:\n        require always {NOW} < 2\n"
    assert steps_and_objects(main("do Sub()", sub)) == ["rejected"]
    assert steps_and_objects(main("do Sub() for 2 steps", sub)) == [1, 1, 1, "terminated"]


def test_conditions_count_while_their_scenario_is_running():
    sub = f"scenario Sub():\n    setup:\n        require eventually {NOW} == 3\n        terminate when {NOW} == {{}}\n"
    assert steps_and_objects(main("wait\ndo Sub()\nwait", sub.replace("{}", "2"))) == ["rejected"]
    assert steps_and_objects(main("wait\ndo Sub()\nwait", sub.replace("{}", "3")))[-1] == "terminated"


def test_terminate_ends_the_scenario_that_it_stands_in():
    sub = "scenario Sub():\n    compose:\n        wait\n        terminate\n"
    assert steps_and_objects(main("do Sub()\nwait", sub)) == [1, 1, 1, "terminated"]
    sub = "scenario Sub():\n    setup:\n        monitor End:\n            wait\n            terminate\n"
    assert steps_and_objects(main("do Sub()\nwait", sub)) == [1, 1, 1, 1, "terminated"]


def test_events_and_objects_made_on_the_way_are_recorded():
    run = simulated(main("wait\ndo Parked(12) for 2 steps", PARKED), 6)
    assert isinstance(run, Simulated)
    assert [(body.id, body.properties["position"].x) for body in run.created] == [(1, 12)]  # type: ignore[attr-defined]
    told = [(moment.step, event.partition(" (")[0]) for moment in run.moments for event in moment.events]
    assert told == [(1, "a scenario begins"), (3, "interrupt"), (3, "abort"), (3, "a scenario ends")]


def test_preconditions_and_invariants_of_scenarios():
    sub = "scenario Sub():\n    precondition: ego.x == 0\n    invariant: ego.x < 2\n"
    sub += "    compose:\n        wait\n        ego.x = ego.x + 1\n        wait\n        wait\n"
    assert steps_and_objects(main("do Sub()", sub))[-1] == "terminated"
    assert steps_and_objects(main("ego.x = 1\ndo Sub()", sub)) == ["rejected"]
    caught = "try:\n    do Sub()\ninterrupt when False:\n    pass\nexcept PreconditionViolation:\n    wait"
    assert steps_and_objects(main("ego.x = 1\n" + caught, sub)) == [1, 1, "terminated"]
    sub = sub.replace("ego.x + 1", "ego.x + 2")
    assert steps_and_objects(main("do Sub()", sub)) == ["rejected"]


def test_objects_created_while_running_obey_the_default_requirements_and_mutation():
    assert steps_and_objects(main("do Parked(0.5)", PARKED)) == ["rejected"]
    noisy = "scenario Noisy():\n    setup:\n        car = Object at (30, 0)\n        mutate car by 0.01\n"
    places = set()
    for seed in range(3):
        run = simulated(main("do Noisy()", noisy), 1, seed=seed)
        assert isinstance(run, Simulated)
        places.add(run.created[0].properties["position"].x)  # type: ignore[attr-defined]
    assert len(places) == 3
    assert all(0 < abs(x - 30) < 0.1 for x in places)


def test_interrupts_switch_between_scenarios():
    following = "scenario Following():\n    setup:\n        leadCar = Object at (10, 0)\n"
    following += "scenario Other(target):\n    setup:\n        Object at (target.position.x + 10, 0)\n"
    compose = f"following = Following()\ntry:\n    do following\ninterrupt when {NOW} == 2:\n    do Other(following.leadCar) for 2 steps"
    assert steps_and_objects(main(compose, following), 5) == [2, 2, 3, 3, 3, 3, LIMIT]


def test_scenarios_that_are_interrupted_do_not_run():
    sub = f"scenario Sub():\n    setup:\n        require always {NOW} not in (1, 2)\n"
    compose = f"try:\n    do Sub()\ninterrupt when {NOW} == 1:\n    wait\n    wait"
    assert steps_and_objects(main(compose, sub), 5)[-1] == LIMIT
    assert steps_and_objects(main("do Sub()", sub), 5) == ["rejected"]


# override

GO = "behavior Go(n):\n    k = 0\n    while True:\n        k += 1\n        take (n, k)\n".replace("take (n, k)", "take f'{n}{k}'")
OVER = GO + "scenario Over(target):\n    setup:\n        override target with behavior Go('b'), with x 3\n"
WITH_GO = "ego = Object at (0, 0), with x 0, with behavior Go('a')"


def test_override_lasts_until_the_scenario_ends_and_the_behavior_goes_on():
    text = main("wait\ndo Over(ego) for 2 steps\nrequire ego.x == 0\nwait\nwait", OVER, WITH_GO)
    assert actions(text) == ["a1", "b1", "b2", "a2", "a3", "terminated"]


def test_override_ends_with_an_interrupted_or_aborted_scenario():
    compose = f"try:\n    do Over(ego)\ninterrupt when {NOW} == 2:\n    abort\nwait\nwait"
    assert actions(main(compose, OVER, WITH_GO)) == ["b1", "b2", "a1", "a2", "terminated"]


def test_two_overrides_are_reverted_in_reverse_order():
    sub = "scenario Sub():\n    setup:\n        override ego with x 1\n        override ego with x 2\n"
    assert actions(main("do Sub() for 1 steps\nrequire ego.x == 0\nwait", sub)) == [None, None, "terminated"]


def test_override_in_a_compose_block_is_reverted_with_its_scenario():
    sub = GO + "scenario Sub():\n    compose:\n        override ego with behavior Go('c')\n        wait\n        wait\n"
    assert actions(main("do Sub()\nwait", sub, WITH_GO)) == ["c1", "c2", "a1", "terminated"]


def test_what_cannot_be_overridden_is_an_error():
    sub = "scenario Sub():\n    setup:\n        override ego {}\n"
    for specifier, message in (("at (1, 1)", "only `with`"), ("with nothing 1", "has no property nothing")):
        with pytest.raises(RunError, match=message):
            actions(main("do Sub()", sub.replace("{}", specifier)))


# The initial scenario, choice


def test_in_initial_scenario():
    both = "scenario {}():\n    setup:\n        if in initial scenario:\n            ego = Object at (0, 0)\n"
    both += "        else:\n            Object at (10, 0)\n"
    assert steps_and_objects(both.replace("{}", "Main"), 1) == [1, 1, LIMIT]
    assert steps_and_objects(main("do Sub()", both.replace("{}", "Sub")), 1) == [2, 2, LIMIT]


@pytest.mark.slow
def test_do_choose_of_the_paper():
    parts = "".join(f"scenario {n}():\n    precondition: {ok}\n    setup:\n        Object at ({10 * k}, 0)\n" for k, (n, ok) in enumerate(
        (("A", True), ("B", True), ("C", False)), 1))  # fmt: skip
    text = main("do choose {A: 2, B: 1, C: 1}", parts)
    found = []
    for seed in range(300):
        run = simulated(text, 1, seed=seed)
        assert isinstance(run, Simulated)
        found.append(len(run.moments[0].objects))
    assert set(found) == {2}
    assert steps_and_objects(main("do choose C, C", parts), 1) == ["rejected"]


def test_scenarios_are_first_class_values():
    choice = "def pickNext(position):\n    return Parked(20 if position.x == 0 else 30)\n"
    text = main("chosen = pickNext(ego.position)\ndo chosen for 1 steps", PARKED + choice)
    assert steps_and_objects(text) == [2, 2, "terminated"]


# Found by reading


def test_the_blocks_of_the_initial_scenario_share_its_variables():
    text = "scenario Main(p=1):\n    invariant: p == 1\n    setup:\n        ego = Object at (0, 0)\n        x = 1\n"
    text += "    compose:\n        require x == p\n        wait\n        wait\n"
    assert steps_and_objects(text) == [1, 1, 1, "terminated"]


def test_a_scenario_that_its_monitor_ends_leaves_the_others_alone():
    ends = "scenario A():\n    setup:\n        monitor M:\n            terminate\n"
    stays = "scenario B():\n    setup:\n        monitor N:\n            while True:\n                ego.x = ego.x + 1\n                wait\n"
    text = main("do A(), B() until ego.x == 3\nrequire ego.x == 3", ends + stays)
    assert steps_and_objects(text)[-1] == "terminated"


def test_a_scenario_that_cannot_begin_leaves_nothing_behind():
    parts = "scenario A():\n    setup:\n        override ego with x 5\n        require eventually False\nscenario B():\n    precondition: False\n"
    compose = "try:\n    do A(), B()\ninterrupt when False:\n    pass\nexcept PreconditionViolation:\n    require ego.x == 0\nwait"
    assert steps_and_objects(main(compose, parts)) == [1, 1, "terminated"]
    parts = "y = 1\nscenario A():\n    setup:\n        y = 5\n        raise ValueError('no')\n"
    compose = "try:\n    do A()\ninterrupt when False:\n    pass\nexcept ValueError:\n    require y == 1\nwait"
    assert steps_and_objects(main(compose, parts)) == [1, 1, "terminated"]


def test_overrides_of_parallel_scenarios_end_in_any_order():
    compose = "    compose:\n        for i in range(steps):\n            wait\n"
    part = "scenario Over(value, steps):\n    setup:\n        override ego with x value\n" + compose
    show = "behavior Show():\n    while True:\n        take self.x\n"
    setup = "ego = Object at (0, 0), with x 1, with behavior Show"
    assert actions(main("do Over(2, 1), Over(3, 2)\nwait\nwait", part + show, setup)) == [3, 3, 1, 1, "terminated"]
    assert actions(main("do Over(2, 2), Over(3, 1)\nwait\nwait", part + show, setup)) == [3, 2, 1, 1, "terminated"]
    part = GO + "scenario Over(name, steps):\n    setup:\n        override ego with behavior Go(name)\n" + compose
    assert actions(main("do Over('b', 1), Over('c', 2)\nwait\nwait", part, WITH_GO)) == ["c1", "c2", "a1", "a2", "terminated"]


def test_an_override_of_the_outer_scenario_outlives_that_of_an_inner_one():
    inner = "scenario Inner():\n    setup:\n        override ego with x 2\n    compose:\n        while True:\n            wait\n"
    outer = "scenario Outer():\n    compose:\n        try:\n            do Inner()\n        interrupt when simulation.currentTime == 1:\n"
    outer += "            override ego with x 3\n            wait\n"
    show = "behavior Show():\n    while True:\n        take self.x\n"
    text = main("do Outer() for 3 steps\nwait\nwait", inner + outer + show, "ego = Object at (0, 0), with x 1, with behavior Show")
    assert actions(text) == [2, 3, 3, 1, 1, "terminated"]


def test_conditions_declared_in_a_compose_block_count_from_then_on():
    assert steps_and_objects(main("wait\nrequire always False\nwait")) == ["rejected"]
    assert steps_and_objects(main("require eventually False\nwait")) == ["rejected"]
    assert steps_and_objects(main("wait\nterminate when True\nwait\nwait")) == [1, 1, "terminated"]


def test_the_invariant_of_a_caller_is_not_checked_while_a_scenario_runs():
    sub = "scenario Mid():\n    invariant: ego.x == 0\n    compose:\n        do Leaf()\n        wait\nscenario Leaf():\n    compose:\n"
    sub += "        ego.x = 1\n        wait\n        wait\n        ego.x = 0\n"
    assert steps_and_objects(main("do Mid()", sub))[-1] == "terminated"
    assert steps_and_objects(main("do Mid()", sub), readings={"invariant-of-caller": "every-step"}) == ["rejected"]


def test_objects_are_made_in_setup_blocks_only():
    for statement in ("Object at (9, 0)", "mutate ego"):
        with pytest.raises(RunError, match="in a setup block only"):
            steps_and_objects(main(f"wait\n{statement}"))
    assert steps_and_objects(main("p = Point at (9, 0)\nrequire (distance to p) == 9\nwait"))[-1] == "terminated"


def test_what_is_made_before_there_is_an_ego_must_be_seen_by_it_though_another_scenario_could_not_begin():
    bad = "scenario Bad():\n    precondition: simulation.currentTime > 5\n    setup:\n        Object at 9 @ 9\n"
    good = "scenario Good():\n    setup:\n        ego = Object at 0 @ 0, with viewDistance 5\n    compose:\n        wait\n"
    compose = "try:\n    do Bad()\ninterrupt when False:\n    pass\nexcept GuardViolation:\n    pass\ndo Good()"
    assert steps_and_objects(main(compose, bad + good, "Object at 3 @ 0")) == [2, 2, "terminated"]
    assert steps_and_objects(main(compose, bad + good, "Object at 100 @ 0")) == ["rejected"]
    assert steps_and_objects(main("do Good()", bad + good, "Object at 100 @ 0")) == ["rejected"]


BEFORE_IT_BEGINS = """
scenario Sub(v):
    setup:
        {ego}lead = Object at (0, 9), with x v
    compose:
        wait
        wait
scenario Main():
    setup:
        ego = Object at (0, 0), with x 0
    compose:
        a = Sub(1)
{body}
"""


def compose(body: str, ego: str = "") -> str:
    return BEFORE_IT_BEGINS.format(ego=ego, body="".join(f"        {line}\n" for line in body.split("\n")))


@pytest.mark.parametrize("ego", ["", "ego = "])
@pytest.mark.parametrize("name", ["lead", "ego", "v"])
def test_names_of_a_scenario_that_has_not_begun_are_an_error_that_says_so(name: str, ego: str) -> None:
    with pytest.raises(UncaughtException) as raised:
        simulated(compose(f"x = a.{name}\ndo a", ego))
    assert raised.value.message == f"AttributeError: Sub(1) was asked for its {name} before it began: ask once `do` has set it up"
    caught = f"try:\n    x = a.{name}\ninterrupt when False: pass\nexcept AttributeError:\n    x = 'none'\nrequire x == 'none'\n"
    assert isinstance(simulated(compose(f"{caught}require not hasattr(a, '{name}')\ndo a\ny = a.{name}", ego)), Simulated)


@pytest.mark.parametrize(
    ("condition", "steps"), [("a.lead.x == 1", 1), ("a.lead.x == 2", 2), ("a.ego.x == 0", 1), ("a.v == 1", 1), ("not a.v == 1", 2)]
)
def test_an_interrupt_about_the_scenario_that_its_statement_begins(condition: str, steps: int) -> None:
    run = simulated(compose(f"try:\n    do a\ninterrupt when {condition}:\n    abort"))
    assert isinstance(run, Simulated)
    assert len(run.moments) - 1 == steps


WAITS = """\
scenario Sub(v):
    setup:
        lead = Object at (0, 9), with x v
        seen = [lead]
    compose: wait
scenario Given(*arguments, **keywords):
    setup:
        {inside}
    compose: wait
behavior Shown(other):
    require other.x == 1
    take 1
scenario Main():
    setup: ego = Object at (0, 0), with x 0
    compose:
        a = Sub(1)
{body}
"""


def waits(inside: str, body: str) -> object:
    program = WAITS.format(inside=inside, body="".join(f"        {line}\n" for line in body.split("\n")))
    return simulated(program, readings={"names-not-begun": "waits"})


@pytest.mark.parametrize(
    ("inside", "argument"),
    [
        ("require arguments[0].x == 1", "a.lead"), ("require arguments[0].y == 9", "a.lead.position"), ("require arguments[0] == 1", "a.v"),
        ("require keywords['o'][0].x == 1", "o=a.seen"), ("require arguments[0] is arguments[1][0]", "a.lead, a.seen"),
        ("Object at (9, 9), with behavior Shown(arguments[0])", "a.lead"),
    ],
)  # fmt: skip
def test_names_that_wait_are_known_to_what_begins_after_their_scenario(inside: str, argument: str) -> None:
    for body in (f"do a, Given({argument})", f"g = Given({argument})\ndo a\ndo g", f"g = Given({argument})\ndo a, g"):
        assert isinstance(waits(inside, body), Simulated)
    if inside.startswith("Object"):  # the behavior begins later than both scenarios
        assert isinstance(waits(inside, f"do Given({argument}), a"), Simulated)
        return
    with pytest.raises(UncaughtException, match=r"Sub\(1\) was asked for its "):
        waits(inside, f"do Given({argument}), a")


@pytest.mark.parametrize("use", ["a.lead.x == 1", "print(a.lead)", "Given(a.v + 1)", "a.seen[0]", "[x for x in a.seen]", "a.lead in [1]", "abs(a.v)"])
def test_other_uses_of_names_that_wait_are_errors_that_say_so(use: str) -> None:
    with pytest.raises(UncaughtException, match=r"AttributeError: Sub\(1\) was asked for its (lead|v|seen) before it began"):
        waits("pass", f"y = {use}\ndo a")


def test_a_message_shows_an_argument_that_waits() -> None:
    with pytest.raises(RunError, match=r"Given\(<waits for a scenario>\) is running already"):
        waits("pass", "g = Given(a.lead)\ndo g, g")


def test_what_a_scenario_does_not_have_is_an_error_before_and_after() -> None:
    for body in ("x = a.nothing\ndo a", "do a\nx = a.nothing"):
        with pytest.raises(UncaughtException) as raised:
            simulated(compose(body))
        assert raised.value.message == "AttributeError: Sub(1) has no attribute nothing"
