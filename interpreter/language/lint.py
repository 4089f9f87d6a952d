"""Warnings: what in a program does no harm and is still, most likely, a mistake, and what a run need not come to."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import NamedTuple

from ...semantics.dynamics.actions import to_run
from ...semantics.machine.operand_kinds import SPATIAL_PROPERTIES
from ...semantics.python.expression_statements import RUN_BY
from ...semantics.store.built_in_classes import BUILT_IN_CLASSES, SPELLINGS
from ...semantics.store.scopes import children, descendants, target_names
from ...semantics.store.suggestions import did_you_mean, nearest, undefined_name_hint
from ...semantics.syntax import Node, Program, Span
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import expressions as e
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import ObjectOrValue
from ...semantics.syntax.python_expressions import (
    Attribute,
    BooleanOperation,
    Call,
    Comparison,
    Comprehension,
    ComprehensionClause,
    Constant,
    Lambda,
    ListDisplay,
    Name,
    Parameter,
    TupleDisplay,
    UnaryOperation,
)
from ...semantics.syntax.specifiers import FacingSpecifier, WithSpecifier
from .modules import HARMLESS, Library, key_of, module_named
from .printer import to_source


class ProgramWarning(NamedTuple):
    """One warning: of which kind it is, its sentence, its place, and how to mend it."""

    kind: str
    message: str
    span: Span
    hint: str


UNREAD, UNUSED, UNREAD_PARAM = "unread property", "unused import", "unread parameter"
UNKNOWN, DEGREES, ONE_VALUE = "unknown name", "heading in degrees", "one value"
NO_EFFECT, BAD_WEIGHT = "no effect", "negative weight"
IMPLAUSIBLE = "implausible map"
KINDS = {
    UNREAD_PARAM: "nothing reads or sets a global parameter that was given from outside, or nothing reads one of the program"
    " whose name is nearly that of one that is read",
    UNREAD: "nothing reads a property, and its name is nearly that of one that is read",
    UNKNOWN: "nothing binds a name that a function, behavior, monitor or scenario uses, or a condition or value of a"
    " simulation",
    NO_EFFECT: "a statement does nothing where it stands, such as `take` in a monitor or a loop in which no time passes",
    BAD_WEIGHT: "a weight of `do choose` or `do shuffle` is a negative number",
    DEGREES: "a heading, or a number that an angle is compared with, is more than a full turn in radians",
    ONE_VALUE: "Uniform is given one list, in place of the values in it; a distance or angle is that from ego to ego;"
    " or `and` or `or` joins actions, behaviors or scenarios, of which it gives one",
    IMPLAUSIBLE: "a map of one's own is so large or so small that its coordinates are most likely others than those that are read",
    UNUSED: "nothing uses what an import gives, and the module does nothing else",
}
"""The kinds of warnings, and when each is given."""


def warnings_of(program: Program, library: Library, read: Collection[str], *, trust: bool) -> list[ProgramWarning]:
    """The warnings about properties and imports. `read` are the properties that simulators read; Python code may read any."""
    nodes = [node for statement in program.statements for node in descendants(statement)]
    return [*_unused_imports(program, nodes, library), *([] if trust else _unread_properties(program.text, nodes, library, read))]


# Properties


def _unread_properties(text: str, nodes: list[Node], library: Library, read: Collection[str]) -> Iterator[ProgramWarning]:
    """Properties that are given in the program and read nowhere, with the one that each is nearly called."""
    inside = [n for module in library.values() if isinstance(module, Program) for st in module.statements for n in descendants(st)]
    known = {name for class_ in BUILT_IN_CLASSES.values() for name in class_.defaults}
    known |= {*SPELLINGS, *SPATIAL_PROPERTIES, *read, *_declared_properties(inside)}
    mentioned = set(_mentioned_names(nodes)) | set(_mentioned_names(inside))
    declared = set(_declared_properties(nodes))
    lines = text.splitlines()
    for node in nodes:
        if isinstance(node, WithSpecifier) and node.property not in declared:
            name, meant = node.property, known | declared
        elif isinstance(node, s.PropertyDefault):
            name, meant = node.name, [one for one in known if sorted(one.casefold()) == sorted(node.name.casefold())]
        else:
            continue
        near = nearest(name, [one for one in meant if one not in SPATIAL_PROPERTIES]) if name not in known | mentioned else None
        if near is not None:
            yield ProgramWarning(UNREAD, f"nothing reads the property {name}", name_span(name, node.span, lines), f"did you mean {near}?")


def name_span(name: str, span: Span, lines: list[str]) -> Span:
    """The first place of a name in a stretch of the text."""
    column = lines[span.line - 1].find(name, span.column - 1) if span.line <= len(lines) else -1
    return span if column < 0 else span._replace(column=column + 1, end_line=span.line, end_column=column + 1 + len(name))


def _declared_properties(nodes: list[Node]) -> Iterator[str]:
    """The properties to which classes give a default value."""
    return (node.name for node in nodes if isinstance(node, s.PropertyDefault))


def _mentioned_names(nodes: list[Node]) -> Iterator[str]:
    """The names of attributes, and the texts, by which a property may be read."""
    for node in nodes:
        if isinstance(node, Attribute):
            yield node.name
        elif isinstance(node, Constant) and isinstance(node.value, str):
            yield node.value


# Global parameters


def unread_params(program: Program, library: Library, given: Collection[str], read: Mapping[str, Collection[str]]) -> list[ProgramWarning]:
    """Global parameters that were given from outside, and that neither the program nor a module of it reads or sets.

    `read` has the parameters that are read before a program runs, each with the modules that read it.
    """
    if any(isinstance(module, Exception) for module in library.values()):
        return []  # what is missing might read them
    nodes = [node for statement in program.statements for node in descendants(statement)] + _inside_modules(library)
    known = _params_read(nodes, library, read) | _params_set(nodes)
    whole = Span(program.file, 0, 0, 0, 0)
    return [
        ProgramWarning(UNREAD_PARAM, f"nothing reads or sets the parameter {name}", whole, _meant_param(name, known, read))
        for name in given if name not in known
    ]


def misspelt_params(
    program: Program, library: Library, read: Mapping[str, Collection[str]]
) -> Iterator[ProgramWarning]:
    """Global parameters that the program sets and nothing reads, with names that are nearly those of others that modules
    read or set.
    """
    if any(isinstance(module, Exception) for module in library.values()):
        return
    nodes, inside = [n for statement in program.statements for n in descendants(statement)], _inside_modules(library)
    known = _params_read(nodes + inside, library, read) | _params_set(inside)
    lines = program.text.splitlines()
    for node in nodes:
        for one in node.assignments if isinstance(node, s.Param) else ():
            near = None if one.name in known or one.name in OF_SIMULATORS else nearest(one.name, known)
            if near is not None:
                text, place = f"nothing reads the parameter {one.name}", name_span(one.name, one.span, lines)
                yield ProgramWarning(UNREAD_PARAM, text, place, f"did you mean {near}?")


def _inside_modules(library: Library) -> list[Node]:
    """Every node of the modules in Scenic."""
    modules = [module for module in library.values() if isinstance(module, Program)]
    return [node for module in modules for statement in module.statements for node in descendants(statement)]


def _params_set(nodes: list[Node]) -> set[str]:
    """The global parameters that the nodes set."""
    return {one.name for node in nodes if isinstance(node, s.Param) for one in node.assignments}


def _params_read(nodes: list[Node], library: Library, read: Mapping[str, Collection[str]]) -> set[str]:
    """The global parameters that modules read before a program runs, and those that the nodes may read."""
    known = {name for name, modules in read.items() if any(module in library for module in modules)}
    if any(isinstance(node, Name) and node.name == PARAMS for node in nodes):
        known |= set(_mentioned_names(nodes))
    return known


OF_SIMULATORS = (
    "weather", "time", "timestep", "time_step", "render", "record", "address", "port", "timeout", "traffic_manager_port",
    "carla_map", "lgsvl_map", "sumo_map", "webots_map", "use2DMap", "realTime", "verifaiSamplerType", "snapToGroundDefault",
)  # fmt: skip
"""Parameters that the simulators of the releases read."""
PARAMS = "globalParameters"
WRITTEN = "it is written with the scenes, and a simulator is told of it; the program does nothing with it"


def _meant_param(name: str, known: Collection[str], read: Mapping[str, Collection[str]]) -> str:
    """Return the advice about a parameter that nothing reads."""
    if name in read:
        return f"the program has none of the modules that read it: {', '.join(read[name])}"
    return did_you_mean(name, known, WRITTEN)


# Imports


def _unused_imports(program: Program, nodes: list[Node], library: Library) -> Iterator[ProgramWarning]:
    """Names that imports at the top level bind and nothing uses, of modules that do nothing but define."""
    used = {node.name for node in nodes if isinstance(node, Name)}
    if "__all__" in used:
        return
    words = set(re.findall(r"\w+", _without_imports(program.text, nodes)))  # in an annotation, say, of which the tree knows nothing
    for statement in program.statements:
        if isinstance(statement, s.Import):
            named = [(one, one.alias or one.name.partition(".")[0], one.name) for one in statement.names]
        elif isinstance(statement, s.ImportFrom) and statement.module != "__future__":
            named = [(one, one.alias or one.name, "." * statement.level + statement.module) for one in statement.names]
        else:
            continue
        for one, name, module in named:
            if name not in used and not name.startswith("_") and name not in words and _only_defines(module, library):
                yield ProgramWarning(UNUSED, f"nothing uses the import {name}", one.span, "remove it")


def _without_imports(text: str, nodes: list[Node]) -> str:
    """The text with the imports taken out."""
    lines = re.split(r"\r\n|\r|\n", text.removeprefix("\ufeff"))
    for node in sorted(nodes, key=lambda node: (node.span.line, node.span.column), reverse=True):  # from right to left, so that columns stay
        if isinstance(node, s.Import | s.ImportFrom):
            first, last = node.span.line, node.span.end_line
            for number in range(first, min(last, len(lines)) + 1):
                line = lines[number - 1]
                before = line[: node.span.column - 1] if number == first else ""
                lines[number - 1] = before + (line[node.span.end_column - 1 :] if number == last else "")
    return "\n".join(lines)


def _only_defines(name: str, library: Library) -> bool:
    """Whether nothing but its names would be missed of a module."""
    if name in HARMLESS:
        return True
    found = module_named(name, library)
    return isinstance(found, Program) and all(isinstance(statement, DEFINITIONS) for statement in found.statements)


DEFINITIONS = s.ClassDefinition | s.FunctionDefinition | d.BehaviorDefinition | d.ScenarioDefinition


OWN_NAMES = s.FunctionDefinition | d.BehaviorDefinition | d.MonitorDefinition | Lambda
"""What has a body with names of its own; a run of the program need not come to it, as to that of a scenario."""
OF_SIMULATIONS = (
    d.RequireAlways | d.RequireEventually | d.RequireMonitor | d.TerminateWhen | d.TerminateAfter | d.Record
)  # fmt: skip
"""Statements whose conditions and values are those of a simulation."""
FULL_TURN = math.tau + 1e-9


def slips(
    program: Program, library: Library, model: str | None, built_in: Collection[str], elsewhere: Mapping[str, tuple[str, ...]]
) -> Iterator[ProgramWarning]:
    """The warnings; `model` is the world model that was chosen from outside, `elsewhere` are the names of others."""
    nodes = [node for statement in program.statements for node in descendants(statement)]
    yield from _unknown_names(program, nodes, library, model, built_in, elsewhere)
    yield from _taken_in_vain(nodes)
    yield from _not_run(program, nodes, library, model)
    yield from _joined_invocations(program, nodes, _definitions(program, nodes, library, model))
    yield from _timeless_loops(nodes)
    yield from _from_ego_to_ego(program)
    lists = _lists(nodes)
    for node in nodes:
        match node:
            case FacingSpecifier(direction=angle) | WithSpecifier(property="heading", value=angle) | s.PropertyDefault(name="heading", value=angle):
                yield from _in_degrees(angle)
            case d.DoChoose(weights=weights) | d.DoShuffle(weights=weights):
                for weight in weights:
                    if (_constant(weight) or 0.0) < 0:
                        text = f"a weight must not be negative, and this one is {_constant(weight):g}"
                        hint = "write 0 for what is never to be chosen, or leave it out"
                        yield ProgramWarning(BAD_WEIGHT, text, weight.span, hint)
            case Comparison():
                yield from _compared_in_degrees(node)
            case s.Handler(type=Comparison() | BooleanOperation() | UnaryOperation(operator="not") as condition):
                source = to_source(condition, program.dialect)
                text = "behind `except` stands an exception, and this is a condition"
                yield ProgramWarning(NO_EFFECT, text, condition.span, f"write `interrupt when {source}:`")
            case Call(
                function=Name(name="Uniform"),
                arguments=(ListDisplay() | TupleDisplay() | Comprehension() | Call() | Name() as values,),
                keywords=(),
            ):
                if isinstance(values, Name) and values.name not in lists:
                    continue
                if isinstance(values, Call) and not _is_range(values, nodes):
                    continue
                text = "Uniform draws one of its arguments, and this is one: always the whole list"
                yield ProgramWarning(ONE_VALUE, text, values.span, _one_by_one(values, program.dialect))
            case _:
                pass


def _lists(nodes: list[Node]) -> set[str]:
    """The names that are bound once in the program, to a list or tuple that is written there."""
    often = Counter(_bound_names(nodes))
    given = (node for node in nodes if isinstance(node, s.Assignment) and _is_list(node.value))
    return {target.name for node in given for target in node.targets if isinstance(target, Name) and often[target.name] == 1}


def _is_list(value: Node) -> bool:
    """Whether an expression writes a list or a tuple."""
    return isinstance(value, ListDisplay | TupleDisplay) or (isinstance(value, Comprehension) and value.kind == "list")


def _is_range(call: Call, nodes: list[Node]) -> bool:
    """Whether a call is one of Python's `range`, or of `list`, `tuple` or `sorted`, which no name of the program hides."""
    function = call.function
    return isinstance(function, Name) and function.name in ("range", "list", "tuple", "sorted") and function.name not in set(_bound_names(nodes))


