"""What is given of a scene: draws that have the value that they had there, and parameters (`Scenario.condition_on`)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from ..formats.scenes import Scene
from ..inference.batch.trace.graph import GraphNode, RowDraw, Site
from ..inference.batch.trace.structures import nodes_in
from ..semantics.kernel.errors import UsageError
from ..semantics.kernel.outcome import Draw, KnownDraw, Outcome
from ..semantics.kernel.values import Random, unwrap
from ..semantics.syntax import python_expressions as p
from ..semantics.syntax import statements as s

if TYPE_CHECKING:
    from .scenario import Scenario

Address = tuple[int, ...]


def draws_of(scenario: Scenario, scene: Scene) -> dict[Address, KnownDraw]:
    """What every draw of a scene gave, by address. Raises `UsageError` for what is not a scene of this scenario."""
    found: dict[Address, KnownDraw] = {}

    def keep(outcome: Outcome, drawn: object) -> None:
        if isinstance(outcome, Draw):
            support = outcome.distribution.support()
            place = next((i for i, (v, _) in enumerate(support or ()) if v is drawn), None)
            found[outcome.address] = KnownDraw(unwrap(drawn)[0], place)

    again = scenario.sampled(scene.seed, scene.index, max_attempts=scene.attempts, witnessed=lambda attempt: found.clear() or keep).scene
    if again.to_json() != scene.to_json():
        raise UsageError("this is not a scene that `sample` of this scenario gave", hint="condition on a scene of the same program and readings")
    return found


def sites_of(scenario: Scenario, objects: Iterable[int]) -> set[Address]:
    """The addresses of the draws on which the properties of some objects depend. Raises `UsageError` where they cannot be told apart."""
    if scenario.batch is None:
        raise UsageError(
            f"it cannot be told on which draws single objects depend: {scenario.not_lifted}", hint="condition on the whole scene, or on parameters"
        )
    made = scenario.batch.template.objects
    wanted = list(objects)
    unknown = next((k for k in wanted if not (type(k) is int and 0 <= k < len(made))), None)
    if unknown is not None:
        raise UsageError(f"there is no object {unknown!r}: a scene has objects 0 to {len(made) - 1}")
    return sites_below([made[k].properties for k in wanted])


def sites_below(values: object) -> set[Address]:
    """The addresses of the draws on which values with symbols in them depend."""
    pending: list[GraphNode] = nodes_in(values)
    seen: set[int] = set()
    found: set[Address] = set()
    while pending:
        node = pending.pop()
        if node.number in seen:
            continue
        seen.add(node.number)
        if isinstance(node.function, (Site, RowDraw)):
            found.add(node.function.address)
        inner = [getattr(node.function, name, ()) for name in ("structure", "keywords", "distribution")]
        pending += [*(a for a in node.arguments if isinstance(a, GraphNode)), *nodes_in(inner)]
    return found


def given_params(scenario: Scenario, params: Mapping[str, object]) -> tuple[dict[Address, KnownDraw], list[s.Require]]:
    """The draws that are parameters themselves, with the values given for them; of other parameters requirements.

    A draw whose distribution depends on other draws is not given its value, which would forget how likely that is: it is required. Raises
    `UsageError` for a parameter that the program does not have, for a value that cannot be drawn, and where a requirement would never hold.
    """
    draws: dict[int, Draw] = {}

    def keep(outcome: Outcome, drawn: object) -> None:
        if isinstance(outcome, Draw):
            draws[id(outcome.distribution)] = outcome

    state = scenario.last_state(keep)
    given: dict[Address, KnownDraw] = {}
    requirements: list[s.Require] = []
    for name, value in params.items():
        if name not in state.params:
            raise UsageError(f"there is no global parameter {name!r}", hint=f"there are: {', '.join(state.params) or 'none'}")
        found = state.params[name]
        draw = draws.get(id(found.origin.distribution)) if type(found) is Random else None
        if draw is not None and scenario.batch is not None and sites_below(scenario.batch.template.params[name]) <= {draw.address}:
            given[draw.address] = possible(name, draw, value)
            continue
        if draw is not None and draw.distribution.support() is None:
            why = "its distribution depends on other draws" if scenario.batch is not None else scenario.not_lifted
            raise UsageError(f"the parameter {name} cannot be given a value: it is drawn from infinitely many, and {why}")
        parameter = p.Attribute(value=p.Name(name="globalParameters"), name=name)
        requirements.append(s.Require(condition=p.Comparison(left=parameter, operators=("==",), operands=(p.Constant(value=value),)), name=name))
    return given, requirements


def possible(name: str, draw: Draw, value: object) -> KnownDraw:
    """The value for a parameter that is a draw. Raises `UsageError` if it cannot be drawn."""
    support = draw.distribution.support()
    place = next((i for i, (v, _) in enumerate(support or ()) if unwrap(v)[0] == value), None)
    if place is None and (support is not None or draw.distribution.log_density(value) == float("-inf")):
        raise UsageError(f"the parameter {name} cannot be {value!r}: it is drawn from {draw.distribution!r}")
    return KnownDraw(value, place)
