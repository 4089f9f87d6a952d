"""A program of one dialect in another, with its comments: `convert`."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any

from ...semantics.store.built_in_classes import BUILT_IN_CLASSES
from ...semantics.store.errors import ParseError
from ...semantics.store.scopes import descendants
from ...semantics.syntax import Block, Node, Program, Statement
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import statements as s
from ...semantics.syntax.statements import PropertyDefault
from .dialects import DEFAULT, DIALECTS, MARK, Dialect
from .indentation import TAB
from .logical_lines import join_text
from .modules import with_old_imports
from .nesting import room, same
from .parser import normal, parse, tables
from .printer import INDENT, Item, StatementPrinter
from .tree_builder import TextOrigin

Place = tuple[int, int]
UNREACHED = 10**9
"""Deeper than any line is indented: of a block without lines of its own."""
LAYOUT = ("_NEWLINE", "_INDENT", "_DEDENT")


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment; `alone`: nothing else is in its line, which is indented by `width` columns."""

    place: Place
    text: str
    alone: bool
    width: int


@dataclass(frozen=True, slots=True)
class CodeLine:
    """A line of code, from its first character to behind its last one, indented by `width` columns."""

    start: Place
    end: Place
    width: int


class Comments:
    """The comments of a program, told one after the other, each once, while the lines of code that they belong to are printed in their order."""

    def __init__(self, program: Program) -> None:
        source = normal(program.text, TextOrigin(program.file))
        self.source = source.split("\n")[:-1]
        released = DIALECTS[program.dialect].released
        self.code = list(self.code_lines(source, DIALECTS[program.dialect]))
        self.pending = deque(self.comments(source, released))
        self.last = {self.code_at(place): place for place in sorted(map(node_start, statements_and_properties(program)))}
        """Where the last statement (or property) of a line of code begins."""
        self.told = 0
        """The last line of the file that is printed, or whose comment is."""
        self.inner = 0
        """How deep the block is indented whose head was told last."""
        self.mark = ""
        """What the comment that names the dialect says besides."""
        mark = MARK.match(source)
        if mark is not None:
            self.pending.popleft()
            self.mark, self.told = self.source[0][mark.end() :].rstrip(), 1

    def code_lines(self, source: str, dialect: Dialect) -> Iterator[CodeLine]:
        """The lines of code, as the layout tells them."""
        first = last = None
        joined = join_text(source, apart=not dialect.intervals)
        for token in tables(dialect.released).parse_interactive(joined.text, start="program").iter_parse():
            if token.type not in LAYOUT:
                first, last = first or token, token
            elif token.type == "_NEWLINE" and first is not None and last is not None:
                start = joined.place(first.line or 0, first.column or 0)
                end = joined.place(last.end_line or 0, last.end_column or 0)
                yield CodeLine(start, end, self.width(start))
                first = None

    def comments(self, source: str, released: bool) -> Iterator[Comment]:
        """The comments: what looks like one and is in no string."""
        terminals = [tables(released).get_terminal(name).pattern.to_regexp() for name in ("STRING", "FSTRING", "COMMENT")]
        line, begins = 1, 0
        for found in re.finditer("|".join(terminals), source):
            line, begins = line + source.count("\n", begins, found.start()), source.rfind("\n", 0, found.start()) + 1
            if found.group().startswith("#"):
                place = (line, found.start() - begins + 1)
                yield Comment(place, found.group().rstrip(), not source[begins : found.start()].strip(), self.width(place))

    def width(self, place: Place) -> int:
        """By how many columns the text at a place is indented, if nothing is before it."""
        return len(self.source[place[0] - 1][: place[1] - 1].replace("\f", "").expandtabs(TAB))

    def code_at(self, place: Place) -> int:
        """The number of the line of code that a place is in."""
        return bisect_right(self.code, place, key=lambda code: code.start) - 1

    def next_code(self) -> int:
        """The number of the first line of code that is not printed."""
        return bisect_right(self.code, self.told, key=lambda code: code.start[0])

    def above(self, number: int) -> Iterator[str]:
        """The lines of comments and the empty lines above a line of code, and the comments inside of it."""
        code = self.code[number]
        yield from self.until(code.start[0])
        yield from (comment.text for comment in self.taken(code.end))
        self.told = max(self.told, code.end[0])

    def behind(self, number: int) -> str:
        """The comment behind a line of code."""
        return "".join("  " + comment.text for comment in self.taken((self.code[number].end[0] + 1, 0)))

    def until(self, line: int) -> Iterator[str]:
        """The lines of comments and the empty lines that stand before a line of the file."""
        for number in range(self.told + 1, line):
            if self.pending and self.pending[0].place[0] <= number:
                yield from (comment.text for comment in self.taken((number + 1, 0)))
            elif not self.source[number - 1].strip():
                yield ""
        self.told = max(self.told, line - 1)

    def taken(self, place: Place) -> Iterator[Comment]:
        """The comments before a place."""
        while self.pending and self.pending[0].place < place:
            yield self.pending.popleft()

    def head(self, text: str, first: Place | None) -> Iterator[str]:
        """The head of a block, whose first statement (if any) is at a place; `inner` is then how deep the block is indented.

        What is printed as a head may be none in the source, as the `setup:` of a scenario without blocks.
        """
        number = self.next_code()
        inside = len(self.code) if first is None else self.code_at(first)
        if number < inside or (number == inside < len(self.code) and self.code[inside].start != first):
            yield from self.above(number)
            following = self.code[number + 1].width if number + 1 < len(self.code) else 0
            self.inner = following if following > self.code[number].width else UNREACHED
            yield text + (self.behind(number) if number < inside else "")
        else:
            self.inner = self.code[inside].width if inside < len(self.code) and self.code[inside].start == first else UNREACHED
            yield text

    def ending(self, width: int) -> Iterator[str]:
        """The comments at the end of a block that is indented by so many columns."""
        following = self.next_code()
        limit = self.code[following].start[0] if following < len(self.code) else len(self.source) + 1
        last = 0
        for comment in self.pending:
            if comment.place[0] >= limit or not comment.alone or comment.width < width:
                break
            last = comment.place[0]
        if last:
            yield from self.until(last + 1)

    def trailing(self) -> Iterator[str]:
        """Yield the comments that are left at the end of the file."""
        yield from self.until(len(self.source) + 1)