def _one_by_one(values: Node, dialect: str) -> str:
    """How `Uniform` is given the values themselves."""
    if isinstance(values, Name | Call):
        return f"write Uniform(*{to_source(values, dialect)})"
    return "write the values themselves: Uniform(1, 2, 3), or Uniform(*values)"


# Angles


def _in_degrees(angle: Node, what: str = "headings") -> Iterator[ProgramWarning]:
    """A heading or another angle beyond a full turn, as a number or as the limits of `Range`."""
    limits = angle.arguments if isinstance(angle, Call) and isinstance(angle.function, Name) and angle.function.name == "Range" else (angle,)
    numbers = [number for one in limits if (number := _constant(one)) is not None]
    largest = max(numbers, key=abs, default=0.0)
    if abs(largest) > FULL_TURN:
        meant_so = f"Range({', '.join(f'{number:g}' for number in numbers)}) deg" if len(numbers) > 1 else f"{largest:g} deg"
        text = f"{what} are in radians, and {largest:g} is more than a full turn"
        yield ProgramWarning(DEGREES, text, angle.span, f"for degrees write {meant_so}")


def _compared_in_degrees(node: Comparison) -> Iterator[ProgramWarning]:
    """An angle that is compared with a number beyond a full turn."""
    parts = (node.left, *node.operands)
    if any(_is_angle(part) for part in parts):
        for part in parts:
            yield from _in_degrees(part, "angles")


