"""The rule "Distributions" of Figure "Semantics of expressions": a distribution evaluates to a sample from it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sized
from typing import NamedTuple

from ..space.distributions import BadParameters, Distribution, NoValues
from ..store.errors import RunError
from ..syntax.nodes import Node, Span
from ..syntax.python_expressions import Call, DictDisplay, Name, Starred
from .config import Abrupt, Config, Stack, State, Value
from .outcome import Draw, Next, Outcome, Requirement, Stuck
from .stuck_runs import NothingToDraw, unmet_requirement
from .values import Constructor, Origin, Random, unwrap


def draw(node: Node, constructor: Constructor, arguments: tuple[object, ...], keywords: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """⟨params⟩ → θ and v ∈ dom baseDist(θ) give ⟨baseDist(params)⟩ →^{P_θ(v)} v (Figure "Semantics of expressions", Distributions)."""
    unwrap((arguments, keywords))  # none may wait for a position
    try:
        named = canonical_keywords(keywords, constructor)
        if constructor.keeps_values:
            distribution = constructor.make(*arguments, **named)
        else:
            distribution = maker(constructor, state)(*(unwrap(a)[0] for a in arguments), **{k: unwrap(v)[0] for k, v in named.items()})
    except NoValues as bad:
        if any(type(a) is Random for a in arguments):
            return of_nothing(constructor, node.span)
        return invalid("E-Distributions", bad, place_of_values(node), state, missing_values(node, constructor.name))
    except BadParameters as bad:
        return invalid("E-Distributions", bad, place_of_weight(node, arguments, bad.number), state)
    except TypeError:
        text = f"the parameters of {constructor.name} are ({constructor.takes})"
        hint = STEPS if constructor.name == "Range" and len(arguments) == 3 else ""
        raise RunError(text, node.span, rule="E-Distributions", hint=hint) from None
    return ask(node, distribution, "E-Distributions", stack, state, f"{constructor.name}(...)")


STEPS = "Range draws any number in between; a whole number is drawn by DiscreteRange(low, high), one of several by Uniform(*range(low, high, step))"


def place_of_values(node: Node) -> Span:
    """Return the place of the list from which a distribution draws, if it is the only argument, else of the
    whole call.
    """
    return node.arguments[0].span if isinstance(node, Call) and len(node.arguments) == 1 else node.span


def missing_values(node: Node, distribution: str) -> str:
    """The sentence that a distribution has nothing to draw; it names the list, where that has a name."""
    match node:
        case Call(arguments=(Name(name=name) | Starred(value=Name(name=name)),)):
            return f"{distribution} has nothing to draw: {name} is empty"
        case _:
            return f"{distribution} has nothing to draw: it is given no values"


def canonical_keywords(keywords: Mapping[str, object], constructor: Constructor) -> dict[str, object]:
    """The arguments by our names of the parameters. Raises `TypeError` if one is given by two names."""
    named = {constructor.renamed.get(name, name): given for name, given in keywords.items()}
    if len(named) < len(keywords):
        raise TypeError("a parameter is given by two names")
    return named


def place_of_weight(node: Node, arguments: tuple[object, ...], number: int | None) -> Span:
    """Return the place of the weight of that number, if the weights are written in the call, else of the
    whole call.
    """
    match node:
        case Call(arguments=(DictDisplay(items=items),), keywords=()) if number is not None:
            distinct = isinstance(arguments[0], Sized) and len(arguments[0]) == len(items)
            if distinct and all(key is not None for key, _ in items):
                return items[number][1].span
        case _:
            pass
    return node.span


def maker(constructor: Constructor, state: State) -> Callable[..., Distribution]:
    """Return the constructor of the distribution: bounds may stand in either order, or not (reading
    `reversed-range`).
    """
    if constructor.unordered is not None and state.reading("reversed-range") == "either":
        return constructor.unordered
    return constructor.make


def of_nothing(constructor: Constructor, span: Span) -> Stuck:
    """A distribution over the values of a container of random length has no value where that is empty (reading `random-length`)."""
    return Stuck("E-Distributions", unmet_requirement(NothingToDraw(constructor.name), span))


def invalid(rule: str, bad: BadParameters, span: Span, state: State, text: str = "") -> Stuck:
    """No rule fires for a θ that is none (reading `invalid-parameters`): an error, or the run is stuck; `text` says it better than `bad`."""
    text = text or str(bad)
    if state.reading("invalid-parameters") == "error":
        raise RunError(text, span, rule=rule)
    return Stuck(rule, Requirement("parameters", span, text))


def ask(node: Node, distribution: Distribution, rule: str, stack: Stack, state: State, text: str) -> Draw:
    """A draw whose result is the value of the expression."""
    origin = Origin(node.span, text, distribution)
    after = state._replace(draws=state.draws + 1)

    def resume(drawn: object) -> Config:
        return Config(Value(Random(unwrap(drawn)[0], origin)), stack, after)

    return Draw(rule, state.address, distribution, node, resume)


class Apart(NamedTuple):
    """Frame of what is reduced only in some runs: its own draws are numbered apart from those after it, of which the next has the number `draws`."""

    prefix: tuple[int, ...]
    draws: int


def numbered_apart(stack: Stack, state: State) -> tuple[Stack, State]:
    """The stack and the state in which something is reduced whose draws are numbered apart."""
    return (Apart(state.prefix, state.draws + 1), stack), state._replace(prefix=state.address, draws=0)


def resume_apart(frame: Apart, result: object, stack: Stack, state: State) -> Outcome:
    """Go on numbering the draws after it."""
    return Next("", Config(Value(result), stack, state._replace(prefix=frame.prefix, draws=frame.draws)))


def unwind_apart(frame: Apart, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Go on numbering the draws after an exception."""
    return Next("", Config(abrupt, stack, state._replace(prefix=frame.prefix, draws=frame.draws)))
