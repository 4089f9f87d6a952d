"""The nodes of the syntax tree from Lark's: expressions and statements of Python, Scenic's own, specifiers, behaviors and scenarios."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, get_args

from lark import Token

from ...semantics.store.errors import ParseError
from ...semantics.store.scopes import bound_by
from ...semantics.store.suggestions import did_you_mean
from ...semantics.syntax import Block, Expression, Span, Specifier, Statement
from ...semantics.syntax.dynamics import (
    Abort,
    BehaviorDefinition,
    Do,
    DoChoose,
    DoShuffle,
    MonitorDefinition,
    Override,
    Record,
    RequireAlways,
    RequireEventually,
    RequireMonitor,
    ScenarioDefinition,
    Take,
    Terminate,
    TerminateAfter,
    TerminateWhen,
    TimeLimit,
    Until,
    Wait,
    WaitFor,
)
from ...semantics.syntax.expressions import (
    Angle,
    ApparentHeading,
    CanSee,
    Degrees,
    Distance,
    DistancePast,
    FieldAt,
    Follow,
    InInitialScenario,
    Intersects,
    IntervalOrPair,
    NotVisible,
    ObjectDefinition,
    ObjectOrOperator,
    OffsetAlong,
    OffsetBy,
    RelativeHeading,
    RelativePosition,
    Seconds,
    Side,
    SideOf,
    VectorOf,
    Visible,
    VisibleFrom,
)
from ...semantics.syntax.python_expressions import (
    Attribute,
    BinaryOperation,
    BooleanOperation,
    Call,
    Comparison,
    Comprehension,
    ComprehensionClause,
    Conditional,
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
from ...semantics.syntax.specifiers import (
    ApparentlyFacingSpecifier,
    AtSpecifier,
    BesideSpecifier,
    BeyondSpecifier,
    ContainedInSpecifier,
    FacingAwayFromSpecifier,
    FacingSpecifier,
    FacingTowardSpecifier,
    FollowingSpecifier,
    InSpecifier,
    NotVisibleSpecifier,
    OffsetAlongSpecifier,
    OffsetBySpecifier,
    VisibleSpecifier,
    WithSpecifier,
)
from ...semantics.syntax.statements import (
    Assert,
    Assignment,
    AugmentedAssignment,
    Break,
    ChooseSimulator,
    ClassDefinition,
    Continue,
    Delete,
    ExpressionStatement,
    For,
    FunctionDefinition,
    Global,
    Handler,
    If,
    Import,
    ImportedName,
    ImportFrom,
    Interrupt,
    Model,
    Mutate,
    Nonlocal,
    Param,
    ParamAssignment,
    Pass,
    PropertyDefault,
    Raise,
    Require,
    Return,
    SoftRequire,
    Try,
    While,
)
from . import literals
from .dialects import dialects_with_feature
from .infix_chains import Link, as_vector, associate, is_dotted_name, join
from .name_checks import nodes_of_scope
from .nesting import children
from .printer import to_source
from .syntax_errors import inside_brackets
from .temporal_formulas import instead, operator_of, over_time, refuse_formulas, refuse_time, with_probability
from .tree_builder import BuilderBase, Parts, condition, is_number_literal, names_of

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


def deletion_targets(node: Expression) -> tuple[Expression, ...]:
    """The targets of `del`, in order."""
    items = node.items if isinstance(node, TupleDisplay | ListDisplay) else (node,)
    return tuple(single_target(item) for item in items)


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
            return Constant(span=span, value=literals.parse_number_literal(str(parts[0])))
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


CHAIN_LIMIT = 50
OPERATORS = Comparison | FieldAt | NotVisible | OffsetAlong | OffsetBy | VisibleFrom
"""What `C` and a first specifier look like where objects are made with `new`."""
BEGIN = "begin with a class, as in `Car at X, facing H`"
SPECIFIER_ARGUMENTS: Mapping[type[Specifier], str] = {
    AtSpecifier: "vector", OffsetBySpecifier: "offset", OffsetAlongSpecifier: "offset", InSpecifier: "region",
    VisibleSpecifier: "viewer", NotVisibleSpecifier: "viewer",
}
"""The last argument of the specifiers that are operators as well."""
SIDES: dict[str, Side] = {side: side for side in get_args(Side)}


class ScenicBuilder(BuilderBase):
    """One method per rule of the grammar's Scenic expressions and specifiers."""

    # -- Infix operators

    def make_sight(self, span: Span, parts: Parts) -> Expression:
        tree = parts[0]
        for word, operand in zip(parts[1::2], parts[2::2], strict=True):
            whole = join(tree.span, operand.span)
            if word.type == "CAN_SEE":
                tree = CanSee(span=whole, viewer=tree, target=as_vector(operand))
            else:
                self.released("intersects", self.token_span(word), "write `R.intersects(S)` of regions")
                tree = Intersects(span=whole, left=tree, right=operand)
        return tree

    def make_phrase(self, span: Span, parts: Parts) -> Expression:
        links: list[Link] = []
        rest = iter(parts[1:])
        for token in rest:
            direction = next(rest) if token.type == "OFFSET_ALONG" else None
            if token.type == "NOT_VISIBLE_FROM":
                self.released("not visible from", self.token_span(token))
            links.append(Link(token.type, next(rest), self.token_span(token), direction))
        if len(links) > CHAIN_LIMIT:
            raise ParseError("nested too deeply", links[CHAIN_LIMIT].keyword)
        return associate(parts[0], links, objects=not self.dialect.explicit_new)

    # -- Postfix and prefix operators

    def make_degrees(self, span: Span, parts: Parts) -> Expression:
        """`S deg`; in the releases `X @ Y deg` is `(X @ Y) deg`, hence `(X deg) @ (Y deg)`, and `-S deg` is `(-S) deg`, hence `-(S deg)`."""
        value = parts[0]
        if self.dialect.released and isinstance(value, UnaryOperation) and value.operator == "-":
            return UnaryOperation(span=span, operator="-", operand=Degrees(span=span, value=value.operand))
        if self.dialect.released and isinstance(value, VectorOf):
            return VectorOf(span=span, x=Degrees(span=value.x.span, value=value.x), y=Degrees(span=value.y.span, value=value.y))
        return Degrees(span=span, value=value)

    def make_seconds(self, span: Span, parts: Parts) -> Seconds:
        return Seconds(span=span, value=parts[0])

    def make_relative_heading(self, span: Span, parts: Parts) -> RelativeHeading:
        return RelativeHeading(span=span, heading=parts[0], origin=parts[1])

    def make_apparent_heading(self, span: Span, parts: Parts) -> ApparentHeading:
        return ApparentHeading(span=span, oriented_point=parts[0], origin=vector_or_none(parts[1]))

    def make_distance(self, span: Span, parts: Parts) -> Distance:
        ends = dict(part for part in parts if part is not None)
        return Distance(span=span, origin=ends.get("from"), target=ends.get("to"))

    def make_angle(self, span: Span, parts: Parts) -> Angle:
        ends = dict(part for part in parts if part is not None)
        return Angle(span=span, origin=ends.get("from"), target=ends.get("to"))

    def make_from_(self, span: Span, parts: Parts) -> tuple[str, Expression]:
        return "from", as_vector(parts[0])

    def make_to_(self, span: Span, parts: Parts) -> tuple[str, Expression]:
        return "to", as_vector(parts[0])

    def make_distance_past(self, span: Span, parts: Parts) -> DistancePast:
        return DistancePast(span=span, oriented_point=parts[0], vector=as_vector(parts[1]))

    def make_distance_past_of(self, span: Span, parts: Parts) -> DistancePast:
        self.released("distance past ... of", span, "write `distance of ... past ...`")
        return DistancePast(span=span, oriented_point=parts[1], vector=as_vector(parts[0]))

    def make_relative_position(self, span: Span, parts: Parts) -> RelativePosition:
        word, target, origin = parts
        self.released("relative position of", self.token_span(word), "write the difference of the positions")
        return RelativePosition(span=span, target=as_vector(target), origin=vector_or_none(origin))

    def make_not_visible_region(self, span: Span, parts: Parts) -> NotVisible:
        word, region = parts
        self.released("not visible", self.token_span(word), "if a truth value is negated, write `not (visible ...)`")
        return NotVisible(span=span, region=region)

    def make_follow(self, span: Span, parts: Parts) -> Follow:
        return Follow(span=span, field=parts[0], origin=vector_or_none(parts[1]), distance=parts[2])

    def make_side_of(self, span: Span, parts: Parts) -> SideOf:
        return SideOf(span=span, side=SIDES[" ".join(parts[0].split()[:-1])], object=parts[1])

    def make_left_side_of(self, span: Span, parts: Parts) -> SideOf:
        return SideOf(span=span, side="left", object=parts[0])

    def make_right_side_of(self, span: Span, parts: Parts) -> SideOf:
        return SideOf(span=span, side="right", object=parts[0])

    def make_visible(self, span: Span, parts: Parts) -> Visible:
        return Visible(span=span, region=parts[0])

    def make_in_initial_scenario(self, span: Span, parts: Parts) -> InInitialScenario:
        return InInitialScenario(span=span)

    def make_initial_scenario(self, span: Span, parts: Parts) -> InInitialScenario:
        if not self.dialect.initial_scenario:
            message = f"`initial scenario` without `in` belongs to dialect {dialects_with_feature('initial_scenario')}"
            raise ParseError(message, span, hint="write `in initial scenario`")
        return InInitialScenario(span=span)

    # -- Object definitions

    def make_conditional(self, span: Span, parts: Parts) -> Expression:
        """`E if B else E`; in `scenic-2.1` what stands behind `C at`, without brackets, is one argument of the specifier if C is a class."""
        then, test, otherwise = parts[0], condition(parts[1]), parts[2]
        whole = Conditional(span=span, then=then, test=test, otherwise=otherwise)
        bracketed = (then.span.line, then.span.column) != (span.line, span.column)
        if not self.dialect.released or self.dialect.explicit_new or bracketed or not isinstance(then, ObjectOrOperator):
            return whole
        followed = self.stray.pop(otherwise.span, None) is not None
        last, more = (otherwise.class_, otherwise.specifiers) if followed else (otherwise, ())
        first = then.as_object.specifiers[0]
        name = SPECIFIER_ARGUMENTS[type(first)]
        value = Conditional(span=join(first.span, last.span), then=getattr(first, name), test=test, otherwise=last)
        made = ObjectDefinition(span=span, class_=then.head, specifiers=(replace(first, **{name: value}), *more))
        if followed:
            return made
        return ObjectOrOperator(span=span, head=then.head, as_object=made, as_operator=replace(whole, then=then.as_operator))

    def make_object_definition(self, span: Span, parts: Parts) -> ObjectDefinition:
        class_, *specifiers = parts
        if is_number_literal(class_) and isinstance(specifiers[0], BesideSpecifier) and specifiers[0].gap is None:
            hint = f"write `{to_source(specifiers[0], self.dialect.name)} by {to_source(class_, self.dialect.name)}`"
            raise ParseError("the distance stands behind what it is measured from, with `by`", class_.span, hint=hint)
        self.require_class(class_)
        return self.defined(ObjectDefinition(span=span, class_=class_, specifiers=tuple(specifiers)))

    def make_object_after_operator(self, span: Span, parts: Parts) -> ObjectDefinition:
        first, *specifiers = parts
        if self.is_new_alone(first) and specifiers[0].span.line > first.span.end_line:  # `new C,` with its specifiers on the next lines
            return replace(first, span=span, specifiers=tuple(specifiers))
        if not isinstance(first, ObjectOrOperator):
            lacks_new = self.dialect.explicit_new and isinstance(first, OPERATORS) and is_dotted_name(next(children(first)))  # type: ignore[arg-type]
            self.stray[span] = self.needs_new(first.span) if lacks_new else stray(first, specifiers[0], self.origin.source)
            return ObjectDefinition(span=span, class_=first, specifiers=tuple(specifiers))
        definition = first.as_object
        return self.defined(ObjectDefinition(span=span, class_=definition.class_, specifiers=definition.specifiers + tuple(specifiers)))

    def make_new_object(self, span: Span, parts: Parts) -> ObjectDefinition:
        word, class_, *specifiers = parts
        if not self.dialect.explicit_new:
            message = f"`new` belongs to dialect {dialects_with_feature('explicit_new')}"
            hint = "leave out `new`, or begin the program with `# dialect: scenic-3`"
            raise ParseError(message, self.token_span(word), hint=hint)
        self.require_class(class_)
        return ObjectDefinition(span=span, class_=class_, specifiers=tuple(specifiers))

    def is_new_alone(self, node: object) -> bool:
        """Return whether a node is `new C` without specifiers."""
        return self.dialect.explicit_new and isinstance(node, ObjectDefinition) and not node.specifiers

    def defined(self, definition: ObjectDefinition) -> ObjectDefinition:
        """`definition`, noted as one that still lacks its `new` where the dialect wants one."""
        if self.dialect.explicit_new:
            self.without_new[definition.span] = definition
        return self.regrouped(definition) if self.dialect.released and not self.dialect.explicit_new else definition

    def regrouped(self, definition: ObjectDefinition) -> ObjectDefinition:
        """`C ..., with p D at X, rest` in `scenic-2.1`: the rest belongs to D, where that is a class of this text and no bracket closes before it."""
        for i, specifier in enumerate(definition.specifiers[:-1]):
            value = specifier.value if isinstance(specifier, WithSpecifier) else None
            if not isinstance(value, ObjectOrOperator) or not (isinstance(value.head, Name) and value.head.name in self.classes):
                continue
            if (value.span.end_line, value.span.end_column) == (specifier.span.end_line, specifier.span.end_column):
                made, rest = value.as_object, definition.specifiers[i + 1 :]
                inner = self.regrouped(replace(made, specifiers=made.specifiers + rest, span=join(made.span, rest[-1].span)))
                last = replace(specifier, value=inner, span=join(specifier.span, inner.span))
                return replace(definition, specifiers=(*definition.specifiers[:i], last))
        return definition

    def require_class(self, node: Expression) -> None:
        """Raises ParseError unless `node` can name a class."""
        if isinstance(node, Call) and is_dotted_name(node.function):
            example = "`new Car at X, facing H`" if self.dialect.explicit_new else "`Car at X, facing H`"
            raise ParseError("objects are not made by calling their class", node.span, hint=f"write specifiers behind it, as in {example}")
        if not is_dotted_name(node):
            raise ParseError("specifiers must follow the name of a class", node.span, hint=BEGIN)

    # -- Specifiers

    def make_with(self, span: Span, parts: Parts) -> WithSpecifier:
        return WithSpecifier(span=span, property=self.property_with_effect(self.identifier(parts[0]), span), value=parts[1])

    def make_at(self, span: Span, parts: Parts) -> AtSpecifier:
        return AtSpecifier(span=span, vector=as_vector(parts[1]))

    def make_offset_by(self, span: Span, parts: Parts) -> OffsetBySpecifier:
        return OffsetBySpecifier(span=span, offset=as_vector(parts[1]))

    def make_offset_along(self, span: Span, parts: Parts) -> OffsetAlongSpecifier:
        return OffsetAlongSpecifier(span=span, direction=parts[1], offset=as_vector(parts[2]))

    def make_in(self, span: Span, parts: Parts) -> InSpecifier:
        return InSpecifier(span=span, keyword="in", region=parts[1])

    def make_on(self, span: Span, parts: Parts) -> InSpecifier:
        return InSpecifier(span=span, keyword="on", region=parts[0])

    def make_contained_in(self, span: Span, parts: Parts) -> ContainedInSpecifier:
        if not self.dialect.explicit_new:
            raise ParseError(
                f"`contained in` belongs to dialect {dialects_with_feature('explicit_new')}", span, hint="write `in R, with regionContainedIn R`"
            )
        return ContainedInSpecifier(span=span, region=parts[0])

    def make_left_of(self, span: Span, parts: Parts) -> BesideSpecifier:
        return BesideSpecifier(span=span, side="left", reference=as_vector(parts[0]), gap=parts[1])

    def make_right_of(self, span: Span, parts: Parts) -> BesideSpecifier:
        return BesideSpecifier(span=span, side="right", reference=as_vector(parts[0]), gap=parts[1])

    def make_ahead_of(self, span: Span, parts: Parts) -> BesideSpecifier:
        return BesideSpecifier(span=span, side="ahead", reference=as_vector(parts[0]), gap=parts[1])

    def make_behind(self, span: Span, parts: Parts) -> BesideSpecifier:
        return BesideSpecifier(span=span, side="behind", reference=as_vector(parts[0]), gap=parts[1])

    def make_beyond(self, span: Span, parts: Parts) -> BeyondSpecifier:
        vector, offset, origin = parts
        return BeyondSpecifier(span=span, vector=as_vector(vector), offset=as_vector(offset), origin=vector_or_none(origin))

    def make_visible_lone(self, span: Span, parts: Parts) -> VisibleSpecifier:
        return VisibleSpecifier(span=span)

    def make_visible_from(self, span: Span, parts: Parts) -> VisibleSpecifier:
        return VisibleSpecifier(span=span, viewer=as_vector(parts[1]))

    def make_not_visible(self, span: Span, parts: Parts) -> NotVisibleSpecifier:
        self.released("not visible", self.token_span(parts[0]))
        return NotVisibleSpecifier(span=span)

    def make_not_visible_from(self, span: Span, parts: Parts) -> NotVisibleSpecifier:
        self.released("not visible from", self.token_span(parts[0]))
        return NotVisibleSpecifier(span=span, viewer=as_vector(parts[1]))

    def make_following(self, span: Span, parts: Parts) -> FollowingSpecifier:
        field, origin, distance = parts
        return FollowingSpecifier(span=span, field=field, origin=vector_or_none(origin), distance=distance)

    def make_facing(self, span: Span, parts: Parts) -> FacingSpecifier:
        return FacingSpecifier(span=span, direction=parts[0])

    def make_facing_toward(self, span: Span, parts: Parts) -> FacingTowardSpecifier:
        return FacingTowardSpecifier(span=span, vector=self.faced(*parts))

    def make_facing_away_from(self, span: Span, parts: Parts) -> FacingAwayFromSpecifier:
        return FacingAwayFromSpecifier(span=span, vector=self.faced(*parts))

    def faced(self, word: Token, vector: Expression) -> Expression:
        """The vector of `facing toward V` and its kin; `directly` is a word of Scenic 3 alone."""
        if "directly" in word and not self.dialect.explicit_new:
            plain = " ".join(part for part in word.split() if part != "directly")
            message = f"`{' '.join(word.split())}` belongs to dialect {dialects_with_feature('explicit_new')}"
            raise ParseError(message, self.token_span(word), hint=f"write `{plain} ...`")
        return as_vector(vector)

    def make_apparently_facing(self, span: Span, parts: Parts) -> ApparentlyFacingSpecifier:
        return ApparentlyFacingSpecifier(span=span, heading=parts[0], origin=vector_or_none(parts[1]))


