"""Simulations of small programs in the world where nothing moves, as the actions of each time step."""

from __future__ import annotations

import scenic_ref
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.simulators.loop import Failed, Simulated, simulate_once
from scenic_ref.simulators.still import Still


def simulated(text: str, steps: int = 8, *, seed: int = 0, timestep: float = 1.0, **options: object) -> Simulated | Failed:
    """One run of a program."""
    scenario = scenic_ref.loads(text, **options)  # type: ignore[arg-type]
    scenario.rehearse()
    return simulate_once(scenario.start(), from_stream(seed, 0, 0), Still(timestep), steps, fuel=scenario.fuel)


def actions(text: str, steps: int = 8, **options: object) -> list[object]:
    """What the first object does in each time step that passes: an action, a tuple of several, or None; then how the run ended."""
    run = simulated(text, steps, **options)  # type: ignore[arg-type]
    if isinstance(run, Failed):
        return ["rejected"]
    taken = [moment.actions.get(0, ()) for moment in run.moments[:-1]]
    return [*(None if not one else one[0] if len(one) == 1 else one for one in taken), run.result]


def behavior(body: str, before: str = "", after: str = "") -> str:
    """A program whose ego has a behavior B with this body; `before` defines what it uses."""
    lines = "".join(f"    {line}\n" for line in body.strip("\n").split("\n"))
    return f"{before}\nbehavior B():\n{lines}\nego = Object at (0, 0), with x 0, with behavior B\n{after}\n"


LIMIT = "time limit"
