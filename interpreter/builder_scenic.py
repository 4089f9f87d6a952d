"""The part of the builder for Scenic's own expressions, object definitions and specifiers."""



from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import get_args

from lark import Token

from ..semantics.kernel.errors import ParseError
from ..semantics.syntax import Expression, Span, Specifier
from ..semantics.syntax.expressions import (
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
from ..semantics.syntax.python_expressions import Call, Comparison, Conditional, Name, UnaryOperation
from ..semantics.syntax.specifiers import (
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
from .chains import Link, as_vector, associate, is_dotted_name, join
from .dialects import having
from .nesting import children
from .printer import to_source
from .syntax_errors import inside_brackets
from .tree_builder import BuilderBase, Parts, condition, is_number

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
            message = f"`initial scenario` without `in` belongs to dialect {having('initial_scenario')}"
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
        if is_number(class_) and isinstance(specifiers[0], BesideSpecifier) and specifiers[0].gap is None:
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
            message = f"`new` belongs to dialect {having('explicit_new')}"
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
            raise ParseError(f"`contained in` belongs to dialect {having('explicit_new')}", span, hint="write `in R, with regionContainedIn R`")
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
            message = f"`{' '.join(word.split())}` belongs to dialect {having('explicit_new')}"
            raise ParseError(message, self.token_span(word), hint=f"write `{plain} ...`")
        return as_vector(vector)

    def make_apparently_facing(self, span: Span, parts: Parts) -> ApparentlyFacingSpecifier:
        return ApparentlyFacingSpecifier(span=span, heading=parts[0], origin=vector_or_none(parts[1]))


def stray(first: Expression, specifier: Specifier, source: str) -> ParseError:
    """The error for a specifier behind a comma that follows no object."""
    if (error := inside_brackets(source, specifier.span)) is not None:
        return error
    if is_number(first):
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
