"""Readings where the formal rules are silent about how modular scenarios begin."""

from __future__ import annotations

from .reading import Probe, Reading
from .silences_of_policy import COMPOSITIONAL, DYNAMIC

SILENCES_OF_SCENARIOS: tuple[Reading, ...] = (
    Reading(
        id="initial-guards",
        kind="silence",
        about="policy",
        question="When are the guards of scenarios checked, those of the initial one too?",
        places=(
            DYNAMIC + ', "Preconditions and Invariants": "like ordinary requirements, violating any precondition causes ..."',
            COMPOSITIONAL + ', "Modular Scenarios": they "operate in the same way as for dynamic behaviors"',
        ),
        alternatives={
            "around-setup": "preconditions before the `setup` block: those of the initial scenario are observations, which may be random, and a "
            "violated one discards the run; invariants in each time step from the first after `setup`, so that they may speak of what it makes",
        },
        consequence="Concerns scenarios. A scene alone has no time steps, so that invariants do not restrict it.",
        code=("semantics.dynamics.initial.check_preconditions", "semantics.dynamics.scenarios.set_up"),
        probe=Probe(
            "x = Uniform(2, 2)\nscenario Main():\n    precondition: x == 2\n    invariant: ego.position.x == 2 and simulation.currentTime < 2\n"
            "    setup:\n        ego = Object at (x, 0)\n        terminate when simulation.currentTime == 1",
            {"around-setup": "two time steps: the precondition may be random, and the invariant holds in both, with no ego before `setup`"},
        ),
    ),
)
