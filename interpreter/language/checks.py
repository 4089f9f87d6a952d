"""Static checks: programs that parse but can never run (`take` outside a behavior, `return` outside a function, ...)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from ...semantics.store.errors import CheckError
from ...semantics.syntax import Block, Node, Program, Span, Statement
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import InInitialScenario, ObjectOrOperator
from ...semantics.syntax.python_expressions import (
    Call,
    Constant,
    Lambda,
    ListDisplay,
    Parameter,
    SetDisplay,
    Starred,
    TupleDisplay,
    UnaryOperation,
)
from .name_checks import declaration_faults, incomplete_statements
from .nesting import children

Home = Literal["the top level", "a setup block", "a compose block", "a behavior", "a monitor", "a function", "a class body"]

DECLARATIVE: tuple[Home, ...] = ("the top level", "a setup block")
DYNAMIC: tuple[Home, ...] = ("a behavior", "a monitor", "a compose block")


@dataclass(frozen=True, slots=True)
class StatementPlace:
    """The place of a statement: the definition around it, and whether a loop, an interruptible `try` or a
    function is.
    """

    home: Home = "the top level"
    in_loop: bool = False
    in_interruptible: bool = False
    in_function: bool = False


# Statement: where the paper permits it (Table "Statements", Sections "Statements" and 3.3), and its name in messages.
HOMES: dict[type[Statement], tuple[str, tuple[Home, ...]]] = {
    d.Take: ("take", ("a behavior", "a monitor")),
    d.Wait: ("wait", DYNAMIC),
    d.Terminate: ("terminate", DYNAMIC),
    d.Do: ("do", DYNAMIC),
    d.DoChoose: ("do choose", DYNAMIC),
    d.DoShuffle: ("do shuffle", DYNAMIC),
    d.Abort: ("abort", DYNAMIC),
    d.Override: ("override", ("a setup block", "a compose block")),
    d.RequireAlways: ("require always", (*DECLARATIVE, "a compose block")),
    d.RequireEventually: ("require eventually", (*DECLARATIVE, "a compose block")),
    d.RequireMonitor: ("require monitor", (*DECLARATIVE, "a compose block")),
    d.TerminateWhen: ("terminate when", (*DECLARATIVE, "a compose block")),
    d.MonitorDefinition: ("monitor", DECLARATIVE),
    d.ScenarioDefinition: ("scenario", DECLARATIVE),
    s.Model: ("model", DECLARATIVE),
    s.Return: ("return", ("a function", *DYNAMIC)),
}


def check_runnable(program: Program) -> None:
    """Raises CheckError for the first thing, in source order, that keeps `program` from running."""
    found = (*block_faults(program.statements, StatementPlace()), *declaration_faults(program), *incomplete_statements(program))
    faults = sorted(found, key=lambda fault: (fault.span.line, fault.span.column))
    if faults:
        raise faults[0]


def block_faults(statements: Iterable[Statement], place: StatementPlace) -> Iterator[CheckError]:
    """The faults of the statements of a block that stands at `place`."""
    for statement in statements:
        yield from _placement_faults(statement, place)
        yield from _content_faults(statement)
        for child in children(statement):
            if not isinstance(child, Statement):
                yield from _expression_faults(child, place)
        for block, inner in _blocks(statement, place):
            yield from block_faults(block, inner)


def _blocks(statement: Statement, place: StatementPlace) -> Iterator[tuple[Block, StatementPlace]]:
    """The blocks of a compound statement, each with its place."""
    match statement:
        case s.If():
            yield from ((statement.then, place), (statement.otherwise, place))
        case s.While() | s.For():
            yield from ((statement.body, replace(place, in_loop=True)), (statement.otherwise, place))
        case s.Try():
            inner = replace(place, in_interruptible=place.in_interruptible or bool(statement.interrupts))
            yield statement.body, inner
            yield from ((clause.body, inner) for clause in (*statement.interrupts, *statement.handlers))
            yield from ((statement.otherwise, inner), (statement.final, inner))
        case s.FunctionDefinition():
            yield statement.body, StatementPlace("a function", in_function=True)
        case s.ClassDefinition():
            yield statement.body, StatementPlace("a class body", in_function=place.in_function)
        case d.BehaviorDefinition():
            yield statement.body, StatementPlace("a behavior", in_function=True)
        case d.MonitorDefinition():
            yield statement.body, StatementPlace("a monitor", in_function=True)
        case d.ScenarioDefinition():
            yield statement.setup or (), StatementPlace("a setup block", in_function=True)
            yield statement.compose or (), StatementPlace("a compose block", in_function=True)
        case _:
            pass


def _placement_faults(statement: Statement, place: StatementPlace) -> Iterator[CheckError]:
    """Faults of where `statement` stands."""
    word, homes = HOMES.get(type(statement), ("", ()))
    if homes and place.home not in homes:
        hint = "; ".join(filter(None, [f"`{word}` belongs {name_places(*homes)}", _instead(statement, place.home)]))
        yield CheckError(f"`{word}` cannot stand {name_places(place.home)}", statement.span, hint=hint)
        return
    match statement:
        case d.Abort() if not place.in_interruptible:
            message = "`abort` stands outside of any `try` with `interrupt when`"
            yield CheckError(message, statement.span, hint="put it into a block of such a `try`")
        case s.Break() | s.Continue() if not place.in_loop:
            word = type(statement).__name__.lower()
            yield CheckError(f"`{word}` stands outside of any loop", statement.span)
        case s.Try() if statement.interrupts and place.home not in DYNAMIC:
            hint = f"it belongs {name_places(*DYNAMIC)}"
            text = f"`interrupt when` cannot stand {name_places(place.home)}"
            yield CheckError(text, statement.interrupts[0].span, hint=hint)
        case s.Nonlocal() if not place.in_function:
            text = f"`nonlocal` cannot stand {name_places(place.home)}"
            yield CheckError(text, statement.span, hint="there is no function around it")
        case s.ImportFrom() if not statement.names and place.home not in DECLARATIVE:
            text = f"`import *` cannot stand {name_places(place.home)}"
            yield CheckError(text, statement.span, hint="name what you import")
        case _:
            pass


def _instead(statement: Statement, home: Home) -> str:
    """Return what to write in place of `take`, `wait` or `do` in `home`, a place where none may stand; "" where nothing is likely."""
    if home == "a function" and isinstance(statement, d.Take | d.Wait | d.Do | d.DoChoose | d.DoShuffle):
        return "write `behavior` in place of `def`, and run it by `do NAME()`"
    if home in DECLARATIVE and isinstance(statement, d.Do) and statement.invocations:
        return "an object is given a behavior by `with behavior NAME()`"
    return ""


def name_places(*homes: Home) -> str:
    """Return the names of some places as they follow "cannot stand": `at the top level`, `in a behavior`, ..."""
    blocks = [home for home in homes if home != "the top level"]
    top = ["at the top level"] if len(blocks) < len(homes) else []
    return " or ".join(top + ([f"in {' or '.join(blocks)}"] if blocks else []))


def _content_faults(statement: Statement) -> Iterator[CheckError]:
    """Faults of what `statement` itself says."""
    match statement:
        case s.FunctionDefinition() | d.BehaviorDefinition() | d.MonitorDefinition() | d.ScenarioDefinition():
            yield from _parameter_faults(statement.parameters)
        case s.ClassDefinition():
            yield from _duplicates("property", [(item.name, item.span) for item in statement.properties])
        case s.Param():
            yield from _duplicates("parameter", [(item.name, item.span) for item in statement.assignments])
        case s.SoftRequire():
            yield from _probability_faults(statement)
        case s.Try():
            for handler in statement.handlers[:-1]:
                if handler.type is None:
                    yield CheckError("an `except` that catches everything must come last", handler.span)
        case _:
            pass


def _probability_faults(statement: s.SoftRequire) -> Iterator[CheckError]:
    """A literal probability outside [0, 1]."""
    node, sign = statement.probability, 1
    while isinstance(node, UnaryOperation) and node.operator in ("-", "+"):
        sign = -sign if node.operator == "-" else sign
        node = node.operand
    if not isinstance(node, Constant):
        return
    value = node.value
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= sign * value <= 1:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        percent = is_number and 2 <= sign * value <= 100  # type: ignore[operator]
        certain = "write `require` without brackets for what must always hold, or a number such as `require[0.5]`"
        hint = f"write {value / 100:g} for {value} %" if percent else certain  # type: ignore[operator]
        yield CheckError("the probability of a soft requirement must be a number from 0 to 1", statement.probability.span, hint=hint)


def _expression_faults(root: Node, place: StatementPlace) -> Iterator[CheckError]:
    """Faults in an expression, specifier or clause; blocks below it are not entered."""
    pending = [(root, False)]
    while pending:
        node, is_spread = pending.pop()
        match node:
            case Call():
                yield from _duplicates("keyword argument", [(k.name, k.span) for k in node.keywords if k.name is not None])
            case Lambda():
                yield from _parameter_faults(node.parameters)
            case InInitialScenario() if place.home not in DECLARATIVE:
                hint = "ask at the top level or in a setup block, and keep the answer in a variable"
                text = f"`in initial scenario` cannot stand {name_places(place.home)}"
                yield CheckError(text, node.span, hint=hint)
            case _:
                pass
        if isinstance(node, Starred) and not is_spread:
            yield CheckError("`*` needs a list, a tuple or a call around it", node.span)
        below = children(node) if not isinstance(node, ObjectOrOperator) else iter((node.as_operator,))
        spreads = isinstance(node, TupleDisplay | ListDisplay | SetDisplay | Call)
        pending.extend((child, spreads) for child in below if not isinstance(child, Statement))


def _parameter_faults(parameters: tuple[Parameter, ...]) -> Iterator[CheckError]:
    yield from _duplicates("parameter", [(parameter.name, parameter.span) for parameter in parameters])


def _duplicates(what: str, named: list[tuple[str, Span]]) -> Iterator[CheckError]:
    """A fault for each name that occurs a second time."""
    seen: set[str] = set()
    for name, span in named:
        if name in seen:
            yield CheckError(f"{what} `{name}` is given twice", span, hint="remove one of the two")
        seen.add(name)

