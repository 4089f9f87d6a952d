"""The probes of the readings about the policy: each alternative does what it says."""

from __future__ import annotations

import pytest
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.store.errors import ParseError, RunError
from scenic_ref.simulators.loop import Simulated

from .worlds import LIMIT, actions, simulated

STEPS = 4
REJECTED = ["rejected"]
NOTHING = [None] * STEPS
SHOWN: dict[tuple[str, str], list[object]] = {
    ("setup-block", "setup"): [*NOTHING, LIMIT],
    ("setup-time", "execution"): [None, None, "terminated"],
    ("override-place", "scenario"): [*NOTHING, LIMIT],
    ("take-in-monitor", "ignored"): [*NOTHING, LIMIT],
    ("monitor-structure", "optional"): [*NOTHING, LIMIT],
    ("interrupt-first-step", "every-step"): [*NOTHING, LIMIT],
    ("interrupt-first-step", "later-steps"): [1, *NOTHING[1:], LIMIT],
    ("invariant-of-caller", "on-return"): [*NOTHING, LIMIT],
    ("invariant-of-caller", "every-step"): REJECTED,
    ("eventually-window", "whole"): ["terminated"],
    ("terminate-who", "scenario"): [None, None, None, None, "terminated"],
    ("terminate-who", "simulation"): [None, "terminated"],
    ("behaviors-after-terminate", "all"): REJECTED,
    ("behaviors-after-terminate", "stop"): ["terminated"],
    ("interrupt-recheck", "next-step"): [1, 1, 1, 1, LIMIT],
    ("do-until-zero", "nothing"): [2, *NOTHING[1:], LIMIT],
    ("between-steps", "not-exceeded"): [1, 2, None, None, LIMIT],
    ("between-steps", "rounded-up"): [1, 1, 2, None, LIMIT],
    ("invariant-while-interrupted", "on-resume"): [*NOTHING, LIMIT],
    ("dynamic-objects", "setup-end"): REJECTED,
    ("dynamic-objects", "unchecked"): [*NOTHING, LIMIT],
    ("time-limit", "required"): REJECTED,
    ("scenario-statements", "setup"): [1, 1, 0, "terminated"],
    ("names-not-begun", "error"): [None, "terminated"],
    ("names-not-begun", "waits"): [None, None, "terminated"],
    ("override-stack", "reverse"): [None, None, "terminated"],
    ("terminate-when-start", "first"): ["terminated"],
    ("bare-behavior", "no-arguments"): [3, *NOTHING[1:], LIMIT],
    ("parallel-order", "written"): [(2, 1), None, None, None, LIMIT],
    ("suspended-scenario", "kept"): [1, 2, 3, None, LIMIT],
    ("interrupts-in-except", "never"): [2, 3, None, None, LIMIT],
    ("ego-of-scenarios", "shared"): [None, None, "terminated"],
    ("finally-of-coroutines", "own-way-out"): [1, 4, None, None, LIMIT],
    ("initial-guards", "around-setup"): [None, "terminated"],
    ("initial-guards", "first-step"): REJECTED,
    ("compose-only", "when-needed"): [None, "terminated"],
    ("requirements-order", "after"): REJECTED,
    ("requirements-order", "before"): [None, "terminated"],
    ("override-overlap", "last-ends"): [2, 2, 2, "terminated"],
    ("override-overlap", "as-found"): [2, 2, 0, "terminated"],
}
SHARES = {("choose-weights", "renormalised"), ("rejected-simulation", "discard"), ("rejected-simulation", "retry"), ("compose-only", "scene")}
"""What is shown by frequencies: below, and in test_simulation.py."""
REFUSED = {
    ("objects-while-running", "setup"): ("setup block only", 6), ("override-what", "existing"): ("has no property nosuch", 3),
    ("do-in-monitor", "refused"): ("has no agent", 6),
}  # fmt: skip
"""What is an error in the second time step: its words, and its line."""


@pytest.mark.parametrize(("reading", "alternative"), SHOWN)
def test_the_probe_shows_the_alternative(reading, alternative):
    probe = READINGS[reading].probe
    assert probe is not None
    assert actions(probe.program, STEPS, readings={reading: alternative}) == SHOWN[reading, alternative]


def test_every_reading_about_the_policy_is_shown_and_has_code():
    about = {(r.id, alternative) for r in READINGS.values() if r.about == "policy" for alternative in r.alternatives}
    assert about == set(SHOWN) | SHARES | set(REFUSED)
    assert all(r.code for r in READINGS.values() if r.about == "policy")


def test_setup_time_shows_in_the_number_of_objects():
    probe = READINGS["setup-time"].probe
    assert probe is not None
    run = simulated(probe.program, STEPS)
    assert isinstance(run, Simulated)
    assert [len(moment.objects) for moment in run.moments] == [1, 2, 2]


