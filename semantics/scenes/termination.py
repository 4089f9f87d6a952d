"""The two termination rules of Figure "statement-semantics": apply mutations, then check the default requirements.

⟨pass, σ, π, O⟩ becomes ⟨Done, σ, π, O'⟩ by Step 1 and (π, O') by Step 2.
"""

from __future__ import annotations

from typing import NamedTuple

from ..kernel.config import PASS, Config, Stack, State, Value
from ..kernel.draws import invalid
from ..kernel.errors import RunError
from ..kernel.kinds import Reader, View, is_scalar, kind_name
from ..kernel.outcome import Done, Draw, Next, Observe, Outcome, Requirement, Stuck
from ..kernel.values import Instance, Origin, Random, plain
from ..space import geometry
from ..space.distributions import BadParameters, Normal
from ..space.regions import Region, everywhere
from ..space.symbols import larger, met, negation, number, smaller
from ..space.vectors import Vector
from ..syntax.nodes import NOWHERE
from ..syntax.python_expressions import Constant
from .operators import can_see_object, object_is_in
from .statements import enforce

POSE = 3  # x, y and heading
NOISY_PROPERTIES = ("position", "heading", "color")
COLOR_DEVIATION = 0.05  # where an object has no property colorStdDev, as in the world model of the released implementations


class Mutating(NamedTuple):
    """Frame of Step 1: the noise for `component` of object number `index` is next; `noise` holds what was drawn for it.

    The components are x, y, the heading and, under the reading `mutate-color=yes`, those of the color. Objects before number `since` were
    there already, when a sub-scenario made others (reading `dynamic-objects`).
    """

    index: int
    component: int = 0
    noise: tuple[object, ...] = ()
    since: int = 0


class Premise(NamedTuple):
    """One premise of Step 2, about an object and perhaps another."""

    kind: str
    object: Instance
    other: Instance
    requirement: Requirement


class Checking(NamedTuple):
    """Frame of Step 2: premise number `index` of `premises` is next."""

    index: int
    premises: tuple[Premise, ...]


class Late(NamedTuple):
    """Frame: requirement number `index` of those that waited for the end is next (reading `require-time=end`).

    `end` is the state to go back to, after the one before was checked in the state of its statement.
    """

    index: int
    end: State | None = None
    since: int = 0


def mutate_objects(frame: Mutating, stack: Stack, state: State) -> Outcome:
    """Termination, Step 1: n ~ Normal(0, S_i · ps_i) for x and y, Normal(0, S_i · hs_i) for the heading of every o_i.

    A standard deviation of 0 is a point mass: no draw, probability 1 (reading `zero-stddev`). The address of a draw names
    its object and component, since which objects are mutated may itself be random.
    """
    reader = Reader(state)
    while frame.index < len(state.scene) and not reader.property(state.scene[frame.index], "mutationScale"):
        frame = Mutating(frame.index + 1, since=frame.since)
    if frame.index == len(state.scene):
        return Next("T-Mutate", Config(PASS, (Late(0, since=frame.since), stack), state._replace(draws=state.draws + 1)))
    instance = state.scene[frame.index]
    scale = reader.property(instance, "mutationScale")
    if frame.component == POSE + len(color_of(instance, reader)):
        return apply_noise(frame, instance, stack, state)
    deviation = deviation_of(instance, frame.component, reader)
    try:
        distribution = Normal(0.0, number(scale) * number(deviation))
    except BadParameters as bad:
        return invalid("T-Mutate", bad, instance.span, state)
    except TypeError:
        raise RunError(f"the standard deviation of the noise on {instance!r} is not a number", instance.span, rule="T-Mutate") from None
    if distribution.stdDev == 0:
        return mutate_objects(frame._replace(component=frame.component + 1, noise=(*frame.noise, 0.0)), stack, state)
    origin = Origin(instance.span, f"mutation of {instance!r}", None)

    def resume(drawn: object) -> Config:
        return Config(Value(Random(drawn, origin)), (frame, stack), state)

    return Draw("T-Mutate", (*state.address, frame.index, frame.component), distribution, Constant(value=None, span=instance.span), resume)