def _is_angle(node: Node) -> bool:
    """Whether an expression is an angle, by the operator or the property that it is of."""
    match node:
        case e.RelativeHeading() | e.ApparentHeading() | e.Angle() | Attribute(name="heading"):
            return True
        case Call(function=Name(name="abs"), arguments=(inner,)) | UnaryOperation(operand=inner):
            return _is_angle(inner)
        case _:
            return False


def _constant(node: Node) -> float | None:
    """The number that an expression writes; None for another one."""
    match node:
        case Constant(value=int() | float() as number) if not isinstance(number, bool):
            return float(number)
        case UnaryOperation(operator="-", operand=Constant(value=int() | float() as number)) if not isinstance(number, bool):
            return -float(number)
        case _:
            return None


# Statements without effect


def _taken_in_vain(nodes: list[Node]) -> Iterator[ProgramWarning]:
    """`take` in a monitor (reading `take-in-monitor`)."""
    for monitor in nodes:
        if isinstance(monitor, d.MonitorDefinition):
            for node in _inside(monitor):
                if isinstance(node, d.Take):
                    text = "`take` in a monitor has no effect: a monitor has no agent"
                    hint = "put it into a behavior; in a monitor `wait` lets a time step pass"
                    yield ProgramWarning(NO_EFFECT, text, node.span, hint)


