"""Static checks: programs that parse but can never run (`take` outside a behavior, `return` outside a function, ...)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from ...semantics.store.errors import CheckError
from ...semantics.store.scopes import OPAQUE, Names, bound_by, function_names
from ...semantics.syntax import Block, Node, Program, Span, Statement
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import InInitialScenario, ObjectDefinition, ObjectOrOperator, ObjectOrValue
from ...semantics.syntax.python_expressions import (
    Call,
    Comprehension,
    Constant,
    Lambda,
    ListDisplay,
    Name,
    Parameter,
    SetDisplay,
    Starred,
    Subscript,
    TupleDisplay,
    UnaryOperation,
)
from .nesting import children

NEEDS = {
    "take": "an action", "do": "a behavior or a scenario", "override": "an object and specifiers", "require": "a condition",
    "param": "a parameter and its value", "record": "a value", "model": "the name of a world model", "simulator": "a simulator",
    "do choose": "behaviors or scenarios", "do shuffle": "behaviors or scenarios", "require always": "a condition",
    "require eventually": "a condition",
}  # fmt: skip
"""Statements that are no names alone, and what is missing there."""


def declaration_faults(program: Program) -> Iterator[CheckError]:
    """Return the faults of the declarations of a program."""
    yield from scope_faults(program.statements, frozenset(), ())


def scope_faults(blocks: tuple[Node, ...], parameters: frozenset[str], around: tuple[Names, ...]) -> Iterator[CheckError]:
    """Return the faults of one scope and of those inside it; `around` are the names of the functions around it."""
    used: dict[str, str] = {}
    for node in nodes_of_scope(blocks):
        if isinstance(node, s.Global | s.Nonlocal):
            yield from name_faults(node, used, parameters, around)
        elif isinstance(node, Name):
            used.setdefault(node.name, "used")
        else:
            used.update(dict.fromkeys(bound_by(node), "assigned"))
        if isinstance(node, s.ClassDefinition):
            yield from scope_faults(node.body, frozenset(), around)
        elif isinstance(node, d.ScenarioDefinition):
            yield from function_faults(node, (*(node.setup or ()), *(node.compose or ())), around)
        elif isinstance(node, s.FunctionDefinition | d.BehaviorDefinition | d.MonitorDefinition):
            yield from function_faults(node, node.body, around)


def function_faults(node: Node, body: tuple[Node, ...], around: tuple[Names, ...]) -> Iterator[CheckError]:
    """Return the faults inside a function, behavior, monitor or scenario."""
    parameters: tuple[Parameter, ...] = getattr(node, "parameters", ())
    yield from scope_faults(body, frozenset(parameter.name for parameter in parameters), (*around, function_names(node)))


def name_faults(
    node: s.Global | s.Nonlocal, used: dict[str, str], parameters: frozenset[str], around: tuple[Names, ...]
) -> Iterator[CheckError]:
    """Return what is wrong with the names of one `global` or `nonlocal`, as Python says it."""
    word = type(node).__name__.lower()
    for name in node.names:
        own = around[-1] if around else None
        if name in parameters:
            yield CheckError(f"`{word} {name}`: {name} is a parameter of this function", node.span, hint="give one of the two another name")
        elif own is not None and name in own.declared_global and name in own.declared_nonlocal:
            yield CheckError(f"{name} is declared both `global` and `nonlocal`", node.span, hint="remove one of the two")
        elif name in used:
            yield CheckError(f"{name} is {used[name]} before `{word} {name}`", node.span, hint=f"begin with `{word} {name}`")
        elif word == "nonlocal" and around and not any(name in names.local for names in around[:-1]):
            yield CheckError(f"`nonlocal {name}`: no function around this one has a variable {name}", node.span, hint="assign it there first")


def nodes_of_scope(blocks: tuple[Node, ...]) -> Iterator[Node]:
    """Return the nodes of one scope in the order of the source; of a definition its own node, not what is in it.

    A lambda and a comprehension have scopes of their own, but for default values and the first iterable.
    """
    pending = list(reversed(blocks))
    while pending:
        node = pending.pop()
        yield node
        match node:
            case Lambda(parameters=parameters):
                pending.extend(reversed([parameter.default for parameter in parameters if parameter.default is not None]))
            case Comprehension(clauses=(first, *_)):
                pending.append(first.iterable)
            case _ if not isinstance(node, OPAQUE):
                pending.extend(reversed(list(children(node))))
            case _:
                pass


SPECIFIERS = ("at", "on", "behind", "beyond", "following", "facing")
"""Specifiers whose keyword may as well be a name."""


def incomplete_statements(program: Program) -> Iterator[CheckError]:
    """Return a fault for each statement or specifier that is only its keyword, and each `mutate` with brackets, where the program has no variable
    of that name.
    """
    words: list[tuple[str, Node]] = []
    specifiers: list[Name] = []
    mutations: list[Node] = []
    bound: set[str] = set()
    pending: list[Node] = list(program.statements)
    while pending:
        node = pending.pop()
        match node:
            case s.ExpressionStatement(value=Name(name=name) | ObjectOrValue(value=Name(name=name))):
                words.append((name, node))
            case s.ExpressionStatement(value=Call(function=Name(name="mutate")) | Subscript(value=Name(name="mutate"))):
                mutations.append(node)
            case TupleDisplay(items=(first, *others)):
                if isinstance(first, ObjectDefinition | ObjectOrOperator):
                    specifiers += [item for item in others if isinstance(item, Name) and item.name in SPECIFIERS]
            case d.Do(invocations=(Name(name=name),)):
                words.append((f"do {name}", node))
            case s.Require(condition=Name(name=name)):
                words.append((f"require {name}", node))
            case s.ImportFrom(names=(), as_model=False):
                return  # which names that brings is not known
            case s.Model(name=name) if not name.startswith("scenic.") and name not in ("gtaLib", "mars"):
                bound.add("mutate")  # it may have a function of that name
            case s.Import() if program.dialect == "pldi19":
                bound.add("mutate")
            case Parameter(name=name):
                bound.add(name)
            case _:
                bound.update(bound_by(node))
        pending.extend(children(node))
    for word, node in words:
        if word in NEEDS and word.split()[-1] not in bound:
            yield CheckError(f"`{word}` needs {NEEDS[word]}", node.span, hint=f"write it behind `{word}`")
    for name in specifiers:
        if name.name not in bound:
            yield CheckError(f"`{name.name}` needs an argument", name.span, hint=f"write `{name.name} ...`")
    if "mutate" not in bound:
        for node in mutations:
            yield CheckError("`mutate` takes names without brackets", node.span, hint="write `mutate a, b`, or `mutate` alone for all objects")


Home = Literal["the top level", "a setup block", "a compose block", "a behavior", "a monitor", "a function", "a class body"]

DECLARATIVE: tuple[Home, ...] = ("the top level", "a setup block")
DYNAMIC: tuple[Home, ...] = ("a behavior", "a monitor", "a compose block")


@dataclass(frozen=True, slots=True)
class StatementPlace:
    """Where a statement stands: the definition around it, and whether a loop, an interruptible `try` or a function is."""

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


def check(program: Program) -> None:
    """Raises CheckError for the first thing, in source order, that keeps `program` from running."""
    found = (*block_faults(program.statements, StatementPlace()), *declaration_faults(program), *incomplete_statements(program))
    faults = sorted(found, key=lambda fault: (fault.span.line, fault.span.column))
    if faults:
        raise faults[0]


def block_faults(statements: Iterable[Statement], place: StatementPlace) -> Iterator[CheckError]:
    """The faults of the statements of a block that stands at `place`."""
    for statement in statements:
        yield from _misplaced(statement, place)
        yield from _malformed(statement)
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


def _misplaced(statement: Statement, place: StatementPlace) -> Iterator[CheckError]:
    """Faults of where `statement` stands."""
    word, homes = HOMES.get(type(statement), ("", ()))
    if homes and place.home not in homes:
        hint = "; ".join(filter(None, [f"`{word}` belongs {within(*homes)}", _instead(statement, place.home)]))
        yield CheckError(f"`{word}` cannot stand {within(place.home)}", statement.span, hint=hint)
        return
    match statement:
        case d.Abort() if not place.in_interruptible:
            message = "`abort` stands outside of any `try` with `interrupt when`"
            yield CheckError(message, statement.span, hint="put it into a block of such a `try`")
        case s.Break() | s.Continue() if not place.in_loop:
            word = type(statement).__name__.lower()
            yield CheckError(f"`{word}` stands outside of any loop", statement.span)
        case s.Try() if statement.interrupts and place.home not in DYNAMIC:
            hint = f"it belongs {within(*DYNAMIC)}"
            text = f"`interrupt when` cannot stand {within(place.home)}"
            yield CheckError(text, statement.interrupts[0].span, hint=hint)
        case s.Nonlocal() if not place.in_function:
            text = f"`nonlocal` cannot stand {within(place.home)}"
            yield CheckError(text, statement.span, hint="there is no function around it")
        case s.ImportFrom() if not statement.names and place.home not in DECLARATIVE:
            text = f"`import *` cannot stand {within(place.home)}"
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


def within(*homes: Home) -> str:
    """Return the names of some places as they follow "cannot stand": `at the top level`, `in a behavior`, ..."""
    blocks = [home for home in homes if home != "the top level"]
    top = ["at the top level"] if len(blocks) < len(homes) else []
    return " or ".join(top + ([f"in {' or '.join(blocks)}"] if blocks else []))


def _malformed(statement: Statement) -> Iterator[CheckError]:
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
                text = f"`in initial scenario` cannot stand {within(place.home)}"
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

