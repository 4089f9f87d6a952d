"""What is the same in every scene of a program, whatever is drawn."""

from __future__ import annotations

from collections.abc import Callable

from ..inference.rejection import DEFAULT_ATTEMPTS, sample
from ..inference.statistics.columns import leaves
from ..interpreter.scenes import OWN_FIELDS, json_value, scene_of
from ..semantics.config import Config, State
from ..semantics.outcome import Done, Outcome
from ..semantics.values import unwrap


def constants_of(start: Callable[[], Config], *, max_attempts: int = DEFAULT_ATTEMPTS, fuel: int) -> dict[str, object]:
    """The features of the scene format that do not depend on any draw, with their values.

    Which values are random does not depend on what is drawn (reading `random-branch`), so that one accepted run is enough.
    Raises `AttemptsExhausted` if none is found.
    """
    ends: list[State] = []

    def keep(outcome: Outcome, drawn: object) -> None:
        if isinstance(outcome, Done):
            ends.append(outcome.state)

    sample(start, 0, 0, max_attempts=max_attempts, fuel=fuel, witnessed=lambda attempt: keep)
    state = ends[-1]
    scene = scene_of(state, 0, 0, 1).to_json()
    params = {name: json_value(value) for name, value in state.params.items() if unwrap(value)[1] is None}
    objects = scene["objects"]
    assert isinstance(objects, list)
    kept = [_constant_part(o, state, i) for i, o in enumerate(objects)]
    return dict(leaves({"ego": scene["ego"], "params": params, "objects": kept}))


def _constant_part(written: dict[str, object], state: State, number: int) -> dict[str, object]:
    """An object in the scene format, without the properties that depend on a draw."""
    fixed = {name for name, value in state.objects[state.scene[number].number].items() if unwrap(value)[1] is None}
    properties = written["properties"]
    assert isinstance(properties, dict)
    own = {name: written[name] for name in OWN_FIELDS if name in fixed}
    return {"class": written["class"], **own, "properties": {name: v for name, v in properties.items() if name in fixed}}
