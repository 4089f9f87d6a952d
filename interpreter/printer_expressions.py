"""Expressions and specifiers as source text, with parentheses around every operand that is not a single term."""



from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from ..semantics.syntax import Expression, Specifier
from ..semantics.syntax import expressions as e
from ..semantics.syntax import python_expressions as p
from ..semantics.syntax import specifiers as q
from .chains import is_dotted_name
from .printer_strings import StringPrinter

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
        """One specifier."""
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
