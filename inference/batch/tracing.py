"""The machine run once on symbols: draws are answered by symbols, requirements become events, and the end is the scene in symbols."""

from __future__ import annotations

import builtins
import itertools
import operator
import textwrap
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from functools import partial, reduce
from typing import Any, NamedTuple

import numpy as np

from ...interpreter.language.printer import to_source
from ...interpreter.runtime.answerers import AS_THEY_ARE, PER_SCENE, Draws, from_stream, replace_distribution
from ...interpreter.runtime.process_sandbox import guard_run
from ...interpreter.runtime.program_run import Accepted, Beginnings, generate_scene
from ...interpreter.runtime.random_streams import Stream
from ...semantics.machine.config import Abrupt, Config, State, Value
from ...semantics.machine.error_places import frames_of
from ...semantics.machine.outcome import Done, Draw, Fault, Next, Outcome, Requirement, Stuck
from ...semantics.machine.run_loop import End, drive_machine
from ...semantics.machine.stuck_runs import KINDS_OF_UNMET, NothingToDraw, unmet_requirement
from ...semantics.machine.values import Bound, Dynamic, Function, Instance, Method, Module, Random, unwrap
from ...semantics.python.arithmetic import BINARY, UNARY
from ...semantics.python.assignment import assigned_variables
from ...semantics.python.builtin_rules import container_method
from ...semantics.python.calls import invoke, vector
from ...semantics.python.elementwise_builtins import SelectingInCases
from ...semantics.space.distributions import (
    Coin,
    Discrete,
    Distribution,
    Normal,
    PointIn,
    Range,
    TruncatedNormal,
    Uniform,
)
from ...semantics.space.numeric_functions import negation, pick
from ...semantics.space.regions import (
    CircularRegion,
    EmptyRegion,
    PointSetRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    Region,
    SectorRegion,
    UnboundedRegion,
    Workspace,
)
from ...semantics.space.regions.point_sampling import PieceSampler
from ...semantics.space.symbol_seam import NotLifted, Spread
from ...semantics.space.vectors import Vector
from ...semantics.step import place, step
from ...semantics.store.errors import RandomBranch, ScenicError
from ...semantics.store.scenic_classes import ScenicClass
from ...semantics.store.scopes import target_names
from ...semantics.store.undo_log import STORED
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import statements as s
from ...semantics.syntax.nodes import NOWHERE, Node, Statement
from .evaluation_plan import only_rejects
from .graph import Graph, GraphEvent, GraphNode, ItemOf, RowDraw, SearchPart, Site
from .graph_builder import Recorder, is_constant_choice
from .symbolic import OPERATORS, Choice, Mistaken, Retry, Scalar, Traced, in_row, symbols_in

MOST_ITEMS = 1 << 16
"""Containers with more items than this together, and regions of more pieces, are drawn from row by row."""
Uniforms = Callable[[], Any]


def draw_from_choice(distribution: Distribution, uniform: Uniforms, made: Recorder) -> Any:
    """Return the symbol for a draw of which all that is random is a choice among constant containers or regions.

    Returns NotImplemented for any other draw. `uniform` gives the numbers of the draw.
    """
    if isinstance(distribution, Uniform):
        return draw_item(distribution, uniform, made)
    if isinstance(distribution, PointIn) and isinstance(distribution.region, Choice):
        return draw_point(distribution.region, uniform, made)
    return NotImplemented


def draw_item(distribution: Uniform, uniform: Uniforms, made: Recorder) -> Any:
    """Draw one of the items of containers that a choice decides; where there are none, the run is rejected."""
    entries = [unwrap(value)[0] for value in distribution.values]
    choices = [entry.container for entry in entries if isinstance(entry, Spread)]
    if not choices or not all(map(is_constant_choice, choices)) or len({choice.node for choice in choices}) > 1:
        return NotImplemented
    if symbols_in([entry for entry in entries if not isinstance(entry, Spread)]):
        return NotImplemented
    if not all(isinstance(unwrap(value)[0], (tuple, list)) for choice in choices for value in choice.values):
        return NotImplemented

    def items_in(entry: object, case: int) -> Sequence[Any]:
        return unwrap(entry.container.values[case])[0] if isinstance(entry, Spread) else [entry]  # type: ignore[return-value]

    cases = range(len(choices[0].values))
    among = [[item for entry in entries for item in items_in(entry, case)] for case in cases]
    if sum(map(len, among)) > MOST_ITEMS:
        return NotImplemented
    index = choices[0].node
    empty = {case: unmet_requirement(NothingToDraw(distribution.name), NOWHERE) for case in cases if not among[case]}
    if empty:
        made.note_failures(index, empty, len(among), distribution.name)
    return pick_item(index, among, uniform, made)


