"""Single mistakes in what runs: statements and conditions that are wrong in one way, wherever such a thing may stand.

The programs are for the simulator in which nothing moves; each is right for as long as its mistake is not reached, which is in the second time step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import indent

BEFORE = """
behavior Other():
    while True:
        take 1
scenario Part():
    setup: pass
    compose:
        while True:
            wait
def now():
    return simulation.currentTime
"""
EGO = "ego = Object at (0, 0), with x 0{}"

STATEMENTS_IN: dict[str, tuple[int, str]] = {
    "behavior": (4, BEFORE + "behavior B():\n    wait\n{}    wait\n" + EGO.format(", with behavior B") + "\n"),
    "handler": (8, BEFORE + "behavior B():\n    try:\n        do Other()\n    interrupt when now() == 1:\n{}        wait\n"
    + EGO.format(", with behavior B") + "\n"),
    "monitor": (4, BEFORE + EGO.format("") + "\nmonitor Watch:\n    wait\n{}    wait\n"),
    "compose": (8, BEFORE + "scenario Main():\n    setup:\n        " + EGO.format("") + "\n    compose:\n        wait\n{}        wait\n"),
    "setup": (8, BEFORE + "scenario Sub():\n    setup:\n{}    compose: wait\n"
    "scenario Main():\n    setup:\n        " + EGO.format("") + "\n    compose:\n        wait\n        do Sub()\n"),
    "function": (4, "def wrong():\n{}    return True\n" + BEFORE + EGO.format("") + "\nrequire always now() == 0 or wrong()\n"),
}
"""Where a statement may stand, and how far to the right."""

STATEMENTS: dict[str, str] = {
    "assigned position": "ego.position = (30, 30)",
    "assigned heading": "ego.heading += 1",
    "position among other targets": "x, [y, *ego.position] = 1, [2, 3, 4]",
    "position set by name": "setattr(ego, 'position', (1, 2))",
    "behavior alone": "Other()",
    "behavior's name alone": "Other",
    "scenario alone": "Part()",
    "requirement that is no boolean": "require 'no'",
}

CONDITIONS_IN: dict[str, str] = {
    "interrupt when": BEFORE + "behavior B():\n    try:\n        do Other()\n    interrupt when now() == 1 and {}:\n        wait\n"
    + EGO.format(", with behavior B") + "\n",
    "until": BEFORE + "behavior B():\n    do Other() until now() == 1 and {}\n" + EGO.format(", with behavior B") + "\n",
    "until of a scenario": BEFORE + "scenario Main():\n    setup: " + EGO.format("") + "\n    compose:\n        do Part() until now() == 1 and {}\n",
    "terminate when": BEFORE + EGO.format("") + "\nterminate when now() == 1 and {}\n",
    "require always": BEFORE + EGO.format("") + "\nrequire always now() == 0 or {}\n",
    "require eventually": BEFORE + EGO.format("") + "\nrequire eventually now() == 0 or {}\n",
    "precondition": BEFORE + "behavior P():\n    precondition: {}\n    wait\nbehavior B():\n    wait\n    do P()\n"
    + EGO.format(", with behavior B") + "\n",
    "precondition of a choice": BEFORE + "behavior P():\n    precondition: {}\n    wait\nbehavior B():\n    wait\n    do choose P(), Other()\n"
    + EGO.format(", with behavior B") + "\n",
    "invariant": BEFORE + "behavior B():\n    invariant: now() == 0 or {}\n    wait\n    wait\n" + EGO.format(", with behavior B") + "\n",
    "invariant of a scenario": BEFORE + "scenario Main():\n    invariant: now() == 0 or {}\n    setup: " + EGO.format("") + "\n",
    "precondition of a scenario": BEFORE + "scenario S():\n    precondition: {}\n    setup: pass\n    compose: wait\n"
    "scenario Main():\n    setup: " + EGO.format("") + "\n    compose:\n        wait\n        do S()\n",
}
"""Where a condition may stand."""

CONDITIONS = ("3", "'no'", "0", "Other()", "None", "ego", "[True]")
"""Values that are not booleans."""


@dataclass(frozen=True, slots=True)
class Misbehaving:
    """A program whose mistake is an error in its second time step, on the line that holds `wrong`."""

    mistake: str
    text: str
    wrong: str


def misbehaving() -> Iterator[Misbehaving]:
    """Every mistake in every place."""
    for place, (depth, text) in STATEMENTS_IN.items():
        for name, statement in STATEMENTS.items():
            yield Misbehaving(f"{name} in a {place}", text.format(indent(f"{statement}\n", " " * depth)), statement)
    for place, text in CONDITIONS_IN.items():
        for condition in CONDITIONS:
            yield Misbehaving(f"{condition} as the condition of {place}", text.format(condition), condition)


__all__ = ["Misbehaving", "misbehaving"]
