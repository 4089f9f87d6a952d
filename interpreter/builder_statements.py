"""The part of the builder for Python's statements and Scenic's static ones."""



from __future__ import annotations

from lark import Token

from ..semantics.kernel.errors import ParseError
from ..semantics.kernel.scopes import bound_by
from ..semantics.kernel.suggestions import did_you_mean
from ..semantics.syntax import Block, Expression, Span
from ..semantics.syntax.dynamics import RequireAlways, RequireEventually
from ..semantics.syntax.python_expressions import Attribute, Name, Subscript, TupleDisplay
from ..semantics.syntax.statements import (
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
from .builder_expressions import BareGenerator
from .chains import join
from .declarations import nodes_of_scope
from .formulas import operator_of, over_time, refuse_formulas, with_probability
from .targets import deleted, single_target, target
from .time_conditions import refuse_time
from .tree_builder import BuilderBase, Parts, condition, names_of


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
        return Delete(span=span, targets=deleted(parts[0]))

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