def pick_item(index: GraphNode, among: Sequence[Sequence[object]], uniform: Uniforms, made: Recorder) -> Any:
    """Draw one of the items among[index], each equally likely. An item that stands in several places has one number."""
    everything = [item for items in among for item in items]
    distinct = list({id(item): item for item in everything}.values())
    number_of = {id(item): number for number, item in enumerate(distinct)}
    numbers = np.array([*(number_of[id(item)] for item in everything), 0])  # the last follows an empty container at the end
    counts = np.array([len(items) for items in among])
    starts = part_starts(counts)
    position = uniform() * made.table(index, counts.astype(float))
    example = int(numbers[starts[index.example] + int(position.example)])  # type: ignore[call-overload]
    node = made.node(ItemOf(numbers, starts), (index, position.node), "int", example, object())
    return made.merge(node, distinct)


def part_starts(counts: np.ndarray) -> np.ndarray:
    """Return the position of the first element of each part, for parts of these sizes one after the other."""
    return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)


def draw_point(choice: Choice, uniform: Uniforms, made: Recorder) -> Any:
    """Draw a uniform point of one of several constant curves, or polygons. The pieces of all of them stand in one array."""
    samplers = [sampler for value in choice.values if (sampler := piece_sampler(value)) is not None]
    if len(samplers) < len(choice.values) or len(set(map(type, samplers))) != 1:
        return NotImplemented
    pieces = [piece for sampler in samplers for piece in sampler.pieces]
    if len(pieces) > MOST_ITEMS:
        return NotImplemented
    counts = np.array([len(sampler.pieces) for sampler in samplers])
    ends = np.array([end for sampler in samplers for end in (*sampler.ends, np.inf)])
    search = SearchPart(ends, np.append(part_starts(counts), len(pieces)))
    along = uniform() * made.table(choice.node, np.array([sampler.total for sampler in samplers]))
    begin = int(search.starts[choice.node.example])  # type: ignore[call-overload]
    example = begin + bisect_right(samplers[choice.node.example].ends, along.example)  # type: ignore[call-overload]
    node = made.node(search, (choice.node, along.node), "int", example, object())
    return samplers[0].point(pick(pieces, Scalar(made, node, example)), along, uniform)


def piece_sampler(region: object) -> PieceSampler | None:
    """Return the sampler of a curve or polygon that has pieces, None for any other region."""
    while isinstance(region, Workspace):
        region = region.region
    if not isinstance(region, (PolylineRegion, PolygonalRegion)) or symbols_in(region):
        return None
    return region.sampler if region.sampler.pieces else None


LIFTED: dict[Callable[..., object], Callable[..., object]] = {
    **{f: f for f in OPERATORS if f is not operator.invert},
    BINARY["+"]: operator.add,
    BINARY["-"]: operator.sub,
    BINARY["&"]: operator.and_,
    BINARY["|"]: operator.or_,
    BINARY["^"]: operator.xor,
    BINARY["*"]: operator.mul,
    BINARY["%"]: operator.mod,
    builtins.abs: operator.abs,
}
"""Operations of the machine, and the operators that they are on floats; `~` is left out on truth values, which it takes for whole numbers."""
EXAMINES = (operator.is_, operator.is_not, operator.eq, operator.ne, bool, UNARY["not"])
"""Operations by which a program asks, among other things, whether a value is None."""
ZERO_DIVIDES = (operator.truediv, operator.mod)
FEW_CASES, MANY_CASES = 64, 1 << 14
"""What is done for every combination of values of several choices, or for every value of one, is done for no more than these."""
DIRECT = (CircularRegion, SectorRegion, RectangularRegion, Workspace)
STATEFUL = (Function, Method, Dynamic, Module, Instance, ScenicClass, BaseException)