def deviation_of(instance: Instance, component: int, reader: Reader) -> object:
    """ps_i, hs_i or the deviation of the color, before it is multiplied by the scale."""
    if component < POSE:
        return reader.property(instance, "headingStdDev" if component == 2 else "positionStdDev")
    return reader.plain(reader.state.objects[instance.number].get("colorStdDev", COLOR_DEVIATION))


def color_of(instance: Instance, reader: Reader) -> tuple[float, ...]:
    """The components of the color to which noise is added: none under `mutate-color=no`, or if the color is no tuple of reals."""
    if reader.state.reading("mutate-color") == "no":
        return ()
    color = reader.plain(reader.state.objects[instance.number].get("color"))
    return color if isinstance(color, tuple) and all(is_scalar(c) for c in color) else ()


def resume_mutating(frame: Mutating, drawn: object, stack: Stack, state: State) -> Outcome:
    """n_{i,x}, n_{i,y} or n_{i,h} was drawn."""
    return mutate_objects(frame._replace(component=frame.component + 1, noise=(*frame.noise, drawn)), stack, state)


def apply_noise(frame: Mutating, instance: Instance, stack: Stack, state: State) -> Outcome:
    """pos_i = O(o_i.position) + (n_{i,x}, n_{i,y}) and head_i = O(o_i.heading) + n_{i,h}.

    Under `mutate-color=yes` the color gets noise as well, and its components are kept within [0, 1].
    """
    reader = Reader(state)
    dx, dy, turn, *tints = (reader.plain(n) for n in frame.noise)
    position = reader.property(instance, "position")
    heading = reader.property(instance, "heading")
    moved = {"position": reader.wrap(Vector(position.x + dx, position.y + dy)), "heading": reader.wrap(heading + turn)}  # type: ignore[operator]
    if tints:
        color = color_of(instance, reader)
        moved["color"] = reader.wrap(tuple(smaller(1.0, larger(0.0, c + t)) for c, t in zip(color, tints, strict=True)))  # type: ignore[operator]
    return mutate_objects(Mutating(frame.index + 1, since=frame.since), stack, state.with_properties(instance, moved))


def resume_late(frame: Late, result: object, stack: Stack, state: State) -> Outcome:
    """Reading `require-time=end`: each captured requirement, in the state of its statement with the noise; then Step 2."""
    if frame.end is not None:
        end = frame.end
        state = state._replace(sigma=end.sigma, ego=end.ego, workspace=end.workspace, objects={**state.objects, **end.objects})
    if frame.index < len(state.late):
        node, captured = state.late[frame.index]
        return enforce(node, (Late(frame.index + 1, state, frame.since), stack), as_captured(captured, state))  # type: ignore[arg-type]
    return Next("", Config(PASS, (Checking(0, premises_of_step_two(state, frame.since)), stack), state._replace(late=())))


def as_captured(captured: State, state: State) -> State:
    """`state` with the variables and properties of `captured`, except what mutation changed since (reading `requirement-capture`)."""
    reader = Reader(state)
    objects = {**state.objects, **captured.objects}
    for instance in state.scene:
        if instance.number in captured.objects and reader.property(instance, "mutationScale"):
            noisy = {name: v for name, v in state.objects[instance.number].items() if name in NOISY_PROPERTIES}
            objects[instance.number] = {**objects[instance.number], **noisy}
    return state._replace(sigma=captured.sigma, ego=captured.ego, workspace=captured.workspace, objects=objects)


def resume_checking(frame: Checking, result: object, stack: Stack, state: State) -> Outcome:
    """One default requirement holds: on with the next."""
    return check_default_requirements(frame, stack, state)


