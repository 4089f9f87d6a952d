"""The part of the builder for expressions inherited from Python."""



from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lark import Token

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Expression, Span
from ..semantics.syntax.expressions import IntervalOrPair, ObjectDefinition, ObjectOrOperator, VectorOf
from ..semantics.syntax.python_expressions import (
    Attribute,
    BinaryOperation,
    BooleanOperation,
    Call,
    Comparison,
    Comprehension,
    ComprehensionClause,
    Constant,
    DictDisplay,
    Keyword,
    Lambda,
    ListDisplay,
    Name,
    Parameter,
    SetDisplay,
    Slice,
    Starred,
    Subscript,
    TupleDisplay,
    UnaryOperation,
)
from ..semantics.syntax.specifiers import InSpecifier
from . import literals
from .chains import is_dotted_name, join
from .targets import target
from .tree_builder import BuilderBase, Parts, condition

CONSTANTS = {"True": True, "False": False, "None": None, "...": ...}


@dataclass(frozen=True, slots=True)
class BareGenerator:
    """A generator that stands in a call without parentheses of its own."""

    generator: Comprehension


class ExpressionBuilder(BuilderBase):
    """One method per rule of the grammar's Python expressions."""

    # -- Atoms

    def make_name(self, span: Span, parts: Parts) -> Name:
        return Name(span=span, name=self.identifier(parts[0]))

    def make_number(self, span: Span, parts: Parts) -> Constant:
        try:
            return Constant(span=span, value=literals.number(str(parts[0])))
        except literals.LiteralFault as fault:
            raise ParseError(fault.message, span) from None

    def make_constant(self, span: Span, parts: Parts) -> Constant:
        return Constant(span=span, value=CONSTANTS[str(parts[0])])

    # -- Displays and comprehensions

    def make_tuple_items(self, span: Span, parts: Parts) -> Expression:
        if len(parts) == 1 and self.is_block_of_specifiers(parts[0]):
            return parts[0]
        return TupleDisplay(span=span, items=tuple(parts))

    def is_block_of_specifiers(self, node: object) -> bool:
        """Return whether a node is `new C ...` with a line for each specifier, which may end with a comma."""
        if not (self.dialect.explicit_new and isinstance(node, ObjectDefinition) and node.specifiers):
            return False
        return node.specifiers[-1].span.line > node.class_.span.end_line

    def make_tuple_display(self, span: Span, parts: Parts) -> TupleDisplay | IntervalOrPair:
        if self.dialect.intervals and len(parts) == 2 and not any(isinstance(part, Starred) for part in parts):
            return IntervalOrPair(span=span, low=parts[0], high=parts[1])
        return TupleDisplay(span=span, items=tuple(parts))

    def make_list_display(self, span: Span, parts: Parts) -> ListDisplay:
        return ListDisplay(span=span, items=tuple(parts))

    def make_set_display(self, span: Span, parts: Parts) -> SetDisplay:
        return SetDisplay(span=span, items=tuple(parts))

    def make_dict_display(self, span: Span, parts: Parts) -> DictDisplay:
        items = [(None, part.value) if isinstance(part, Keyword) else part for part in parts]
        return DictDisplay(span=span, items=tuple(items))

    def make_pair(self, span: Span, parts: Parts) -> tuple[Expression, Expression]:
        return parts[0], parts[1]

    def make_comprehension_clause(self, span: Span, parts: Parts) -> ComprehensionClause:
        targets, _, iterable, *conditions = parts
        return ComprehensionClause(span=span, target=target(targets), iterable=condition(iterable), conditions=tuple(conditions))

    def make_condition(self, span: Span, parts: Parts) -> Expression:
        return condition(parts[0])

    def make_generator(self, span: Span, parts: Parts) -> Comprehension:
        return Comprehension(span=span, kind="generator", element=parts[0], clauses=tuple(parts[1:]))

    def make_list_comprehension(self, span: Span, parts: Parts) -> Comprehension:
        return Comprehension(span=span, kind="list", element=parts[0], clauses=tuple(parts[1:]))

    def make_set_comprehension(self, span: Span, parts: Parts) -> Comprehension:
        return Comprehension(span=span, kind="set", element=parts[0], clauses=tuple(parts[1:]))

    def make_dict_comprehension(self, span: Span, parts: Parts) -> Comprehension:
        return Comprehension(span=span, kind="dict", key=parts[0], element=parts[1], clauses=tuple(parts[2:]))

    def make_starred(self, span: Span, parts: Parts) -> Starred:
        return Starred(span=span, value=parts[1])

    # -- Primaries

    def make_attribute(self, span: Span, parts: Parts) -> Attribute:
        return Attribute(span=span, value=parts[0], name=self.identifier(parts[1]))

    def make_subscript(self, span: Span, parts: Parts) -> Subscript:
        return Subscript(span=span, value=parts[0], index=parts[1])

    def make_slice(self, span: Span, parts: Parts) -> Slice:
        lower, _, upper, step = parts
        return Slice(span=span, lower=lower, upper=upper, step=step[0] if step else None)

    def make_slice_step(self, span: Span, parts: Parts) -> tuple[Expression | None]:
        return (parts[1],)

    def make_call(self, span: Span, parts: Parts) -> Call:
        function, arguments = parts[0], parts[1] or []
        if len(arguments) > 1:
            for item in arguments:
                if isinstance(item, BareGenerator):
                    raise ParseError("a generator among other arguments needs parentheses", item.generator.span)
        positional: list[Expression] = []
        keywords: list[Keyword] = []
        for item in arguments:
            if isinstance(item, BareGenerator):
                positional.append(item.generator)
            elif isinstance(item, Keyword):
                keywords.append(item)
            elif keywords and not (isinstance(item, Starred) and all(k.name is not None for k in keywords)):
                raise ParseError("a positional argument follows a keyword argument", item.span)
            else:
                positional.append(item)
        return Call(span=span, function=function, arguments=tuple(positional), keywords=tuple(keywords))

    def make_arguments(self, span: Span, parts: Parts) -> Parts:
        return parts

    def make_starred_argument(self, span: Span, parts: Parts) -> Starred:
        return Starred(span=span, value=parts[1])

    def make_double_starred(self, span: Span, parts: Parts) -> Keyword:
        return Keyword(span=span, name=None, value=parts[1])

    def make_keyword_argument(self, span: Span, parts: Parts) -> Keyword:
        return Keyword(span=span, name=self.identifier(parts[0]), value=parts[1])

    def make_argument_comprehension(self, span: Span, parts: Parts) -> BareGenerator:
        return BareGenerator(self.make_generator(span, parts))

    # -- Operators

    def make_binary(self, span: Span, parts: Parts) -> Expression:
        tree: Expression = parts[0]
        for operator, operand in zip(parts[1::2], parts[2::2], strict=True):
            place = join(tree.span, operand.span) if operand is not parts[-1] else span
            if operator == "@":
                tree = VectorOf(span=place, x=tree, y=operand)
            else:
                tree = BinaryOperation(span=place, operator=str(operator), left=tree, right=operand)  # pyright: ignore[reportArgumentType]
        return tree

    def make_unary(self, span: Span, parts: Parts) -> UnaryOperation:
        return UnaryOperation(span=span, operator=str(parts[0]), operand=parts[1])  # pyright: ignore[reportArgumentType]

    def make_negation(self, span: Span, parts: Parts) -> UnaryOperation:
        return UnaryOperation(span=span, operator="not", operand=condition(parts[0]))

    def make_or_test(self, span: Span, parts: Parts) -> BooleanOperation:
        return BooleanOperation(span=span, operator="or", operands=tuple(map(condition, parts)))

    def make_and_test(self, span: Span, parts: Parts) -> BooleanOperation:
        return BooleanOperation(span=span, operator="and", operands=tuple(map(condition, parts)))

    def make_comparison(self, span: Span, parts: Parts) -> Expression:
        operators: Any = tuple(self.comparison_operator(token) for token in parts[1::2])
        node = Comparison(span=span, left=parts[0], operators=operators, operands=tuple(parts[2::2]))
        if self.dialect.explicit_new or operators != ("in",) or not is_dotted_name(parts[0]) or parts[1].type == "IS_IN":
            return node
        place = join(self.token_span(parts[1]), parts[2].span)
        specifier = InSpecifier(span=place, keyword="in", region=parts[2])
        definition = ObjectDefinition(span=span, class_=parts[0], specifiers=(specifier,))
        return ObjectOrOperator(span=span, head=parts[0], as_object=definition, as_operator=node)

    def comparison_operator(self, token: Token) -> str:
        return "in" if token.type == "IS_IN" else " ".join(token.split())

    def make_lambda(self, span: Span, parts: Parts) -> Lambda:
        return Lambda(span=span, parameters=tuple(parts[0] or ()), body=parts[1])

    # -- Parameters

    def make_parameter(self, span: Span, parts: Parts) -> Parameter:
        return Parameter(span=span, name=self.identifier(parts[0]), default=parts[1])

    def make_typed_parameter(self, span: Span, parts: Parts) -> Parameter:
        return self.make_parameter(span, [parts[0], parts[2]])

    def make_rest_parameter(self, span: Span, parts: Parts) -> Parameter:
        return Parameter(span=span, name=self.identifier(parts[1]), kind="*args")

    def make_keyword_parameter(self, span: Span, parts: Parts) -> Parameter:
        return Parameter(span=span, name=self.identifier(parts[1]), kind="**kwargs")

    make_typed_rest_parameter, make_typed_keyword_parameter = make_rest_parameter, make_keyword_parameter

    def make_parameters(self, span: Span, parts: Parts) -> tuple[Parameter, ...]:
        """The parameters with their kinds. Raises ParseError where their order is not Python's."""
        found: list[Parameter] = []
        keyword_only = False
        for part in parts:
            if isinstance(part, Token) and part == "/":
                if not found or keyword_only or any(p.kind != "positional" for p in found):
                    raise ParseError("`/` must follow positional parameters", self.token_span(part))
                found = [Parameter(span=p.span, name=p.name, default=p.default, kind="positional only") for p in found]
            elif isinstance(part, Token):
                if keyword_only or part is parts[-1]:
                    raise ParseError("`*` must stand once, before keyword-only parameters", self.token_span(part))
                keyword_only = True
            elif part.kind == "*args":
                if keyword_only:
                    raise ParseError("there can be one `*` parameter only", part.span)
                keyword_only = True
                found.append(part)
            elif found and found[-1].kind == "**kwargs":
                raise ParseError("no parameter can follow `**`", part.span)
            elif part.kind == "positional" and keyword_only:
                found.append(Parameter(span=part.span, name=part.name, default=part.default, kind="keyword only"))
            else:
                if part.kind == "positional" and part.default is None and found and found[-1].default is not None:
                    raise ParseError(f"parameter `{part.name}` without a default follows one with a default", part.span)
                found.append(part)
        return tuple(found)
