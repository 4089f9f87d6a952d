"""Scenic's static statements: Figure "Semantics of statements" of the paper."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from ..machine.conditions import condition_truth
from ..machine.config import PASS, Abrupt, Captured, Config, Stack, State, reduce
from ..machine.draws import numbered_apart
from ..machine.operand_kinds import is_object, is_scalar, kind_name
from ..machine.outcome import Change, Draw, Next, Observe, Outcome, Requirement, Stuck
from ..machine.premises import premises
from ..machine.simulation_state import check_setup
from ..machine.value_nesting import check_nesting
from ..machine.values import Instance, Origin, Random, copy_containers, unwrap, value_in_run
from ..python.assignment import finish_statement
from ..python.imports import in_model
from ..space.distributions import BadParameters, Coin
from ..space.numeric_functions import is_finite_number, is_met
from ..store.errors import RunError
from ..syntax import statements as s
from ..syntax.nodes import Node, Span


def param(node: s.Param, stack: Stack, state: State) -> Outcome:
    """The values of `param x = E, ...` come first."""
    return premises(node, [a.value for a in node.assignments], conclude_param, stack, state)


def conclude_param(node: s.Param, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E, σ, π, O⟩ → ⟨v, σ, π, O'⟩ then ⟨param x = E, σ, π, O⟩ → ⟨pass, σ, π[x/v], O'⟩; a value from the command line wins, and in a
    world model one that there is already (reading `model-params`)."""
    fixed = {*state.settings.params, *(state.params if state.reading("model-params") == "keep" and in_model(stack) else ())}
    assigned = {a.name: v for a, v in zip(node.assignments, values, strict=True) if a.name not in fixed}
    for name, assignment in assigned.items():
        check_nesting(f"the parameter {name}", assignment, node.span)
    unwrap(assigned)  # none may wait for a position
    change = Change("π", ", ".join(assigned), next(iter(assigned.values()), None))
    return finish_statement("S-Param", node, stack, state._replace(params={**state.params, **assigned}), change)


# Requirements


Concluding = Callable[[Requirement, object, Stack, State], Outcome]
"""The rule about the value of a condition."""


class Requiring(NamedTuple):
    """Frame: the condition of a requirement is being reduced."""

    requirement: Requirement
    conclude: Concluding


class Deciding(NamedTuple):
    """Frame: the condition of a requirement is being reduced with plain values (reading `random-branch`), and what it changes will be taken back, to
    the state `after` it.
    """

    requirement: Requirement
    conclude: Concluding
    after: State


def require(requirement: Requirement, condition: Node, conclude: Concluding, stack: Stack, state: State) -> Next:
    """Reduce the condition of a requirement, then conclude. What is drawn may decide what happens in it, if it may (reading `random-branch`)."""
    if state.reading("random-branch") == "error" or state.may_branch:
        return reduce(condition, Requiring(requirement, conclude), stack, state)
    frame = Deciding(requirement, conclude, state._replace(draws=state.draws + 1))
    around, within = numbered_apart((frame, stack), state)
    return Next("", Config(condition, around, within._replace(deciding=True)))


def resume_requiring(frame: Requiring, result: object, stack: Stack, state: State) -> Outcome:
    """The condition was reduced."""
    return frame.conclude(frame.requirement, result, stack, state)


def resume_deciding(frame: Deciding, result: object, stack: Stack, state: State) -> Outcome:
    """The condition was reduced: the requirement is observed, and the state is as before."""
    outcome = frame.conclude(frame.requirement, result, stack, state)
    after = Config(PASS, stack, taken_back(frame))
    return outcome._replace(beyond=after) if isinstance(outcome, Stuck) else outcome._replace(config=after)  # type: ignore[union-attr]


