"""The rules of the dynamic constructs: each fires, and all that fire are in the catalogue."""

from __future__ import annotations

import scenic_ref
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.semantics.machine.outcome import Outcome
from scenic_ref.semantics.rules import RULES
from scenic_ref.simulators.loop import simulate_once
from scenic_ref.simulators.still import Still

PROGRAMS = (
    "scenario Main():\n    precondition: True\n    setup: ego = Object at (0, 0)\n",
    """
behavior Inner():
    precondition: self.x == 0
    take 1
behavior Stop():
    precondition: False
    wait
behavior B():
    try:
        do choose Inner
        do Inner() for 1 steps
    interrupt when simulation.currentTime == 1:
        abort
    try:
        do Stop()
    interrupt when False:
        pass
    except PreconditionViolation:
        wait
    terminate
ego = Object at (0, 0), with x 0, with behavior B
require always ego.x == 0
""",
    """
scenario Sub():
    setup:
        override ego with x 1
        terminate when simulation.currentTime == 1
scenario Main():
    setup:
        ego = Object at (0, 0), with x 0
    compose:
        do Sub()
""",
    "ego = Object at (0, 0)\nrequire eventually False\nterminate when True",
    "behavior B():\n    invariant: False\n    wait\nego = Object at (0, 0), with behavior B",
    "# dialect: scenic-3\nbehavior B():\n    wait for 1 steps\nego = new Object with behavior B\nrecord ego.heading\nterminate after 2 steps\n",
)


def fired(text: str) -> set[str]:
    """The rules that fire in a run."""
    found: set[str] = set()

    def look(outcome: Outcome, drawn: object) -> None:
        found.add(getattr(outcome, "rule", ""))

    scenario = scenic_ref.loads(text)
    simulate_once(scenario.start(), from_stream(0, 0, 0), Still(), 4, witness=look)
    return found


def test_every_rule_fires_and_is_catalogued():
    rules = set().union(*map(fired, PROGRAMS)) - {""}
    assert rules <= set(RULES)
    assert {rule for rule in RULES if rule.startswith("D-")} <= rules
