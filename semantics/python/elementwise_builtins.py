"""Builtins that go through what they are given element by element: `map`, `filter`, `zip`, `next`, `any`, ..., no further than they must."""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import count
from types import BuiltinFunctionType
from typing import Any, Literal, NamedTuple

from ..machine.config import Config, Stack, State, value
from ..machine.host_calls import HostException, host, raw
from ..machine.operand_kinds import cases, is_vector, kind_name, of_cases
from ..machine.outcome import Next, Outcome
from ..machine.values import Bound, Native, Origin, Random, unwrap, value_in_run, wrap
from ..space.numeric_functions import is_needed
from ..store.budget import Metered, as_whole_number
from ..store.errors import FuelExhausted, RunError
from ..store.generators import EXHAUSTED, Generator
from ..store.scopes import Scope
from ..syntax import python_expressions as p
from ..syntax.nodes import Node
from .call_costs import as_callback
from .functions import InScope, return_host_result
from .generators import GO_ON, begin_generator, give, pull, take_element, unlink_elements, walk
from .iteration import elements, elements_in_this_run, known_elements
from .library import BUILTIN, ITERTOOLS, LISTING
from .released_members import as_function

Arguments = tuple[object, ...]
Keywords = Mapping[str, object]
Rule = Callable[[Node, Arguments, Keywords, Stack, State], Outcome]

# next, any, all


class Asking(NamedTuple):
    """Frame of `next(g, default)`; no `default` where none was given."""

    node: Node
    default: tuple[object, ...]


def next_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`next(g, default)` of a generator, or of an iterator of the library."""
    iterator, *default = arguments
    if len(default) > 1 or keywords:
        raise HostException(TypeError("next() takes an iterator and a default"))
    frame = Asking(node, tuple(default))
    if type(iterator) is Metered:
        return resume_asking(frame, take_element(iterator, state)[0], stack, state)
    return pull(iterator, (frame, stack), state)  # type: ignore[arg-type]


def resume_asking(frame: Asking, result: object, stack: Stack, state: State) -> Outcome:
    """If the body of g comes to the element v then ⟨next(g)⟩ → v, and g goes on behind it when it is asked again; after the last one the
    default, or StopIteration.
    """
    if result is EXHAUSTED and not frame.default:
        raise HostException(StopIteration())
    return value("E-Next", next(iter(frame.default)) if result is EXHAUSTED else result, stack, state, frame.node)


def iter_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`iter(xs)` of a list, whose elements stay what they are."""
    items: Any = arguments[0]
    return return_host_result(node, state.settings.door.budget.metered(items), stack, state)


class Quantifying(NamedTuple):
    """Frame of `any(g)` and `all(g)`: what the elements were so far (a chain, last first)."""

    node: Node
    function: Callable[..., bool]
    generator: Generator
    found: tuple = ()


def quantifier_rule(function: Callable[..., bool]) -> Callable[..., Outcome]:
    """The rule of `any(g)` or `all(g)`, g a generator: no further than an element that decides."""

    def rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
        if len(arguments) > 1 or keywords:
            raise HostException(TypeError(f"{function.__name__}() takes one argument"))
        generator: Any = next(iter(arguments))
        return pull(generator, (Quantifying(node, function, generator), stack), state)

    return rule


def resume_quantifying(frame: Quantifying, result: object, stack: Stack, state: State) -> Outcome:
    """One more element; what decides whatever comes then, or the last one, ends it."""
    function, door = frame.function, state.settings.door
    if result is not EXHAUSTED:
        frame = frame._replace(found=(result, frame.found))
        if type(result) is Random or host(door, state, bool, result) is not (function is any):
            return pull(frame.generator, (frame, stack), state)
    return return_host_result(frame.node, host(door, state, function, unlink_elements(frame.found)), stack, state)


# islice


class Slicing(NamedTuple):
    """The body of `islice(g, start, stop, step)`: the places of the elements that it gives, and the place of the next one in g."""

    generator: Generator
    wanted: range
    place: int = 0


