"""`do choose` and `do shuffle`: among those whose preconditions hold (Section "Compositional Scenarios", "Random Selection of Scenarios")."""

from __future__ import annotations

from typing import NamedTuple

from ..machine.conditions import condition_truth
from ..machine.config import Abrupt, Config, Stack, State, Value
from ..machine.operand_kinds import is_finite, is_scalar, kind_name
from ..machine.outcome import Draw, Next, Outcome, Requirement, Stuck
from ..machine.premises import premises
from ..machine.simulation_state import agent_of
from ..machine.values import Dynamic, value_in_run
from ..space.distributions import BadParameters, Discrete
from ..store.errors import RunError
from ..store.scopes import Scope
from ..syntax import dynamics as d
from .frames import Picking, Shuffling
from .guards import scope_of
from .invocations import Beginning, invoke, limit_task, runner, with_arguments


class Enabling(NamedTuple):
    """Frame: precondition number `condition` of option number `i` is being reduced; `enabled` are those whose preconditions all hold."""

    picking: Picking
    i: int
    condition: int
    enabled: tuple[int, ...]
    outer: Scope


def pick(node: d.DoChoose | d.DoShuffle, stack: Stack, state: State) -> Outcome:
    """`do choose A, B`, `do shuffle {A: 2, B: 1}`: the invocations, their weights (1 if there are none) and the limit."""
    amount = node.limit.amount if isinstance(node.limit, d.TimeLimit) else None
    return premises(node, [*node.invocations, *node.weights, amount], conclude_pick, stack, state)


def conclude_pick(node: d.DoChoose | d.DoShuffle, values: list[object], stack: Stack, state: State) -> Outcome:
    """Look whose preconditions hold."""
    count = len(node.invocations)
    weights = [value_in_run(w) for w in values[count:-1]] or [1] * count
    options = tuple((with_arguments(v, one, state), w) for v, w, one in zip(values, weights, node.invocations))
    return limit_task(node, Picking(node, options), Beginning(begin_choice), values[-1], stack, state)


def begin_choice(picking: Picking, stack: Stack, state: State) -> Outcome:
    """The limit has not passed: look whose preconditions hold."""
    return enable(Enabling(picking, 0, 0, (), state.sigma), stack, state)


def enable(frame: Enabling, stack: Stack, state: State) -> Outcome:
    """The next precondition, or the choice."""

    options = frame.picking.options
    while frame.i < len(options):
        dynamic, _ = options[frame.i]
        conditions = dynamic.definition.preconditions  # type: ignore[attr-defined]
        if frame.condition < len(conditions):
            who = runner(stack)
            scope = scope_of(dynamic, state, **({"self": agent_of(who, state)} if who.kind == "behavior" else {}))
            return Next("", Config(conditions[frame.condition], (frame, stack), state._replace(sigma=scope)))
        frame = frame._replace(i=frame.i + 1, condition=0, enabled=(*frame.enabled, frame.i))
    return choose(frame, stack, state)


def resume_enabling(frame: Enabling, result: object, stack: Stack, state: State) -> Outcome:
    """A precondition was reduced: one that does not hold disables its option."""
    dynamic, _ = frame.picking.options[frame.i]
    condition = dynamic.definition.preconditions[frame.condition]  # type: ignore[attr-defined]
    holds = condition_truth(result, condition.span, state, "a precondition", "D-Choose")
    after = frame._replace(condition=frame.condition + 1) if holds else frame._replace(i=frame.i + 1, condition=0)
    return enable(after, stack, state._replace(sigma=frame.outer))


def unwind_enabling(frame: Enabling, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """A precondition raised an exception."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def choose(frame: Enabling, stack: Stack, state: State) -> Outcome:
    """Section "Compositional Scenarios", "Random Selection of Scenarios": "choose scenarios to run randomly amongst only those whose preconditions
    are satisfied". The probability of each is proportional to its weight (reading `choose-weights`); "If none of the three scenarios are enabled,
    Scenic will reject the simulation."
    """
    picking, node = frame.picking, frame.picking.node
    word = "choose" if isinstance(node, d.DoChoose) else "shuffle"
    if not frame.enabled:
        return Stuck("D-Choose", Requirement("precondition", node.span, f"one of those to {word} from on line {node.span.line} is enabled"))
    try:
        distribution = Discrete(tuple((k, picking.options[k][1]) for k in frame.enabled))  # type: ignore[arg-type]
    except BadParameters:
        text, wrong = weights_fault([picking.options[k] for k in frame.enabled])
        whole = len(picking.options) == len(node.weights)  # `do shuffle` has not run any yet
        span = node.weights[frame.enabled[wrong]].span if whole and wrong is not None else node.span
        raise RunError(f"`do {word}`: {text}", span, rule="D-Choose") from None

    def resume(chosen: object) -> Config:
        after = state._replace(draws=state.draws + 1)
        return Config(Value(Chosen(picking, value_in_run(chosen))), (Starting(), stack), after)  # type: ignore[arg-type]

    return Draw("D-Choose", state.address, distribution, node, resume)


def weights_fault(options: list[tuple[Dynamic, object]]) -> tuple[str, int | None]:
    """Return what is wrong with the weights of the options that are left (reading `choose-weights`), and the number of
    the wrong one.
    """
    for number, (option, weight) in enumerate(options):
        if not is_scalar(weight) or not is_finite(weight):
            given = weight if is_scalar(weight) else kind_name(weight)
            return f"the weight of {option!r} must be a finite number, not {given}", number
        if weight < 0:  # type: ignore[operator]
            return f"the weight of {option!r} must not be negative, but it is {weight}", number
    left = ", ".join(repr(option) for option, _ in options)
    return f"the weights of all options that are left and enabled ({left}) are 0", None


class Chosen(NamedTuple):
    """The value that lets the frame `Starting` begin an option."""

    picking: Picking
    option: int


class Starting(NamedTuple):
    """Frame that begins the option that was drawn."""


def resume_starting(frame: Starting, result: object, stack: Stack, state: State) -> Outcome:
    """Run the option; `do shuffle` draws again among the rest afterwards."""
    assert isinstance(result, Chosen)
    picking, k = result.picking, result.option
    if isinstance(picking.node, d.DoShuffle) and len(picking.options) > 1:
        rest = picking._replace(options=tuple(o for j, o in enumerate(picking.options) if j != k))
        stack = (Shuffling(rest), stack)
    return invoke(picking.node, (picking.options[k][0],), stack, state, enabled=True)


def resume_shuffling(frame: Shuffling, result: object, stack: Stack, state: State) -> Outcome:
    """One has ended: draw among the others whose preconditions hold now."""
    return begin_choice(frame.picking, stack, state)
