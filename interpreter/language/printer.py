"""Expressions and specifiers as source text, with parentheses around every operand that is not a single term."""

from __future__ import annotations

import keyword
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ...semantics.syntax import Block, Expression, Node, Program, Specifier, Statement
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s
from ...semantics.syntax.python_expressions import BooleanOperation, Comparison, Constant, FormattedValue, FString, Parameter, Starred
from .dialects import DEFAULT, DIALECTS, Dialect
from .infix_chains import is_dotted_name
from .nesting import room

QUOTES = ('"""', "'''", '"', "'")


class NoQuotesLeft(ValueError):
    """The text cannot stand inside these quotes."""


def print_constant(value: object) -> str:
    """The literal of a constant."""
    if value is ...:
        return "..."
    if isinstance(value, float) and math.isinf(value):
        return "1e999"
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) >= 10**4000:
        return hex(value)
    return repr(value)


class StringPrinter(ABC):
    """The part of the printer for strings; `outer` are the quotes of the f-strings around, which cannot occur inside them."""

    def __init__(self, dialect: Dialect, outer: tuple[str, ...] = ()) -> None:
        self.dialect = dialect
        self.outer = outer

    @abstractmethod
    def test(self, node: Expression) -> str:
        """The text of an expression."""

    def print_Constant(self, node: Constant) -> str:
        value = node.value
        if not self.outer or not isinstance(value, str | bytes):
            return print_constant(value)
        prefix, text = ("b", value.decode("latin-1")) if isinstance(value, bytes) else ("", value)
        for quote in QUOTES:
            if self.fits(text, quote):
                return prefix + quote + text + quote
        raise NoQuotesLeft("no quotes are left for a string")

    def fits(self, text: str, quote: str) -> bool:
        """Whether `text` can stand between these quotes as it is, within the f-strings around."""
        literal = quote + text + quote
        alone = quote not in text + quote[1:] and (len(quote) == 3 or "\n" not in text)
        return alone and not any(mark in literal for mark in self.outer) and "\\" not in text

    def print_FString(self, node: FString) -> str:
        """The literal of an f-string, in the first quotes that do."""
        for quote in QUOTES:
            try:
                return f"f{quote}{self.inside(node, quote)}{quote}"
            except NoQuotesLeft:
                continue
        raise NoQuotesLeft("no quotes are left for an f-string")

    def inside(self, node: FString, quote: str, *, layout: bool = False) -> str:
        """The text between the quotes (`layout`: of a format specification)."""
        texts = [self.literal(part, quote, layout) if isinstance(part, str) else self.replacement(part, quote) for part in node.parts]
        return "".join(texts)

    def literal(self, text: str, quote: str, layout: bool) -> str:
        """Literal characters of an f-string: escaped, or as they are inside another f-string."""
        if not self.outer:
            body = "".join([_escape(char) for char in text])
            return body.replace("{", "\\x7b").replace("}", "\\x7d") if layout else body.replace("{", "{{").replace("}", "}}")
        if not self.fits(text, quote) or (layout and ("{" in text or "}" in text)):
            raise NoQuotesLeft("a literal piece does not fit")
        return text.replace("{", "{{").replace("}", "}}")

    def within(self, quote: str) -> StringPrinter:
        """A printer of what stands in an f-string between such quotes."""
        return type(self)(self.dialect, (*self.outer, quote))

    def replacement(self, part: FormattedValue, quote: str) -> str:
        """`{(value)!conversion:format}`."""
        text = self.within(quote).test(part.value)
        if "\\" in text or quote in text:
            raise NoQuotesLeft("an interpolation does not fit")
        conversion = f"!{part.conversion}" if part.conversion else ""
        layout = "" if part.format is None else ":" + self.inside(part.format, quote, layout=True)
        return f"{{({text}){conversion}{layout}}}"


def _escape(char: str) -> str:
    return {"'": "\\'", '"': '\\"'}.get(char) or repr(char)[1:-1]