def stray(first: Expression, specifier: Specifier, source: str) -> ParseError:
    """The error for a specifier behind a comma that follows no object."""
    if (error := inside_brackets(source, specifier.span)) is not None:
        return error
    if is_number_literal(first):
        return ParseError("a vector needs parentheses", first.span, hint="write `(x, y)`")
    if isinstance(specifier, VisibleSpecifier) and specifier.viewer is None:
        hint = "write `(visible)` if a variable of that name is meant"
        return ParseError("`visible` is a specifier here, but no object stands before it", specifier.span, hint=hint)
    if not is_dotted_name(first):
        return ParseError("a specifier follows an expression", first.span, hint=BEGIN)
    return ParseError("a comma stands before the first specifier", first.span, hint="remove the comma after the class")


def vector_or_none(node: Expression | None) -> Expression | None:
    """`as_vector(node)`, or None for None."""
    return None if node is None else as_vector(node)


class StatementBuilder(BuilderBase):
    """One method per rule of the grammar's static statements."""

    def make_program(self, span: Span, parts: Parts) -> Block:
        return tuple(parts)

    def make_interpolation(self, span: Span, parts: Parts) -> Expression:
        return parts[0]

    def make_block(self, span: Span, parts: Parts) -> Block:
        return tuple(parts)

    # -- Simple statements

    def make_expression_statement(self, span: Span, parts: Parts) -> ExpressionStatement:
        return ExpressionStatement(span=span, value=self.object_place(parts[0]))

    def make_assignment(self, span: Span, parts: Parts) -> Assignment:
        *targets, value = parts
        return Assignment(span=span, targets=tuple(map(target, targets)), value=self.object_place(value))

    def make_augmented_assignment(self, span: Span, parts: Parts) -> AugmentedAssignment:
        left, operator, value = parts
        return AugmentedAssignment(span=span, target=single_target(left), operator=operator[:-1], value=value)

    def make_return(self, span: Span, parts: Parts) -> Return:
        value = parts[0]
        return Return(span=span, value=None if value is None else self.object_place(value))

    def make_break(self, span: Span, parts: Parts) -> Break:
        return Break(span=span)

    def make_continue(self, span: Span, parts: Parts) -> Continue:
        return Continue(span=span)

    def make_pass(self, span: Span, parts: Parts) -> Pass:
        return Pass(span=span)

    def make_delete(self, span: Span, parts: Parts) -> Delete:
        return Delete(span=span, targets=deletion_targets(parts[0]))

    def make_assert(self, span: Span, parts: Parts) -> Assert:
        return Assert(span=span, test=condition(parts[0]), message=parts[1])

    def make_raise(self, span: Span, parts: Parts) -> Raise:
        exception, cause = parts
        return Raise(span=span, exception=exception, cause=cause)

    def make_global(self, span: Span, parts: Parts) -> Global:
        return Global(span=span, names=tuple(map(self.identifier, parts)))

    def make_nonlocal(self, span: Span, parts: Parts) -> Nonlocal:
        return Nonlocal(span=span, names=tuple(map(self.identifier, parts)))

    # -- Imports

    def make_dotted_name(self, span: Span, parts: Parts) -> str:
        return ".".join(map(self.identifier, parts))

    def make_import(self, span: Span, parts: Parts) -> Import:
        return Import(span=span, names=tuple(parts))

    def make_imported_module(self, span: Span, parts: Parts) -> ImportedName:
        name, alias = parts
        return ImportedName(span=span, name=name, alias=None if alias is None else self.identifier(alias))

    def make_import_source(self, span: Span, parts: Parts) -> tuple[str, int]:
        *dots, module = parts
        if not dots and module is None:
            raise ParseError("expected the name of a module after `from`", span)
        return module or "", sum(map(len, dots))

    def make_import_from(self, span: Span, parts: Parts) -> ImportFrom:
        (module, level), *names = parts
        imported = tuple(name for name in names if isinstance(name, ImportedName))
        return ImportFrom(span=span, module=module, names=imported, level=level)

    def make_imported_name(self, span: Span, parts: Parts) -> ImportedName:
        name, alias = parts
        return ImportedName(span=span, name=self.identifier(name), alias=None if alias is None else self.identifier(alias))

    # -- Compound statements

    def make_if(self, span: Span, parts: Parts) -> If:
        test, then, *branches, otherwise = parts
        rest: Block = otherwise or ()
        for place, branch_test, branch in reversed(branches):
            end = rest[-1].span if rest else branch[-1].span
            rest = (If(span=join(place, end), test=branch_test, then=branch, otherwise=rest),)
        return If(span=span, test=condition(test), then=then, otherwise=rest)

    def make_elif(self, span: Span, parts: Parts) -> tuple[Span, Expression, Block]:
        return span, condition(parts[0]), parts[1]

    def make_else(self, span: Span, parts: Parts) -> Block:
        return parts[0]

    def make_while(self, span: Span, parts: Parts) -> While:
        return While(span=span, test=condition(parts[0]), body=parts[1], otherwise=parts[2] or ())

    def make_for(self, span: Span, parts: Parts) -> For:
        targets, _, iterable, body, otherwise = parts
        return For(span=span, target=target(targets), iterable=iterable, body=body, otherwise=otherwise or ())

    def make_function(self, span: Span, parts: Parts) -> FunctionDefinition:
        name, parameters, _, body = parts
        return FunctionDefinition(span=span, name=self.identifier(name), parameters=parameters or (), body=body)

    def make_decorated(self, span: Span, parts: Parts) -> FunctionDefinition:
        *decorators, function = parts
        if isinstance(function, ClassDefinition):
            hint = f"call it after the class: {function.name} = decorator({function.name})"
            raise ParseError("decorators of classes are not part of the language", decorators[0].span, hint=hint)
        return FunctionDefinition(span=span, name=function.name, parameters=function.parameters, body=function.body, decorators=tuple(decorators))

    def make_decorator(self, span: Span, parts: Parts) -> Expression:
        return parts[0]

    def make_class(self, span: Span, parts: Parts) -> ClassDefinition:
        word, name, superclasses, body = parts
        if word == "constructor" and (not self.dialect.released or self.dialect.explicit_new):
            raise ParseError("`constructor` belongs to dialect scenic-2.1", self.token_span(parts[0]), hint="write `class`")
        for item in superclasses or ():
            if not isinstance(item, Expression):
                place = item.generator.span if isinstance(item, BareGenerator) else item.span
                raise ParseError("a class takes the names of its superclasses only", place)
        properties = tuple(item for item in body if isinstance(item, PropertyDefault))
        statements = tuple(item for item in body if not isinstance(item, PropertyDefault))
        for item in properties:
            self.properties.pop(item.span, None)
        own = {name for node in nodes_of_scope(statements) for name in bound_by(node)}
        for node in nodes_of_scope(statements):
            if node.span in self.annotations:
                raise self.no_property(self.annotations[node.span])
            words = {word for target in node.targets for word in attributes_in(target) or ()} if isinstance(node, Assignment) else set()
            if self.dialect.released and words and words <= set(ATTRIBUTES) - own:
                raise ParseError("the default of a property stands behind `:`, not `=`", node.span, hint="write `name[dynamic]: default`")
        return ClassDefinition(span=span, name=self.identifier(name), superclasses=tuple(superclasses or ()), properties=properties, body=statements)

    def no_property(self, target: Expression) -> ParseError:
        """The error for a line of a class that gives a default to what is no name, such as one with a misspelt attribute."""
        words = attributes_in(target)
        if words is None:
            return ParseError("a property is a name alone", target.span, hint="write `name: default`; elements and attributes are assigned with `=`")
        self.released("attributes of properties", target.span, "leave them out")
        wrong = next((word for word in words if word not in ATTRIBUTES), "")
        if not wrong:
            return ParseError("a comma too many stands in the attributes of this property", target.span, hint="write `name[dynamic]: default`")
        hint = did_you_mean(wrong, ATTRIBUTES, f"there are {', '.join(ATTRIBUTES)}")
        return ParseError(f"`{wrong}` is not an attribute of properties", target.span, hint=hint)

    def make_annotation(self, span: Span, parts: Parts) -> PropertyDefault | Assignment | Pass:
        """A property of a class, unless the name is a path or gets a value: then what follows the colon says nothing to the machine."""
        left, attributes, annotation, value = parts
        if attributes is not None:
            self.released("attributes of properties", span, "leave them out")
        if value is not None and attributes is None:
            return Assignment(span=span, targets=(single_target(left),), value=self.object_place(value))
        if value is not None or not isinstance(left, Name):
            if attributes is None and isinstance(single_target(left), Attribute | Subscript):
                self.annotations[span] = left
                return Pass(span=span)
            raise ParseError("a property is written `name: default`", span)
        names = () if attributes is None else tuple(attributes.strip("[] \t").replace(",", " ").split())
        if "final" in names and not self.dialect.explicit_new:
            raise ParseError("the attribute `final` belongs to dialect scenic-3", span, hint="leave it out")
        node = PropertyDefault(span=span, name=self.property_with_effect(left.name, span), value=self.object_place(annotation), attributes=names)
        self.properties[span] = node
        return node

    def make_try(self, span: Span, parts: Parts) -> Try:
        body, *clauses, otherwise, final = parts
        interrupts = tuple(clause for clause in clauses if isinstance(clause, Interrupt))
        handlers = tuple(clause for clause in clauses if isinstance(clause, Handler))
        if not clauses and final is None:
            message = "`try` needs at least one `interrupt when`, `except` or `finally` clause"
            raise ParseError(message, span, hint="add such a clause, aligned with `try`")
        if otherwise is not None and not handlers:
            raise ParseError("the `else` of a `try` needs an `except` before it", otherwise[0].span)
        return Try(span=span, body=body, interrupts=interrupts, handlers=handlers, otherwise=otherwise or (), final=final or ())

    def make_interrupt(self, span: Span, parts: Parts) -> Interrupt:
        test = refuse_time("interrupt when", condition(parts[0]), self.dialect)
        return Interrupt(span=span, condition=test, body=parts[1])

    def make_handler(self, span: Span, parts: Parts) -> Handler:
        type_, name, body = parts
        return Handler(span=span, type=type_, name=None if name is None else self.identifier(name), body=body)

    def make_finally(self, span: Span, parts: Parts) -> Block:
        return parts[0]

    # -- Scenic's static statements

    def make_model(self, span: Span, parts: Parts) -> Model:
        return Model(span=span, name=parts[0])

    def make_simulator(self, span: Span, parts: Parts) -> ChooseSimulator:
        self.released("simulator", span, "choose the simulator by `scenic-ref simulate --simulator`")
        return ChooseSimulator(span=span, value=parts[0])

    def make_param(self, span: Span, parts: Parts) -> Param:
        return Param(span=span, assignments=tuple(parts))

    def make_param_assignment(self, span: Span, parts: Parts) -> ParamAssignment:
        word, value = parts
        name = self.literal_name(word) if word.type == "STRING" else self.identifier(word)
        if not isinstance(name, str):
            raise ParseError("the name of a parameter must be text", self.token_span(word))
        return ParamAssignment(span=span, name=name, value=value)

    def literal_name(self, token: Token) -> str | bytes:
        """The value of a string that names a parameter."""
        try:
            return literals.string(str(token))
        except literals.LiteralFault as fault:
            raise ParseError(fault.message, self.token_span(token)) from None

    def make_require(self, span: Span, parts: Parts) -> Require | RequireAlways | RequireEventually:
        """`require B`; `require always (B)` may look like a call of a function."""
        word, part = over_time(condition(parts[0]), self.dialect)
        refuse_time(f"require {word}".rstrip(), part, self.dialect)
        kinds = {"": Require, "always": RequireAlways, "eventually": RequireEventually}
        return kinds[word](span=span, condition=part, name=parts[1] or "")

    def make_soft_require(self, span: Span, parts: Parts) -> SoftRequire:
        required = refuse_time("require", condition(parts[1]), self.dialect)
        if (word := operator_of(required, self.dialect)) in ("always", "eventually"):
            message, hint = with_probability(word)
            raise ParseError(message, required.span, hint=hint)
        refuse_formulas(required, self.dialect)
        return SoftRequire(span=span, probability=parts[0], condition=required, name=parts[2] or "")

    def make_requirement_name(self, span: Span, parts: Parts) -> str:
        self.released("as", span, "leave out the name")
        return self.make_released_name(span, parts)

    def make_released_name(self, span: Span, parts: Parts) -> str:
        (word,) = parts
        return str(self.literal_name(word)) if word.type == "STRING" else str(word)

    def make_mutate(self, span: Span, parts: Parts) -> Mutate:
        _, objects, scale = parts
        return Mutate(span=span, objects=objects or (), scale=scale)

    def make_mutate_all(self, span: Span, parts: Parts) -> Mutate:
        return Mutate(span=span, scale=parts[0])

    def make_mutated(self, span: Span, parts: Parts) -> tuple[Name, ...]:
        return tuple(Name(span=self.token_span(token), name=self.identifier(token)) for token in names_of(parts))


