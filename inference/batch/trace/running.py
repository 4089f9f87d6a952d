"""The machine run once on symbols: draws are answered by symbols, requirements become events, and the end is the scene in symbols."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from ....interpreter.choosers import AS_THEY_ARE, PER_SCENE, Draws, replaced
from ....interpreter.streams import Stream
from ....interpreter.walls import within
from ....semantics.kernel.config import Config, State, Value
from ....semantics.kernel.outcome import Done, Draw, Fault, Next, Observe, Requirement, Stuck
from ....semantics.kernel.scopes import target_names
from ....semantics.kernel.versions import STORED
from ....semantics.python.assignment import written
from ....semantics.space.distributions import Coin, Discrete, Distribution, Normal, PointIn, Range, TruncatedNormal, Uniform
from ....semantics.space.regions import (
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
from ....semantics.space.symbols import NotLifted
from ....semantics.space.vectors import Vector
from ....semantics.step import place, step
from ....semantics.syntax import python_expressions as p
from ....semantics.syntax import statements as s
from ..evaluate.plan import only_rejects
from .graph import Event, Graph, RowDraw, Site
from .lifting import lift
from .recording import Retry, Trace
from .structures import in_row
from .symbols import Traced

TRIES = 200
"""Runs that are tried until one is found in which all vector fields and regions have values."""
MAPPED = (Range, Normal, TruncatedNormal, Uniform, Discrete, Coin)
MAPPED_REGIONS = (CircularRegion, SectorRegion, RectangularRegion, PolygonalRegion, PolylineRegion, PointSetRegion)
PURE = frozenset({"S-Return", "S-Require", "S-Expression", "S-If", "S-While", "S-For", "S-Break"})


FEW = 5
"""How many of these may end with an error of the program."""


class Mistaken(NotLifted):
    """The run that was traced ends with an error of the program; others may not."""


class Impossible(NotLifted):
    """A requirement fails whatever is drawn: there are no scenes."""

    def __init__(self, requirement: Requirement) -> None:
        super().__init__(requirement.text)
        self.requirement = requirement


class Lifted(NamedTuple):
    """A program as a graph, and the state at its end, with symbols in it."""

    graph: Graph
    state: State


def trace(start: Callable[[], Config], fuel: int, draws: Draws = AS_THEY_ARE) -> Lifted:
    """The graph of a program. Raises `NotLifted` with the reason if it has none, `Impossible` if it has no scenes."""
    reason, errors = "", 0
    for attempt in range(TRIES):
        try:
            return trace_run(start(), attempt, fuel, draws)
        except Retry as retry:
            reason = str(retry)
        except Mistaken as mistake:
            reason, errors = str(mistake), errors + 1
            if errors == FEW:
                raise
    raise NotLifted(f"in {TRIES} runs this always failed: {reason}")


@within()
def trace_run(config: Config, attempt: int, fuel: int, draws: Draws = AS_THEY_ARE) -> Lifted:
    """The graph that the run of attempt `attempt` at scene 0 of seed 0 gives."""

    def number_at(site: Site) -> float:
        numbers = Stream(0, 0, PER_SCENE if site.per_scene else attempt).at(site.address)
        for _ in range(site.index):
            numbers()
        return numbers()

    door = config.state.settings.door
    made = Trace(number_at, door.budget)
    door.lift = partial(lift, made)
    made.place = lambda text: Requirement("field", place(config), text)
    partial_runs: list[tuple[object, State]] = []  # where what is evaluated in some runs only ends, and the state at its beginning
    try:
        for _ in range(fuel):
            events = len(made.graph.events)
            outcome = step(config)
            match outcome:
                case Next(config=after, change=change, where=where):
                    if change is not None and change.where == "print":
                        raise NotLifted("the program prints")
                    if made.conditions:
                        check_pure(outcome)
                    config = after
                    if where is not None:
                        made.begin(where.symbol.node, where.expected)  # type: ignore[attr-defined]
                        partial_runs.append((where.stack, config.state))
                case Draw() if outcome.otherwise:
                    coin = outcome.distribution.sample(numbers_of(outcome, made))
                    config = outcome.resume(bool(coin) if not isinstance(coin, Traced) else True)
                    if isinstance(coin, Traced):
                        if made.conditions or config.state.reading("require-time") == "end":
                            raise NotLifted("a soft requirement within another, or at the end")
                        made.begin(coin.node, True)
                        partial_runs.append((config.stack[1], config.state))
                case Draw():
                    config = outcome.resume(draw_symbol(replaced(outcome, draws), made))
                case Observe(config=after):
                    config = after
                case Stuck(requirement=requirement, beyond=beyond):
                    if beyond is not None and len(made.graph.events) == events:  # it fails in all runs that come here
                        config = never_holds(requirement, made, beyond)
                    elif beyond is not None and made.graph.events[-1].requirement is requirement:
                        config = beyond
                    else:
                        raise Retry(requirement.text)
                case Done(state=state):
                    return Lifted(made.graph, state)
                case Fault(error=error):
                    raise Mistaken(f"{error}")
            while partial_runs and type(config.control) is Value and config.stack is partial_runs[-1][0]:
                check_unchanged(partial_runs.pop()[1], config.state)
                made.conditions.pop()
        raise NotLifted("the program does not end")
    except NotLifted as problem:
        if made.imagined:
            raise Retry(str(problem)) from None
        raise
    finally:
        made.open = False
        door.lift = None


def never_holds(requirement: Requirement, made: Trace, beyond: Config) -> Config:
    """A requirement fails whatever is drawn: no run is accepted, or of a soft one those whose coin shows tails. Raises `Impossible`, `Retry`."""
    if made.condition is None:
        raise Impossible(requirement) if all(map(only_rejects, made.graph.events)) else Retry(requirement.text)
    made.graph.events.append(Event("require", made.condition, False, requirement))
    return beyond


def check_pure(outcome: Next) -> None:
    """Refuse statements and calls that change something in what is not evaluated in every run, and exceptions, which leave it."""
    node = outcome.node
    pure = not outcome.rule.startswith("S-") or outcome.rule in PURE or is_local(outcome)
    stores = isinstance(node, p.Call) and isinstance(node.function, p.Attribute) and node.function.name in STORED
    if not pure or stores or outcome.rule == "E-Raise":
        raise NotLifted("what is evaluated only in some runs changes something")


def is_local(outcome: Next) -> bool:
    """Whether a statement is an assignment to variables of a function of the program: they end with its call."""
    node, scope = outcome.node, outcome.config.state.sigma
    if not isinstance(node, s.Assignment) or scope.kind != "function":
        return False
    return all(written(target) and set(target_names(target)) <= scope.names.local for target in node.targets)


def check_unchanged(before: State, after: State) -> None:
    """Refuse changes of the scene by what is evaluated only in some runs."""
    if any(getattr(before, name) is not getattr(after, name) for name in ("scene", "params", "ego", "workspace", "late", "dynamic", "objects")):
        raise NotLifted("what is evaluated only in some runs changes the scene")


def numbers_of(draw: Draw, made: Trace) -> Callable[[], Any]:
    """The numbers of a draw, as symbols."""
    used = 0

    def uniform() -> Any:
        nonlocal used
        used += 1
        return made.site(draw.address, used - 1, draw.per_scene)

    return uniform


def draw_symbol(draw: Draw, made: Trace) -> object:
    """What a draw gives: the distribution's own map of numbers, on symbols; or row by row where it takes no fixed number of them."""
    try:
        drawn = draw.distribution.sample(numbers_of(draw, made)) if is_mapped(draw.distribution) else draw_by_rows(draw, made)
    except EmptyRegion as empty:
        raise Retry(str(empty)) from None
    except UnboundedRegion as unbounded:
        raise NotLifted(str(unbounded)) from None
    if isinstance(draw.distribution, PointIn):
        made.graph.points[draw.address] = (draw.distribution.region, drawn)
    return drawn


def is_mapped(distribution: Distribution) -> bool:
    """Whether the distribution is sampled by a map of a fixed number of uniform numbers without loops."""
    if isinstance(distribution, PointIn):
        region: Region = distribution.region
        while isinstance(region, Workspace):
            region = region.region
        return isinstance(region, MAPPED_REGIONS)
    return isinstance(distribution, MAPPED)


def draw_by_rows(draw: Draw, made: Trace) -> object:
    """The draw as a single operation."""
    stream = Stream(0, 0, 0)
    distribution = in_row(draw.distribution, lambda node: node.example)
    example = distribution.sample(stream.at(draw.address))  # type: ignore[attr-defined]
    if not isinstance(example, Vector):
        raise NotLifted("a draw that is made row by row gives no point")
    node = made.node(RowDraw(draw.distribution, draw.address, draw.per_scene), (), "object", example, object())
    requirement = Requirement("region", draw.node.span, "a region to draw a point from is not empty")
    made.graph.events.append(Event("call", node, requirement=requirement, condition=made.condition))
    return made.vector(node, example)


__all__ = ["Lifted", "trace"]
