"""Termination, Step 2: Check Default Requirements (Figure "Semantics of statements"). `termination` goes through the premises one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ..machine.config import State
from ..machine.operand_kinds import REGION, Reader, View, has_kind, kind_name
from ..machine.outcome import Requirement
from ..machine.values import Instance, value_in_run
from ..space import geometry
from ..space.box_crowds import crowd_meets, near_pairs
from ..space.numeric_functions import cosine, every, is_met, may_be, negation, sine, to_floats
from ..space.regions import Region, everywhere
from ..store.errors import RunError, ScenicError
from ..syntax.nodes import NOWHERE
from .operators import can_see_object, object_is_in

MANY = 50
"""Up to so many objects, a rule goes through all pairs, one by one: it is quick, and a reader of the trace sees each."""


def pairs_that_may_meet(objects: Sequence[Instance], state: State) -> list[tuple[int, int]] | None:
    """The pairs of many objects that are near each other, by their places; None for few, or where one has a position or a size that is none."""
    if len(objects) <= MANY:
        return None
    try:
        return near_pairs(crowd_of(objects, state))
    except (ScenicError, AttributeError):  # the premise that needs the value will say it
        return None


def crowd_of(objects: Sequence[Instance], state: State) -> list[tuple[float, float, float, float, float]]:
    """The bounding boxes of the objects."""
    views = [View(o, Reader(state)) for o in objects]
    return [(o.position.x, o.position.y, o.heading, o.width, o.length) for o in views]


class Premise(NamedTuple):
    """A premise of the rule about these objects: it is true in a state if `holds(state, *objects)`."""

    holds: Callable[..., bool]
    objects: tuple[Instance, ...]
    requirement: Requirement


def check_default_requirements(premises: tuple[Premise, ...], index: int, state: State) -> tuple[Requirement, bool] | None:
    """If for O = {o_1, ..., o_n}
        ∀ i: boundingBox(o_i) ⊆ workspace,
        ∀ i ≠ j: o_i.allowCollisions ∨ o_j.allowCollisions ∨ boundingBox(o_i) ∩ boundingBox(o_j) = ∅,
        ∀ i: ¬o_i.requireVisible ∨ ⟨ego can see o_i⟩ → True,
    then ⟨Done, σ, π, O⟩ → (π, O).

    Gives premise number `index`, and whether it holds; None after the last, when the rule fires.
    """
    if index == len(premises):
        return None
    holds, objects, requirement = premises[index]
    return requirement, is_met(holds(state, *objects), requirement)


def default_requirements(state: State, since: int = 0) -> Iterator[Premise]:
    """The premises of the rule, in its order: containment of all, collisions of all pairs, visibility of all.

    One that a property of its objects turns off is left out; on symbols, the property is a part of it. Those about objects before number `since`
    alone are left out; those about visibility wait until there is an ego, and are then about all objects (reading `compose-only`).
    """
    reader = Reader(state)
    ego = reader.plain(state.ego)
    names = {o.number: state.names.get(o.number) or f"{o.class_.name} (object {i})" for i, o in enumerate(state.scene)}
    bounded = workspace_of(state) is not everywhere
    new = state.scene[since:]
    for o in new:
        if bounded:
            yield Premise(in_workspace, (o,), Requirement("containment", o.span, f"{names[o.number]} is contained in the workspace"))
        if reader.property(o, "regionContainedIn") is not None:
            text = f"{names[o.number]} is contained in its regionContainedIn"
            yield Premise(in_region_of_its_own, (o,), Requirement("containment", o.span, text))
    solid = [o for o in state.scene if may_be(False, reader.property(o, "allowCollisions"))]
    if len(solid) > MANY:
        solid = [o for o in solid if not reader.property(o, "allowCollisions")]
    yield from collisions(solid, {o.number for o in new}, names, state)
    if isinstance(ego, Instance):
        seen = state.scene if state.simulation is not None and state.simulation.egoless else new
        for o in seen:
            if may_be(True, reader.property(o, "requireVisible")):
                yield Premise(visible, (o, ego), Requirement("visibility", o.span, f"{names[o.number]} is visible from ego"))


def collisions(solid: Sequence[Instance], made: set[int], names: Mapping[int, str], state: State) -> Iterator[Premise]:
    """The premises about pairs, one for each; of many objects one for each pair that is near each other, and then one about all.

    Those about objects whose numbers are not among `made` alone are left out.
    """
    near = pairs_that_may_meet(solid, state) if made.issuperset(o.number for o in solid) else None
    pairs = [(i, j) for j in range(len(solid)) for i in range(j)] if near is None else near
    for i, j in pairs:
        first, second = solid[i], solid[j]
        if second.number in made:
            text = f"{names[first.number]} and {names[second.number]} do not intersect"
            yield Premise(no_collision, (first, second), Requirement("collision", second.span, text))
    if near is not None:
        yield Premise(all_apart, tuple(solid), Requirement("collision", solid[-1].span, f"no two of the {len(solid)} objects intersect"))


def in_workspace(state: State, o: Instance) -> bool:
    """boundingBox(o) ⊆ workspace, the requirement that o is in it."""
    return object_is_in(View(o, Reader(state)), workspace_of(state))


def in_region_of_its_own(state: State, o: Instance) -> bool:
    """boundingBox(o) ⊆ o.regionContainedIn (reading `region-contained`)."""
    reader = Reader(state)
    return object_is_in(View(o, reader), contained_in(o, reader))


def no_collision(state: State, first: Instance, second: Instance) -> bool:
    """o_i.allowCollisions ∨ o_j.allowCollisions ∨ boundingBox(o_i) ∩ boundingBox(o_j) = ∅ (reading `touching`)."""
    reader = Reader(state)
    one, other = View(first, reader), View(second, reader)
    intersect = geometry.boxes_intersect(
        one.position, one.heading, one.width, one.length, other.position, other.heading, other.width, other.length,
        closed=state.reading("touching") == "collide",
    )  # fmt: skip
    return negation(every([*(to_floats(reader.property(o, "allowCollisions")) == 0 for o in (first, second)), intersect]))


def all_apart(state: State, *objects: Instance) -> bool:
    """boundingBox(o_i) ∩ boundingBox(o_j) = ∅ for all pairs."""
    crowd = crowd_of(objects, state)
    numbers = [n for x, y, heading, width, length in crowd for n in (x, y, cosine(heading), sine(heading), width / 2, length / 2)]
    return negation(crowd_meets(state.reading("touching") == "collide", *numbers))


def visible(state: State, o: Instance, ego: Instance) -> bool:
    """¬o_i.requireVisible ∨ ⟨ego can see o_i⟩ → True."""
    reader = Reader(state)
    required, seen = reader.property(o, "requireVisible"), can_see_object(View(ego, reader), View(o, reader))
    return seen if required is True else negation(every([to_floats(required) != 0, negation(seen)]))


def workspace_of(state: State) -> Region:
    """The value of `workspace`; without one, the whole plane."""
    found = value_in_run(state.workspace)
    if found is None:
        return everywhere
    if has_kind(found, REGION):
        return found  # type: ignore[return-value]
    place = state.settings.defined.get("workspace", NOWHERE)
    raise RunError(f"workspace must be a region, not {kind_name(found)}", place, rule="T-Check", hint="write workspace = Workspace(region)")


def contained_in(instance: Instance, reader: Reader) -> Region:
    """O(instance.regionContainedIn) (reading `region-contained`)."""
    found = reader.property(instance, "regionContainedIn")
    if has_kind(found, REGION):
        return found  # type: ignore[return-value]
    raise RunError(f"regionContainedIn must be a region, not {kind_name(found)}", instance.span, rule="T-Check")

