"""Syntax trees in the form in which the parser gives them, so that parse(print(p)) = p can be asked of every program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from ...semantics.syntax import Expression, Specifier
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import specifiers as q
from ...semantics.syntax import statements as s

Arithmetic = Literal["+", "-", "*", "/", "//", "%", "**"]
ParameterKind = Literal["positional", "*args", "keyword only", "**kwargs"]
Link = Literal["==", "!=", "<", ">", "<=", ">="]


def name(text: str) -> p.Name:
    """Return the node of a variable."""
    return p.Name(name=text)


def constant_literal(value: object) -> p.Constant:
    """A literal that is not a negative number."""
    return p.Constant(value=value)


def number_literal(value: float) -> Expression:
    """A number; a negative one is a minus sign and a literal, and a whole one is written without a point."""
    written = int(value) if float(value).is_integer() else value
    return p.UnaryOperation(operator="-", operand=p.Constant(value=-written)) if written < 0 else p.Constant(value=written)


def is_dotted(node: Expression) -> bool:
    """Whether the parser could take the node for the name of a class."""
    while isinstance(node, p.Attribute):
        node = node.value
    return isinstance(node, p.Name)


def as_whole_value(node: Expression) -> Expression:
    """The node as a whole statement, the right-hand side of an assignment, a default value or a result."""
    return e.ObjectOrValue(value=node) if is_dotted(node) else node


def pair(x: Expression, y: Expression) -> p.TupleDisplay:
    """`(x, y)`."""
    return p.TupleDisplay(items=(x, y))


def attribute(value: Expression, *names: str) -> Expression:
    """`value.name.name`."""
    for each in names:
        value = p.Attribute(value=value, name=each)
    return value


def call(function: str | Expression, *arguments: Expression, **keywords: Expression) -> p.Call:
    """`function(arguments, name=value)`."""
    named = tuple(p.Keyword(name=key, value=value) for key, value in keywords.items())
    return p.Call(function=name(function) if isinstance(function, str) else function, arguments=arguments, keywords=named)


def operation(left: Expression, operator: Arithmetic, right: Expression) -> p.BinaryOperation:
    """`left operator right`."""
    return p.BinaryOperation(operator=operator, left=left, right=right)


def comparison(left: Expression, operator: Link, right: Expression) -> p.Comparison:
    """`left operator right`."""
    return p.Comparison(left=left, operators=(operator,), operands=(right,))


def is_in(left: Expression, region: Expression) -> p.Comparison:
    """`left is in region`."""
    return p.Comparison(left=left, operators=("in",), operands=(region,))


def degrees(value: Expression | float) -> Expression:
    """`value deg`; `-S deg` means `-(S deg)` in every dialect."""
    if isinstance(value, (int, float)):
        return degrees(number_literal(value))
    if isinstance(value, p.UnaryOperation) and value.operator == "-":
        return p.UnaryOperation(operator="-", operand=degrees(value.operand))
    return e.Degrees(value=value)


def clamp_call(node: Expression, low: float, high: float) -> Expression:
    """`min(max(node, low), high)`."""
    return call("min", call("max", node, number_literal(low)), number_literal(high))


def _either(head: Expression, specifier: Specifier, operator: Expression) -> Expression:
    """Return what the parser gives where a (dotted) name may be a class or an operand; otherwise the
    operator.
    """
    if not is_dotted(head):
        return operator
    definition = e.ObjectDefinition(class_=head, specifiers=(specifier,))
    return e.ObjectOrOperator(head=head, as_object=definition, as_operator=operator)


def field_at(field: Expression, vector: Expression) -> Expression:
    """`F at V`."""
    return _either(field, q.AtSpecifier(vector=vector), e.FieldAt(field=field, vector=vector))


def offset_by(base: Expression, offset: Expression) -> Expression:
    """`V offset by V`."""
    return _either(base, q.OffsetBySpecifier(offset=offset), e.OffsetBy(base=base, offset=offset))


def offset_along(base: Expression, direction: Expression, offset: Expression) -> Expression:
    """`V offset along D by V`."""
    specifier = q.OffsetAlongSpecifier(direction=direction, offset=offset)
    return _either(base, specifier, e.OffsetAlong(base=base, direction=direction, offset=offset))


def visible_from(region: Expression, viewer: Expression) -> Expression:
    """`R visible from P`."""
    return _either(region, q.VisibleSpecifier(viewer=viewer), e.VisibleFrom(region=region, viewer=viewer))


def new_object(class_: str, specifiers: Sequence[Specifier]) -> Expression:
    """`class specifier, ..., specifier` where any expression may stand; at least one specifier."""
    head = name(class_)
    definition = e.ObjectDefinition(class_=head, specifiers=tuple(specifiers))
    if len(specifiers) > 1:
        return definition
    operator = _as_operator(head, specifiers[0])
    return definition if operator is None else e.ObjectOrOperator(head=head, as_object=definition, as_operator=operator)


def _as_operator(head: Expression, specifier: Specifier) -> Expression | None:
    """The operator that `head specifier` would be if `head` were not a class."""
    match specifier:
        case q.AtSpecifier(vector=vector):
            return e.FieldAt(field=head, vector=vector)
        case q.OffsetBySpecifier(offset=offset):
            return e.OffsetBy(base=head, offset=offset)
        case q.OffsetAlongSpecifier(direction=direction, offset=offset):
            return e.OffsetAlong(base=head, direction=direction, offset=offset)
        case q.VisibleSpecifier(viewer=viewer) if viewer is not None:
            return e.VisibleFrom(region=head, viewer=viewer)
        case q.InSpecifier(keyword="in", region=region):
            return p.Comparison(left=head, operators=("in",), operands=(region,))
        case _:
            return None


def assign(target: str | Expression, value: Expression) -> s.Assignment:
    """`target = value`."""
    return s.Assignment(targets=(name(target) if isinstance(target, str) else target,), value=as_whole_value(value))


def alone(value: Expression) -> s.ExpressionStatement:
    """An expression as a statement."""
    return s.ExpressionStatement(value=as_whole_value(value))


def give_back(value: Expression) -> s.Return:
    """`return value`."""
    return s.Return(value=as_whole_value(value))


def parameter(text: str, default: Expression | None = None, kind: ParameterKind = "positional") -> p.Parameter:
    """A parameter of a function."""
    return p.Parameter(name=text, default=default, kind=kind)
