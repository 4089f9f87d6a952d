"""Dynamic and compositional statements: the second group of Table "Statements", behaviors, monitors and scenarios."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .nodes import Expression, Node, Specifier, Statement
from .python_expressions import Parameter
from .statements import Block


@dataclass(frozen=True, slots=True, kw_only=True)
class BehaviorDefinition(Statement):
    """`behavior name(parameters): precondition/invariant lines, then body`."""

    name: str
    parameters: tuple[Parameter, ...]
    preconditions: tuple[Expression, ...]
    invariants: tuple[Expression, ...]
    body: Block


@dataclass(frozen=True, slots=True, kw_only=True)
class MonitorDefinition(Statement):
    """`monitor name[(parameters)]: body`; with `by_instance` (dialect `scenic-3`) it runs where `require monitor` says so."""

    name: str
    parameters: tuple[Parameter, ...]
    body: Block
    by_instance: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioDefinition(Statement):
    """`scenario name(parameters): preconditions, invariants, setup block, compose block`; a missing block is None."""

    name: str
    parameters: tuple[Parameter, ...]
    preconditions: tuple[Expression, ...]
    invariants: tuple[Expression, ...]
    setup: Block | None = None
    compose: Block | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RequireAlways(Statement):
    """`require always B [as name]`."""

    condition: Expression
    name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RequireEventually(Statement):
    """`require eventually B [as name]`."""

    condition: Expression
    name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RequireMonitor(Statement):
    """`require monitor M(...) [as name]` of dialect `scenic-3`."""

    monitor: Expression
    name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class TerminateWhen(Statement):
    """`terminate when B [as name]`; `terminate simulation when B` if it is about the `simulation`."""

    condition: Expression
    name: str = ""
    simulation: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TerminateAfter(Statement):
    """`terminate after S seconds` or `terminate after S steps`."""

    limit: TimeLimit


@dataclass(frozen=True, slots=True, kw_only=True)
class Record(Statement):
    """`record E [every T] [after T] [as name]`, `record initial E`, `record final E`: `time` says which values are kept.

    `period` and `delay` are read only: as in Scenic 3.1.1, the values of all time steps are kept.
    """

    value: Expression
    time: Literal["always", "initial", "final"] = "always"
    name: str = ""
    period: TimeLimit | None = None
    delay: TimeLimit | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Take(Statement):
    """`take action, ...`."""

    actions: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wait(Statement):
    """`wait`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitFor(Statement):
    """`wait for S seconds`, `wait for S steps` or `wait until B`."""

    limit: TimeLimit | Until


@dataclass(frozen=True, slots=True, kw_only=True)
class Terminate(Statement):
    """`terminate`; `terminate simulation` if it is about the `simulation`."""

    simulation: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeLimit(Node):
    """`for S seconds` or `for S steps`."""

    amount: Expression
    unit: Literal["seconds", "steps"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Until(Node):
    """`until B`."""

    condition: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Do(Statement):
    """`do invocation, ... [for S seconds | for S steps | until B]`."""

    invocations: tuple[Expression, ...]
    limit: TimeLimit | Until | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DoChoose(Statement):
    """`do choose A, B` or, with weights, `do choose {A: 2, B: 1}` (then `weights` is as long as `invocations`)."""

    invocations: tuple[Expression, ...]
    weights: tuple[Expression, ...] = ()
    limit: TimeLimit | Until | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DoShuffle(Statement):
    """`do shuffle A, B` or, with weights, `do shuffle {A: 2, B: 1}`."""

    invocations: tuple[Expression, ...]
    weights: tuple[Expression, ...] = ()
    limit: TimeLimit | Until | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Abort(Statement):
    """`abort`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Override(Statement):
    """`override name specifier, ...`."""

    object: Expression
    specifiers: tuple[Specifier, ...]
