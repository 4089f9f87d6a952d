"""Assignment targets: which expressions can be assigned to."""

from __future__ import annotations

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Expression
from ..semantics.syntax.expressions import IntervalOrPair, ObjectDefinition, ObjectOrOperator
from ..semantics.syntax.python_expressions import Attribute, Call, Comparison, Constant, ListDisplay, Name, Starred, Subscript, TupleDisplay

NESTING_LIMIT = 50


def target(node: Expression, *, starred: bool = False, depth: int = 0) -> Expression:
    """`node` as a target: names, attributes, subscripts, and tuples, lists and starred forms of them.

    Raises ParseError for anything else.
    """
    if depth > NESTING_LIMIT:
        raise ParseError("the target is nested too deeply", node.span)
    match node:
        case Name() | Attribute() | Subscript():
            return node
        case IntervalOrPair():
            pair = TupleDisplay(span=node.span, items=(node.low, node.high))
            return target(pair, depth=depth)
        case TupleDisplay() | ListDisplay():
            items = tuple(target(item, starred=True, depth=depth + 1) for item in node.items)
            if sum(isinstance(item, Starred) for item in items) > 1:
                raise ParseError("an assignment can have one starred target only", node.span)
            return type(node)(span=node.span, items=items)
        case Starred() if starred:
            return Starred(span=node.span, value=target(node.value, depth=depth + 1))
        case _:
            hint = "write == to compare" if isinstance(node, Comparison | Call | Constant) else ""
            if isinstance(node, ObjectDefinition | ObjectOrOperator):
                hint = "specifiers take their values without `=`, and a vector is written `(x, y)`"
            raise ParseError("this cannot be assigned to", node.span, hint=hint)


def single_target(node: Expression) -> Expression:
    """`node` as the target of an augmented assignment or a deletion: a name, an attribute or a subscript."""
    if not isinstance(node, Name | Attribute | Subscript):
        raise ParseError("expected a name, an attribute or a subscript", node.span)
    return node


def deleted(node: Expression) -> tuple[Expression, ...]:
    """The targets of `del`, in order."""
    items = node.items if isinstance(node, TupleDisplay | ListDisplay) else (node,)
    return tuple(single_target(item) for item in items)