def islice_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`islice(g, stop)` or `islice(g, start, stop, step)` of a generator."""
    generator, *limits = map(value_in_run, arguments)
    if keywords or not 1 <= len(limits) <= 3:
        raise HostException(TypeError("islice() takes an iterable and one to three numbers"))
    if not all(limit is None or (isinstance(limit, int) and limit >= 0) for limit in limits):
        raise HostException(ValueError("islice() takes an iterable and whole numbers, none of them negative"))
    chosen: Any = slice(*limits)
    if chosen.step == 0:
        raise HostException(ValueError("islice() takes a step of at least 1"))
    wanted = range(chosen.start or 0, ENDLESS if chosen.stop is None else chosen.stop, chosen.step or 1)
    return return_host_result(node, begin_generator(Slicing(generator, wanted), state.sigma, state), stack, state)  # type: ignore[arg-type]


ENDLESS = 2**62
"""Where a slice without an end ends: no run takes so many steps."""


def resume_slicing(frame: Slicing, result: object, stack: Stack, state: State) -> Outcome:
    """An element is asked for; or the generator gave one, or ended."""
    if result is not GO_ON:
        if result is EXHAUSTED:
            return give(None, EXHAUSTED, stack, state)
        wanted, frame = frame.place in frame.wanted, frame._replace(place=frame.place + 1)
        if wanted:
            return give(frame, result, stack, state)
    return pull(frame.generator, (frame, stack), state) if frame.place < frame.wanted.stop else give(None, EXHAUSTED, stack, state)


# zip, enumerate


class Pairing(NamedTuple):
    """The body of `zip(I, ...)`: what gives the elements, and those found for the next row; with `strict`, `ending` once the first has no more."""

    node: Node
    sources: tuple[object, ...]
    strict: bool = False
    found: tuple[object, ...] = ()
    ending: bool = False


def zip_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`zip(I, ..., J)`: rows of elements side by side."""
    if any(name != "strict" for name in keywords):
        raise HostException(TypeError("zip() takes iterables and strict"))
    sources = tuple(walk(i, node, state) for i in arguments)
    return pair_rows(Pairing(node, sources, bool(value_in_run(keywords.get("strict", False)))), stack, state)


def enumerate_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`enumerate(I, start)`: rows of a number and an element."""
    if not 1 <= len(arguments) <= 2 - len(keywords) or any(name != "start" for name in keywords):
        raise HostException(TypeError("enumerate() takes an iterable and start"))
    iterable, *start = (*arguments, *keywords.values())
    try:
        numbers = state.settings.door.budget.metered(count(as_whole_number(value_in_run(start[0])) if start else 0))
    except TypeError:
        raise HostException(TypeError(f"enumerate() starts at a whole number, not {kind_name(start[0])}")) from None
    return pair_rows(Pairing(node, (numbers, walk(iterable, node, state))), stack, state)


def pair_rows(frame: Pairing, stack: Stack, state: State) -> Outcome:
    """The generator of rows."""
    return return_host_result(frame.node, begin_generator(frame, state.sigma, state), stack, state)


def advance_pairing(frame: Pairing, stack: Stack, state: State) -> Outcome:
    """Take an element from each, in order; the first that has none ends the rows."""
    while len(frame.found) < len(frame.sources):
        position = len(frame.found)
        source = frame.sources[position]
        if type(source) is Generator:
            return pull(source, (frame, stack), state)
        element, source = take_element(source, state)
        following = extend_row(frame._replace(sources=(*frame.sources[:position], source, *frame.sources[position + 1 :])), element)
        if following is None:
            return give(None, EXHAUSTED, stack, state)
        frame = following
    if frame.ending or not frame.sources:
        return give(None, EXHAUSTED, stack, state)
    return give(frame._replace(found=()), frame.found, stack, state)


def resume_pairing(frame: Pairing, result: object, stack: Stack, state: State) -> Outcome:
    """A row is asked for; or a source that is a generator gave an element, or ended."""
    following = frame if result is GO_ON else extend_row(frame, result)
    return give(None, EXHAUSTED, stack, state) if following is None else advance_pairing(following, stack, state)


def extend_row(frame: Pairing, element: object) -> Pairing | None:
    """The row with one more element; None where the rows end."""
    position = len(frame.found)
    if element is EXHAUSTED and not frame.strict:
        return None
    if frame.strict and position and (element is EXHAUSTED) != frame.ending:
        raise HostException(ValueError(f"zip() argument {position + 1} is {'longer' if frame.ending else 'shorter'} than the first"))
    return frame._replace(found=(*frame.found, element), ending=element is EXHAUSTED)


# map, filter, reversed


_F, _X, _XS = p.Name(name="<function>"), p.Name(name="<element>"), p.Name(name="<elements>")


def map_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`map(f, xs)` is the generator `(f(x) for x in xs)`; with several iterables their elements are taken side by side."""
    if len(arguments) < 2:
        raise HostException(TypeError("map() takes a function and at least one iterable"))
    function, *iterables = arguments
    if len(iterables) == 1:
        return comprehend(node, function, iterables[0], p.Call(function=_F, arguments=(_X,), span=node.span), "generator", stack, state)
    rows = begin_generator(Pairing(node, tuple(walk(i, node, state) for i in iterables)), state.sigma, state)
    element = p.Call(function=_F, arguments=(p.Starred(value=_X),), span=node.span)
    return comprehend(node, function, rows, element, "generator", stack, state)