def lift(trace: Recorder, operation: Callable[..., object], arguments: list[object], keywords: dict[str, object]) -> object:
    """`operation(*arguments, **keywords)` where there are symbols in the arguments."""
    found = symbols_in((arguments, keywords))
    if not found:
        return operation(*arguments, **keywords)
    if operation in EXAMINES:
        trace.examined.update(symbol.node.number for symbol in found)
    if operation is invoke:
        check_method(arguments[0])
        if not symbols_in(arguments[0]) or is_direct(arguments[0]):
            operation, *arguments = arguments  # type: ignore[assignment]
    if isinstance(operation, Bound):
        operation = operation.afresh
    keywords = {name: value.afresh if isinstance(value, Bound) else value for name, value in keywords.items()}
    if operation in (bool, UNARY["not"]) and isinstance(arguments[0], Traced):
        return trace.truth(arguments[0]) if operation is bool else negation(trace.truth(arguments[0]))
    basic = LIFTED.get(operation)
    if basic is not None and _numeric(basic, arguments):
        return _operator(trace, basic, arguments)
    if is_direct(operation):
        return operation(*arguments, **keywords)
    if operation in (min, max) and not keywords:
        compared = list(arguments[0]) if len(arguments) == 1 and isinstance(arguments[0], (list, tuple)) else arguments
        if all(map(_is_number_or_choice, compared)):
            return reduce(partial(extreme, trace, operation), compared)
    if basic is not None and all(map(_is_number_or_choice, arguments)) and not (basic in ZERO_DIVIDES and symbols_in(list(_entries(arguments[1])))):
        mapped = trace.over_choices(basic, arguments)
        if mapped is not NotImplemented:
            return mapped
    choices = {s.node.number: s for s in found if isinstance(s, Choice)}
    only_choices = choices and len(choices) == len({s.node.number for s in found}) and _few(choices)
    if only_choices and not keywords and all(isinstance(a, Choice) or not symbols_in(a) for a in arguments):
        mapped = trace.over_choices(operation, arguments)
        if mapped is not NotImplemented:
            return mapped
    if basic is not None and all(isinstance(a, Vector) or _is_number(a) for a in arguments) and any(isinstance(a, Vector) for a in arguments):
        return operation(*arguments)
    if _stateful((arguments, keywords)):
        raise NotLifted(f"{getattr(operation, '__name__', operation)} of functions or objects and random values")
    return trace.call(operation, tuple(arguments), keywords)


def extreme(trace: Recorder, operation: Callable[..., object], first: object, second: object) -> object:
    """The smaller or larger of two numbers, the first of equal ones: itself, so that a whole number stays one."""
    replaces: object = second < first if operation is min else second > first  # type: ignore[operator]
    replaces = replaces.number() if isinstance(replaces, Traced) else replaces
    return trace.pick(trace.as_float_node(replaces.node), (first, second)) if isinstance(replaces, Traced) else second if replaces else first


def _entries(value: object) -> Iterator[object]:
    """The values that a choice is among, those of choices among them included."""
    if isinstance(value, Choice):
        for entry in value.values:
            yield from _entries(entry)
    else:
        yield value


def _is_number_or_choice(value: object) -> bool:
    return all(map(_is_number_or_choice, value.values)) if isinstance(value, Choice) else _is_number(value)


def is_direct(function: object) -> bool:
    """Whether a function of the library is made of liftable operations itself: constructors of vectors and closed forms, methods of regions."""
    if isinstance(function, type):
        return function in DIRECT
    owner = function if isinstance(function, Traced) else getattr(function, "__self__", None)
    return function is vector or (isinstance(owner, Region) and hasattr(Region, function.__name__))  # type: ignore[attr-defined]