def unwind_deciding(frame: Deciding, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception leaves the condition: it depends on what is drawn."""
    origin = abrupt.origin or Origin(frame.requirement.span, "a requirement")
    return Next("", Config(abrupt._replace(origin=origin), stack, taken_back(frame)))


def taken_back(frame: Deciding) -> State:
    """The state without what the condition changed."""
    frame.after.version.versions.go_to(frame.after.version)
    return frame.after


def check_place(span: Span, stack: Stack, state: State) -> None:
    """A requirement may not stand in what the condition of another calls, where that changes nothing."""
    within = state.deciding
    while stack and not within:
        frame, stack = stack
        within = isinstance(frame, Deciding)
    if within:
        raise RunError("a requirement may not be stated while the condition of another is evaluated", span, rule="S-Require")


def conclude_require(requirement: Requirement, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨B, σ, π, O⟩ → ⟨True, σ, π, O'⟩ then ⟨require B, σ, π, O⟩ → ⟨pass, σ, π, O'⟩."""
    return observe_requirement("S-Require", requirement, condition_truth(result, requirement.span, state, "a requirement", "S-Require"), stack, state)


def observe_requirement(rule: str, requirement: Requirement, holds: object, stack: Stack, state: State) -> Outcome:
    """The rule fires only if the requirement holds; otherwise no rule applies and the run is stuck."""
    after = Config(PASS, stack, state)
    return Observe(rule, requirement, after) if is_met(holds, requirement) else Stuck(rule, requirement, after)


def hard_requirement(node: s.Require, stack: Stack, state: State) -> Outcome:
    """`require B`, now or at the end (reading `require-time`)."""
    check_place(node.span, stack, state)
    at_the_end = state.reading("require-time") == "end" and state.simulation is None
    return capture(node, stack, state) if at_the_end else enforce(node, stack, state)


def capture(node: s.Require, stack: Stack, state: State) -> Outcome:
    """⟨require B, σ, π, O⟩ → ⟨pass, σ, π, O⟩, and ⟨require B⟩ is checked at the end, on what σ and O hold here (reading `requirement-capture`)."""
    captured = Captured(state.sigma.snapshot(partial(copy_containers, seen={})), state.ego, state.workspace, state.objects)
    return Next("S-Require-Capture", Config(PASS, stack, state._replace(late=(*state.late, (node, captured)))), node)


def enforce(node: s.Require, stack: Stack, state: State) -> Outcome:
    """Reduce the condition: now, or at the end of the program in the state of the statement (reading `require-time`)."""
    requirement = Requirement("require", node.span, f"the requirement on line {node.span.line}")
    return require(requirement, node.condition, conclude_require, stack, state)


def soft_requirement(node: s.SoftRequire, stack: Stack, state: State) -> Outcome:
    """The probability of `require[p] B` comes first."""
    check_place(node.span, stack, state)
    return premises(node, [node.probability], conclude_soft, stack, state)


def conclude_soft(node: s.SoftRequire, values: list[object], stack: Stack, state: State) -> Outcome:
    """Throw the coin: once per run, or once per scene before the rejection loop (reading `soft`)."""
    probability = values[0]
    if type(probability) is Random:
        raise RunError("the probability of a soft requirement must be a constant", node.probability.span, rule="S-SoftReq-Check")
    try:
        coin = Coin(probability)  # type: ignore[arg-type]
    except (BadParameters, TypeError):
        raise RunError(
            f"the probability of a soft requirement must be between 0 and 1, not {probability}", node.probability.span, rule="S-SoftReq-Check"
        ) from None

    def resume(heads: object) -> Config:
        return check_soft_requirement(node, stack, state) if heads else skip(stack, state)

    per_scene = state.reading("soft") == "scene"
    return Draw("S-SoftReq-Check", state.address, coin, node, resume, per_scene=per_scene, otherwise="S-SoftReq-Skip")


def check_soft_requirement(node: s.SoftRequire, stack: Stack, state: State) -> Config:
    """⟨require[p] B, σ, π, O⟩ →^p ⟨require B, σ, π, O⟩."""
    return Config(s.Require(condition=node.condition, span=node.span), *numbered_apart(stack, state))


def skip(stack: Stack, state: State) -> Config:
    """⟨require[p] B, σ, π, O⟩ →^{1-p} ⟨pass, σ, π, O⟩."""
    return Config(PASS, stack, state._replace(draws=state.draws + 1))


# Mutation


def mutate(node: s.Mutate, stack: Stack, state: State) -> Outcome:
    """The objects of `mutate` and the scale come first."""
    return premises(node, [*node.objects, node.scale], conclude_mutate, stack, state)


def conclude_mutate(node: s.Mutate, values: list[object], stack: Stack, state: State) -> Outcome:
    """⟨mutate obj_i by s, σ, π, O⟩ → ⟨pass, σ, π, O[σ(obj_i).mutationScale / s]⟩; the scale is 1 by default.

    For the listed objects, or for every Object that exists now (reading `mutate-all`).
    """
    *listed, scale = values
    first = 0
    if state.simulation is not None:
        first = check_setup("objects are mutated", node, stack)
    scale = 1 if node.scale is None else scale
    inner = value_in_run(scale)
    if not is_scalar(inner) or inner < 0 or not is_finite_number(inner):  # type: ignore[operator]
        place = node.span if node.scale is None else node.scale.span
        hint = "it scales the noise of the position and of the heading alike: give one number"
        raise RunError(f"`mutate ... by` expects a number that is at least 0, not {inner}", place, rule="S-Mutate", hint=hint)
    targets = [value_in_run(v) for v in listed] if node.objects else list(state.scene[first:])
    for i, target in enumerate(targets):
        if not (isinstance(target, Instance) and is_object(target)):
            hint = "for a number that varies write Normal(mean, stdDev)" if is_scalar(target) else ""
            raise RunError(f"only Objects can be mutated, not {kind_name(target)}", node.objects[i].span, rule="S-Mutate", hint=hint)
        if target not in state.scene[first:]:
            raise RunError(f"{target!r} is in the scene already: a scenario that runs mutates the objects that it makes", node.span, rule="S-Mutate")
        state = state.with_properties(target, {"mutationScale": scale})
    return finish_statement("S-Mutate", node, stack, state, Change("O", ", ".join(f"{t!r}.mutationScale" for t in targets), scale))