def statements_and_properties(program: Program) -> Iterator[Node]:
    """The statements and properties of a program."""
    for statement in program.statements:
        yield from (node for node in descendants(statement) if isinstance(node, Statement | PropertyDefault))


def node_start(node: Node) -> Place:
    """Return the place at which a node begins."""
    return (node.span.line, node.span.column)


Change = Callable[[Node], Any]


@room()
def convert(program: Program, dialect: str, library: Mapping[str, object]) -> str:
    """The text of a program in a dialect; `library` holds the modules that it imports, for the names of their classes. Raises `ParseError`."""
    source, target = DIALECTS[program.dialect], DIALECTS[dialect]
    classes = classes_of([program, *(module for module in library.values() if isinstance(module, Program))])
    statements = resolve_object_definitions(with_old_imports(program, library).statements, classes)  # type: ignore[arg-type]
    statements = convert_monitors(rewrite_tree(statements, partial(respell_node, source, target)), source, target)
    for statement in statements:
        check_said(statement, target, classes)
    printer = Commented(target, program)
    lines = [line.rstrip() for statement in statements for line in printer.lines(statement)]
    lines += printer.comments.trailing()
    if dialect != DEFAULT or printer.comments.mark or MARK.match("".join(lines[:1])):
        lines.insert(0, f"# dialect: {dialect}{printer.comments.mark}")
    return "".join([line + "\n" for line in lines])


def classes_of(programs: Iterable[Program]) -> frozenset[str]:
    """The names of the Scenic classes: those that are built in, and those that the programs define (not from a class of Python)."""
    found = set(BUILT_IN_CLASSES)
    defined = [node for program in programs for statement in program.statements for node in descendants(statement)]
    definitions = [node for node in defined if isinstance(node, s.ClassDefinition)]
    while True:
        more = {c.name for c in definitions if not c.superclasses or any(last_name(base) in found for base in c.superclasses)}
        if more <= found:
            return frozenset(found)
        found |= more


def last_name(node: Node) -> str:
    """The last part of a dotted name, "" for anything else."""
    return node.name if isinstance(node, (p.Name, p.Attribute)) else ""


def rewrite_tree(node: Any, change: Change) -> Any:
    """The tree with every node in it replaced by what `change` makes of it, the innermost ones first."""
    if isinstance(node, Node):
        parts = {f.name: getattr(node, f.name) for f in fields(node) if f.name != "span"}
        new = {name: rewrite_tree(part, change) for name, part in parts.items()}
        return change(node if all(new[name] is parts[name] for name in parts) else replace(node, **new))
    if isinstance(node, tuple):
        items = tuple(rewrite_tree(item, change) for item in node)
        if all(a is b for a, b in zip(items, node, strict=True)):
            return node
        return items if type(node) is tuple else type(node)(*items)
    return node


def resolve_object_definitions(tree: Any, classes: frozenset[str]) -> Any:
    """The tree in which every name that may begin an object definition does so if, and only if, it is that of a class."""

    def settle(node: Node) -> Node:
        match node:
            case e.ObjectOrOperator(head=head, as_object=made, as_operator=operator):
                return made if last_name(head) in classes else operator
            case e.ObjectOrValue(value=value):
                return e.ObjectDefinition(class_=value, span=node.span) if last_name(value) in classes else value
            case _:
                return node

    return rewrite_tree(tree, settle)


def respell_node(source: Dialect, target: Dialect, node: Node) -> Node:
    """A node as the target spells it: intervals, the simulation, and monitors, which run when they are defined or when they are required."""
    match node:
        case e.IntervalOrPair(low=low, high=high) if not target.intervals:
            return p.Call(function=p.Name(name="Range"), arguments=(low, high), span=node.span)
        case p.Attribute(value=p.Name(name="simulation") as clock) if target.released and not source.released:
            return replace(node, value=p.Call(function=clock, span=clock.span))
        case d.MonitorDefinition():
            node = replace(node, by_instance=target.monitor_instances)
        case _:
            pass
    blocks = {f.name: getattr(node, f.name) for f in fields(node) if is_block(getattr(node, f.name))}
    new = {name: convert_monitors(block, source, target) for name, block in blocks.items()}
    return replace(node, **new) if any(new[name] is not blocks[name] for name in new) else node