ATTRIBUTES = ("additive", "dynamic", "final")
"""Of properties, in the releases: as the terminal of this name has them."""


def attributes_in(target: Expression) -> list[str] | None:
    """Return the words of `name[word, word]`, which look like the attributes of a property; None for any other expression."""
    if not (isinstance(target, Subscript) and isinstance(target.value, Name)):
        return None
    index = target.index
    words = [item.name for item in (index.items if isinstance(index, TupleDisplay) else (index,)) if isinstance(item, Name)]
    return words if len(words) == (len(index.items) if isinstance(index, TupleDisplay) else 1) else None


NOT_RECORDED = "leave the statement out, since `scenic-ref simulate -o` writes what happens"


@dataclass(frozen=True, slots=True)
class Guard:
    """A `precondition:` or `invariant:` line."""

    span: Span
    kind: str
    condition: Expression


@dataclass(frozen=True, slots=True)
class ScenarioPart:
    """The `setup` or `compose` block of a scenario."""

    span: Span
    kind: str
    body: Block


# Preconditions, invariants, statements, and the named blocks of a scenario.
Guarded = tuple[tuple[Expression, ...], tuple[Expression, ...], Block, dict[str, Block]]


class DynamicsBuilder(BuilderBase):
    """One method per rule of the grammar's dynamic and compositional statements."""

    # -- Definitions

    def make_behavior(self, span: Span, parts: Parts) -> BehaviorDefinition:
        name, parameters, (preconditions, invariants, body, _) = parts
        return BehaviorDefinition(
            span=span,
            name=self.identifier(name),
            parameters=parameters or (),
            preconditions=preconditions,
            invariants=invariants,
            body=body,
        )

    def make_monitor(self, span: Span, parts: Parts) -> MonitorDefinition:
        name, parameters, body = parts
        return MonitorDefinition(
            span=span, name=self.identifier(name), parameters=parameters or (), body=body, by_instance=self.dialect.monitor_instances
        )

    def make_monitor_without_parentheses(self, span: Span, parts: Parts) -> MonitorDefinition:
        name, body = parts
        if self.dialect.monitor_instances:
            hint = f"write `monitor {name}():`, and `require monitor {name}()` where it is to run"
            raise ParseError(f"a monitor of dialect {self.dialect.name} has parentheses", self.token_span(name), hint=hint)
        return MonitorDefinition(span=span, name=self.identifier(name), parameters=(), body=body)

    def make_scenario(self, span: Span, parts: Parts) -> ScenarioDefinition:
        name, parameters, (preconditions, invariants, body, blocks) = parts
        setup, compose = blocks.get("setup"), blocks.get("compose")
        rest = [statement for statement in body if not is_text(statement)]
        if rest and blocks:
            message = "a scenario with a `setup` or `compose` block has no statements outside of them"
            raise ParseError(message, rest[0].span, hint="move the statement into the `setup` block")
        return ScenarioDefinition(
            span=span,
            name=self.identifier(name),
            parameters=parameters or (),
            preconditions=preconditions,
            invariants=invariants,
            setup=setup if blocks or not body else body,
            compose=compose,
        )

    def make_guarded_block(self, span: Span, parts: Parts) -> Guarded:
        """Preconditions, invariants, statements and named blocks. Raises ParseError for guards that do not come first."""
        guards: dict[str, list[Expression]] = {"precondition": [], "invariant": []}
        statements: list[Statement] = []
        blocks: dict[str, Block] = {}
        for part in parts:
            if isinstance(part, Guard):
                if blocks or any(not is_text(statement) for statement in statements) or len(statements) > 1:
                    hint = "move it to the head of the definition"
                    raise ParseError(f"`{part.kind}` lines must come first in their definition", part.span, hint=hint)
                guards[part.kind].append(part.condition)
            elif isinstance(part, ScenarioPart):
                if part.kind in blocks:
                    raise ParseError(f"a scenario has one `{part.kind}` block only", part.span)
                if part.kind == "setup" and blocks:
                    raise ParseError("the `setup` block comes before the `compose` block", part.span)
                blocks[part.kind] = part.body
            else:
                statements.append(part)
        return tuple(guards["precondition"]), tuple(guards["invariant"]), tuple(statements), blocks

    make_scenario_block = make_guarded_block

    def make_precondition(self, span: Span, parts: Parts) -> Guard:
        return Guard(span, "precondition", refuse_time("precondition", condition(parts[0]), self.dialect))

    def make_invariant(self, span: Span, parts: Parts) -> Guard:
        return Guard(span, "invariant", refuse_time("invariant", condition(parts[0]), self.dialect))

    def make_setup(self, span: Span, parts: Parts) -> ScenarioPart:
        return ScenarioPart(span, "setup", parts[0])

    def make_compose(self, span: Span, parts: Parts) -> ScenarioPart:
        return ScenarioPart(span, "compose", parts[0])

    # -- Requirements over time

    def make_require_always(self, span: Span, parts: Parts) -> RequireAlways:
        part = self.without_formulas("require always", parts[0])
        return RequireAlways(span=span, condition=part, name=parts[1] or "")

    def make_require_eventually(self, span: Span, parts: Parts) -> RequireEventually:
        part = self.without_formulas("require eventually", parts[0])
        return RequireEventually(span=span, condition=part, name=parts[1] or "")

    def make_require_formula(self, span: Span, parts: Parts) -> RequireAlways | RequireEventually:
        word, operand, name = parts
        kind = RequireAlways if word.type == "ALWAYS" else RequireEventually
        return kind(span=span, condition=self.without_formulas(f"require {word}", operand), name=name or "")

    def without_formulas(self, word: str, node: Expression) -> Expression:
        """The condition `node` behind `word`. Raises `ParseError` for operators over time, and for a time."""
        part = refuse_time(word, condition(node), self.dialect)
        refuse_formulas(part, self.dialect, "")
        return part

    def make_require_monitor(self, span: Span, parts: Parts) -> RequireMonitor:
        word, monitor, name = parts
        if not self.dialect.monitor_instances:
            message = f"`require monitor` belongs to dialect {dialects_with_feature('monitor_instances')}"
            raise ParseError(message, self.token_span(word), hint="leave it out: a monitor runs as soon as it is defined")
        return RequireMonitor(span=span, monitor=monitor, name=name or "")

    def make_terminate_when(self, span: Span, parts: Parts) -> TerminateWhen:
        part = refuse_time("terminate when", condition(parts[0]), self.dialect)
        return TerminateWhen(span=span, condition=part, name=parts[1] or "")

    def make_terminate_simulation_when(self, span: Span, parts: Parts) -> TerminateWhen:
        self.released("terminate simulation when", span, "write `terminate when ...`, without a name" if parts[1] else "write `terminate when ...`")
        part = refuse_time("terminate simulation when", condition(parts[0]), self.dialect)
        return TerminateWhen(span=span, condition=part, name=parts[1] or "", simulation=True)

    def make_terminate_after(self, span: Span, parts: Parts) -> TerminateAfter:
        limit: TimeLimit = parts[0]
        amount = to_source(limit.amount, self.dialect.name)
        hint = instead("terminate when", f"{amount} {limit.unit}", amount, released=False)
        self.released("terminate after", span, hint)
        return TerminateAfter(span=span, limit=limit)

    # -- Recording

    def make_record(self, span: Span, parts: Parts) -> Record:
        self.released("record", span, NOT_RECORDED)
        value, period, delay, name = parts
        if (period or delay) is not None and not self.dialect.explicit_new:
            raise ParseError(f"`every` and `after` belong to dialect {dialects_with_feature('explicit_new')}", (period or delay).span)
        return Record(span=span, value=value, name=name or "", period=period, delay=delay)

    def make_record_initial(self, span: Span, parts: Parts) -> Record:
        self.released("record initial", span, NOT_RECORDED)
        return Record(span=span, value=parts[0], time="initial", name=parts[1] or "")

    def make_record_final(self, span: Span, parts: Parts) -> Record:
        self.released("record final", span, NOT_RECORDED)
        return Record(span=span, value=parts[0], time="final", name=parts[1] or "")

    # -- Inside behaviors, monitors and compose blocks

    def make_take(self, span: Span, parts: Parts) -> Take:
        return Take(span=span, actions=tuple(part for part in parts if part is not None))

    def make_wait(self, span: Span, parts: Parts) -> Wait:
        return Wait(span=span)

    def make_wait_for(self, span: Span, parts: Parts) -> WaitFor:
        return self.waiting(WaitFor(span=span, limit=parts[0]))

    def make_wait_until(self, span: Span, parts: Parts) -> WaitFor:
        node = self.waiting(WaitFor(span=span, limit=Until(span=span, condition=condition(parts[0]))))
        refuse_time("wait until", condition(parts[0]), self.dialect)
        return node

    def waiting(self, node: WaitFor) -> WaitFor:
        """The statement. Raises ParseError where the dialect lacks it."""
        if not self.dialect.explicit_new:
            raise ParseError(
                f"`wait` with a limit belongs to dialect {dialects_with_feature('explicit_new')}", node.span, hint="write `wait` in a loop"
            )
        return node

    def make_terminate(self, span: Span, parts: Parts) -> Terminate:
        return Terminate(span=span)

    def make_terminate_simulation(self, span: Span, parts: Parts) -> Terminate:
        self.released("terminate simulation", span, "write `terminate`")
        return Terminate(span=span, simulation=True)

    def make_abort(self, span: Span, parts: Parts) -> Abort:
        return Abort(span=span)

    def make_invocations(self, span: Span, parts: Parts) -> tuple[Expression, ...]:
        return tuple(parts)

    def make_do(self, span: Span, parts: Parts) -> Do:
        return Do(span=span, invocations=parts[0], limit=parts[1])

    def make_do_choose(self, span: Span, parts: Parts) -> DoChoose:
        invocations, weights = weighted_alternatives(parts[0])
        return DoChoose(span=span, invocations=invocations, weights=weights, limit=parts[1])

    def make_do_shuffle(self, span: Span, parts: Parts) -> DoShuffle:
        invocations, weights = weighted_alternatives(parts[0])
        return DoShuffle(span=span, invocations=invocations, weights=weights, limit=parts[1])

    def make_time_limit(self, span: Span, parts: Parts) -> TimeLimit:
        return parts[0]

    def make_duration(self, span: Span, parts: Parts) -> TimeLimit:
        return self.time_limit(span, parts, "for")

    def make_delay(self, span: Span, parts: Parts) -> TimeLimit:
        return self.time_limit(span, parts, "after")

    def make_period(self, span: Span, parts: Parts) -> TimeLimit:
        return self.time_limit(span, parts, "every")

    def time_limit(self, span: Span, parts: Parts, word: str) -> TimeLimit:
        """The time behind `word`. Raises `ParseError` where it has no unit and the dialect wants one."""
        amount, steps = parts
        if steps is not None:
            return TimeLimit(span=span, amount=amount, unit="steps")
        implied = self.dialect.released and not self.dialect.explicit_new  # in 2.1.0 a number alone is one of seconds
        return TimeLimit(span=span, amount=without_seconds(amount, word, implied=implied), unit="seconds")

    def make_until(self, span: Span, parts: Parts) -> Until:
        return Until(span=span, condition=refuse_time("until", condition(parts[0]), self.dialect))

    def make_override(self, span: Span, parts: Parts) -> Override:
        return Override(span=span, object=parts[0], specifiers=tuple(parts[1:]))


