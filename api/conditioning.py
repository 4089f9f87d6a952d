"""Conditioning on a scene: draws that keep their values of that scene, and given parameters
(`Scenario.condition_on`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from copy import copy
from typing import TYPE_CHECKING

from ..data.scene import Scene, scene_of
from ..inference.batch.graph import GraphNode, RowDraw, Site
from ..inference.batch.symbolic import Choice, nodes_in
from ..inference.batch.tracing import Lifted, trace_program
from ..interpreter.runtime.answerers import AS_THEY_ARE
from ..interpreter.runtime.program_run import Accepted
from ..semantics.machine.outcome import Draw, GivenValues, KnownDraw, Outcome
from ..semantics.machine.sandbox_table import is_user_made
from ..semantics.machine.values import CONTAINERS, Dynamic, Instance, Random, unwrap
from ..semantics.space.distributions import Distribution, PointIn
from ..semantics.space.vectors import Vector
from ..semantics.store.errors import AttemptsExhausted, UsageError
from ..semantics.store.scopes import descendants
from ..semantics.syntax import Program
from ..semantics.syntax import statements as s
from .pickling import Condition

if TYPE_CHECKING:
    from .scenario import Scenario

Address = tuple[int, ...]
CONTRADICTION = "what is given contradicts itself"


def conditioned_scenario(scenario: Scenario, scene: Scene | None, objects: Iterable[int] | None, params: Mapping[str, object]) -> Scenario:
    """`Scenario.condition_on`. Raises `UsageError`, and the errors that the program has given all this."""
    check_law(scenario)
    objects = tuple(objects) if isinstance(objects, Iterable) else objects
    first = scenario
    while first.conditioned_from is not None:
        first = first.conditioned_from
    draws, required = given_params(first, params)
    known = [scenario.given.draws, draws]
    if scene is not None:
        drawn = draws_of(scenario, scene)
        sites = drawn.keys() if objects is None else sites_of(first, objects)
        known.append({address: value for address, value in drawn.items() if address in sites})
        for name, value in params.items() if objects is None else ():
            if not equal(scene.params[name], value):
                raise UsageError(f"{CONTRADICTION}: the parameter {name} is {scene.params[name]!r} in the scene, not {value!r}")
    elif objects is not None:
        raise UsageError("it is not given in which scene these objects are", hint="condition_on(scene, objects=...)")
    for name, value in required.items():
        if not equal(scenario.given.params.get(name, value), value):
            raise UsageError(f"{CONTRADICTION}: the parameter {name} would be {scenario.given.params[name]!r} and {value!r}")
    found = copy(scenario)
    for name in ("settings", "constants", "facts", "pruning", "_lifted"):
        found.__dict__.pop(name, None)
    found.draws, found.factorised, found._rehearsed = AS_THEY_ARE, False, False  # pyright: ignore[reportPrivateUsage]
    found.conditioned_from, found.condition = scenario, Condition(scene, objects, dict(params))
    found.given = GivenValues(together(known), {**scenario.given.params, **required})
    if (params or scenario.given.params) and found.impossible is not None:
        raise UsageError(f"with what is given, {found.impossible.message}")
    return found


def check_law(scenario: Scenario) -> None:
    """Raises `UsageError` where the conditional law cannot be drawn from by rejection.

    With coins that are thrown once for all attempts at a scene, what is given tells about them by how many runs are accepted under each.
    """
    modules = (m for m in scenario.settings.library.values() if isinstance(m, Program))
    nodes = (node for program in (scenario.program, *modules) for statement in program.statements for node in descendants(statement))
    coin = next((node for node in nodes if isinstance(node, s.SoftRequire)), None)
    if scenario.readings["soft"] == "scene" and coin is not None:
        raise UsageError(
            "under the reading soft=scene, nothing can be given of a program with soft requirements: the coin of a scene would need the rates at "
            "which runs are accepted under each of its sides, which are not known", coin.span, hint="choose the reading soft=run",
        )  # fmt: skip


def draws_of(scenario: Scenario, scene: Scene) -> dict[Address, KnownDraw]:
    """Return the value of every draw of a scene, by address. Raises `UsageError` if the scene comes neither
    from this scenario nor from one of which it is made.
    """
    if not isinstance(scene, Scene):  # users call this
        raise UsageError(f"`scene` is a scene that this scenario gave, not {scene!r:.60}")
    found: dict[Address, KnownDraw] = {}

    def keep(outcome: Outcome, drawn: object) -> None:
        if isinstance(outcome, Draw):
            support = outcome.distribution.support()
            place = next((i for i, (v, _) in enumerate(support or ()) if v is drawn), None)
            found[outcome.address] = KnownDraw(unwrap(drawn)[0], None if place is None else (place,))

    maker: Scenario | None = scenario
    while maker is not None:
        found.clear()
        maker.rehearse()
        try:
            ended = maker.last_run(scene.seed, scene.index, scene.attempts, witness=keep)
        except AttemptsExhausted:
            ended = None
        if isinstance(ended, Accepted):
            again = scene_of(ended.state, scene.seed, scene.index, scene.attempts, pruned=bool(maker.draws) or maker.in_parts)
            if again.to_json() == scene.to_json():
                return found
        maker = maker.conditioned_from
    raise UsageError("this is not a scene that `sample` of this scenario gave", hint="condition on a scene of the same program and readings")


def lift_scenario(scenario: Scenario) -> Lifted | None:
    """The program as a graph, and what it leaves with symbols in it, if it can be made one."""
    return None if scenario.batch is None else trace_program(scenario.start, scenario.fuel)


def sites_of(scenario: Scenario, objects: Iterable[int]) -> set[Address]:
    """The addresses of the draws on which the properties of some objects depend. Raises `UsageError` where they cannot be told apart."""
    graph = lift_scenario(scenario)
    if graph is None:
        raise UsageError(
            f"it cannot be told on which draws single objects depend: {scenario.not_lifted}", hint="condition on the whole scene, or on parameters"
        )
    state = graph.state
    if not isinstance(objects, Iterable):
        raise UsageError(f"objects are given by their numbers in the scene, not as {objects!r}", hint="condition_on(scene, objects=[0])")
    wanted = list(objects)
    unknown = next((k for k in wanted if not (type(k) is int and 0 <= k < len(state.scene))), None)
    if unknown is not None:
        raise UsageError(f"there is no object {unknown!r}: a scene has objects 0 to {len(state.scene) - 1}")
    pending = [state.scene[k] for k in wanted]
    seen = set(state.scene)
    values: list[object] = []
    while pending:
        properties = list(state.objects[pending.pop().number].values())
        values += properties
        held = set(instances_in(properties)) - seen
        seen |= held
        pending += held
    return sites_below(values)


def instances_in(value: object) -> Iterator[Instance]:
    """The instances that a value holds, however deep: those of other instances excluded."""
    match value:
        case Instance():
            yield value
        case Random():
            yield from instances_in(value.value)
        case Choice():
            yield from instances_in(value.values)
        case Dynamic():
            yield from instances_in(value.arguments)
        case dict():
            yield from instances_in(list(value.items()))
        case _ if isinstance(value, CONTAINERS):
            for part in value:
                yield from instances_in(part)
        case _:
            pass


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


def given_params(scenario: Scenario, params: Mapping[str, object]) -> tuple[dict[Address, KnownDraw], dict[str, object]]:
    """The draws that are parameters themselves, with what is known of them; and the parameters that are required to have their value at the end.

    A draw whose distribution depends on other draws is not given its value, which would forget how likely that is: it is required. Raises
    `UsageError` for a parameter that the program does not have, for a value that it never has, and where a requirement would never hold.
    """
    made: list[Draw] = []

    def keep(outcome: Outcome, drawn: object) -> None:
        if isinstance(outcome, Draw):
            made.append(outcome)

    known: list[dict[Address, KnownDraw]] = []
    required: dict[str, object] = {}
    if not params:
        return {}, required
    state, graph = scenario.last_state(keep), lift_scenario(scenario)
    for name, value in params.items():
        if name not in state.params:
            raise UsageError(f"there is no global parameter {name!r}", hint=f"there are: {', '.join(state.params) or 'none'}")
        found, origin = unwrap(state.params[name])
        if not equal(value, value):
            raise UsageError(f"the parameter {name} cannot be {value!r}, which nothing equals")
        if origin is None and not is_user_made(found):
            if not equal(found, value):
                raise UsageError(f"the parameter {name} cannot be {value!r}: it is always {found!r}")
            continue
        sites = None if graph is None else sites_below(graph.state.params[name])
        itself = origin if type(state.params[name]) is Random else None
        alike = [d for d in made if itself is not None and d.distribution is itself.distribution]
        draw = next((d for d in alike if sites is not None and sites <= {d.address}), None)
        if draw is not None:
            known.append({draw.address: possible(name, draw.distribution, value)})
            continue
        if alike and alike[0].distribution.support() is None:
            why = "its distribution depends on other draws" if graph is not None else scenario.not_lifted
            raise UsageError(f"the parameter {name} cannot be given a value: it is drawn from infinitely many, and {why}")
        required[name] = value
    return together(known), required


def possible(name: str, distribution: Distribution, value: object) -> KnownDraw:
    """Return the draw of a parameter that must equal a value. Raises `UsageError` if the distribution cannot
    give that value.
    """
    support = distribution.support()
    places = tuple(i for i, (v, _) in enumerate(support or ()) if equal(unwrap(v)[0], value))
    if places:
        return KnownDraw(value, places)
    drawn = as_drawn(distribution, value)
    if support is not None or not distribution.log_density(drawn) > float("-inf"):
        raise UsageError(f"the parameter {name} cannot be {value!r}: it is drawn from {distribution!r}")
    return KnownDraw(drawn)


def as_drawn(distribution: Distribution, value: object) -> object:
    """The value as a draw from infinitely many gives it: a vector or a float."""
    match value:
        case (int() | float() as x, int() | float() as y) if isinstance(distribution, PointIn):
            return Vector(x, y)
        case int() if abs(value) <= 2**53:
            return float(value)
        case _:
            return value


def together(known: Iterable[Mapping[Address, KnownDraw]]) -> dict[Address, KnownDraw]:
    """Merge known draws from several sources. Raises `UsageError` if the sources contradict each other."""
    found: dict[Address, KnownDraw] = {}
    for side in known:
        for address, one in side.items():
            other = found.get(address, one)
            found[address] = merge_known_draws(one, other)
    return found


def merge_known_draws(one: KnownDraw, other: KnownDraw) -> KnownDraw:
    """Combine two facts known about one draw. Raises `UsageError` if no value satisfies both."""
    if one.places is not None and other.places is not None:
        places = tuple(place for place in one.places if place in other.places)
        if places:
            return KnownDraw(one.value, places)
    elif equal(one.value, other.value):
        return one
    raise UsageError(f"{CONTRADICTION}: the same draw would give {other.value!r} and {one.value!r}")


def equal(left: object, right: object) -> bool:
    """`left == right`, in the language."""
    return bool(left == right)
