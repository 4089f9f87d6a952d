"""What is compiled of a program: each behavior, monitor and condition once, however many simulations there are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ...semantics.kernel.errors import GuardViolation, InvariantViolation, PreconditionViolation
from ...semantics.kernel.scopes import ByIdentity, Scope, function_names
from ...semantics.kernel.values import Dynamic
from ...semantics.syntax import dynamics as d
from ...semantics.syntax.nodes import Expression, Node
from ...semantics.syntax.statements import Block
from .leaving import Untranslated
from .statements import condition, coroutine


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


class Library:
    """What is compiled of a program under its `readings`, and what is left to the machine, with the reason: coroutines (`left`), whole simulations
    (`wholes`, with how many). It is not `usable` under readings that only the machine follows.
    """

    def __init__(self, readings: Mapping[str, str]) -> None:
        self.readings = readings
        self.codes: dict[ByIdentity, Code | Untranslated] = {}
        self.conditions: dict[ByIdentity, Callable[[Any, Scope], Any]] = {}
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

    def condition(self, node: Node, scope: Scope, *, decides: bool) -> Callable[[Any, Scope], Any]:
        """A condition, or value to record, that a scenario declared, as a function of the `Equations` and its scope."""
        key = ByIdentity(node)
        found = self.conditions.get(key)
        if found is None:
            found = self.conditions[key] = condition(node, None, self.readings, plain_scope=scope.kind == "module", decides=decides)  # type: ignore[arg-type]
        return found