def _timeless_loops(nodes: list[Node]) -> Iterator[ProgramWarning]:
    """A loop of a behavior or monitor that nothing ends, and in which no time passes."""
    for body in nodes:
        if isinstance(body, d.BehaviorDefinition | d.MonitorDefinition):
            for node in _inside(body):
                if not isinstance(node, s.While) or not isinstance(node.test, Constant) or not node.test.value:
                    continue
                if not any(isinstance(inner, LEAVING) for inner in _outside(node)):
                    text = "nothing ends this loop, and no time passes in it"
                    yield ProgramWarning(NO_EFFECT, text, node.test.span, "let a time step pass in it: `wait`, or `take` an action")


LEAVING = (
    d.Take | d.Wait | d.WaitFor | d.Do | d.DoChoose | d.DoShuffle | d.Abort | d.Terminate | s.Return | s.Break | s.Raise | s.Assert | s.Try
)  # fmt: skip
"""What ends a loop, or takes time in it."""


def _from_ego_to_ego(program: Program) -> Iterator[ProgramWarning]:
    """The distance or angle from ego to ego, where the other object of an operator is left out."""
    shared = (node for statement in program.statements for node in _outside(statement))
    for node in shared:
        match node:
            case (
                e.Distance(origin=None, target=Name(name="ego")) | e.Distance(origin=Name(name="ego"), target=None)
                | e.Angle(origin=None, target=Name(name="ego")) | e.Angle(origin=Name(name="ego"), target=None)
                | e.RelativeHeading(heading=Name(name="ego"), origin=None)
            ):
                text = "the object that is left out is ego, so that this is always 0"
                yield ProgramWarning(ONE_VALUE, text, node.span, "name the other object: `from ego to X`, or `of X from ego`")
            case _:
                pass


