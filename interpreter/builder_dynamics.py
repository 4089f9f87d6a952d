"""The part of the builder for behaviors, monitors, scenarios and the statements inside them."""



from __future__ import annotations

from dataclasses import dataclass, replace

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Block, Expression, Span, Statement
from ..semantics.syntax.dynamics import (
    Abort,
    BehaviorDefinition,
    Do,
    DoChoose,
    DoShuffle,
    MonitorDefinition,
    Override,
    Record,
    RequireAlways,
    RequireEventually,
    RequireMonitor,
    ScenarioDefinition,
    Take,
    Terminate,
    TerminateAfter,
    TerminateWhen,
    TimeLimit,
    Until,
    Wait,
    WaitFor,
)
from ..semantics.syntax.expressions import Seconds
from ..semantics.syntax.python_expressions import BinaryOperation, Constant, DictDisplay, UnaryOperation
from ..semantics.syntax.statements import ExpressionStatement
from .dialects import having
from .formulas import refuse_formulas
from .printer import to_source
from .time_conditions import instead, refuse_time
from .tree_builder import BuilderBase, Parts, condition

NOT_RECORDED = "leave the statement out, since `scenic-ref simulate -o` writes what happens"


@dataclass(frozen=True, slots=True)
class Guard:
    """A `precondition:` or `invariant:` line."""

    span: Span
    kind: str
    condition: Expression


@dataclass(frozen=True, slots=True)
class ScenarioPart:
    """The `setup` or `compose` block of a scenario."""

    span: Span
    kind: str
    body: Block


# Preconditions, invariants, statements, and the named blocks of a scenario.
Guarded = tuple[tuple[Expression, ...], tuple[Expression, ...], Block, dict[str, Block]]