# Words that begin or continue a construct: as names they are written in parentheses, which is always right.
SOFT_WORDS = frozenset(
    {
        "abort",
        "ahead",
        "angle",
        "apparent",
        "apparently",
        "at",
        "back",
        "behavior",
        "behind",
        "beyond",
        "by",
        "can",
        "compose",
        "deg",
        "distance",
        "do",
        "facing",
        "follow",
        "following",
        "front",
        "in",
        "initial",
        "interrupt",
        "invariant",
        "left",
        "model",
        "monitor",
        "mutate",
        "new",
        "of",
        "offset",
        "on",
        "override",
        "param",
        "past",
        "precondition",
        "relative",
        "require",
        "right",
        "scenario",
        "seconds",
        "setup",
        "steps",
        "take",
        "terminate",
        "to",
        "toward",
        "until",
        "visible",
        "wait",
    }
)

TERMS = (
    p.Name,
    p.Constant,
    p.FString,
    p.TupleDisplay,
    p.ListDisplay,
    p.SetDisplay,
    p.DictDisplay,
    p.Attribute,
    p.Subscript,
    p.Call,
    p.Comprehension,
    p.Slice,
    e.IntervalOrPair,
    e.ObjectOrValue,
)


ARITHMETIC = (p.UnaryOperation, p.BinaryOperation, p.BooleanOperation, p.Comparison, e.VectorOf, e.Degrees)
"""What needs no parentheses between commas."""


