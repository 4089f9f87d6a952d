"""How a flat chain of infix operators associates (see the third idea in `grammar.lark`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...semantics.syntax import Expression, Span, Specifier
from ...semantics.syntax.expressions import (
    FieldAt,
    IntervalOrPair,
    NotVisible,
    ObjectDefinition,
    ObjectOrOperator,
    OffsetAlong,
    OffsetBy,
    RelativeTo,
    VisibleFrom,
)
from ...semantics.syntax.python_expressions import Attribute, Name, TupleDisplay
from ...semantics.syntax.specifiers import (
    AtSpecifier,
    NotVisibleSpecifier,
    OffsetAlongSpecifier,
    OffsetBySpecifier,
    VisibleSpecifier,
)

Kind = Literal["AT", "VISIBLE_FROM", "NOT_VISIBLE_FROM", "RELATIVE_TO", "OFFSET_BY", "OFFSET_ALONG"]
TO_THE_END = ("AT", "VISIBLE_FROM", "NOT_VISIBLE_FROM")


@dataclass(frozen=True, slots=True)
class Link:
    """An infix operator with the operand after it; `direction` is set for `offset along`."""

    kind: Kind
    operand: Expression
    keyword: Span
    direction: Expression | None = None


def join(start: Span, end: Span) -> Span:
    """The stretch of text from the beginning of `start` to the end of `end`."""
    return Span(start.file, start.line, start.column, end.end_line, end.end_column)


def is_dotted_name(node: Expression) -> bool:
    """Whether `node` is a name or an attribute of a dotted name, hence possibly a class."""
    while isinstance(node, Attribute):
        node = node.value
    return isinstance(node, Name)


def as_vector(node: Expression) -> Expression:
    """`node` where a vector is meant: there a pair is a pair in every dialect."""
    if isinstance(node, IntervalOrPair):
        return TupleDisplay(span=node.span, items=(node.low, node.high))
    return node


def associate(first: Expression, links: list[Link], objects: bool) -> Expression:
    """The tree of `first link link ...`; where a (dotted) name heads a chain, it may be a class, if `objects` are made without `new`."""
    operands = [first, *(link.operand for link in links)]
    trees = operands[:]  # trees[i]: the tree of everything from operand i to the end
    for index in range(len(links) - 1, -1, -1):
        head, opening = operands[index], links[index]
        operator = _fold(index, links, trees, head)
        if objects and opening.kind != "RELATIVE_TO" and is_dotted_name(head):
            definition = ObjectDefinition(span=operator.span, class_=head, specifiers=(_specifier(opening, trees[index + 1]),))
            trees[index] = ObjectOrOperator(span=operator.span, head=head, as_object=definition, as_operator=operator)
        else:
            trees[index] = operator
    return trees[0]


def _fold(start: int, links: list[Link], trees: list[Expression], head: Expression) -> Expression:
    """The reading as operators of the chain that begins with `head`, the operand number `start`."""
    if links[start].kind in TO_THE_END:
        return apply(links[start], head, trees[start + 1])
    tree = head
    for index in range(start, len(links)):
        if index + 1 < len(links) and links[index + 1].kind in TO_THE_END:
            return apply(links[index], tree, trees[index + 1])
        tree = apply(links[index], tree, links[index].operand)
    return tree


def apply(link: Link, left: Expression, right: Expression) -> Expression:
    """`left operator right` for the operator of `link`."""
    span = join(left.span, right.span)
    match link.kind:
        case "AT":
            return FieldAt(span=span, field=left, vector=as_vector(right))
        case "VISIBLE_FROM":
            return VisibleFrom(span=span, region=left, viewer=right)
        case "NOT_VISIBLE_FROM":
            return NotVisible(span=span, region=left, viewer=right)
        case "RELATIVE_TO":
            return RelativeTo(span=span, left=left, right=right)
        case "OFFSET_BY":
            return OffsetBy(span=span, base=as_vector(left), offset=as_vector(right))
        case "OFFSET_ALONG":
            assert link.direction is not None
            return OffsetAlong(span=span, base=as_vector(left), direction=link.direction, offset=as_vector(right))


def _specifier(link: Link, argument: Expression) -> Specifier:
    """Return the operator read as the first specifier of an object definition."""
    span = join(link.keyword, argument.span)
    match link.kind:
        case "AT":
            return AtSpecifier(span=span, vector=as_vector(argument))
        case "VISIBLE_FROM":
            return VisibleSpecifier(span=span, viewer=argument)
        case "NOT_VISIBLE_FROM":
            return NotVisibleSpecifier(span=span, viewer=argument)
        case "OFFSET_ALONG":
            assert link.direction is not None
            return OffsetAlongSpecifier(span=span, direction=link.direction, offset=as_vector(argument))
        case _:
            return OffsetBySpecifier(span=span, offset=as_vector(argument))
