"""The probes of the readings about the policy: each alternative does what it says."""

from __future__ import annotations

import pytest
from scenic_ref.semantics.kernel.errors import RunError
from scenic_ref.semantics.readings import READINGS
from scenic_ref.simulators.simulating import Simulated

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
    ("invariant-while-interrupted", "on-resume"): [*NOTHING, LIMIT],
    ("dynamic-objects", "setup-end"): REJECTED,
    ("dynamic-objects", "unchecked"): [*NOTHING, LIMIT],
    ("time-limit", "required"): REJECTED,
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