@pytest.mark.slow
def test_choose_weights():
    """300 draws with probability 2/3: 6 standard deviations are 49; with the disabled option's weight it would be 1/4."""
    probe = READINGS["choose-weights"].probe
    assert probe is not None
    lengths = []
    for seed in range(300):
        run = simulated(probe.program, STEPS, seed=seed)
        assert isinstance(run, Simulated)
        lengths.append(len(run.moments))
    assert set(lengths) == {2, 3}
    assert abs(lengths.count(2) - 200) < 49


@pytest.mark.parametrize(("reading", "alternative"), REFUSED)
def test_what_is_refused(reading, alternative):
    probe = READINGS[reading].probe
    assert probe is not None
    message, line = REFUSED[reading, alternative]
    assert actions(probe.program, 0) == [LIMIT]
    with pytest.raises(RunError, match=message) as found:
        simulated(probe.program, 1)
    assert found.value.span.line == line


def test_a_scene_without_ego_is_refused_to_the_letter():
    probe = READINGS["compose-only"].probe
    assert probe is not None
    with pytest.raises(RunError, match="never assigns ego") as found:
        simulated(probe.program, 1, readings={"compose-only": "scene"})
    assert found.value.rule == "T-Mutate"


@pytest.mark.parametrize(
    ("amount", "timestep", "fits", "rounded"),
    [
        ("1.5 steps", 1.0, 1, 2), ("0.5 steps", 1.0, 0, 1), ("2 steps", 1.0, 2, 2), ("0 steps", 1.0, 0, 0), ("2.999 steps", 0.1, 2, 3),
        ("0.25 seconds", 0.1, 2, 3), ("0.3 seconds", 0.1, 3, 3), ("1.5 seconds", 1.0, 1, 2), ("0.5 seconds", 1.0, 0, 1), ("3 seconds", 1.0, 3, 3),
    ],
)  # fmt: skip
@pytest.mark.parametrize("statement", ["do Inner() for {}", "do choose Inner for {}", "do shuffle Inner for {}"])
def test_a_limit_between_two_time_steps(statement: str, amount: str, timestep: float, fits: int, rounded: int) -> None:
    """Reading `between-steps`; a limit that is a multiple of the time step is the same under both."""
    before = "behavior Inner():\n    while True:\n        take 1\nbehavior B():\n"
    program = f"{before}    {statement.format(amount)}\n    take 2\nego = Object at (0, 0), with behavior B"
    for alternative, steps in (("not-exceeded", fits), ("rounded-up", rounded)):
        found = actions(program, 5, timestep=timestep, readings={"between-steps": alternative})
        assert found[: steps + 1] == [*[1] * steps, 2]


def test_the_releases_round_limits_up_in_compose_blocks_and_of_scenarios_too() -> None:
    """As 2.1.0 and 3.1.1 do."""
    sub = "scenario Sub():\n    setup:\n        override ego with x 1\n        {}\n    compose:\n        while True:\n            wait\n"
    main = "scenario Main():\n    setup:\n        ego = Object with x 0, with behavior Show\n    compose:\n        do Sub(){}\n        wait\n"
    show = "behavior Show():\n    while True:\n        take self.x\n"
    for declared, limit in (("pass", " for 1.5 steps"), ("terminate after 1.5 steps", "")):
        program = show + sub.format(declared) + main.format(limit)
        assert actions(program, 6, dialect="scenic-2.1", profile="scenic-2.1") == [1, 1, 0, "terminated"]
        assert actions(program, 6, dialect="scenic-2.1", profile="paper") == [1, 0, "terminated"]


@pytest.mark.parametrize("statement", ["terminate after {}", "    do Wait() for {}", "        do Wait() for {}"])
def test_a_limit_without_a_unit_is_one_of_seconds_in_the_older_release_alone(statement: str) -> None:
    """As in 2.1.0; 3.1.1 says that the unit is missing, as the paper's dialect does (Table "Statements")."""
    before = "behavior Wait():\n    while True:\n        wait\n"
    line = statement.strip()
    if line.startswith("terminate"):
        program = before + "ego = Object with behavior Wait()\n{}\n"
    elif statement.startswith("        "):
        program = "scenario Wait():\n    setup: pass\nscenario Main():\n    setup:\n        ego = Object\n    compose:\n        {}\n"
    else:
        program = before + "behavior B():\n    {}\n    terminate\nego = Object with behavior B()\n"

    def steps(limit: str) -> int:
        run = simulated(program.format(line.format(limit)), 9, timestep=0.5, dialect="scenic-2.1", profile="scenic-2.1")
        assert isinstance(run, Simulated)
        return len(run.moments) - 1

    assert [steps("2"), steps("2 seconds"), steps("2 steps"), steps("(1 + 1)")] == [4, 4, 2, 4]
    for dialect, made in (("paper", "Object"), ("scenic-3", "new Object")):
        if dialect == "paper" and line.startswith("terminate"):
            continue
        with pytest.raises(ParseError) as raised:
            simulated(program.replace("Object", made).format(line.format("2")), dialect=dialect)
        assert raised.value.message == "a time limit needs a unit"