class DynamicsBuilder(BuilderBase):
    """One method per rule of the grammar's dynamic and compositional statements."""

    # -- Definitions

    def make_behavior(self, span: Span, parts: Parts) -> BehaviorDefinition:
        name, parameters, (preconditions, invariants, body, _) = parts
        return BehaviorDefinition(
            span=span,
            name=self.identifier(name),
            parameters=parameters or (),
            preconditions=preconditions,
            invariants=invariants,
            body=body,
        )

    def make_monitor(self, span: Span, parts: Parts) -> MonitorDefinition:
        name, parameters, body = parts
        return MonitorDefinition(
            span=span, name=self.identifier(name), parameters=parameters or (), body=body, by_instance=self.dialect.monitor_instances
        )

    def make_monitor_without_parentheses(self, span: Span, parts: Parts) -> MonitorDefinition:
        name, body = parts
        if self.dialect.monitor_instances:
            hint = f"write `monitor {name}():`, and `require monitor {name}()` where it is to run"
            raise ParseError(f"a monitor of dialect {self.dialect.name} has parentheses", self.token_span(name), hint=hint)
        return MonitorDefinition(span=span, name=self.identifier(name), parameters=(), body=body)

    def make_scenario(self, span: Span, parts: Parts) -> ScenarioDefinition:
        name, parameters, (preconditions, invariants, body, blocks) = parts
        setup, compose = blocks.get("setup"), blocks.get("compose")
        rest = [statement for statement in body if not is_text(statement)]
        if rest and blocks:
            message = "a scenario with a `setup` or `compose` block has no statements outside of them"
            raise ParseError(message, rest[0].span, hint="move the statement into the `setup` block")
        return ScenarioDefinition(
            span=span,
            name=self.identifier(name),
            parameters=parameters or (),
            preconditions=preconditions,
            invariants=invariants,
            setup=setup if blocks or not body else body,
            compose=compose,
        )

    def make_guarded_block(self, span: Span, parts: Parts) -> Guarded:
        """Preconditions, invariants, statements and named blocks. Raises ParseError for guards that do not come first."""
        guards: dict[str, list[Expression]] = {"precondition": [], "invariant": []}
        statements: list[Statement] = []
        blocks: dict[str, Block] = {}
        for part in parts:
            if isinstance(part, Guard):
                if blocks or any(not is_text(statement) for statement in statements) or len(statements) > 1:
                    hint = "move it to the head of the definition"
                    raise ParseError(f"`{part.kind}` lines must come first in their definition", part.span, hint=hint)
                guards[part.kind].append(part.condition)
            elif isinstance(part, ScenarioPart):
                if part.kind in blocks:
                    raise ParseError(f"a scenario has one `{part.kind}` block only", part.span)
                if part.kind == "setup" and blocks:
                    raise ParseError("the `setup` block comes before the `compose` block", part.span)
                blocks[part.kind] = part.body
            else:
                statements.append(part)
        return tuple(guards["precondition"]), tuple(guards["invariant"]), tuple(statements), blocks

    make_scenario_block = make_guarded_block

    def make_precondition(self, span: Span, parts: Parts) -> Guard:
        return Guard(span, "precondition", refuse_time("precondition", condition(parts[0]), self.dialect))

    def make_invariant(self, span: Span, parts: Parts) -> Guard:
        return Guard(span, "invariant", refuse_time("invariant", condition(parts[0]), self.dialect))

    def make_setup(self, span: Span, parts: Parts) -> ScenarioPart:
        return ScenarioPart(span, "setup", parts[0])

    def make_compose(self, span: Span, parts: Parts) -> ScenarioPart:
        return ScenarioPart(span, "compose", parts[0])

    # -- Requirements over time

    def make_require_always(self, span: Span, parts: Parts) -> RequireAlways:
        part = self.without_formulas("require always", parts[0])
        return RequireAlways(span=span, condition=part, name=parts[1] or "")

    def make_require_eventually(self, span: Span, parts: Parts) -> RequireEventually:
        part = self.without_formulas("require eventually", parts[0])
        return RequireEventually(span=span, condition=part, name=parts[1] or "")

    def make_require_formula(self, span: Span, parts: Parts) -> RequireAlways | RequireEventually:
        word, operand, name = parts
        kind = RequireAlways if word.type == "ALWAYS" else RequireEventually
        return kind(span=span, condition=self.without_formulas(f"require {word}", operand), name=name or "")

    def without_formulas(self, word: str, node: Expression) -> Expression:
        """The condition `node` behind `word`. Raises `ParseError` for operators over time, and for a time."""
        part = refuse_time(word, condition(node), self.dialect)
        refuse_formulas(part, self.dialect, "")
        return part

    def make_require_monitor(self, span: Span, parts: Parts) -> RequireMonitor:
        word, monitor, name = parts
        if not self.dialect.monitor_instances:
            message = f"`require monitor` belongs to dialect {having('monitor_instances')}"
            raise ParseError(message, self.token_span(word), hint="leave it out: a monitor runs as soon as it is defined")
        return RequireMonitor(span=span, monitor=monitor, name=name or "")

    def make_terminate_when(self, span: Span, parts: Parts) -> TerminateWhen:
        part = refuse_time("terminate when", condition(parts[0]), self.dialect)
        return TerminateWhen(span=span, condition=part, name=parts[1] or "")

    def make_terminate_simulation_when(self, span: Span, parts: Parts) -> TerminateWhen:
        self.released("terminate simulation when", span, "write `terminate when ...`, without a name" if parts[1] else "write `terminate when ...`")
        part = refuse_time("terminate simulation when", condition(parts[0]), self.dialect)
        return TerminateWhen(span=span, condition=part, name=parts[1] or "", simulation=True)

    def make_terminate_after(self, span: Span, parts: Parts) -> TerminateAfter:
        limit: TimeLimit = parts[0]
        amount = to_source(limit.amount, self.dialect.name)
        hint = instead("terminate when", f"{amount} {limit.unit}", amount, released=False)
        self.released("terminate after", span, hint)
        return TerminateAfter(span=span, limit=limit)

    # -- Recording

    def make_record(self, span: Span, parts: Parts) -> Record:
        self.released("record", span, NOT_RECORDED)
        value, period, delay, name = parts
        if (period or delay) is not None and not self.dialect.explicit_new:
            raise ParseError(f"`every` and `after` belong to dialect {having('explicit_new')}", (period or delay).span)
        return Record(span=span, value=value, name=name or "", period=period, delay=delay)

    def make_record_initial(self, span: Span, parts: Parts) -> Record:
        self.released("record initial", span, NOT_RECORDED)
        return Record(span=span, value=parts[0], time="initial", name=parts[1] or "")

    def make_record_final(self, span: Span, parts: Parts) -> Record:
        self.released("record final", span, NOT_RECORDED)
        return Record(span=span, value=parts[0], time="final", name=parts[1] or "")

    # -- Inside behaviors, monitors and compose blocks

    def make_take(self, span: Span, parts: Parts) -> Take:
        return Take(span=span, actions=tuple(part for part in parts if part is not None))

    def make_wait(self, span: Span, parts: Parts) -> Wait:
        return Wait(span=span)

    def make_wait_for(self, span: Span, parts: Parts) -> WaitFor:
        return self.waiting(WaitFor(span=span, limit=parts[0]))

    def make_wait_until(self, span: Span, parts: Parts) -> WaitFor:
        node = self.waiting(WaitFor(span=span, limit=Until(span=span, condition=condition(parts[0]))))
        refuse_time("wait until", condition(parts[0]), self.dialect)
        return node

    def waiting(self, node: WaitFor) -> WaitFor:
        """The statement. Raises ParseError where the dialect lacks it."""
        if not self.dialect.explicit_new:
            raise ParseError(f"`wait` with a limit belongs to dialect {having('explicit_new')}", node.span, hint="write `wait` in a loop")
        return node

    def make_terminate(self, span: Span, parts: Parts) -> Terminate:
        return Terminate(span=span)

    def make_terminate_simulation(self, span: Span, parts: Parts) -> Terminate:
        self.released("terminate simulation", span, "write `terminate`")
        return Terminate(span=span, simulation=True)

    def make_abort(self, span: Span, parts: Parts) -> Abort:
        return Abort(span=span)

    def make_invocations(self, span: Span, parts: Parts) -> tuple[Expression, ...]:
        return tuple(parts)

    def make_do(self, span: Span, parts: Parts) -> Do:
        return Do(span=span, invocations=parts[0], limit=parts[1])

    def make_do_choose(self, span: Span, parts: Parts) -> DoChoose:
        invocations, weights = weighted(parts[0])
        return DoChoose(span=span, invocations=invocations, weights=weights, limit=parts[1])

    def make_do_shuffle(self, span: Span, parts: Parts) -> DoShuffle:
        invocations, weights = weighted(parts[0])
        return DoShuffle(span=span, invocations=invocations, weights=weights, limit=parts[1])

    def make_time_limit(self, span: Span, parts: Parts) -> TimeLimit:
        return parts[0]

    def make_duration(self, span: Span, parts: Parts) -> TimeLimit:
        return self.time_limit(span, parts, "for")

    def make_delay(self, span: Span, parts: Parts) -> TimeLimit:
        return self.time_limit(span, parts, "after")

    def make_period(self, span: Span, parts: Parts) -> TimeLimit:
        return self.time_limit(span, parts, "every")

    def time_limit(self, span: Span, parts: Parts, word: str) -> TimeLimit:
        """The time behind `word`. Raises `ParseError` where it has no unit and the dialect wants one."""
        amount, steps = parts
        if steps is not None:
            return TimeLimit(span=span, amount=amount, unit="steps")
        implied = self.dialect.released and not self.dialect.explicit_new  # in 2.1.0 a number alone is one of seconds
        return TimeLimit(span=span, amount=without_seconds(amount, word, implied=implied), unit="seconds")

    def make_until(self, span: Span, parts: Parts) -> Until:
        return Until(span=span, condition=refuse_time("until", condition(parts[0]), self.dialect))

    def make_override(self, span: Span, parts: Parts) -> Override:
        return Override(span=span, object=parts[0], specifiers=tuple(parts[1:]))


