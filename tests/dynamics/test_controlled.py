"""What the simulator updates is controlled by actions, not assigned (paper, Section "Statements", "Overrides")."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
import scenic_ref
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import RunError
from scenic_ref.simulators.loop import Simulated, simulate_once
from scenic_ref.simulators.still import Still

from .worlds import LIMIT, actions, behavior

WRITES = (
    "o.position = (30, 30)", "o.heading += 1", "o.position, x = (1, 2), 3", "[x, *o.position] = [1, 2, 3]", "setattr(o, 'position', (1, 2))",
    "x = o.heading = 2", "[y, (x, o.heading)] = 1, (2, 3)", "[setattr(p, 'heading', 1) for p in [o]]",
    "list(map(lambda p: setattr(p, 'heading', 1), [o]))",
)  # fmt: skip


@pytest.mark.parametrize("write", WRITES)
def test_an_assignment_is_refused_wherever_it_stands(write):
    function = f"def change(o):\n    {write}\n"
    here = write.replace("o.", "self.").replace("(o,", "(self,").replace("[o]", "[self]")
    programs = [
        behavior(f"wait\n{here}\nwait"), behavior("wait\nchange(self)\nwait", function),
        behavior(f"try:\n    wait\n    wait\ninterrupt when simulation.currentTime == 1:\n    {here}\n    wait"),
        f"{function}ego = Object at (0, 0)\nmonitor M:\n    wait\n    change(ego)\n    wait",
        f"{function}def bad():\n    change(ego)\n    return True\nego = Object at (0, 0)\nrequire always simulation.currentTime == 0 or bad()",
        f"{function}scenario Main():\n    setup: ego = Object at (0, 0)\n    compose:\n        wait\n        change(ego)\n        wait",
        f"{function}scenario S():\n    setup: change(ego)\n    compose: wait\n"
        "scenario Main():\n    setup: ego = Object at (0, 0)\n    compose:\n        wait\n        do S()",
    ]
    for text in programs:
        assert actions(text, 0) == [LIMIT]
        with pytest.raises(RunError, match="updated by the simulator: it cannot be assigned") as found:
            actions(text, 2)
        assert text.split("\n")[found.value.span.line - 1].strip() in (write, here)


def test_objects_can_be_placed_until_their_setup_block_is_over():
    sub = "scenario S():\n    setup:\n        o = Object at (5, 5)\n        o.position = (9, 9)\n"
    sub += "    compose:\n        require o.position.x == 9\n        {}\n"
    main = "scenario Main():\n    setup:\n        ego = Object at (0, 0)\n        ego.position = (1, 0)\n    compose:\n        do S()\n"
    assert actions(sub.format("wait") + main, 3) == [None, "terminated"]
    with pytest.raises(RunError, match="cannot be assigned"):
        actions(sub.format("o.position = (1, 1)") + main, 3)


def test_other_properties_and_points_can_be_assigned():
    body = "p = OrientedPoint at (1, 2), facing 1\np.position = (3, 4)\nself.x = p.position.x\ntake self.x\ntake self.position.x"
    assert actions(behavior(body), 3) == [3, 0, None, LIMIT]


class Fuelled(Still):
    """A world with a property of its own, which each step uses up."""

    properties = frozenset({"fuel"})

    def step(self, actions) -> Sequence[str]:
        """One less."""
        self.left = getattr(self, "left", 10) - 1
        return ()

    def read(self, id: int):
        """What is left."""
        return {"fuel": self.left}


def test_what_a_simulator_declares_cannot_be_assigned_and_what_is_recorded_is_its_own():
    text = behavior("take self.fuel\nrequire self.fuel == 9\nself.{} = 99\ntake self.fuel").replace("with x 0", "with fuel 10, with x 0")
    scenario = scenic_ref.loads(text.format("fuel"))
    with pytest.raises(RunError, match="fuel of <Object 0> is updated by the simulator"):
        simulate_once(scenario.start(), from_stream(0, 0, 0), Fuelled(), 3)
    scenario = scenic_ref.loads(text.format("x"))
    run = simulate_once(scenario.start(), from_stream(0, 0, 0), Fuelled(), 3)
    assert isinstance(run, Simulated)
    assert [moment.objects[0]["fuel"] for moment in run.moments] == [10, 9, 8, 7]
    assert run.scene.objects[0].position == Vector(0, 0)