def is_text(statement: Statement) -> bool:
    """Whether `statement` is a lone string, as a docstring is."""
    if not isinstance(statement, ExpressionStatement):
        return False
    return isinstance(statement.value, Constant) and isinstance(statement.value.value, str)


def weighted_alternatives(invocations: tuple[Expression, ...]) -> tuple[tuple[Expression, ...], tuple[Expression, ...]]:
    """The alternatives and their weights: a lone dictionary display gives both."""
    only = invocations[0]
    if len(invocations) > 1 or not isinstance(only, DictDisplay):
        return invocations, ()
    keys = tuple(key for key, _ in only.items if key is not None)
    if not keys or len(keys) < len(only.items):
        raise ParseError("expected `{alternative: weight, ...}`", only.span)
    return keys, tuple(weight for _, weight in only.items)


def without_seconds(amount: Expression, word: str, *, implied: bool = False) -> Expression:
    """The expression whose last word `seconds` was read as a postfix operator of its last operand, without that word; which may be `implied`.

    Raises `ParseError` for a time behind `word` that has no unit.
    """
    path: list[BinaryOperation | UnaryOperation] = []
    node = amount
    while isinstance(node, BinaryOperation) or (isinstance(node, UnaryOperation) and node.operator != "not"):
        path.append(node)
        node = node.right if isinstance(node, BinaryOperation) else node.operand
    if not isinstance(node, Seconds):
        if implied:
            return amount
        number = amount.value if isinstance(amount, Constant) else None
        written = f"{number:g}" if isinstance(number, int | float) else "..."
        hint = f"write `{word} {written} seconds` or `{word} {written} steps`"
        raise ParseError("a time limit needs a unit", amount.span, hint=hint)
    tree = node.value
    for outer in reversed(path):
        tree = replace(outer, right=tree) if isinstance(outer, BinaryOperation) else replace(outer, operand=tree)
    return tree

