"""The end of scenarios: what they were running ends with them, and what they overrode is as it was."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..machine.config import Config, State
from ..machine.outcome import Next, Outcome
from ..machine.simulation_state import Suspended, simulation_of, with_scenario
from .frames import Interruptible, Scenarios
from .overrides import revert_override


def end_scenario(number: int, state: State) -> State:
    """The scenario is over, and all that it runs: "properties overridden by a scenario revert to their original values", in reverse order."""
    running = simulation_of(state).scenarios.get(number)
    if running is None or running.over:
        return state
    for inner in scenarios_in([running.compose] if running.compose is not None else []):
        state = end_scenario(inner, state)
    running = simulation_of(state).scenarios[number]  # which may have inherited what an inner one had overridden
    for override in reversed(running.overrides):
        state = revert_override(override, number, state)
    return with_scenario(state, running._replace(over=True, overrides=(), compose=None))


def scenarios_in(processes: Iterable[Suspended]) -> Iterator[int]:
    """The scenarios that suspended compose blocks are running."""
    for process in processes:
        for frame in process.frames:
            if isinstance(frame, Scenarios):
                yield from frame.numbers
            elif isinstance(frame, Interruptible):
                yield from scenarios_in(p for _, _, p in frame.waiting)


def give_up(processes: tuple[Suspended, ...], config: Config) -> Outcome:
    """Coroutines that will not go on: the scenarios that they were running end."""
    state = config.state
    for number in scenarios_in(processes):
        state = end_scenario(number, state)
    return Next("", config._replace(state=state))