def check_method(function: object) -> None:
    """Refuse a function that differs from run to run if what it does is the program's, or changes something."""
    for value in _entries(function) if isinstance(function, Choice) else (function.example,) if isinstance(function, Traced) else ():
        if isinstance(value, STATEFUL):
            raise NotLifted("which function is called differs from run to run")
        if container_method(value) and value.__name__ in STORED:  # type: ignore[attr-defined]
            raise NotLifted("which container is changed differs from run to run")


def _few(choices: dict[int, Choice]) -> bool:
    total = 1
    for choice in choices.values():
        total *= len(choice.values)
    return total <= (MANY_CASES if len(choices) == 1 else FEW_CASES)


def _is_number(value: object) -> bool:
    if isinstance(value, Scalar):
        return value.node.kind == "float"
    return isinstance(value, (int, float)) and not isinstance(value, bool) and (isinstance(value, float) or abs(value) <= 2**53)


def _is_truth(value: object) -> bool:
    return isinstance(value, bool) or (isinstance(value, Scalar) and value.node.kind == "bool")


def _numeric(operation: Callable[..., object], arguments: list[object]) -> bool:
    """Whether the operation is one on floats (at least one of them a symbol), or a logical one on truth values."""
    if operation in (operator.and_, operator.or_, operator.xor):
        return all(map(_is_truth, arguments))
    if not any(isinstance(a, Scalar) for a in arguments):
        return False
    return all(_is_number(a) or (isinstance(a, Choice) and all(map(_is_float, a.values))) for a in arguments)