def check_default_requirements(frame: Checking, stack: Stack, state: State) -> Outcome:
    """Termination, Step 2: boundingBox(o_i) ⊆ workspace; no collisions; visible from ego. One premise per step."""
    if frame.index == len(frame.premises):
        return Next("T-Check", Config(PASS, stack, state)) if stack else Done("T-Check", state)
    premise = frame.premises[frame.index]
    after = Config(PASS, (Checking(frame.index + 1, frame.premises), stack), state)
    holds = met(condition(premise, state), premise.requirement)
    return Observe("T-Check", premise.requirement, after) if holds else Stuck("T-Check", premise.requirement, after)


def condition(premise: Premise, state: State) -> bool:
    """The truth of a premise of Step 2."""
    reader = Reader(state)
    one, other = View(premise.object, reader), View(premise.other, reader)
    match premise.kind:
        case "containment":
            return object_is_in(one, workspace_of(state))
        case "regionContainedIn":
            return object_is_in(one, contained_in(premise.object, reader))
        case "visibility":
            return can_see_object(other, one)
        case _:
            return negation(geometry.boxes_intersect(
                one.position, one.heading, one.width, one.length, other.position, other.heading, other.width, other.length,
                closed=state.reading("touching") == "collide",
            ))  # fmt: skip


def premises_of_step_two(state: State, since: int = 0) -> tuple[Premise, ...]:
    """The premises of the rule, in its order: containment of all, collisions of all pairs, visibility of all.

    Which ones there are depends on properties that are constants of the program in all but odd cases. Those about objects before number
    `since` alone are left out; those about visibility wait until there is an ego, and are then about all objects (reading `compose-only`).
    """
    reader = Reader(state)
    ego = reader.plain(state.ego)
    names = {o.number: state.names.get(o.number) or f"{o.class_.name} (object {i})" for i, o in enumerate(state.scene)}
    bounded = workspace_of(state) is not everywhere
    found: list[Premise] = []
    new = state.scene[since:]
    made = {o.number for o in new}
    for o in new:
        if bounded:
            found.append(premise("containment", o, o, f"{names[o.number]} is contained in the workspace"))
        if reader.property(o, "regionContainedIn") is not None:
            found.append(premise("regionContainedIn", o, o, f"{names[o.number]} is contained in its regionContainedIn"))
    solid = [o for o in state.scene if not reader.property(o, "allowCollisions")]
    for j, second in enumerate(solid):
        if second.number not in made:
            continue
        found += [premise("collision", o, second, f"{names[o.number]} and {names[second.number]} do not intersect") for o in solid[:j]]
    if isinstance(ego, Instance):
        seen = state.scene if state.simulation is not None and state.simulation.egoless else new
        found += [premise("visibility", o, ego, f"{names[o.number]} is visible from ego") for o in seen if reader.property(o, "requireVisible")]
    return tuple(found)


def premise(kind: str, one: Instance, other: Instance, text: str) -> Premise:
    """A premise about `one`, reported at its place in the source; a collision at that of the later object."""
    place = other.span if kind == "collision" else one.span
    return Premise(kind, one, other, Requirement("containment" if kind == "regionContainedIn" else kind, place, text))


def workspace_of(state: State) -> Region:
    """The value of `workspace`; without one, the whole plane."""
    found = plain(state.workspace)
    if found is None:
        return everywhere
    if isinstance(found, Region):
        return found
    raise RunError(f"workspace must be a region, not {kind_name(found)}", NOWHERE, rule="T-Check", hint="write workspace = Workspace(region)")


def contained_in(instance: Instance, reader: Reader) -> Region:
    """O(instance.regionContainedIn) (reading `region-contained`)."""
    found = reader.property(instance, "regionContainedIn")
    if isinstance(found, Region):
        return found
    raise RunError(f"regionContainedIn must be a region, not {kind_name(found)}", instance.span, rule="T-Check")
