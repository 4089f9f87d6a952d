"""The making of a graph: every operation on symbols becomes a node; equal ones become one, and what is constant is computed at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from ...semantics.machine.host_calls import DoorStuck, HostException
from ...semantics.machine.outcome import Requirement
from ...semantics.machine.stuck_runs import UNMET, unmet_requirement
from ...semantics.machine.values import Bound, Native
from ...semantics.python.calls import invoke
from ...semantics.python.elementwise_builtins import select
from ...semantics.space.box_crowds import crowd_meets
from ...semantics.space.fields import OutsideField, PolygonalVectorField, VectorField
from ...semantics.space.numeric_functions import Elementary, is_macro, position_in
from ...semantics.space.symbol_seam import Listed, NotLifted
from ...semantics.space.vectors import Vector
from ...semantics.store.budget import Budget
from ...semantics.store.errors import ScenicError
from ...semantics.syntax.nodes import NOWHERE
from .graph import (
    AsFloat,
    Crowd,
    Graph,
    GraphEvent,
    GraphNode,
    HasValue,
    Kind,
    Lookup,
    Macro,
    Part,
    PartialRun,
    PositionOf,
    RowCall,
    Search,
    Site,
    bounds_of,
    decide_comparison,
    explain_decided_comparison,
)
from .symbolic import OPERATORS, Choice, Mistaken, Opaque, Retry, Scalar, Traced, in_row, symbols_in


class MacroGraph(NamedTuple):
    """The nodes of the numbers that a macro takes, those that are computed from them in order, and its result."""

    arguments: tuple[GraphNode, ...]
    nodes: tuple[GraphNode, ...]
    result: object


@lru_cache(maxsize=64)
def graph_of(macro: Macro) -> MacroGraph:
    """The graph of a macro, made once. Raises `NotLifted` if the course of its function depends on its arguments."""
    trace = Recorder(lambda site: 0.37 + 0.01 * site.index, Budget())
    symbols = [trace.site((), i, False) for i in range(sum(macro.shape))]
    for symbol in symbols:
        symbol.node.bounds = None
    found = Macro(macro.function.__wrapped__, macro.shape).call(symbols)  # type: ignore[attr-defined]
    if trace.graph.events:
        raise NotLifted(macro.function.__name__)
    nodes = tuple(node for node in trace.graph.nodes if not isinstance(node.function, Site))
    return MacroGraph(tuple(s.node for s in symbols), nodes, found.node if isinstance(found, Traced) else found)


PLAIN = (bool, int, float, str, type(None))


def siblings_of(value: object) -> tuple[object, ...]:
    """Return all values of the same kind, such as all lanes of a network; none where they cannot be listed."""
    return value.siblings if isinstance(value, Listed) else ()


def traced_function_name(function: object) -> str:
    """A function as reports call it."""
    if isinstance(function, Traced):
        return traced_function_name(function.example)
    if function is select:
        return "filter"
    owner = getattr(function, "__self__", function)
    return owner.name if isinstance(owner, (Native, Bound)) else getattr(function, "__qualname__", repr(function))


def premise_of(arguments: tuple[object, ...], text: str) -> str:
    """Return the premise of a call in words: that a field has a value, or a region a point."""
    fields = [a for a in arguments if isinstance(a, VectorField)]
    return OutsideField(fields[0], Vector(0.0, 0.0)).premise if fields else text


def bounds_of_field(subject: object = None, *rest: object) -> tuple[float, float] | None:
    """The least and greatest heading of a field with constant cells."""
    if not (isinstance(subject, PolygonalVectorField) and subject.cells and all(isinstance(h, (int, float)) for _, h in subject.cells)):
        return None
    headings = [float(h) for _, h in subject.cells] + ([] if subject.defaultHeading is None else [subject.defaultHeading])  # type: ignore[arg-type]
    return min(headings), max(headings)


def key_of(function: object, arguments: tuple[object, ...], keywords: Mapping[str, object]) -> object:
    """Return a key that is equal for calls that are one: the function and arguments that are nodes, numbers
    or the same object.
    """

    def part(value: object) -> object:
        if isinstance(value, Traced):
            return value.node if not isinstance(value, Choice) else (value.node, id(value.values))
        if isinstance(value, Vector):
            return part(value.x), part(value.y)
        return (type(value), value) if isinstance(value, PLAIN) else id(value)

    return ("call", function if not keywords else object(), *map(part, arguments))


AS_FLOAT = AsFloat()
MOST_NESTED = 16
"""A choice among more values than this stays nested if some of them are choices."""
LARGEST_PRODUCT = 256
"""Operations on two choices among few values are done once for every pair of values."""
TRUTH = frozenset({
    np.equal, np.not_equal, np.less, np.less_equal, np.greater, np.greater_equal, np.logical_and, np.logical_or, np.logical_xor, np.logical_not,
})  # fmt: skip


def is_constant_choice(value: object) -> TypeGuard[Choice]:
    """Return whether a value is a choice among values that are the same in all runs."""
    return isinstance(value, Choice) and not symbols_in(list(value.values))


class Recorder:
    """The graph of one run on symbols, while it is made; `conditions` are the nodes that say which runs come to what is being evaluated."""

    def __init__(self, number_at: Callable[[Site], float], budget: Budget) -> None:
        self.graph = Graph()
        self.budget = budget
        self.number_at = number_at
        self.known: dict[object, GraphNode] = {}
        self.conditions: list[GraphNode] = []
        self.partial: PartialRun | None = None  # what is reduced next
        self.counted: set[tuple[int, GraphNode | None]] = set()
        self.examined: set[int] = set()  # nodes of which the program has asked whether they are None
        self.place: Callable[[str], Requirement] = lambda text: Requirement("", NOWHERE, text)
        self.open = True
        self.decision = ""
        """The operator and the bounds of both sides, in words, of the last comparison that is false whatever is drawn; "" if it is true."""

    # Nodes

    def node(self, function: object, arguments: tuple[object, ...], kind: Kind, example: object, key: object = None) -> GraphNode:
        """The node of `function(*arguments)`: a known one if there is one."""
        self.check_open()
        key = (function, *(a if isinstance(a, GraphNode) else (type(a), a) for a in arguments)) if key is None else key
        found = self.known.get(key)
        if found is None:
            found = GraphNode(len(self.graph.nodes), function, arguments, kind, example, bounds_of(function, arguments))
            self.graph.nodes.append(found)
            self.known[key] = found
        return found

    def check_open(self) -> None:
        """Refuse operations after the run: nobody would try another one."""
        if not self.open:
            raise NotLifted("a random value outlived its run")

    def site(self, address: tuple[int, ...], index: int, per_scene: bool) -> Scalar:
        """The `index`-th number of a draw site."""
        site = Site(address, index, per_scene)
        node = self.node(site, (), "float", self.number_at(site))
        node.bounds = (0.0, 1.0 - 2.0**-53)
        return Scalar(self, node, node.example)

    def table(self, index: GraphNode, values: np.ndarray) -> Scalar:
        """The element of a constant array."""
        kind: Kind = "bool" if values.dtype == bool else "float"
        example = values[index.example].item()  # type: ignore[index]
        node = self.node(Lookup(values), (index,), kind, example, ("table", values.tobytes(), values.dtype.str, index))
        if kind == "float" and np.isfinite(values).all():
            node.bounds = (float(values.min()), float(values.max()))
        return Scalar(self, node, example)

    # Operations

    def apply_ufunc(self, function: np.ufunc, arguments: Sequence[object]) -> Any:
        """A function of NumPy or SciPy, or an operator, on numbers and truth values."""
        operands = [self.operand(a) for a in arguments]
        if not any(isinstance(a, GraphNode) for a in operands):
            result = function(*operands)
            return result.item() if isinstance(result, np.generic) else result
        constant = decide_comparison(function, tuple(operands))
        if constant is not None:
            self.decision = explain_decided_comparison(function, tuple(operands)) if constant is False else ""
            return constant
        if function in (np.logical_and, np.logical_or) and not all(isinstance(a, GraphNode) for a in operands):
            fixed = operands[0] if not isinstance(operands[0], GraphNode) else operands[1]
            if isinstance(fixed, bool):
                return fixed if fixed is (function is np.logical_or) else next(a for a in arguments if isinstance(a, Traced))
        with np.errstate(all="ignore"):
            example = function(*(a.example if isinstance(a, GraphNode) else a for a in operands))
        truth = function in TRUTH
        node = self.node(function, tuple(operands), "bool" if truth else "float", bool(example) if truth else float(example))
        return Scalar(self, node, node.example)

    def operand(self, value: object) -> object:
        """The node of a symbol, as a number or truth value; a constant as it is."""
        if isinstance(value, Scalar):
            return value.node
        if isinstance(value, Traced):
            return self.operand(value.number())
        if isinstance(value, bool):
            return value
        if isinstance(value, int):
            if abs(value) > 2**53:
                raise NotLifted("a whole number is too large for a float")
            return float(value)
        if isinstance(value, (float, np.floating)):
            return float(value)
        raise NotLifted(f"an operation on a number and a {type(value).__name__}")

    def operate(self, operation: Callable[..., object], arguments: tuple[object, ...]) -> Any:
        """An operator of Python; choices among few values are gone through, so that types stay as in Python."""
        choices = [a for a in arguments if isinstance(a, Choice)]
        if choices and not any(isinstance(a, Traced) and not isinstance(a, Choice) for a in arguments):
            mapped = self.over_choices(operation, arguments)
            if mapped is not NotImplemented:
                return mapped
        if any(isinstance(a, (tuple, list, Vector)) for a in arguments):
            return NotImplemented
        return self.apply_ufunc(OPERATORS[operation], arguments)

    def over_choices(self, operation: Callable[..., object], arguments: Sequence[object]) -> Any:
        """`operation` for every combination of values of the choices among the arguments, or NotImplemented if these are too many."""
        choices: dict[int, Choice] = {a.node.number: a for a in arguments if isinstance(a, Choice)}
        total = 1
        for choice in choices.values():
            total *= len(choice.values)
        if len(choices) > 1 and total > LARGEST_PRODUCT:
            return NotImplemented
        functions: list[Callable[[], object]] = []
        index: Any = None
        for combination in range(total):
            rest, at = combination, {}
            for number, choice in choices.items():
                rest, at[number] = divmod(rest, len(choice.values))
            values = (a.values[at[a.node.number]] if isinstance(a, Choice) else a for a in arguments)
            functions.append(partial(operation, *values))
        stride: float = 1.0
        for choice in choices.values():
            part = self.apply_ufunc(np.multiply, (self.as_float_node(choice.node), stride))
            index = part if index is None else self.apply_ufunc(np.add, (index, part))
            stride *= len(choice.values)
        position = next(iter(choices.values())).node if len(choices) == 1 else self.whole(index)
        return self.tabulate(position, functions, operation)

    def whole(self, index: Scalar) -> GraphNode:
        """A float that is a whole number as a position."""
        return self.node(int, (index.node,), "int", int(index.example))  # type: ignore[arg-type]

    def as_float_node(self, node: GraphNode) -> Scalar:
        """A whole number or truth value as a float."""
        made = self.node(AS_FLOAT, (node,), "float", float(node.example))  # type: ignore[arg-type]
        return Scalar(self, made, made.example)

    def as_float(self, symbol: Traced) -> Any:
        """A symbol whose values are numbers, as floats (truth values stay such)."""
        if isinstance(symbol, Scalar):
            return symbol
        assert isinstance(symbol, Choice)
        plain = [v for v in symbol.values if not symbols_in(v)]
        if not all(isinstance(v, (bool, int, float, Traced)) for v in symbol.values):
            raise NotLifted("a choice among values that are not numbers is used as a number")
        if len(plain) == len(symbol.values):
            if any(isinstance(v, int) and abs(v) > 2**53 for v in plain):
                raise NotLifted("a whole number is too large for a float")
            kind = bool if all(isinstance(v, bool) for v in plain) else float
            return self.table(symbol.node, np.array(plain, dtype=kind))
        result = symbol.values[-1]
        for position in range(len(symbol.values) - 2, -1, -1):
            here = self.apply_ufunc(np.equal, (self.as_float_node(symbol.node), float(position)))
            result = self.where(here, symbol.values[position], result)
        return result

    def where(self, condition: Any, then: Any, otherwise: Any) -> Any:
        """`then` where the condition holds, else `otherwise`."""
        if not isinstance(condition, Traced):
            return then if condition else otherwise
        operands = tuple(self.operand(a) for a in (condition, then, otherwise))
        example = operands[1] if condition.example else operands[2]
        example = example.example if isinstance(example, GraphNode) else example
        truth = all(isinstance(a, bool) or (isinstance(a, GraphNode) and a.kind == "bool") for a in operands[1:])
        node = self.node(np.where, operands, "bool" if truth else "float", example)
        return Scalar(self, node, example)

    # Choices

    def pick(self, position: Scalar, values: Sequence[object]) -> Any:
        """`values[int(position)]`."""
        index = position.node if position.node.kind == "int" else self.whole(position)
        return self.merge(index, values)

    def merge(self, index: GraphNode, results: Sequence[Any]) -> Any:
        """The result that the index chooses."""
        from ...semantics.machine.values import unwrap

        results = [unwrap(r)[0] for r in results]
        first = results[0]
        if all(r is first or (type(r) is type(first) and isinstance(r, PLAIN) and r == first and str(r) == str(first)) for r in results[1:]):
            return first
        if all(isinstance(r, Vector) for r in results):
            return Vector(self.numbers(index, [r.x for r in results]), self.numbers(index, [r.y for r in results]))
        if len(results) <= MOST_NESTED and any(map(is_constant_choice, results)):
            return self.flat_choice(index, results)
        return Choice(self, index, results)

    def flat_choice(self, index: GraphNode, results: Sequence[object]) -> Choice:
        """Return one choice in place of a choice among constant choices and other values.

        Otherwise a question to one of the inner choices would decide runs in which another one is chosen.
        """
        values: list[object] = []
        starts: list[int] = []
        for result in results:
            starts.append(len(values))
            values += result.values if is_constant_choice(result) else (result,)
        position: Any = self.table(index, np.array(starts, dtype=float))
        for number, result in enumerate(results):
            if is_constant_choice(result):
                here = self.apply_ufunc(np.equal, (self.as_float_node(index), float(number)))
                inner = self.apply_ufunc(np.add, (self.as_float_node(result.node), float(starts[number])))
                position = self.where(here, inner, position)
        return Choice(self, self.whole(position), values)

    def tabulate(self, index: GraphNode, functions: Sequence[Callable[[], object]], operation: object) -> Any:
        """Call all functions once, and return the result of the one that the index chooses.

        A function that fails decides the runs in which it is chosen. Returns NotImplemented where one of them makes an
        event of its own, and where some fail and others give symbols.
        """
        events = len(self.graph.events)
        results: list[Any] = []
        failures: dict[int, Requirement | Exception] = {}
        for position, function in enumerate(functions):
            try:
                results.append(function())
            except UNMET as problem:
                failures[position] = unmet_requirement(problem, NOWHERE)
            except Exception as problem:
                failures[position] = problem
            except (Mistaken, Retry):
                self.forget(events)
                return NotImplemented
            if position in failures:
                results.append(None)
        if len(self.graph.events) > events or (failures and symbols_in(results)):
            self.forget(events)
            return NotImplemented
        if failures:
            self.note_failures(index, failures, len(results), traced_function_name(operation))
            instead = results[index.example]  # type: ignore[call-overload]
            results = [instead if position in failures else result for position, result in enumerate(results)]
        return self.merge(index, results)

    def note_failures(
        self, index: GraphNode, failures: Mapping[int, Requirement | Exception], count: int, text: str
    ) -> None:
        """Make an event of the failures at some of the `count` positions of an index.

        A requirement rejects the runs, and any other failure leaves them to the interpreter. Raises `Retry` or `Mistaken`
        where the traced run has such a position.
        """
        here = failures.get(index.example)  # type: ignore[call-overload]
        if isinstance(here, Requirement):
            raise Retry(here.text)
        if here is not None:
            raise Mistaken(f"{text}: {here}")
        rejected, left, reasons = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), np.full(count, None)
        for position, failure in failures.items():
            rejects = isinstance(failure, Requirement)
            rejected[position], left[position], reasons[position] = rejects, not rejects, failure if rejects else None
        key = ("known", index, rejected.tobytes(), left.tobytes(), tuple(reasons))
        node = self.node(HasValue(rejected, left, reasons), (index,), "int", index.example, key)
        self.note_call(node, text)

    def note_call(self, node: GraphNode, text: str) -> None:
        """Make an event of a node that may have no value, unless there is one already for the runs that come here."""
        if not self.counted & {(node.number, None), *((node.number, condition) for condition in self.conditions)}:
            self.counted.add((node.number, self.condition))
            self.graph.events.append(GraphEvent("call", node, condition=self.condition, requirement=self.place(text)))

    def numbers(self, index: GraphNode, results: Sequence[Any]) -> Any:
        """The number that the index chooses."""
        merged = self.merge(index, results)
        return merged.number() if isinstance(merged, Traced) else merged

    # What is not made of operators

    def apply(self, function: Callable[..., object], arguments: tuple[object, ...], result: type | None) -> Any:
        """A function of symbols: the ones that have columns of their own, and any other row by row."""
        if function is np.where:
            return self.where(*arguments)
        if isinstance(function, Elementary):
            return self.elementary(function, arguments)
        if is_macro(function):
            return self.macro(function, arguments)
        if function is crowd_meets:
            return self.collision(*arguments)
        if function is position_in:
            cumulative, value = arguments
            array = np.array(cumulative, dtype=float)
            operand = self.operand(value)
            assert isinstance(operand, GraphNode)
            example = int(np.searchsorted(array, operand.example, side="right"))  # type: ignore[arg-type]
            node = self.node(Search(array), (operand,), "int", example, ("search", array.tobytes(), operand))
            return Scalar(self, node, example)
        return self.call(function, tuple(map(self.as_numbers, arguments)), {}, result)

    def elementary(self, function: Elementary, arguments: tuple[object, ...]) -> Any:
        """A function of the C library."""
        operands = tuple(self.operand(a) for a in arguments)
        example = function.safely(*(a.example if isinstance(a, GraphNode) else a for a in operands))  # type: ignore[misc]
        return Scalar(self, self.node(function, operands, "float", example), example)

    def macro(self, function: Callable[..., object], arguments: tuple[object, ...]) -> Any:
        """A function of numbers and vectors, as one node."""
        shape = tuple(2 if isinstance(a, Vector) else 1 for a in arguments)
        parts = [part for a in arguments for part in (a if isinstance(a, Vector) else (a,))]
        operands = tuple(self.operand(part) for part in parts)
        made = Macro(function, shape)
        example = bool(made.call([a.example if isinstance(a, GraphNode) else a for a in operands]))
        return Scalar(self, self.node(made, operands, "bool", example), example)

    def collision(self, closed: Any, *numbers: object) -> Any:
        """Whether any two of many boxes meet, as one node."""
        operands = tuple(map(self.operand, numbers))
        example = crowd_meets(closed, *(a.example if isinstance(a, GraphNode) else a for a in operands))  # type: ignore[arg-type]
        return Scalar(self, self.node(Crowd(closed), operands, "bool", example), example)

    def as_numbers(self, value: object) -> object:
        """A choice among numbers as a number, in vectors as well."""
        if isinstance(value, Vector):
            return Vector(self.as_numbers(value.x), self.as_numbers(value.y))  # type: ignore[arg-type]
        return value.number() if isinstance(value, Choice) and all(isinstance(v, (bool, int, float, Scalar)) for v in value.values) else value

    def call(
        self, function: Callable[..., object], arguments: tuple[object, ...], keywords: Mapping[str, object], result: type | None = None
    ) -> Any:
        """`function(*arguments, **keywords)`, row by row."""
        self.check_open()
        example_of = lambda node: node.example  # noqa: E731
        try:
            example = function(*in_row(arguments, example_of), **in_row(dict(keywords), example_of))  # type: ignore[misc]
        except UNMET as stuck:
            raise Retry(str(stuck)) from None
        except (ScenicError, HostException, DoorStuck, Exception) as problem:
            raise Mistaken(f"{traced_function_name(arguments[0] if function is invoke else function)}: {problem}") from None
        if symbols_in(example):
            raise NotLifted("a function gives a random value that it has hidden")
        if result is float and type(example) is not bool:
            example = float(example)  # type: ignore[arg-type]
        text = traced_function_name(arguments[0] if function is invoke else function)
        kind: Kind = "float" if type(example) is float else "bool" if type(example) is bool else "object"
        optional = kind == "object" and not isinstance(example, Vector)
        among = (*siblings_of(example), None) if optional and siblings_of(example) else ()
        call = RowCall(
            function, arguments, dict(keywords), type(example), result is float, text, self.budget, optional,
            frozenset(map(id, among)),
        )  # fmt: skip
        key = key_of(function, arguments, keywords)
        before = len(self.graph.nodes)
        node = self.node(call, (), kind, example, key)
        if node.number == before:
            node.bounds = bounds_of_field(*arguments) if kind == "float" else None
        self.note_call(node, premise_of(arguments, text))
        if isinstance(example, Vector):
            return self.vector(node, example)
        if among:
            found = PositionOf(among, {id(value): position for position, value in enumerate(among)})
            index = self.node(found, (node,), "int", found.positions[id(example)], ("position", node))
            return Choice(self, index, among)
        return Opaque(self, node, example) if kind == "object" else Scalar(self, node, example)

    def vector(self, node: GraphNode, example: Vector) -> Vector:
        """The vector that a node's object is."""
        return Vector(self.part(node, "x", example.x), self.part(node, "y", example.y))  # type: ignore[arg-type]

    def part(self, node: GraphNode, name: str, example: float) -> Scalar:
        """A number that is an attribute of a node's object."""
        return Scalar(self, self.node(Part(name), (node,), "float", float(example)), float(example))

    # Events

    def guard(self, symbol: Traced) -> bool:
        """The truth of a symbol in the traced run; other runs, where it differs, are not what the graph describes."""
        truth = self.truth(symbol)
        if isinstance(truth, Traced):
            where = self.place("what is drawn decides what happens")
            self.graph.events.append(GraphEvent("guard", truth.node, bool(truth.example), condition=self.condition, guarded=where))
            return bool(truth.example)
        return truth

    def truth(self, value: object) -> Any:
        """The truth of a value: a symbol for truth values, if it is not the same in all runs."""
        if isinstance(value, Opaque):
            return self.call(bool, (value,), {}, bool)
        if isinstance(value, Choice):
            chosen = self.merge(value.node, [self.truth(v) for v in value.values])
            return chosen.number() if isinstance(chosen, Traced) else chosen
        if isinstance(value, Scalar) and value.node.kind != "bool":
            return self.apply_ufunc(np.not_equal, (value, 0.0))
        return value if isinstance(value, Scalar) else bool(value)

    def require(self, requirement: Requirement, symbol: Traced) -> bool:
        """The truth of a symbol decides a requirement: runs in which it is False are rejected. Its truth in the traced run."""
        truth = self.truth(symbol)
        if isinstance(truth, Traced):
            self.graph.events.append(GraphEvent("require", truth.node, True, requirement, self.condition))
            return bool(truth.example)
        return truth

    def need(self, symbol: Opaque | Choice) -> None:
        """Suppose from here on that a value exists, or does not, as in the traced run; the interpreter does
        the runs in which that differs.

        If the program has asked before, these may be none. Raises `Retry` where the value is then None, and
        so of no known type.
        """
        if isinstance(symbol, Opaque) and symbol.node.number not in self.examined:
            self.settle(symbol)
        elif symbol.example is None:
            raise Retry("a value is None that is used as something else")
        else:
            self.suppose(symbol.there())

    def suppose(self, truth: Scalar) -> None:
        """Guard a truth value once in the same runs."""
        if not self.counted & {(~truth.node.number, condition) for condition in (None, *self.conditions)}:
            self.counted.add((~truth.node.number, self.condition))
            self.guard(truth)

    def settle(self, symbol: Opaque) -> None:
        """The interpreter does the runs in which a value is None and in the traced run is not, or the other way round."""
        symbol.node.function = replace(symbol.node.function, optional=False)  # type: ignore[type-var]

    def forget(self, number: int) -> None:
        """Take back the events after so many."""
        events = self.graph.events
        self.counted -= {(n, e.condition) for e in events[number:] for n in (e.node.number, ~e.node.number)}
        del events[number:]

    # What is evaluated in some runs only

    def begin(self, condition: GraphNode, expected: bool) -> None:
        """Evaluate from here on only in the runs in which the truth of `condition` is as expected, and in
        which the conditions around it hold as well.
        """
        here: Any = Scalar(self, condition, condition.example)
        here = here if expected else ~here
        outer = Scalar(self, self.condition, self.condition.example) if self.condition is not None else True
        both: Any = self.apply_ufunc(np.logical_and, (outer, here))
        if not isinstance(both, Traced):
            raise Retry("an operand is never reduced")
        self.conditions.append(both.node)

    @property
    def condition(self) -> GraphNode | None:
        """In which runs the machine reaches the place where it is: those in which this node is True, if there is one."""
        return self.conditions[-1] if self.conditions else None

    @property
    def rejected(self) -> bool:
        """Whether the traced run has failed a requirement, so that it would not reach the place where the machine is."""
        return any(
            e.kind == "require" and bool(e.node.example) is not e.expected and (e.condition is None or bool(e.condition.example))
            for e in self.graph.events
        )

    @property
    def imagined(self) -> bool:
        """Whether the traced run would not reach the place where the machine is."""
        return self.condition is not None and not self.condition.example


__all__ = ["Recorder"]

