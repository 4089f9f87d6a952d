"""Warnings about what a run need not come to, or takes as it is: names in bodies that nothing binds, headings in degrees, `Uniform` of one list."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping

from ..semantics.kernel.scopes import descendants, target_names
from ..semantics.kernel.suggestions import meant
from ..semantics.syntax import Node, Program
from ..semantics.syntax import dynamics as d
from ..semantics.syntax import statements as s
from ..semantics.syntax.python_expressions import (
    Call,
    ComprehensionClause,
    Constant,
    Lambda,
    ListDisplay,
    Name,
    Parameter,
    TupleDisplay,
    UnaryOperation,
)
from ..semantics.syntax.specifiers import FacingSpecifier, WithSpecifier
from .modules import Library, key_of, module_named
from .warnings import DEGREES, ONE_VALUE, UNKNOWN, ProgramWarning

BODIES = s.FunctionDefinition | d.BehaviorDefinition | d.MonitorDefinition | d.ScenarioDefinition | Lambda
"""What has a body that a run of the program need not come to."""
FULL_TURN = math.tau + 1e-9


def slips(
    program: Program, library: Library, model: str | None, built_in: Collection[str], elsewhere: Mapping[str, tuple[str, ...]]
) -> Iterator[ProgramWarning]:
    """The warnings; `model` is the world model that was chosen from outside, `elsewhere` are the names of others."""
    nodes = [node for statement in program.statements for node in descendants(statement)]
    yield from _unknown_names(program, nodes, library, model, built_in, elsewhere)
    for node in nodes:
        match node:
            case FacingSpecifier(direction=angle) | WithSpecifier(property="heading", value=angle) | s.PropertyDefault(name="heading", value=angle):
                yield from _in_degrees(angle)
            case Call(function=Name(name="Uniform"), arguments=(ListDisplay() | TupleDisplay() as values,), keywords=()):
                text = "Uniform draws one of its arguments, and this is one: always the whole list"
                yield ProgramWarning(ONE_VALUE, text, values.span, "write the values themselves: Uniform(1, 2, 3), or Uniform(*values)")
            case _:
                pass


# Angles


def _in_degrees(angle: Node) -> Iterator[ProgramWarning]:
    """A heading beyond a full turn, as a number or as the limits of `Range`."""
    limits = angle.arguments if isinstance(angle, Call) and isinstance(angle.function, Name) and angle.function.name == "Range" else (angle,)
    numbers = [number for one in limits if (number := _constant(one)) is not None]
    largest = max(numbers, key=abs, default=0.0)
    if abs(largest) > FULL_TURN:
        meant_so = f"Range({', '.join(f'{number:g}' for number in numbers)}) deg" if len(numbers) > 1 else f"{largest:g} deg"
        text = f"headings are in radians, and {largest:g} is more than a full turn"
        yield ProgramWarning(DEGREES, text, angle.span, f"for degrees write {meant_so}")


def _constant(node: Node) -> float | None:
    """The number that an expression writes; None for another one."""
    match node:
        case Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case UnaryOperation(operator="-", operand=Constant(value=int() | float() as number)) if not isinstance(number, bool):
            return -float(number)
        case _:
            return None


# Names


def _unknown_names(
    program: Program, nodes: list[Node], library: Library, model: str | None, built_in: Collection[str], elsewhere: Mapping[str, tuple[str, ...]]
) -> Iterator[ProgramWarning]:
    """Names in bodies that neither the program binds anywhere, nor a module that it takes all names of, nor the language."""
    given = _names_of(program, library, model, set())
    if given is None:
        return
    known = {*built_in, *given, *_bound(nodes)}
    told: set[str] = set()
    for body in nodes:
        if isinstance(body, BODIES):
            for node in descendants(body):
                if isinstance(node, Name) and node.name not in known and node.name not in told and not node.name.startswith("__"):
                    told.add(node.name)
                    yield ProgramWarning(UNKNOWN, f"{node.name} is not defined", node.span, meant(node.name, sorted(known), elsewhere))


def _bound(nodes: list[Node]) -> Iterator[str]:
    """Every name that is bound somewhere, in whatever scope."""
    for node in nodes:
        match node:
            case s.Assignment(targets=targets) | s.Delete(targets=targets):
                for target in targets:
                    yield from target_names(target)
            case s.AugmentedAssignment(target=target) | s.For(target=target) | ComprehensionClause(target=target):
                yield from target_names(target)
            case s.Import(names=names):
                yield from (one.alias or one.name.partition(".")[0] for one in names)
            case s.ImportFrom(names=names):
                yield from (one.alias or one.name for one in names)
            case s.Global(names=names) | s.Nonlocal(names=names):
                yield from names
            case s.Handler(name=str(name)) | Parameter(name=name):
                yield name
            case s.FunctionDefinition(name=name) | s.ClassDefinition(name=name) | s.PropertyDefault(name=name):
                yield name
            case d.BehaviorDefinition(name=name) | d.MonitorDefinition(name=name) | d.ScenarioDefinition(name=name):
                yield name
            case _:
                pass


def _names_of(program: Program, library: Library, model: str | None, seen: set[int]) -> set[str] | None:
    """The names that modules give all of to a program; None where that cannot be told."""
    found: set[str] = set()
    modules = [] if model is None else [module_named(model, library)]
    for statement in program.statements:
        for node in descendants(statement):
            match node:
                case s.Model(name=name) if model is None:
                    modules.append(module_named(name, library))
                case s.ImportFrom(names=(), module=name, level=level):
                    modules.append(library.get(key_of(name, level, ".", library)))
                case s.Import(names=names) if program.dialect == "pldi19":
                    modules += [one for name in names if isinstance(one := module_named(name.name, library), Program)]
                case _:
                    pass
    for module in modules:
        if isinstance(module, Program):
            if id(module) in seen:
                continue
            seen.add(id(module))
            inner = _names_of(module, library, None, seen)
            if inner is None:
                return None
            found |= inner | set(_bound([node for statement in module.statements for node in descendants(statement)]))
        elif isinstance(module, Mapping):
            found |= set(map(str, module))
        else:
            return None
    return found
