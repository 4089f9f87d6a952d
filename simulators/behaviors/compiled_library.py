"""The compiled code of a program: each behavior, monitor and condition once, however many simulations there
are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

from ...semantics.machine.host_calls import HostException
from ...semantics.machine.values import Dynamic, Function
from ...semantics.python.functions import bind
from ...semantics.store.errors import GuardViolation, InvariantViolation, PreconditionViolation
from ...semantics.store.scopes import ByIdentity, Names, Scope, function_names
from ...semantics.syntax import dynamics as d
from ...semantics.syntax.nodes import Expression, Node
from ...semantics.syntax.python_expressions import Parameter
from ...semantics.syntax.statements import Block
from .fallback import Untranslated
from .operations import function_report_name
from .translate_expressions import syntax_size
from .translate_statements import OF_METHOD, SCOPES, condition, coroutine, function_body


class CompiledGuard(NamedTuple):
    """A precondition or invariant: whether it holds, in a scope; where it stands; the exception of one that does not, and what that tells."""

    holds: Callable[[Any, Any], bool]
    node: Expression
    violation: type[GuardViolation]
    text: str


class Code(NamedTuple):
    """A behavior or monitor: the generator function of its body, and its guards."""

    run: Callable[[Any, Scope, Any], Any]
    preconditions: tuple[CompiledGuard, ...] = ()
    invariants: tuple[CompiledGuard, ...] = ()


class FunctionCode(NamedTuple):
    """A function or lambda: what its body does in a scope, how large it is, and the names of its parameters where each is one of its own."""

    run: Callable[[Any, Scope], Any]
    size: int
    names: tuple[str, ...] | None

    def bindings(
        self, function: Function, arguments: tuple[Any, ...], names: tuple[str, ...], named: tuple[Any, ...]
    ) -> dict[str, Any] | None:
        """The variables of a call, whose keywords have these `names` and values; None where arguments do not fit."""
        known = self.names
        if known is None:
            try:
                return bind(function.name, function.parameters, function.defaults, arguments, dict(zip(names, named)))
            except HostException:
                return None
        if len(arguments) > len(known):
            return None
        bound = dict(zip(known, arguments))
        for name, value in zip(names, named):
            if name in bound or name not in known:
                return None
            bound[name] = value
        if len(bound) < len(known):
            for name in known:
                if name not in bound:
                    if name not in function.defaults:
                        return None
                    bound[name] = function.defaults[name]
        return bound


@dataclass(frozen=True, slots=True, eq=False)
class FunctionKey:
    """A function or lambda as a key of a cache; keys are equal if their bodies begin with the same node."""

    body: Block | Node
    parameters: tuple[Parameter, ...]
    names: Names

    @property
    def first(self) -> Node:
        """The first node of the body."""
        return self.body[0] if isinstance(self.body, tuple) else self.body

    def __hash__(self) -> int:
        return object.__hash__(self.first)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FunctionKey) and other.first is self.first


@lru_cache(maxsize=16_384)
def function_code(key: FunctionKey, scopes: str, readings: tuple[tuple[str, str], ...]) -> FunctionCode | Untranslated:
    """The code of a function or lambda, made once for a process: the functions of world models are the same in every program."""
    try:
        run = function_body(key.body, key.names, dict(readings), scopes)
    except Untranslated as problem:
        return problem
    simple = all(q.kind == "positional" for q in key.parameters)
    size = syntax_size(*(key.body if isinstance(key.body, tuple) else (key.body,)))
    return FunctionCode(run, size, tuple(q.name for q in key.parameters) if simple else None)


def scopes_of(scope: Scope) -> str:
    """Return where a function whose scope is within this one finds its variables
    (`statements.function_body`).
    """
    if scope.kind == "module":
        return SCOPES
    return OF_METHOD if scope.kind == "class" and scope.parent is not None and scope.parent.kind == "module" else ""


class Library:
    """The compiled code of a program under its `readings`, and the parts left to the machine, with the
    reason: coroutines (`left`), functions (`functions_left`, by what they are; in `nanoseconds` how long the
    machine ran them), whole simulations (`wholes`, with how many).

    It is not `usable` under readings that only the machine follows.
    """

    def __init__(self, readings: Mapping[str, str]) -> None:
        self.readings = readings
        self.codes: dict[ByIdentity, Code | Untranslated] = {}
        self.conditions: dict[ByIdentity, Callable[[Any, Scope], Any]] = {}
        self.functions: dict[int, tuple[object, FunctionCode | None]] = {}
        self.functions_left: dict[str, str] = {}
        self.nanoseconds: Counter[str] = Counter()
        self.left: dict[ByIdentity, str] = {}
        self.wholes: Counter[str] = Counter()
        self.usable = readings["invariant-of-caller"] == "on-return"

    def code_of(self, behavior: Dynamic) -> Code:
        """The code of a behavior. Raises `Untranslated`."""
        definition = behavior.definition
        found = self.codes.get(ByIdentity(definition))
        if found is None:
            found = self.noted(definition, lambda: self.behavior(definition, plain_scope=behavior.scope.kind == "module"))  # type: ignore[arg-type]
        if isinstance(found, Untranslated):
            raise found
        return found

    def monitor(self, body: Block, scope: Scope) -> Code:
        """The code of a monitor with this body, in its scope. Raises `Untranslated`."""
        found = self.codes.get(ByIdentity(body[0]))
        if found is None:
            plain_scope = scope.parent is not None and scope.parent.kind == "module"
            found = self.noted(body[0], lambda: Code(coroutine(body, scope.names, self.readings, plain_scope=plain_scope, has_agent=False)))
        if isinstance(found, Untranslated):
            raise found
        return found

    def noted(self, node: Node, compiled: Callable[[], Code]) -> Code | Untranslated:
        """The code of what a node says, or why there is none, kept for the next time."""
        found: Code | Untranslated
        try:
            found = compiled()
        except Untranslated as problem:
            found = problem
        self.codes[ByIdentity(node)] = found
        return found

    def behavior(self, definition: d.BehaviorDefinition, *, plain_scope: bool) -> Code:
        """The code of a definition. Raises `Untranslated`."""

        def guards(word: str, violation: type[GuardViolation], conditions: tuple[Expression, ...]) -> tuple[CompiledGuard, ...]:
            return tuple(
                CompiledGuard(
                    condition(c, definition, self.readings, plain_scope=plain_scope, decides=True), c, violation,
                    f"the {word} of {definition.name} on line {c.span.line}",
                )
                for c in conditions
            )  # fmt: skip

        run = coroutine(definition.body, function_names(definition), self.readings, plain_scope=plain_scope, has_agent=True)
        before = guards("precondition", PreconditionViolation, definition.preconditions)
        return Code(run, before, guards("invariant", InvariantViolation, definition.invariants))

    def function(self, function: Function) -> FunctionCode | None:
        """The code of a function of the program; None where the machine runs it."""
        found = self.functions.get(id(function.body))
        if found is None:
            key = FunctionKey(function.body, function.parameters, function.names)
            code = function_code(key, scopes_of(function.scope), tuple(sorted(self.readings.items())))
            if isinstance(code, Untranslated):
                self.functions_left[function_report_name(function)] = code.reason
                code = None
            found = self.functions[id(function.body)] = function.body, code  # which is kept, so that nothing else gets its number
        return found[1]

    def condition(self, node: Node, scope: Scope, *, decides: bool) -> Callable[[Any, Scope], Any]:
        """A condition, or value to record, that a scenario declared, as a function of the `Equations` and its scope."""
        key = ByIdentity(node)
        found = self.conditions.get(key)
        if found is None:
            found = self.conditions[key] = condition(node, None, self.readings, plain_scope=scope.kind == "module", decides=decides)  # type: ignore[arg-type]
        return found
