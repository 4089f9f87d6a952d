"""The driver of the two termination rules (Figure "Semantics of statements"): `mutation` is Step 1,
`default_requirements` Step 2.

⟨pass, σ, π, O⟩ becomes ⟨Done, σ, π, O'⟩ by Step 1 and (π, O') by Step 2. Objects before number `since` have
been through this already, when a scenario that runs has made others (reading `dynamic-objects`).
"""

from __future__ import annotations

import operator
from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

from ..machine.config import PASS, Captured, Config, Stack, State, Value
from ..machine.host_calls import host
from ..machine.operand_kinds import Reader
from ..machine.outcome import Done, Draw, Next, Observe, Outcome, Requirement, Stuck
from ..machine.values import Origin, Random, value_in_run
from ..syntax.nodes import NOWHERE
from ..syntax.python_expressions import Constant
from .default_requirements import Premise, check_default_requirements, default_requirements
from .mutation import NOISY_PROPERTIES, apply_mutations
from .statements import enforce


def given_params(state: State) -> Iterator[Premise]:
    """The parameters that have to have a given value, once a scene is generated."""
    if state.simulation is None:
        for name, value in state.settings.given.params.items():
            yield Premise(partial(has_value, name, value), (), Requirement("given", NOWHERE, f"the parameter {name} is {value!r}, as is given"))


def has_value(name: str, value: object, state: State) -> bool:
    """π(name) = value; on symbols a symbol."""
    return value_in_run(host(state.settings.door, state, operator.eq, state.params[name], value))  # type: ignore[return-value]


class Mutating(NamedTuple):
    """Frame of Step 1: what was drawn is noise on object number `i`, after `noise`."""

    i: int
    noise: tuple[object, ...]
    since: int


class Late(NamedTuple):
    """Frame: requirement number `i` of those that waited for the end is next (reading `require-time=end`).

    `end` is the state to go back to, after the one before was checked in the state of its statement.
    """

    i: int
    since: int
    end: State | None = None


class Checking(NamedTuple):
    """Frame of Step 2: premise number `i` of `premises` is next."""

    premises: tuple[Premise, ...]
    i: int = 0


def apply_termination_rules(stack: Stack, state: State, since: int = 0) -> Outcome:
    """Begin with Step 1."""
    return mutate(Mutating(since, (), since), stack, state)


def mutate(frame: Mutating, stack: Stack, state: State) -> Outcome:
    """Ask for the noise of Step 1; the address of a draw names its object and component, since which are mutated may itself be random."""
    found = apply_mutations(frame.i, frame.noise, state)
    if isinstance(found, Stuck):
        return found
    if isinstance(found, State):
        return Next("T-Mutate", Config(PASS, (Late(0, frame.since), stack), found._replace(draws=found.draws + 1)))
    index, drawn, normal, before = found
    instance = before.scene[index]
    origin = Origin(instance.span, f"mutation of {instance!r}", None)

    def resume(noise: object) -> Config:
        return Config(Value(Random(noise, origin)), (Mutating(index, drawn, frame.since), stack), before)

    return Draw("T-Mutate", (*before.address, index, len(drawn)), normal, Constant(value=None, span=instance.span), resume)


def resume_mutating(frame: Mutating, drawn: object, stack: Stack, state: State) -> Outcome:
    """n_{i,x}, n_{i,y} or n_{i,h} was drawn."""
    return mutate(frame._replace(noise=(*frame.noise, drawn)), stack, state)


def resume_late(frame: Late, result: object, stack: Stack, state: State) -> Outcome:
    """Reading `require-time=end`: each captured requirement, in the state of its statement with the noise; then Step 2."""
    if frame.end is not None:
        end = frame.end
        state = state._replace(sigma=end.sigma, ego=end.ego, workspace=end.workspace, objects={**state.objects, **end.objects})
    if frame.i < len(state.late):
        node, captured = state.late[frame.i]
        return enforce(node, (Late(frame.i + 1, frame.since, state), stack), as_captured(captured, state))  # type: ignore[arg-type]
    return Next("", Config(PASS, (Checking((*default_requirements(state, frame.since), *given_params(state))), stack), state._replace(late=())))


def as_captured(captured: Captured, state: State) -> State:
    """`state` with the variables and properties of `captured`, except what mutation changed since (reading `requirement-capture`)."""
    reader = Reader(state)
    objects = {**state.objects, **captured.objects}
    for instance in state.scene:
        if instance.number in captured.objects and reader.property(instance, "mutationScale"):
            noisy = {name: v for name, v in state.objects[instance.number].items() if name in NOISY_PROPERTIES}
            objects[instance.number] = {**objects[instance.number], **noisy}
    return state._replace(sigma=captured.sigma, ego=captured.ego, workspace=captured.workspace, objects=objects)


def resume_checking(frame: Checking, result: object, stack: Stack, state: State) -> Outcome:
    """One premise of Step 2; after the last, the scene (or the scenario that runs) is done."""
    checked = check_default_requirements(frame.premises, frame.i, state)
    if checked is None:
        return Next("T-Check", Config(PASS, stack, state)) if stack else Done("T-Check", state)
    requirement, holds = checked
    after = Config(PASS, (frame._replace(i=frame.i + 1), stack), state)
    return Observe("T-Check", requirement, after) if holds else Stuck("T-Check", requirement, after)