class ExpressionPrinter(StringPrinter):
    """Prints expressions in one dialect."""

    membership = "is in"
    """How `x in y` is spelt for a name x, which might be that of a class."""

    def test(self, node: Expression) -> str:
        """`node` where any expression may stand."""
        return getattr(self, "print_" + type(node).__name__)(node)

    def operand(self, node: Expression) -> str:
        """`node` as an operand: a term, or parenthesised."""
        return self.test(node) if isinstance(node, TERMS) else f"({self.test(node)})"

    def argument(self, node: Expression) -> str:
        """`node` behind a soft keyword, which looks ahead for a word, a digit or a parenthesis."""
        head = node.value if isinstance(node, e.Degrees) else node.function if isinstance(node, p.Call) else node
        plain = is_dotted_name(head) or isinstance(head, p.Constant) or isinstance(node, p.TupleDisplay)
        return self.test(node) if plain else f"({self.test(node)})"

    def item(self, node: Expression) -> str:
        """`node` between commas."""
        return self.test(node) if isinstance(node, (p.Starred, *ARITHMETIC)) else self.operand(node)

    def list_of_tests(self, node: Expression) -> str:
        """`node` where a tuple needs no parentheses."""
        if isinstance(node, p.TupleDisplay) and node.items:
            return self.items(node.items)
        return self.test(node)

    def items(self, nodes: Iterable[Expression]) -> str:
        """The items of a tuple."""
        texts = list(map(self.item, nodes))
        return texts[0] + "," if len(texts) == 1 else ", ".join(texts)

    def listed(self, nodes: Iterable[Expression]) -> str:
        return ", ".join(map(self.item, nodes))

    # -- Python

    def print_Name(self, node: p.Name) -> str:
        return f"({node.name})" if node.name in SOFT_WORDS else node.name

    def print_Starred(self, node: p.Starred) -> str:
        return "*" + self.operand(node.value)

    def print_TupleDisplay(self, node: p.TupleDisplay) -> str:
        return f"({self.items(node.items)})" if node.items else "()"

    def print_ListDisplay(self, node: p.ListDisplay) -> str:
        return f"[{self.listed(node.items)}]"

    def print_SetDisplay(self, node: p.SetDisplay) -> str:
        return f"{{{self.listed(node.items)}}}"

    def print_DictDisplay(self, node: p.DictDisplay) -> str:
        pairs = [f"**{self.operand(v)}" if k is None else f"{self.operand(k)}: {self.item(v)}" for k, v in node.items]
        return "{" + ", ".join(pairs) + "}"

    def print_Attribute(self, node: p.Attribute) -> str:
        return f"{self.primary(node.value)}.{node.name}"

    def primary(self, node: Expression) -> str:
        """`node` before a dot, a bracket or a call's parenthesis."""
        return f"({self.test(node)})" if isinstance(node, p.Constant) else self.operand(node)

    def print_Subscript(self, node: p.Subscript) -> str:
        return f"{self.primary(node.value)}[{self.list_of_tests(node.index)}]"

    def print_Slice(self, node: p.Slice) -> str:
        ends = [self.operand(end) if end is not None else "" for end in (node.lower, node.upper)]
        return ":".join(ends) + (":" + self.operand(node.step) if node.step is not None else "")

    def print_Call(self, node: p.Call) -> str:
        named = [f"{k.name}={self.item(k.value)}" if k.name else f"**{self.operand(k.value)}" for k in node.keywords]
        return f"{self.primary(node.function)}({', '.join([*map(self.item, node.arguments), *named])})"

    def print_UnaryOperation(self, node: p.UnaryOperation) -> str:
        return f"{node.operator} {self.operand(node.operand)}" if node.operator == "not" else node.operator + self.operand(node.operand)

    def print_BinaryOperation(self, node: p.BinaryOperation) -> str:
        return f"{self.operand(node.left)} {node.operator} {self.operand(node.right)}"

    def print_BooleanOperation(self, node: p.BooleanOperation) -> str:
        return f" {node.operator} ".join([self.operand(item) for item in node.operands])

    def print_Comparison(self, node: p.Comparison) -> str:
        operators: tuple[str, ...] = node.operators
        if operators == ("in",) and is_dotted_name(node.left):
            operators = (self.membership,)  # `in` could be read as a specifier
        rest = [f" {word} {self.operand(item)}" for word, item in zip(operators, node.operands, strict=True)]
        return self.operand(node.left) + "".join(rest)

    def print_Conditional(self, node: p.Conditional) -> str:
        return f"{self.operand(node.then)} if {self.operand(node.test)} else {self.operand(node.otherwise)}"

    def print_Lambda(self, node: p.Lambda) -> str:
        parameters = self.parameters(node.parameters)
        return f"lambda{' ' if parameters else ''}{parameters}: {self.operand(node.body)}"

    def parameters(self, parameters: tuple[p.Parameter, ...]) -> str:
        """The parameters with the marks `/` and `*` where their kinds need them."""
        texts: list[str] = []
        kinds = [parameter.kind for parameter in parameters]
        for index, parameter in enumerate(parameters):
            default = "" if parameter.default is None else "=" + self.operand(parameter.default)
            if parameter.kind == "keyword only" and not {"*args", "keyword only"} & set(kinds[:index]):
                texts.append("*")
            stars = {"*args": "*", "**kwargs": "**"}.get(parameter.kind, "")
            texts.append(stars + parameter.name + default)
            if parameter.kind == "positional only" and "positional only" not in kinds[index + 1 :]:
                texts.append("/")
        return ", ".join(texts)

    def print_Comprehension(self, node: p.Comprehension) -> str:
        clauses = "".join([self.loop(clause) for clause in node.clauses])
        element = self.operand(node.element)
        if node.key is not None:
            element = f"{self.operand(node.key)}: {element}"
        opening, closing = {"list": "[]", "set": "{}", "dict": "{}", "generator": "()"}[node.kind]
        return opening + element + clauses + closing

    def loop(self, clause: p.ComprehensionClause) -> str:
        conditions = "".join([f" if {self.operand(condition)}" for condition in clause.conditions])
        return f" for {self.target(clause.target)} in {self.operand(clause.iterable)}{conditions}"

    def target(self, node: Expression) -> str:
        """`node` as the target of a loop."""
        return self.items(node.items) if isinstance(node, p.TupleDisplay) and node.items else self.test(node)

    # -- Scenic

    def print_VectorOf(self, node: e.VectorOf) -> str:
        return f"{self.operand(node.x)} @ {self.operand(node.y)}"

    def print_IntervalOrPair(self, node: e.IntervalOrPair) -> str:
        return f"({self.operand(node.low)}, {self.operand(node.high)})"

    def print_Degrees(self, node: e.Degrees) -> str:
        return f"{self.operand(node.value)} deg"

    def print_Seconds(self, node: e.Seconds) -> str:
        return f"{self.operand(node.value)} seconds"

    def option(self, word: str, node: Expression | None) -> str:
        """` word node`, or nothing."""
        return "" if node is None else f" {word} {self.operand(node)}"

    def print_RelativeHeading(self, node: e.RelativeHeading) -> str:
        return f"relative heading of {self.operand(node.heading)}{self.option('from', node.origin)}"

    def print_ApparentHeading(self, node: e.ApparentHeading) -> str:
        return f"apparent heading of {self.operand(node.oriented_point)}{self.option('from', node.origin)}"

    def print_Distance(self, node: e.Distance) -> str:
        return f"distance{self.option('from', node.origin)}{self.option('to', node.target)}"

    def print_DistancePast(self, node: e.DistancePast) -> str:
        if self.dialect.released:
            return f"distance past {self.operand(node.vector)}{self.option('of', node.oriented_point)}"
        return f"distance{self.option('of', node.oriented_point)}{self.option('past', node.vector)}"

    def print_RelativePosition(self, node: e.RelativePosition) -> str:
        return f"relative position of {self.operand(node.target)}{self.option('from', node.origin)}"

    def print_Angle(self, node: e.Angle) -> str:
        return f"angle{self.option('from', node.origin)}{self.option('to', node.target)}"

    def print_CanSee(self, node: e.CanSee) -> str:
        return f"{self.operand(node.viewer)} can see {self.operand(node.target)}"

    def print_FieldAt(self, node: e.FieldAt) -> str:
        return f"{self.operand(node.field)} at {self.operand(node.vector)}"

    def print_RelativeTo(self, node: e.RelativeTo) -> str:
        return f"{self.operand(node.left)} relative to {self.operand(node.right)}"

    def print_OffsetBy(self, node: e.OffsetBy) -> str:
        return f"{self.operand(node.base)} offset by {self.operand(node.offset)}"

    def print_OffsetAlong(self, node: e.OffsetAlong) -> str:
        return f"{self.operand(node.base)} offset along {self.operand(node.direction)} by {self.operand(node.offset)}"

    def print_Visible(self, node: e.Visible) -> str:
        return f"visible {self.argument(node.region)}"

    def print_NotVisible(self, node: e.NotVisible) -> str:
        if node.viewer is not None:
            return f"{self.operand(node.region)} not visible from {self.operand(node.viewer)}"
        return f"not visible {self.argument(node.region)}"

    def print_Intersects(self, node: e.Intersects) -> str:
        return f"{self.operand(node.left)} intersects {self.operand(node.right)}"

    def print_VisibleFrom(self, node: e.VisibleFrom) -> str:
        return f"{self.operand(node.region)} visible from {self.operand(node.viewer)}"

    def print_Follow(self, node: e.Follow) -> str:
        return f"follow {self.argument(node.field)}{self.option('from', node.origin)} for {self.operand(node.distance)}"

    def print_SideOf(self, node: e.SideOf) -> str:
        return f"{node.side} of {self.operand(node.object)}"

    def print_InInitialScenario(self, node: e.InInitialScenario) -> str:
        return "initial scenario" if self.dialect.initial_scenario else "in initial scenario"

    def print_ObjectOrValue(self, node: e.ObjectOrValue) -> str:
        return self.test(node.value)

    def print_ObjectOrOperator(self, node: e.ObjectOrOperator) -> str:
        """The flat chain that gives both readings: the operators along the left spine of the operator reading."""
        operator = node.as_operator
        if isinstance(operator, p.Conditional):
            first = replace(node, as_operator=operator.then)
            return f"{self.print_ObjectOrOperator(first)} if {self.operand(operator.test)} else {self.operand(operator.otherwise)}"
        if isinstance(operator, p.Comparison):
            return f"{self.operand(node.head)} in {self.operand(operator.operands[0])}"
        links: list[str] = []
        while operator != node.head:
            match operator:
                case e.FieldAt():
                    link, operator = f" at {self.operand(operator.vector)}", operator.field
                case e.VisibleFrom():
                    link, operator = f" visible from {self.operand(operator.viewer)}", operator.region
                case e.NotVisible(viewer=e.Expression() as viewer):
                    link, operator = f" not visible from {self.operand(viewer)}", operator.region
                case e.RelativeTo():
                    link, operator = f" relative to {self.operand(operator.right)}", operator.left
                case e.OffsetBy():
                    link, operator = f" offset by {self.operand(operator.offset)}", operator.base
                case e.OffsetAlong():
                    direction = self.operand(operator.direction)
                    link, operator = f" offset along {direction} by {self.operand(operator.offset)}", operator.base
                case _:
                    raise AssertionError(operator)
            links.append(link)
        return self.operand(node.head) + "".join(reversed(links))

    def print_ObjectDefinition(self, node: e.ObjectDefinition) -> str:
        new = "new " if self.dialect.explicit_new else ""
        return new + " ".join([self.operand(node.class_), self.specifiers(node.specifiers)]).strip()

    # -- Specifiers

    def specifiers(self, specifiers: tuple[Specifier, ...]) -> str:
        """The specifiers, separated by commas."""
        return ", ".join([self.specifier(specifier) for specifier in specifiers])

    def specifier(self, node: Specifier) -> str:
        match node:
            case q.WithSpecifier():
                return f"with {node.property} {self.argument(node.value)}"
            case q.AtSpecifier():
                return f"at {self.argument(node.vector)}"
            case q.OffsetBySpecifier():
                return f"offset by {self.argument(node.offset)}"
            case q.OffsetAlongSpecifier():
                return f"offset along {self.argument(node.direction)} by {self.operand(node.offset)}"
            case q.BesideSpecifier():
                words = {"left": "left of", "right": "right of", "ahead": "ahead of", "behind": "behind"}
                return f"{words[node.side]} {self.argument(node.reference)}{self.option('by', node.gap)}"
            case q.BeyondSpecifier():
                return f"beyond {self.argument(node.vector)} by {self.operand(node.offset)}{self.option('from', node.origin)}"
            case q.VisibleSpecifier():
                return "visible" + self.option("from", node.viewer)
            case q.NotVisibleSpecifier():
                return "not visible" + self.option("from", node.viewer)
            case q.ContainedInSpecifier():
                return f"contained in {self.argument(node.region)}"
            case q.InSpecifier():
                return f"{node.keyword} {self.argument(node.region)}"
            case q.FollowingSpecifier():
                return f"following {self.argument(node.field)}{self.option('from', node.origin)} for {self.operand(node.distance)}"
            case q.FacingSpecifier():
                return f"facing {self.argument(node.direction)}"
            case q.FacingTowardSpecifier():
                return f"facing toward {self.operand(node.vector)}"
            case q.FacingAwayFromSpecifier():
                return f"facing away from {self.operand(node.vector)}"
            case q.ApparentlyFacingSpecifier():
                return f"apparently facing {self.argument(node.heading)}{self.option('from', node.origin)}"
            case _:
                raise TypeError(f"no specifier: {node!r}")


