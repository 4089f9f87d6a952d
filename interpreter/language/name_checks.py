"""Static checks of names: `global` and `nonlocal` as Python has them, and words of the language that lack what belongs behind them."""

from __future__ import annotations

from collections.abc import Iterator

from ...semantics.store.errors import CheckError
from ...semantics.store.scopes import OPAQUE, Names, bound_by, function_names
from ...semantics.syntax import Node, Program
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import ObjectDefinition, ObjectOrOperator, ObjectOrValue
from ...semantics.syntax.python_expressions import Call, Comprehension, Lambda, Name, Parameter, Subscript, TupleDisplay
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
