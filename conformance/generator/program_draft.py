"""A program while it is being written: its variables with their kinds, what may still be used, and what that costs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from typing import Literal

from ...interpreter.language.nesting import children
from ...semantics.syntax import Expression, Node
from ...semantics.syntax import expressions as e
from ...semantics.syntax.python_expressions import Name
from .choice_sources import Choices
from .settings import ProgramSettings

Kind = Literal[
    "scalar", "heading", "vector", "boolean", "region", "field", "point", "object", "list", "dictionary", "function", "maker", "waiting", "lists"
]

FAR = 1e9
DISTRIBUTIONS = frozenset({"Range", "Uniform", "Discrete", "DiscreteRange", "Normal", "TruncatedNormal"})
FROM_EGO = (e.Angle, e.ApparentHeading, e.Distance, e.DistancePast, e.Follow, e.RelativeHeading, e.RelativePosition)
"""The operators that measure from ego where an operand is left out."""


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable: a scalar (the elements of a list, the result of a function) lies in [low, high], a vector within `high` of both axes.

    `random` says whether its value may be random; `ways` is the number of values if it was itself drawn, so that `resample`
    can draw it again, else 0. A function is called with scalars in the intervals `takes`; one call makes `cost` combined outcomes
    and `makes` objects. `size` is the least length of a list (of `lists`, which is a random one), `most` its greatest.
    """

    name: str
    kind: Kind
    low: float = -FAR
    high: float = FAR
    random: bool = True
    ways: int = 0
    takes: tuple[tuple[float, float], ...] = ()
    spreads: bool = False
    named: bool = False
    optional: int = 0
    cost: int = 1
    makes: int = 0
    size: int = 0
    most: int = 0


@dataclass(frozen=True, slots=True)
class Property:
    """A scalar property of a class of the program, with values in [low, high]."""

    name: str
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Class:
    """A class of the program: its scalar properties in the order in which they may depend on each other."""

    name: str
    properties: tuple[Property, ...] = ()
    cost: int = 1
    is_object: bool = True


@dataclass
class Draft:
    """The generator's knowledge at one place of the program that it writes; a draft belongs to one
    generation.
    """

    choices: Choices
    settings: ProgramSettings
    features: frozenset[str]
    variables: list[Variable] = field(default_factory=list)
    classes: list[Class] = field(default_factory=list)
    taken: int = 0
    ways: int = 1
    repeats: int = 1
    objects: int = 0
    has_ego: bool = False
    settled: bool = False
    drawless: bool = False
    own: tuple[Property, ...] = ()
    inside: Literal["program", "function", "loop"] = "program"

    def allows(self, feature: str) -> bool:
        """Whether this program may use a feature."""
        return feature in self.features

    @property
    def view_distance(self) -> str:
        """The name of the property that says how far an object sees."""
        return "visibleDistance" if self.allows("released") else "viewDistance"

    def is_random(self, node: Node) -> bool:
        """Whether an expression draws, or mentions a variable that may be random; ego, which may be, is mentioned where an operand is left out."""
        random = DISTRIBUTIONS | {v.name for v in self.variables if v.random}
        pending = [node]
        while pending:
            current = pending.pop()
            if isinstance(current, Name) and current.name in random:
                return True
            if isinstance(current, FROM_EGO) and any(getattr(current, each.name) is None for each in fields(current)):
                return True
            pending.extend(children(current))
        return False

    def fresh(self, letter: str) -> str:
        """A name that is not yet in use."""
        self.taken += 1
        return f"{letter}{self.taken}"

    def may_draw(self) -> bool:
        """Whether a distribution may stand here."""
        return not (self.settled or self.drawless)

    def afford(self, ways: int) -> bool:
        """Whether a draw with this number of values, made in every turn of the loops around, still fits; if so it is paid for."""
        if not self.settings.finite:
            return True
        total = self.ways * ways**self.repeats
        if total > self.settings.max_outcomes:
            return False
        self.ways = total
        return True

    @contextmanager
    def without_randomness(self) -> Iterator[None]:
        """Only values that no draw decides: for conditions of `if`, lengths, weights."""
        before, self.settled = self.settled, True
        try:
            yield
        finally:
            self.settled = before

    @contextmanager
    def without_draws(self) -> Iterator[None]:
        """No distribution, though random variables: for functions that library code calls."""
        before, self.drawless = self.drawless, True
        try:
            yield
        finally:
            self.drawless = before

    @contextmanager
    def block(self, repeats: int = 1) -> Iterator[None]:
        """A block that is run so often: what it defines is unknown afterwards."""
        known, classes, times = list(self.variables), list(self.classes), self.repeats
        self.repeats *= repeats
        try:
            yield
        finally:
            most = {v.name: v.most for v in self.variables}  # a list that became longer here is longer afterwards
            self.variables = [replace(v, most=max(v.most, most.get(v.name, 0))) for v in known]
            self.classes, self.repeats = classes, times

    @contextmanager
    def definition(self) -> Iterator[None]:
        """A body that is run when it is called: its draws are counted from 1, few of them are allowed."""
        ways, times = self.ways, self.repeats
        self.ways, self.repeats = max(1, self.settings.max_outcomes // 4), 1
        try:
            with self.block():
                yield
        finally:
            self.ways, self.repeats = ways, times

    def cost_so_far(self) -> int:
        """Inside a definition: the number of combined outcomes of one call."""
        return self.ways // max(1, self.settings.max_outcomes // 4) if self.settings.finite else 1

    def known(self, *kinds: Kind) -> list[Variable]:
        """The variables of these kinds that may be used here, the latest first."""
        return [v for v in reversed(self.variables) if v.kind in kinds and not (self.settled and v.random)]

    def define(self, variable: Variable) -> Variable:
        """Note a variable that the program has from here on."""
        self.variables = [*(v for v in self.variables if v.name != variable.name), variable]
        return variable


Option = tuple[int, Callable[[], Expression | None]]


def first_that_works(draft: Draft, options: Sequence[Option]) -> Expression:
    """The expression of a chosen option; where it finds none (a draw that cannot be afforded), of the first option, which always works."""
    chosen = draft.choices.weighted(options)()
    result = options[0][1]() if chosen is None else chosen
    assert result is not None
    return result