INDENT = "    "
Item = tuple[Node | None, Iterator[str]]
"""What stands in a block, and its lines; a block within that belongs to no node (`setup`) has none."""


@room()
def to_source(what: Program | Node | Block, dialect: str = DEFAULT) -> str:
    """The text of a program (in its own dialect, which its first line names), a block, a statement or an expression.

    Parsing it gives an equal tree; positions are not part of equality.
    """
    if isinstance(what, Program):
        mark = "" if what.dialect == DEFAULT else f"# dialect: {what.dialect}\n"
        return mark + to_source(what.statements, what.dialect)
    printer = StatementPrinter(DIALECTS[dialect])
    if isinstance(what, tuple):
        return "".join([line + "\n" for statement in what for line in printer.lines(statement)])
    if isinstance(what, Statement):
        return "".join([line + "\n" for line in printer.lines(what)])
    if isinstance(what, Specifier):
        return printer.specifier(what)
    if isinstance(what, Expression):
        return printer.test(what)
    raise TypeError(f"no statement, specifier or expression: {type(what).__name__}")


class StatementPrinter(ExpressionPrinter):
    """Prints statements in one dialect, as lines."""

    def lines(self, node: Statement) -> Iterator[str]:
        """The lines of a statement, without line ends."""
        yield from getattr(self, "lines_" + type(node).__name__, self.simple)(node)

    def clause(self, head: str, statements: Block, more: Iterable[Item] = ()) -> Iterator[str]:
        """`head:` and its block, with `more` items before its statements."""
        yield head + ":"
        yield from self.block([*more, *self.statements(statements)])

    def statements(self, statements: Block) -> list[Item]:
        """The items of a block that are statements."""
        return [(statement, self.lines(statement)) for statement in statements]

    def block(self, items: list[Item]) -> Iterator[str]:
        """The indented lines of the items of a block."""
        for _, lines in items:
            for line in lines:
                yield INDENT + line
        if not items:
            yield INDENT + "pass"

    def one(self, node: Node, text: str) -> Iterator[str]:
        """The text of a node that has a line of its own."""
        yield text

    def optional(self, head: str, statements: Block | None) -> Iterator[str]:
        """`head:` and its block, if there is one."""
        if statements:
            yield from self.clause(head, statements)

    # -- Simple statements

    def simple(self, node: Statement) -> Iterator[str]:
        """The one line of a simple statement."""
        yield from self.one(node, self.line(node))

    def line(self, node: Statement) -> str:
        match node:
            case s.ExpressionStatement():
                return self.list_of_tests(node.value)
            case s.Assignment():
                return " = ".join([self.target(t) for t in node.targets] + [self.list_of_tests(node.value)])
            case s.AugmentedAssignment():
                return f"{self.test(node.target)} {node.operator}= {self.list_of_tests(node.value)}"
            case s.Return():
                return "return" + ("" if node.value is None else " " + self.list_of_tests(node.value))
            case s.Break() | s.Continue() | s.Pass() | d.Wait() | d.Abort():
                return type(node).__name__.lower()
            case s.Delete():
                return "del " + (", ".join([self.test(t) for t in node.targets]) or "()")
            case s.Assert():
                return f"assert {self.operand(node.test)}" + ("" if node.message is None else f", {self.operand(node.message)}")
            case s.Raise():
                return "raise" + "".join([self.option("", node.exception)[1:], self.option("from", node.cause)])
            case s.Global() | s.Nonlocal():
                return f"{type(node).__name__.lower()} {', '.join(node.names)}"
            case s.Import():
                return "import " + ", ".join([print_imported_name(name) for name in node.names])
            case s.ImportFrom():
                names = ", ".join([print_imported_name(name) for name in node.names]) or "*"
                return f"from {'.' * node.level}{node.module} import {names}"
            case _:
                return self.scenic_line(node)

    def scenic_line(self, node: Statement) -> str:
        match node:
            case s.Model():
                return f"model {node.name}"
            case s.Param():
                return "param " + ", ".join([f"{parameter_name(a.name)} = {self.item(a.value)}" for a in node.assignments])
            case s.ChooseSimulator():
                return f"simulator {self.operand(node.value)}"
            case s.Require():
                return f"require {self.condition(node.condition)}{print_requirement_name(node.name)}"
            case s.SoftRequire():
                return f"require[{self.test(node.probability)}] {self.operand(node.condition)}{print_requirement_name(node.name)}"
            case d.RequireAlways():
                return f"require always ({self.test(node.condition)}){print_requirement_name(node.name)}"
            case d.RequireEventually():
                return f"require eventually ({self.test(node.condition)}){print_requirement_name(node.name)}"
            case d.RequireMonitor():
                return f"require monitor {self.operand(node.monitor)}{print_requirement_name(node.name)}"
            case d.TerminateWhen():
                return f"terminate {'simulation ' * node.simulation}when {self.operand(node.condition)}{print_requirement_name(node.name)}"
            case d.TerminateAfter():
                return f"terminate after{self.limit(node.limit).removeprefix(' for')}"
            case d.Terminate():
                return "terminate" + " simulation" * node.simulation
            case d.WaitFor():
                return f"wait{self.limit(node.limit)}"
            case d.Record():
                when = "" if node.time == "always" else f"{node.time} "
                period, delay = (self.limit(limit).removeprefix(" for") for limit in (node.period, node.delay))
                limits = f"{period and ' every' + period}{delay and ' after' + delay}"
                return f"record {when}({self.test(node.value)}){limits}{print_requirement_name(node.name)}"
            case s.Mutate():
                names = " ".join(["mutate", ", ".join([name.name for name in node.objects])]).rstrip()
                return names + ("" if node.scale is None else f" by ({self.test(node.scale)})")
            case d.Take():
                return "take " + ", ".join([f"({self.test(a)})" for a in node.actions])
            case d.Do():
                return f"do {self.invoked(node.invocations)}{self.limit(node.limit)}"
            case d.DoChoose() | d.DoShuffle():
                word = "choose" if isinstance(node, d.DoChoose) else "shuffle"
                return f"do {word} {self.weighted(node.invocations, node.weights)}{self.limit(node.limit)}"
            case d.Override():
                return f"override {self.operand(node.object)} {self.specifiers(node.specifiers)}"
            case _:
                raise TypeError(f"no statement: {type(node).__name__}")

    def condition(self, node: Expression) -> str:
        """`node` behind `require`: a comparison, or `and` and `or`, that begin with a bracket or a word need no more brackets."""
        text = self.test(node)
        return text if isinstance(node, Comparison | BooleanOperation) and (text[0] == "(" or text[0].isalnum()) else self.argument(node)

    def invoked(self, nodes: tuple[Expression, ...]) -> str:
        return ", ".join([f"({self.test(node)})" for node in nodes])

    def weighted(self, nodes: tuple[Expression, ...], weights: tuple[Expression, ...]) -> str:
        """The alternatives of `do choose`, with their weights if they have any."""
        if not weights:
            return self.invoked(nodes)
        pairs = [f"{self.operand(node)}: {self.operand(weight)}" for node, weight in zip(nodes, weights, strict=True)]
        return "{" + ", ".join(pairs) + "}"

    def limit(self, limit: d.TimeLimit | d.Until | None) -> str:
        """` for S seconds`, ` for S steps`, ` until B` or nothing."""
        if limit is None:
            return ""
        if isinstance(limit, d.Until):
            return f" until {self.operand(limit.condition)}"
        return f" for {self.operand(limit.amount)} {limit.unit}"

    # -- Compound statements

    def lines_If(self, node: s.If) -> Iterator[str]:
        head = "if"
        while True:
            yield from self.clause(f"{head} {self.operand(node.test)}", node.then)
            match node.otherwise:
                case (s.If() as node,):
                    head = "elif"
                case rest:
                    yield from self.optional("else", rest)
                    return

    def lines_While(self, node: s.While) -> Iterator[str]:
        yield from self.clause(f"while {self.operand(node.test)}", node.body)
        yield from self.optional("else", node.otherwise)

    def lines_For(self, node: s.For) -> Iterator[str]:
        yield from self.clause(f"for {self.target(node.target)} in {self.list_of_tests(node.iterable)}", node.body)
        yield from self.optional("else", node.otherwise)

    def lines_FunctionDefinition(self, node: s.FunctionDefinition) -> Iterator[str]:
        for decorator in node.decorators:
            yield from self.one(decorator, "@" + self.operand(decorator))
        yield from self.clause(f"def {node.name}({self.parameters(node.parameters)})", node.body)

    def lines_Try(self, node: s.Try) -> Iterator[str]:
        yield from self.clause("try", node.body)
        for interrupt in node.interrupts:
            yield from self.clause(f"interrupt when {self.operand(interrupt.condition)}", interrupt.body)
        for handler in node.handlers:
            name = f" as {handler.name}" if handler.name else ""
            yield from self.clause("except" + self.option("", handler.type).replace("  ", " ", 1) + name, handler.body)
        yield from self.optional("else", node.otherwise)
        yield from self.optional("finally", node.final)

    def lines_ClassDefinition(self, node: s.ClassDefinition) -> Iterator[str]:
        superclasses = ", ".join([self.test(c) if isinstance(c, Starred) else self.operand(c) for c in node.superclasses])
        properties = [(item, self.one(item, f"{item.name}{attributes(item)}: {self.default(item.value)}")) for item in node.properties]
        yield from self.clause(f"class {node.name}({superclasses})" if superclasses else f"class {node.name}", node.body, properties)

    def default(self, node: Expression) -> str:
        """A default value: a tuple in brackets where the releases need them, and without where `(a, b)` would be an interval."""
        return self.test(node) if self.dialect.released else self.list_of_tests(node)

    def definition(self, word: str, name: str, parameters: tuple[Parameter, ...]) -> str:
        return f"{word} {name}({self.parameters(parameters)})"

    def guards(self, node: d.BehaviorDefinition | d.ScenarioDefinition) -> Iterator[Item]:
        """Yield the preconditions, then the invariants."""
        for word, conditions in (("precondition", node.preconditions), ("invariant", node.invariants)):
            yield from ((condition, self.one(condition, f"{word}: {self.operand(condition)}")) for condition in conditions)

    def lines_BehaviorDefinition(self, node: d.BehaviorDefinition) -> Iterator[str]:
        yield from self.clause(self.definition("behavior", node.name, node.parameters), node.body, self.guards(node))

    def lines_MonitorDefinition(self, node: d.MonitorDefinition) -> Iterator[str]:
        one = not (self.dialect.monitor_instances or node.parameters)
        yield from self.clause(f"monitor {node.name}" if one else self.definition("monitor", node.name, node.parameters), node.body)

    def lines_ScenarioDefinition(self, node: d.ScenarioDefinition) -> Iterator[str]:
        yield from self.clause(self.definition("scenario", node.name, node.parameters), (), [*self.guards(node), *self.parts(node)])

    def parts(self, node: d.ScenarioDefinition) -> Iterator[Item]:
        for word, block in (("setup", node.setup), ("compose", node.compose)):
            if block is not None:
                yield None, self.clause(word, block)


def print_imported_name(name: s.ImportedName) -> str:
    """`name as alias`."""
    return name.name + (f" as {name.alias}" if name.alias else "")


def print_requirement_name(name: str) -> str:
    """` as name`, or nothing."""
    return f" as {name if name.isidentifier() or name.isdecimal() else repr(name)}" if name else ""


def attributes(item: s.PropertyDefault) -> str:
    """The attributes of a property."""
    return f"[{', '.join(item.attributes)}]" if item.attributes else ""


def parameter_name(name: str) -> str:
    """The name of a global parameter, quoted unless it is an identifier and no keyword."""
    return name if name.isidentifier() and not keyword.iskeyword(name) else repr(name)