def filter_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`filter(f, xs)` is `[x for x in xs if f(x)]`, a list as in the released implementations, perhaps a random one.

    Where a draw decides which container xs is, f sees the elements that it has in this run, which are not random for f; they are random for a
    function that draws, makes or changes something, where xs has the same number of elements in every run.
    """
    if len(arguments) != 2:
        raise HostException(TypeError("filter() takes a function and an iterable"))
    function, among = arguments
    lengths_differ = type(among) is Random and known_elements(among, state) is None
    if type(among) is Random and (lengths_differ or not is_vector(among.value)):
        if (possible := cases(among.value)) is not None:
            return select_next(SelectingInCases(node, function, among, tuple(possible), state.address), stack, state)
        try:
            return return_host_result(node, filter_random_container(function, among, state), stack, state)
        except RunError as refused:
            if lengths_differ or refused.rule != "E-Call-Host" or isinstance(refused, FuelExhausted):
                raise
            state.settings.door.budget.versions.go_to(state.version)
    items, origin = elements_in_this_run(among, node, state)
    test = _X if function is None else p.Call(function=_F, arguments=(_X,), span=node.span)
    return comprehend(node, function, items, test, "list", (Selecting(node, items, origin), stack), state)


class Selecting(NamedTuple):
    """Frame of `filter`: whether the function holds of each of the `items`, whose number may depend on the draw `origin`, is being reduced."""

    node: Node
    items: list[object]
    origin: Origin | None


def resume_selecting(frame: Selecting, truths: list[object], stack: Stack, state: State) -> Outcome:
    """The elements of which the function holds; the list is random where that is."""
    door, items = state.settings.door, frame.items
    holds = [host(door, state, bool, t) for t in truths]
    if frame.origin is None and not any(type(t) is Random for t in holds):
        return value("", [item for item, t in zip(items, holds, strict=True) if t], stack, state)
    chosen, origin = unwrap(host(door, state, select, items, holds))
    return value("", wrap(chosen, frame.origin or origin), stack, state)


class SelectingInCases(NamedTuple):
    """Frame of `filter` of a container that differs from run to run: it is filtered in every case, each needed in the runs with its condition."""

    node: Node
    function: object
    container: Random
    cases: tuple[tuple[object, object], ...]
    address: tuple[int, ...]
    """That of the next draw: a function that draws would change it."""
    found: tuple[object, ...] = ()


def select_next(frame: SelectingInCases, stack: Stack, state: State) -> Outcome:
    """Filter the container of the next case, or put together what they gave."""
    if len(frame.found) == len(frame.cases):
        chosen = of_cases(frame.container.value, frame.found, drawn=state.address != frame.address)
        return value("", wrap(unwrap(chosen)[0], frame.container.origin), stack, state)
    condition, container = frame.cases[len(frame.found)]
    items = list(elements(container, frame.node, state))
    filtering = p.Call(function=p.Constant(value=LISTING["filter"]), arguments=(p.Constant(value=frame.function), p.Constant(value=items)))
    end = (frame, stack)
    is_needed(condition, True, end)
    return Next("", Config(filtering, end, state))


def resume_selecting_in_cases(frame: SelectingInCases, result: object, stack: Stack, state: State) -> Outcome:
    """One more case is done."""
    return select_next(frame._replace(found=(*frame.found, result)), stack, state)


def filter_random_container(function: object, among: object, state: State) -> object:
    """The elements of a random container of which a function holds, which is called with the values that they have in this run."""
    door = state.settings.door
    return host(door, state, select_items, as_callback(as_function(function, state), door.budget), among)


def select_items(function: Callable[[object], object] | None, items: Iterable[object]) -> list[object]:
    """The items of which the function holds, or which are true."""
    return [item for item in items if (item if function is None else function(item))]


def select(items: list[object], truths: list[bool]) -> list[object]:
    """The items whose truth is True."""
    return [item for item, holds in zip(items, truths, strict=True) if holds]


def comprehend(
    node: Node, function: object, iterable: object, element: p.Expression, kind: Literal["list", "generator"], stack: Stack, state: State
) -> Outcome:
    """The values of an expression of `_F`, a function, and `_X`, an element of the iterable."""
    scope = Scope("comprehension", state.sigma, bindings={"<function>": function, "<elements>": iterable})
    clause = p.ComprehensionClause(target=_X, iterable=_XS)
    body = p.Comprehension(kind=kind, element=element, clauses=(clause,), span=node.span)
    return return_host_result(node, body, (InScope(state.sigma), stack), state._replace(sigma=scope))


def reversed_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`reversed(xs)`: the elements of a sequence, the last one first."""
    settled = [elements(a, node, state) if type(a) is Random else a for a in arguments]
    items = raw(state.settings.door, state, LISTING["reversed"], *settled, **keywords)
    return comprehend(node, None, items, _X, "generator", stack, state)


