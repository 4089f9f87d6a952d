"""What is known of every scene of a program, whatever is drawn."""

from __future__ import annotations

from collections.abc import Callable

from ..data.scene import OWN_FIELDS, json_value, scene_of
from ..inference.batch import Batch
from ..inference.batch.evaluation_plan import only_rejects
from ..inference.batch.features import supports_of
from ..inference.batch.suggested_features import Suggested
from ..inference.comparison.known_features import Facts
from ..inference.comparison.scene_columns import leaves
from ..inference.rejection import DEFAULT_ATTEMPTS, sample
from ..interpreter.runtime.answerers import Draws
from ..semantics.kernel.config import Config, State
from ..semantics.kernel.outcome import Done, Outcome
from ..semantics.kernel.values import unwrap

SCALE, NOISY = "mutationScale", {"position", "heading", "color"}
"""The property that says whether an object is mutated, and those that mutation changes (rule T-Mutate, reading `mutate-color`)."""


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


def facts_of(constants: dict[str, object], batch: Batch | None, pruned: Draws) -> Facts:
    """What is known of the scenes: with a graph, also the supports that it shows and the features that it suggests.

    Where runs that the graph does not describe are left to the interpreter, there are no supports.
    """
    if batch is None:
        return Facts(constants)
    sure = all(map(only_rejects, batch.graph.events))
    suggested = Suggested(batch.graph, batch.template, pruned, sure=sure)
    supports = {name: support for name, support in supports_of(batch.template).items() if name not in constants} if sure else {}
    return Facts(constants, {**supports, **suggested.supports}, suggested)


def _constant_part(written: dict[str, object], state: State, number: int) -> dict[str, object]:
    """An object in the scene format, without the properties that depend on a draw."""
    held = state.objects[state.scene[number].number]
    fixed = {name for name, value in held.items() if unwrap(value)[1] is None}
    if SCALE in held and SCALE not in fixed:  # whether there is noise may depend on a draw, and there was none in this run
        fixed -= NOISY
    properties = written["properties"]
    assert isinstance(properties, dict)
    own = {name: written[name] for name in OWN_FIELDS if name in fixed}
    return {"class": written["class"], **own, "properties": {name: v for name, v in properties.items() if name in fixed}}