def is_text(statement: Statement) -> bool:
    """Whether `statement` is a lone string, as a docstring is."""
    if not isinstance(statement, ExpressionStatement):
        return False
    return isinstance(statement.value, Constant) and isinstance(statement.value.value, str)


def weighted(invocations: tuple[Expression, ...]) -> tuple[tuple[Expression, ...], tuple[Expression, ...]]:
    """The alternatives and their weights: a lone dictionary display gives both."""
    only = invocations[0]
    if len(invocations) > 1 or not isinstance(only, DictDisplay):
        return invocations, ()
    keys = tuple(key for key, _ in only.items if key is not None)
    if not keys or len(keys) < len(only.items):
        raise ParseError("expected `{alternative: weight, ...}`", only.span)
    return keys, tuple(weight for _, weight in only.items)


def without_seconds(amount: Expression, word: str, *, implied: bool = False) -> Expression:
    """The expression whose last word `seconds` was read as a postfix operator of its last operand, without that word; which may be `implied`.

    Raises `ParseError` for a time behind `word` that has no unit.
    """
    path: list[BinaryOperation | UnaryOperation] = []
    node = amount
    while isinstance(node, BinaryOperation) or (isinstance(node, UnaryOperation) and node.operator != "not"):
        path.append(node)
        node = node.right if isinstance(node, BinaryOperation) else node.operand
    if not isinstance(node, Seconds):
        if implied:
            return amount
        number = amount.value if isinstance(amount, Constant) else None
        written = f"{number:g}" if isinstance(number, int | float) else "..."
        hint = f"write `{word} {written} seconds` or `{word} {written} steps`"
        raise ParseError("a time limit needs a unit", amount.span, hint=hint)
    tree = node.value
    for outer in reversed(path):
        tree = replace(outer, right=tree) if isinstance(outer, BinaryOperation) else replace(outer, operand=tree)
    return tree
