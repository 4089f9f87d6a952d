"""From Lark's parse tree to the abstract syntax: the loop, source spans, and what all parts of the builder share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lark import Token, Tree

from ...semantics.machine.operand_kinds import FLAT, SPATIAL_PROPERTIES
from ...semantics.store.built_in_classes import BUILT_IN_CLASSES
from ...semantics.store.errors import ParseError
from ...semantics.syntax import Expression, Span, Statement
from ...semantics.syntax.expressions import (
    FieldAt,
    ObjectDefinition,
    ObjectOrOperator,
    ObjectOrValue,
    OffsetBy,
)
from ...semantics.syntax.python_expressions import Comparison, Constant, TupleDisplay, UnaryOperation
from ...semantics.syntax.statements import ClassDefinition, PropertyDefault
from . import literals
from .dialects import Dialect, dialects_with_feature
from .infix_chains import is_dotted_name, join
from .logical_lines import AS_WRITTEN, JoinedText

Parts = list[Any]  # What the children of a rule were turned into: nodes, tokens, tuples of nodes, or None.


IN_SCENARIOS = "write `scenario Main():` with `setup:` and `compose:` blocks inside"
IN_HEADS = "write it in the first lines of one, before its other statements"
PARTS = {
    **dict.fromkeys(("setup", "compose"), ("a `scenario`", IN_SCENARIOS)),
    **dict.fromkeys(("precondition", "invariant"), ("a `behavior` or `scenario`", IN_HEADS)),
}
"""The words that such lines begin with: what they are parts of, and the hint where they stand elsewhere."""


@dataclass(frozen=True, slots=True)
class TextOrigin:
    """The origin of the parsed text: its file, and what to add to its lines and to the columns of its first
    line; `joined` is the text as the grammar reads it, `source` is the text as it was written, if that is a
    whole file.
    """

    file: str
    line: int = 0
    column: int = 0
    joined: JoinedText = AS_WRITTEN
    source: str = ""

    def span(self, line: int, column: int, end_line: int, end_column: int) -> Span:
        """The place in the file of a stretch of the joined text."""
        return self.written(*self.joined.place(line, column), *self.joined.place(end_line, end_column))

    def written(self, line: int, column: int, end_line: int, end_column: int) -> Span:
        """The place in the file of a stretch of the text as it was written."""
        return Span(
            self.file,
            line + self.line,
            column + (self.column if line == 1 else 0),
            end_line + self.line,
            end_column + (self.column if end_line == 1 else 0),
        )

    def move(self, span: Span) -> Span:
        """The place in the file of a span within the parsed text."""
        return self.span(span.line, span.column, span.end_line, span.end_column)


class BuilderBase:
    """The base of all parts of the builder: the origin of the text and the dialect in which it is written."""

    def __init__(self, origin: TextOrigin, dialect: Dialect) -> None:
        self.origin = origin
        self.dialect = dialect
        self.stray: dict[Span, ParseError] = {}
        self.without_new: dict[Span, ObjectDefinition] = {}
        self.properties: dict[Span, PropertyDefault] = {}
        self.annotations: dict[Span, Expression] = {}
        self.classes = set(BUILT_IN_CLASSES)

    def build(self, tree: Tree[Token]) -> Any:
        """Return the value of `tree`: each rule's method is called on the values of its children, leaves
        first, without recursion.
        """
        pending: list[Any] = [tree]
        order: list[Any] = []
        while pending:
            item = pending.pop()
            order.append(item)
            if isinstance(item, Tree):
                pending.extend(item.children)
                if item.data == "class":
                    self.classes.add(str(item.children[1]))
        values: Parts = []
        for item in reversed(order):
            if not isinstance(item, Tree):
                values.append(item)
                continue
            size = len(item.children)
            parts = values[len(values) - size :]
            del values[len(values) - size :]
            values.append(getattr(self, "make_" + item.data)(self.span_of(item), parts))
        for error in self.stray.values():
            raise error
        for place, node in self.properties.items():
            if node.name in PARTS:
                home, hint = PARTS[node.name]
                raise ParseError(f"`{node.name}` stands only in {home}", place, hint=hint)
            raise below_class(node, values[0]) or ParseError(
                "`name: default` lines belong in classes", place, hint="give the variable a value, as in `x: int = 3`"
            )
        for place in self.without_new:
            raise self.needs_new(place)
        return values[0]

    def needs_new(self, place: Span) -> ParseError:
        """The error for an object without `new`."""
        return ParseError(f"dialect {self.dialect.name} makes objects with `new`", place, hint="write `new` before the class")

    def span_of(self, tree: Tree[Token]) -> Span:
        """The place of a rule's text."""
        meta = tree.meta
        if meta.empty:
            return self.origin.span(1, 1, 1, 1)
        return self.origin.span(meta.line, meta.column, meta.end_line, meta.end_column)

    def token_span(self, token: Token) -> Span:
        """The place of a token."""
        line, column = token.line or 1, token.column or 1
        return self.origin.span(line, column, token.end_line or line, token.end_column or column)

    def identifier(self, token: Token) -> str:
        """The name that a NAME token spells."""
        try:
            return literals.name(str(token))
        except literals.LiteralFault as fault:
            raise ParseError(fault.message, self.token_span(token)) from None

    def released(self, construct: str, span: Span, hint: str = "") -> None:
        """Raises ParseError where the dialect is none of those that have the construct."""
        if not self.dialect.released:
            repair = f"{hint}, or {BY_DIALECT}" if hint else BY_DIALECT
            raise ParseError(f"`{construct}` belongs to dialects {dialects_with_feature('released')}", span, hint=repair)

    def property_with_effect(self, name: str, span: Span) -> str:
        """The name of a property. Raises ParseError where it has a meaning in the releases that it does not have here: it would be without effect."""
        if self.dialect.explicit_new and name in SPATIAL_PROPERTIES:
            raise ParseError(f"the property `{name}` {FLAT}", span, hint=SPATIAL_PROPERTIES[name])
        if self.dialect.released and name in OUTSIDE:
            what, hint = OUTSIDE[name]
            raise ParseError(f"the property `{name}` of the releases is outside this reference: {what}", span, hint=hint)
        return name

    def object_place(self, node: Expression) -> Expression:
        """`node` where an object may stand: a (dotted) name alone may then be a class (reading `bare-class`)."""
        if not self.dialect.explicit_new and is_dotted_name(node):
            return ObjectOrValue(span=node.span, value=node)
        if isinstance(node, TupleDisplay):
            _refuse_split_vector(node)
        return node