# Behaviors, scenarios and monitors that are called as functions, or taken as actions


def _not_run(
    program: Program, nodes: list[Node], library: Library, model: str | None
) -> Iterator[ProgramWarning]:
    """Statements in bodies that only make a behavior, scenario or monitor, and `take` of one, where the name is known."""
    known = _definitions(program, nodes, library, model)
    for body in nodes:
        if not isinstance(body, OWN_NAMES | d.ScenarioDefinition):
            continue
        for node in _inside(body):
            if isinstance(node, s.ExpressionStatement) and (kind := _kind_of(node.value, known)) is not None:
                text = f"the {_word(kind)} {to_source(node.value, program.dialect)} alone does nothing"
                yield ProgramWarning(NO_EFFECT, text, node.span, RUN_BY[kind])
            elif isinstance(node, d.Take) and not isinstance(body, d.MonitorDefinition):
                for action in _single_actions(node):
                    if (kind := _kind_of(action, known)) is not None:
                        source = to_source(action, program.dialect)
                        text = f"{source} is a {_word(kind)}, not an action"
                        hint = to_run(kind, source if isinstance(action, Call) else f"{source}()")
                        yield ProgramWarning(NO_EFFECT, text, action.span, hint)


def _joined_invocations(program: Program, nodes: list[Node], known: Mapping[str, type[Node]]) -> Iterator[ProgramWarning]:
    """Actions, behaviors or scenarios that `and` or `or` joins, which gives one of them."""
    functions = {node.name for node in nodes if isinstance(node, s.FunctionDefinition)}
    for node in nodes:
        match node:
            case d.Take():
                candidates, chance = tuple(_single_actions(node)), "`Uniform(...)`"
            case d.Do(invocations=candidates):
                chance = "`do choose`"
            case _:
                continue
        for one in candidates:
            if not isinstance(one, BooleanOperation):
                continue
            if isinstance(node, d.Take):
                kinds = ["action" if _makes_action(operand, functions) else "" for operand in one.operands]
            else:
                kinds = ["" if (kind := _kind_of(operand, known)) is None else _word(kind) for operand in one.operands]
            if all(kinds):
                hint = "write `,` for all of them at once" + (f", or {chance} for one of them by chance" if one.operator == "or" else "")
                yield ProgramWarning(ONE_VALUE, f"`{one.operator}` gives only one of these {kinds[0]}s", one.span, hint)


def _makes_action(node: Node, functions: Collection[str]) -> bool:
    """Whether an expression calls what is named like a class, and is no function of the program."""
    match node:
        case ObjectOrValue(value=inner):
            return _makes_action(inner, functions)
        case Call(function=Name(name=name)):
            return name[:1].isupper() and name not in functions
        case _:
            return False


def _single_actions(node: d.Take) -> Iterator[Node]:
    """The actions of `take`, those in lists and tuples one by one."""
    for action in node.actions:
        yield from action.items if isinstance(action, ListDisplay | TupleDisplay) else (action,)