def _is_float(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _operator(trace: Recorder, operation: Callable[..., object], arguments: list[object]) -> object:
    if operation in ZERO_DIVIDES and bool(trace.operate(operator.eq, (arguments[1], 0.0))):
        raise ZeroDivisionError("float division by zero" if operation is operator.truediv else "float modulo")
    return trace.operate(operation, tuple(arguments))


def _stateful(value: object) -> bool:
    """Whether functions, modules, classes or instances of the program are in a value: what they give depends on the state."""
    match value:
        case Choice():
            return any(map(_stateful, value.values))
        case Random():
            return _stateful(value.value)
        case list() | tuple() | set() | frozenset():
            return any(map(_stateful, value))
        case dict():
            return any(map(_stateful, value.items()))
        case _:
            return isinstance(value, STATEFUL)


TRIES, LOOKED_AT, MOST_STEPS = 20, 4000, 1_000_000
"""The first runs are traced until one is found in which all fields, regions and lists have values. If there is none, the machine
makes more runs, up to so many or so many steps, and those in which it finds all values are traced.
"""
MAPPED = (Range, Normal, TruncatedNormal, Uniform, Discrete, Coin)
MAPPED_REGIONS = (CircularRegion, SectorRegion, RectangularRegion, PolygonalRegion, PolylineRegion, PointSetRegion)
PURE = (s.Return, s.If, s.While, s.For)
"""Statements that change nothing but what they contain does."""
LONGEST = 80
"""Letters of a construct that a reason shows."""
FEW, SOME = 5, 40
"""How many of these may end with an error of the program; and how many where a requirement has failed before, which is why there may be one."""


class Impossible(NotLifted):
    """A requirement fails whatever is drawn: there are no scenes."""

    def __init__(self, requirement: Requirement, decision: str) -> None:
        super().__init__(requirement.text)
        self.requirement = requirement
        self.decision = decision


class Lifted(NamedTuple):
    """A program as a graph, and the state at its end, with symbols in it."""

    graph: Graph
    state: State


def trace_program(start: Callable[[], Config], fuel: int, draws: Draws = AS_THEY_ARE) -> Lifted:
    """The graph of a program. Raises `NotLifted` with the reason if it has none, `Impossible` if it has no scenes."""
    reason, errors = "", {FEW: 0, SOME: 0}
    for attempt in itertools.chain(range(TRIES), promising_attempts(start, fuel, draws)):
        try:
            return trace_run(start(), attempt, fuel, draws)
        except Retry as retry:
            reason = str(retry)
        except Mistaken as mistake:
            reason, most = str(mistake), SOME if mistake.late else FEW
            errors[most] += 1
            if errors[most] == most:
                raise
    raise NotLifted(f"no run with all values was found; in the last one that was traced, this failed: {reason}")


def promising_attempts(start: Callable[[], Config], fuel: int, draws: Draws) -> Iterator[int]:
    """Yield attempts at scene 0 of seed 0 in which no value is missing, at most `TRIES` of them.

    The machine itself looks for them, which is much faster than tracing. It stops at the first error of the program.
    """
    begin, found, steps = Beginnings(start, fuel), 0, 0
    for attempt in range(TRIES, LOOKED_AT):
        try:
            ended = generate_scene(begin(), from_stream(0, 0, attempt, draws), fuel=fuel)
        except ScenicError:
            return
        if isinstance(ended, Accepted) or ended.requirement.kind not in KINDS_OF_UNMET:
            found += 1
            yield attempt
        steps += ended.steps - begin.shared_steps
        if found == TRIES or steps > MOST_STEPS:
            return


@guard_run
def trace_run(config: Config, attempt: int, fuel: int, draws: Draws = AS_THEY_ARE) -> Lifted:
    """The graph that the run of attempt `attempt` at scene 0 of seed 0 gives."""

    def number_at(site: Site) -> float:
        numbers = Stream(0, 0, PER_SCENE if site.per_scene else attempt).at(site.address)
        for _ in range(site.index):
            numbers()
        return numbers()

    door = config.state.settings.door
    made = Recorder(number_at, door.budget)
    door.lift = partial(lift, made)
    traced, beginning = SymbolicRun(made, draws, config), config
    try:
        end, _ = drive_machine(traced.step, config, traced.answer, fuel, witness=traced.watch, beyond=traced.beyond)
    except Impossible:
        raise
    except NotLifted as problem:
        if made.imagined:
            raise Retry(str(problem)) from None
        raise late(type(problem)(with_place(str(problem), traced.config, beginning)), made) from None
    finally:
        made.open = False
        door.lift = None
    if isinstance(end, Done):
        return Lifted(made.graph, end.state)
    reason = no_graph(end)
    raise Retry(str(reason)) if made.imagined else late(reason, made)


def late(problem: BaseException, made: Recorder) -> BaseException:
    """The problem; of an error of the program, with whether a requirement has failed before, so that it may be the program's only here."""
    if isinstance(problem, Mistaken):
        problem.late = made.rejected
    return problem


def no_graph(end: End) -> BaseException:
    """Return the exception to raise for a run that has not come to its end."""
    match end:
        case Fault(error=RandomBranch(span=span)):
            return NotLifted(f"{span}: what is drawn decides what happens in the condition of a requirement")
        case Fault(error=error):
            return Mistaken(f"{error}")
        case Stuck(requirement=requirement):
            return Retry(requirement.text)
        case _:
            return NotLifted("the program does not end")


def with_place(problem: str, config: Config, beginning: Config) -> str:
    """Why there is no graph, with the construct and its place: in the program itself, if what was reduced was in a library."""
    nodes = [config.control, *(getattr(frame, "node", None) for frame in frames_of(config.stack))]
    found = [n for n in nodes if isinstance(n, Node) and n.span.line > 0]
    here = next((n for n in found if n.span.file == place(beginning).file), next(iter(found), None))
    return problem if here is None else f"{here.span}: {problem}, in `{textwrap.shorten(to_source(here), LONGEST, placeholder=' ...')}`"


class SymbolicRun:
    """The driver of a traced run: it steps, answers draws and watches events."""

    def __init__(self, made: Recorder, draws: Draws, config: Config) -> None:
        self.made = made
        self.draws = draws
        self.config = config  # the one that makes the latest step, and how many events there were before it
        self.events = 0
        self.partial_runs: list[tuple[Any, State]] = []  # where what is evaluated in some runs only ends, and the state at its beginning
        made.place = lambda text: Requirement("field", place(self.config), text)

    def step(self, config: Config) -> Outcome:
        """Return the machine's next outcome; partial runs that end before it are closed."""
        partial_runs = self.partial_runs
        while partial_runs and type(config.control) is Value and config.stack is partial_runs[-1][0]:
            check_unchanged(partial_runs.pop()[1], config.state)
            self.made.conditions.pop()
        self.config, self.events = config, len(self.made.graph.events)
        outcome = step(config)
        return self.with_symbols(outcome) if isinstance(outcome, Next) and outcome.config.state.deciding else outcome

    def with_symbols(self, outcome: Next) -> Next:
        """The condition of a requirement, which the machine evaluates with plain values: what branches on one has no graph."""
        state = outcome.config.state
        if state.reading("boolean-random") == "operator":
            raise NotLifted("the condition of a requirement is short-circuit, others are not")
        return outcome._replace(config=outcome.config._replace(state=state._replace(deciding=False)))

    def answer(self, draw: Draw) -> object:
        """The symbol for what is drawn; heads for a coin that is one, and what follows is then evaluated only in some runs."""
        if not draw.otherwise:
            return draw_symbol(replace_distribution(draw, self.draws), self.made)
        coin = draw.distribution.sample(numbers_of(draw, self.made))
        if not isinstance(coin, Traced):
            return bool(coin)
        after = draw.resume(True)
        if self.made.conditions or after.state.reading("require-time") == "end":
            raise NotLifted("a soft requirement within another, or at the end")
        assert isinstance(draw.distribution, Coin)
        self.made.graph.coins[coin.node.number] = float(draw.distribution.probability)
        self.made.begin(coin.node, True)
        self.partial_runs.append((after.stack[1], after.state))
        return True

    def watch(self, outcome: Outcome, drawn: object) -> None:
        """Refuse what a graph cannot say, and note where evaluation begins that only some runs need."""
        found, self.made.partial = self.made.partial, None
        if isinstance(outcome, Next):
            if outcome.change is not None and outcome.change.where == "print":
                raise NotLifted("the program prints")
            if self.made.conditions:
                check_pure(outcome)
        if found is not None:
            if not isinstance(outcome, Next) or outcome.config.stack is not found.end:
                raise NotLifted("a function that library code calls depends on a random value")
            self.made.begin(found.condition, found.expected)
            self.partial_runs.append((found.end, outcome.config.state))

    def beyond(self, outcome: Stuck) -> Config | None:
        """Return the point at which a run goes on after its requirement became an event, or fails whatever is
        drawn. Raises `Impossible`, `Retry`.
        """
        if outcome.beyond is None:
            return self.rejected_in_case(outcome)
        events = self.made.graph.events
        if len(events) == self.events:  # it fails in all runs that come here
            never_holds(outcome.requirement, self.made)
        elif events[-1].requirement is not outcome.requirement:
            return None
        return outcome.beyond

    def rejected_in_case(self, outcome: Stuck) -> Config | None:
        """Return the point after the rejected case, when a container is filtered case by case."""
        end, state = self.partial_runs[-1] if self.partial_runs else ((None, ()), None)
        if state is None or not isinstance(end[0], SelectingInCases):
            return None
        assert self.made.condition is not None
        self.made.graph.events.append(GraphEvent("require", self.made.condition, False, outcome.requirement))
        return Config(Value([]), end, state)


def never_holds(requirement: Requirement, made: Recorder) -> None:
    """Make an event of a requirement that fails whatever is drawn: it rejects all runs that come here.

    Raises `Impossible` where all runs come here or are rejected before, `Retry` where nothing is drawn.
    """
    if made.condition is not None:
        made.graph.events.append(GraphEvent("require", made.condition, False, requirement))
        return
    if all(map(only_rejects, made.graph.events)):
        raise Impossible(requirement, made.decision)
    number = next((node for node in made.graph.nodes if isinstance(node.function, Site)), None)
    if number is None:
        raise Retry(requirement.text)
    never = made.node(np.less, (number, 0.0), "bool", False)  # what is drawn is in [0, 1)
    made.graph.events.append(GraphEvent("require", never, True, requirement))


def check_pure(outcome: Next) -> None:
    """Refuse statements and calls that change something in what is not evaluated in every run, and exceptions, which leave it."""
    node, control = outcome.node, outcome.config.control
    pure = not isinstance(node, Statement) or isinstance(node, PURE) or is_local(outcome)
    stores = isinstance(node, p.Call) and isinstance(node.function, p.Attribute) and node.function.name in STORED
    if not pure or stores or (isinstance(control, Abrupt) and control.kind == "raise"):
        raise NotLifted("what is evaluated only in some runs changes something, or raises an exception")


def is_local(outcome: Next) -> bool:
    """Whether a statement is an assignment to variables of a function of the program: they end with its call."""
    node, scope = outcome.node, outcome.config.state.sigma
    if not isinstance(node, s.Assignment) or scope.kind != "function":
        return False
    return all(assigned_variables(target) and set(target_names(target)) <= scope.names.local for target in node.targets)


def check_unchanged(before: State, after: State) -> None:
    """Refuse changes of the scene by what is evaluated only in some runs."""
    if any(getattr(before, name) is not getattr(after, name) for name in ("scene", "params", "ego", "workspace", "late", "dynamic", "objects")):
        raise NotLifted("what is evaluated only in some runs makes an object or point, or changes the scene")


def numbers_of(draw: Draw, made: Recorder) -> Callable[[], Any]:
    """The numbers of a draw, as symbols."""
    used = 0

    def uniform() -> Any:
        nonlocal used
        used += 1
        return made.site(draw.address, used - 1, draw.per_scene)

    return uniform


def draw_symbol(draw: Draw, made: Recorder) -> object:
    """Return the value of a draw: the distribution's own map of numbers, on symbols; or row by row if it
    takes no fixed number of them.
    """
    try:
        drawn = draw_from_choice(draw.distribution, numbers_of(draw, made), made)
        if drawn is NotImplemented:
            drawn = draw_in_general(draw, made)
    except EmptyRegion as empty:
        raise Retry(str(empty)) from None
    except UnboundedRegion as unbounded:
        raise NotLifted(str(unbounded)) from None
    if isinstance(draw.distribution, PointIn):
        made.graph.points[draw.address] = (draw.distribution.region, drawn)
    return drawn


def draw_in_general(draw: Draw, made: Recorder) -> object:
    """Draw by the distribution's own map of numbers on symbols, or row by row where it takes no fixed number of them."""
    if has_spread(draw.distribution):
        return made.call(one_of, (draw.distribution, numbers_of(draw, made)()), {})
    if is_mapped(draw.distribution):
        return draw.distribution.sample(numbers_of(draw, made))
    return draw_by_rows(draw, made)


def has_spread(distribution: Distribution) -> bool:
    """Whether it is among the items of a container of which there are not as many in every run."""
    return isinstance(distribution, Uniform) and any(isinstance(unwrap(v)[0], Spread) for v in distribution.values)


def one_of(distribution: Uniform, number: float) -> object:
    """Return the value of a distribution over all items of some containers in one run. Raises `NothingToDraw`
    if there are none.
    """
    values = [item for v in distribution.values for item in (v.container if isinstance(v, Spread) else (v,))]
    if not values:
        raise NothingToDraw(distribution.name)
    return Uniform(tuple(values)).sample(lambda: number)


def is_mapped(distribution: Distribution) -> bool:
    """Whether the distribution is sampled by a map of a fixed number of uniform numbers without loops."""
    if isinstance(distribution, PointIn):
        region: Region = distribution.region
        while isinstance(region, Workspace):
            region = region.region
        return isinstance(region, MAPPED_REGIONS)
    return isinstance(distribution, MAPPED)


def draw_by_rows(draw: Draw, made: Recorder) -> object:
    """The draw as a single operation."""
    stream = Stream(0, 0, 0)
    distribution = in_row(draw.distribution, lambda node: node.example)
    example = distribution.sample(stream.at(draw.address))  # type: ignore[attr-defined]
    if not isinstance(example, Vector):
        raise NotLifted("a draw that is made row by row gives no point")
    node = made.node(RowDraw(draw.distribution, draw.address, draw.per_scene), (), "object", example, object())
    requirement = Requirement("region", draw.node.span, "a region to draw a point from is not empty")
    made.graph.events.append(GraphEvent("call", node, requirement=requirement, condition=made.condition))
    return made.vector(node, example)


__all__ = ["Lifted", "trace_program"]