def is_block(value: object) -> bool:
    """Whether the value is a block of statements."""
    return isinstance(value, tuple) and bool(value) and all(isinstance(item, Statement) for item in value)


def convert_monitors(block: tuple[Statement, ...], source: Dialect, target: Dialect) -> tuple[Statement, ...]:
    """A block in which monitors run as they did: by `require monitor` behind their definitions, or without it. Raises `ParseError`."""
    monitors = [node for node in block if isinstance(node, d.MonitorDefinition)]
    if source.monitor_instances is target.monitor_instances or not (monitors or any(isinstance(node, d.RequireMonitor) for node in block)):
        return block
    if target.monitor_instances:
        return tuple(new for node in block for new in ([node, monitor_requirement(node)] if isinstance(node, d.MonitorDefinition) else [node]))
    asked = [node for node in block if isinstance(node, d.RequireMonitor)]
    for node in asked:
        if sum(monitor_requirement(monitor) == node for monitor in monitors) != 1 or sum(other.monitor == node.monitor for other in asked) != 1:
            raise unsupported_syntax_error("a monitor runs where it is defined, once, without arguments", node, target)
    for monitor in monitors:
        if monitor_requirement(monitor) not in asked:
            raise unsupported_syntax_error("a monitor that is defined runs, and this one is not required here", monitor, target)
    return tuple(node for node in block if node not in asked)


def monitor_requirement(monitor: d.MonitorDefinition) -> d.RequireMonitor:
    """`require monitor M()`."""
    return d.RequireMonitor(monitor=p.Call(function=p.Name(name=monitor.name)), span=monitor.span)


def unsupported_syntax_error(what: str, node: Node, target: Dialect) -> ParseError:
    """The error for what the target cannot say."""
    return ParseError(f"dialect {target.name} cannot say this: {what}", node.span)


AMBIGUOUS = "an object without specifiers, or a pair, which would mean something else there; or a name that is not known to be a class"


def check_said(statement: Statement, target: Dialect, classes: frozenset[str]) -> None:
    """Parse what is printed of a statement: it must be the same one. Raises `ParseError` at the innermost statement that is not.

    Scenic 2.1 knows an object by the name of its class.
    """
    made = (node for node in descendants(statement) if isinstance(node, e.ObjectDefinition)) if target.released and not target.explicit_new else ()
    nameless = next((node for node in made if last_name(node.class_) not in classes), None)
    if nameless is not None:
        raise unsupported_syntax_error("an object whose class is not known by its name", nameless, target)
    try:
        text = "\n".join(Converted(target).lines(statement)) + "\n"
        again = resolve_object_definitions(parse(text, dialect=target.name).statements, classes)
        reason = "" if same(again, (statement,)) else AMBIGUOUS
    except ParseError as problem:
        reason = problem.message
    if reason:
        for inner in descendants(statement):
            if isinstance(inner, Statement) and inner is not statement:
                check_said(inner, target, classes)
        raise unsupported_syntax_error(reason, statement, target)


class Converted(StatementPrinter):
    """Prints for another implementation: what is a class is known by now, and the released ones have no `is in`."""

    @property
    def membership(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        return "in" if self.dialect.released else "is in"


class Commented(Converted):
    """Prints the statements of a program with its comments and the empty lines between the statements, in the order of the source."""

    def __init__(self, dialect: Dialect, program: Program) -> None:
        super().__init__(dialect)
        self.comments = Comments(program)

    def within(self, quote: str) -> Converted:
        """Return the converter for the inside of an f-string, which has no comments."""
        return Converted(self.dialect, (*self.outer, quote))

    def one(self, node: Node, text: str) -> Iterator[str]:
        """The text of a node, below what is above it or inside of it, and the comment behind it, if it is the last in its line."""
        comments, place = self.comments, node_start(node)
        number = comments.code_at(place)
        yield from comments.above(number)
        yield text + (comments.behind(number) if comments.last.get(number, place) <= place else "")

    def clause(self, head: str, statements: Block, more: Iterable[Item] = ()) -> Iterator[str]:
        """A head and its block, with the comments above the head, inside of it and behind it, and those at the end of the block."""
        items = sort_by_source([*more, *self.statements(statements)])
        yield from self.comments.head(head + ":", next((node_start(node) for node, _ in items if node is not None), None))
        width = self.comments.inner
        yield from self.block(items)
        yield from (INDENT + line for line in self.comments.ending(width))


def sort_by_source(items: list[Item]) -> list[Item]:
    """The items of a block in the order of the source; what belongs to no node stays behind what is before it."""
    place, keys = (0, 0), []
    for node, _ in items:
        place = node_start(node) if node is not None else place
        keys.append(place)
    return [items[i] for i in sorted(range(len(items)), key=keys.__getitem__)]