def below_class(line: PropertyDefault, statements: object) -> ParseError | None:
    """The error for a `name: default` line right below a class, of whose block it was meant to be; None for others."""
    block = statements if isinstance(statements, tuple) else ()
    above = [node for node in block if isinstance(node, Statement) and node.span < line.span and not isinstance(node, PropertyDefault)]
    last = above[-1] if above else None
    if not isinstance(last, ClassDefinition):
        return None
    inside = min((node.span.line for node in (*last.properties, *last.body)), default=last.span.line)
    if inside == last.span.line:
        return None
    message = f"`name: default` lines belong in classes, and this one is not in class {last.name}"
    return ParseError(message, line.span, hint=f"indent it like line {inside}")


BY_DIALECT = "begin the program with `# dialect: scenic-2.1`"
"""How to have what the releases alone have; the syntax of 2.1 is nearest to that of the paper."""
OUTSIDE = {
    "cameraOffset": ("what an object sees, it sees from its position", "leave it out, or place a Point where the camera is"),
    "mutator": ("mutation adds normal noise to position and heading", "say how much by positionStdDev and headingStdDev, or draw the value yourself"),
}
"""Properties of both releases that would be without effect here: why, and what to write."""


def _refuse_split_vector(node: TupleDisplay) -> None:
    """Raises ParseError for `C at 1, 2`, which reads as a tuple but was meant as `C at (1, 2)`."""
    first = node.items[0] if node.items else None
    if len(node.items) != 2 or not isinstance(first, ObjectOrOperator) or not isinstance(first.as_operator, FieldAt | OffsetBy):
        return
    vector = first.as_operator.vector if isinstance(first.as_operator, FieldAt) else first.as_operator.offset
    if is_number_literal(vector) and is_number_literal(node.items[1]) and node.span.column == first.span.column:
        raise ParseError("a vector needs parentheses", join(vector.span, node.span), hint="write `(x, y)`")


def is_number_literal(node: Expression) -> bool:
    """Whether `node` is a number, perhaps with a sign."""
    if isinstance(node, UnaryOperation):
        node = node.operand
    return isinstance(node, Constant) and isinstance(node.value, int | float)


def condition(node: Expression) -> Expression:
    """`node` where a truth value is meant: `x in y` is then a comparison, whatever `x` is."""
    if isinstance(node, ObjectOrOperator) and isinstance(node.as_operator, Comparison):
        return node.as_operator
    return node


def names_of(tokens: Parts) -> list[Token]:
    """The NAME tokens among `tokens`."""
    return [token for token in tokens if isinstance(token, Token) and token.type == "NAME"]
