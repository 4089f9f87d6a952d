"""Warnings: what in a program does no harm and is still, most likely, a mistake: a property or a given parameter that nothing
reads, an import that nothing uses.

Every property of an object is written with the scene, so that one that nothing reads may be meant for whoever reads scenes. It is warned about
where its name is nearly that of a property that is read; where a class gives it a default, only if letters are swapped or in another case.
Library modules are not warned about.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

from ..semantics.kernel.classes import BUILT_IN_CLASSES, SPELLINGS
from ..semantics.kernel.kinds import SPATIAL_PROPERTIES
from ..semantics.kernel.scopes import descendants
from ..semantics.kernel.suggestions import did_you_mean, nearest
from ..semantics.syntax import Node, Program, Span
from ..semantics.syntax import dynamics as d
from ..semantics.syntax import statements as s
from ..semantics.syntax.python_expressions import Attribute, Constant, Name
from ..semantics.syntax.specifiers import WithSpecifier
from .modules import HARMLESS, Library, module_named


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
    known |= {*SPELLINGS, *SPATIAL_PROPERTIES, *read, *_declared(inside)}
    mentioned = set(_mentioned(nodes)) | set(_mentioned(inside))
    declared = set(_declared(nodes))
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
            yield ProgramWarning(UNREAD, f"nothing reads the property {name}", place_of(name, node.span, lines), f"did you mean {near}?")


def place_of(name: str, span: Span, lines: list[str]) -> Span:
    """The first place of a name in a stretch of the text."""
    column = lines[span.line - 1].find(name, span.column - 1) if span.line <= len(lines) else -1
    return span if column < 0 else span._replace(column=column + 1, end_line=span.line, end_column=column + 1 + len(name))


def _declared(nodes: list[Node]) -> Iterator[str]:
    """The properties to which classes give a default value."""
    return (node.name for node in nodes if isinstance(node, s.PropertyDefault))


def _mentioned(nodes: list[Node]) -> Iterator[str]:
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
                text, place = f"nothing reads the parameter {one.name}", place_of(one.name, one.span, lines)
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
        known |= set(_mentioned(nodes))
    return known


OF_SIMULATORS = (
    "weather", "time", "timestep", "time_step", "render", "record", "address", "port", "timeout", "traffic_manager_port",
    "carla_map", "lgsvl_map", "sumo_map", "webots_map", "use2DMap", "realTime", "verifaiSamplerType", "snapToGroundDefault",
)  # fmt: skip
"""Parameters that the simulators of the releases read."""
PARAMS = "globalParameters"
WRITTEN = "it is written with the scenes, and a simulator is told of it; the program does nothing with it"


def _meant_param(name: str, known: Collection[str], read: Mapping[str, Collection[str]]) -> str:
    """What to do about a parameter that nothing reads."""
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