def _definitions(
    program: Program, nodes: list[Node], library: Library, model: str | None
) -> dict[str, type[Node]]:
    """The names that are bound once, by the definition of a behavior, scenario or monitor, in the program or in modules
    that give it all names.
    """
    given = _names_of(program, library, model, set()) or set()
    modules = [module for module in library.values() if isinstance(module, Program)]
    inside = [node for module in modules for st in module.statements for node in descendants(st)]
    own = Counter(_bound_names(nodes))
    found: dict[str, type[Node]] = {}
    for where, names in ((inside, {name for name in given if name not in own}), (nodes, set(own))):
        often = own if where is nodes else Counter(_bound_names(where))
        for node in where:
            if isinstance(node, DYNAMIC) and node.name in names and often[node.name] == 1:
                found[node.name] = type(node)
    return found


def _kind_of(expression: Node, known: Mapping[str, type[Node]]) -> type[Node] | None:
    """Return the kind of definition that an expression names or calls, if that is known."""
    match expression:
        case ObjectOrValue(value=inner) | Call(function=inner):
            return _kind_of(inner, known)
        case Name(name=name):
            return known.get(name)
        case _:
            return None


def _word(kind: type[Node]) -> str:
    """The word for a kind of definition."""
    return kind.__name__.removesuffix("Definition").lower()


DYNAMIC = d.BehaviorDefinition | d.ScenarioDefinition | d.MonitorDefinition


# Names


def _unknown_names(
    program: Program, nodes: list[Node], library: Library, model: str | None, built_in: Collection[str], elsewhere: Mapping[str, tuple[str, ...]]
) -> Iterator[ProgramWarning]:
    """Names in bodies that neither the program binds anywhere, nor a module that it takes all names of, nor the language."""
    given = _names_of(program, library, model, set())
    if given is None:
        return
    shared = [node for statement in program.statements for node in _outside(statement)]
    declared = {name for node in nodes if isinstance(node, s.Global) for name in node.names}
    known = {*built_in, *given, *declared, *_bound_names(shared)}
    homes = {name: body for body in nodes if isinstance(body, OWN_NAMES) for name in _bound_names(_inside(body))}
    told: set[str] = set()
    for name, visible in _used_names(shared, known):
        if name.name not in visible and name.name not in told and not name.name.startswith("__"):
            told.add(name.name)
            hint = _told_of(homes[name.name]) if name.name in homes else undefined_name_hint(name.name, sorted(visible), elsewhere)
            yield ProgramWarning(UNKNOWN, f"{name.name} is not defined", name.span, hint)


def _used_names(shared: list[Node], known: set[str]) -> Iterator[tuple[Name, set[str]]]:
    """The names in what a run need not come to, each with the names that are bound where it stands."""
    for node in shared:
        if isinstance(node, OWN_NAMES):
            yield from _used_inside(node, known)
        elif isinstance(node, d.ScenarioDefinition | OF_SIMULATIONS):
            yield from ((inner, known) for inner in _outside(node) if isinstance(inner, Name))


def _used_inside(body: Node, visible: set[str]) -> Iterator[tuple[Name, set[str]]]:
    """The names in a body with names of its own, and in the bodies inside of it."""
    nodes = list(_inside(body))
    own = {*visible, *_bound_names(nodes)}
    for node in nodes:
        if isinstance(node, OWN_NAMES):
            yield from _used_inside(node, own)
        elif isinstance(node, Name):
            yield node, own


def _outside(node: Node) -> Iterator[Node]:
    """`node` and every node below it that is not in a body with names of its own."""
    pending = [node]
    while pending:
        current = pending.pop()
        yield current
        if not isinstance(current, OWN_NAMES):
            pending.extend(reversed(list(children(current))))


def _inside(body: Node) -> Iterator[Node]:
    """Every node of a body with names of its own that is not in another one inside of it."""
    return (node for child in children(body) for node in _outside(child))


def _told_of(body: Node) -> str:
    """Describe the binding of a name that cannot be seen from elsewhere."""
    what = body.name if isinstance(body, s.FunctionDefinition | d.BehaviorDefinition | d.MonitorDefinition) else "the lambda"
    return f"only {what} on line {body.span.line} has a variable of that name, its own"


def _bound_names(nodes: Iterable[Node]) -> Iterator[str]:
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
            found |= inner | set(_bound_names([node for statement in module.statements for node in descendants(statement)]))
        elif isinstance(module, Mapping):
            found |= set(map(str, module))
        else:
            return None
    return found