def unless_random(name: str, rule: Rule) -> tuple[Native, Rule]:
    """A builtin that gives a generator; of a list of random length, it gives such a list."""

    def either(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
        if any(type(a) is Random and known_elements(a, state) is None for a in (*arguments, *keywords.values())):
            return return_host_result(node, host(state.settings.door, state, LISTING[name], *arguments, **keywords), stack, state)
        return rule(node, arguments, keywords, stack, state)

    return LISTING[name], either


ELEMENTWISE: Mapping[Callable[..., object], Rule] = {
    LISTING["map"]: map_rule, LISTING["filter"]: filter_rule,
    **dict([unless_random("zip", zip_rule), unless_random("enumerate", enumerate_rule), unless_random("reversed", reversed_rule)]),
}  # fmt: skip
"""The rules of Python's lazy builtins."""

GENERATOR_RULES: Mapping[object, Rule] = {
    BUILTIN["next"]: next_rule, any: quantifier_rule(any), all: quantifier_rule(all), ITERTOOLS["islice"].function: islice_rule,  # type: ignore[attr-defined]
}  # fmt: skip
"""Functions that go through a generator no further than they must; one that pays by what it is bound to."""


def generator_rule(function: object, arguments: Arguments) -> Rule | None:
    """The rule of a call whose first argument is a generator, another iterator or a list, if there is one for it."""
    if not arguments or not isinstance(function, (BuiltinFunctionType, Native, Bound)):
        return None
    called = function.function if type(function) is Bound else function
    match arguments[0]:
        case Generator():
            return GENERATOR_RULES.get(called)
        case Metered() if called is BUILTIN["next"]:
            return next_rule
        case list() | tuple() if called is BUILTIN["iter"].function and len(arguments) == 1:  # type: ignore[attr-defined]
            return iter_rule
        case _:
            return None
