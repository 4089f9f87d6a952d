"""Programs that random ones reach seldom: what once told the machine from the paper, and what tells it from its neighbours."""

from __future__ import annotations

from .programs import Assign, Attempt, Carry, Creation, Demand, DynamicProgram, Invitation, Leave, LetStepPass, Procedure, Repeat, TakeActions

STOP = Procedure("Stop", (), (), (TakeActions(("1",)), Leave("terminate")))
GUARDED = Procedure("Guarded", (), ("self.x == 0",), (Assign("self.x", "1"), TakeActions(("2",)), TakeActions(("3",))))


def together(*names: str) -> DynamicProgram:
    """An agent that runs these behaviors together, and catches their exceptions."""
    body = Carry("", tuple(Invitation(name, "1") for name in names))
    caught = Attempt((body,), (("now() == 3", (LetStepPass(),)),), (("InvariantViolation", (TakeActions(("4",)),)),))
    main = Procedure("Both", (), (), (caught, Repeat(0, "True", (TakeActions(("5",)),))))
    return DynamicProgram((STOP, GUARDED, main), (), (Creation("ego", "0", "0", Invitation("Both", "1")),))


def two_agents(first: str, second: str) -> DynamicProgram:
    """Two agents, each with a behavior of its own."""
    require = Procedure("Demanding", (), (), (TakeActions(("1",)), Demand("now() == 0"), TakeActions(("2",))))
    agents = tuple(Creation(name, place, "0", Invitation(b, "1")) for name, place, b in (("ego", "0", first), ("other", "5", second)))
    return DynamicProgram((STOP, GUARDED, require), (), agents)


BY_HAND = {
    "terminate-then-violation": together("Stop", "Guarded"),
    "violation-then-terminate": together("Guarded", "Stop"),
    "terminate-then-rejection": two_agents("Stop", "Demanding"),
    "rejection-then-terminate": two_agents("Demanding", "Stop"),
    "terminate-then-uncaught": two_agents("Stop", "Guarded"),
}
