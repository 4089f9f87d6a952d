"""Programs of the static core, from their syntax trees, as terms of `proofs/kernel/Machine.v`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import isfinite

from scenic_ref.conformance.implementations.protocol import Unsupported
from scenic_ref.semantics.python.builtins import BUILTINS
from scenic_ref.semantics.syntax import Block, Expression, Program, Specifier
from scenic_ref.semantics.syntax.expressions import ObjectDefinition, ObjectOrOperator, ObjectOrValue, VectorOf
from scenic_ref.semantics.syntax.python_expressions import (
    Attribute,
    BinaryOperation,
    BooleanOperation,
    Call,
    Comparison,
    Constant,
    DictDisplay,
    ListDisplay,
    Name,
    TupleDisplay,
    UnaryOperation,
)  # fmt: skip
from scenic_ref.semantics.syntax.specifiers import AtSpecifier, WithSpecifier
from scenic_ref.semantics.syntax.statements import (
    Assignment,
    ClassDefinition,
    ExpressionStatement,
    Mutate,
    Param,
    Pass,
    Require,
    SoftRequire,
)  # fmt: skip

from .core_programs import BINARY, NAMES, fraction, listed

CLASS = 98
"""The number of a property that the translation adds to each object: the number of its class."""
KNOWN = {name: p for p, name in NAMES.items() if p < 10}
BEYOND = frozenset(
    {
        "heading",
        "viewAngle",
        "behavior",
        "regionContainedIn",
        "velocity",
        "speed",
        "angularSpeed",
        "color",
        "parent",
        "parentOrientation",
        "name",
        "height",
        "visibleDistance",
    }
)
"""Properties with a meaning that the core has not; the heading of every object is 0."""
MIRRORED = {">": "<", ">=": "<="}


@dataclass
class Translation:
    """A program on its way to Coq: the numbers of its variables, parameters, properties and classes; how long the lists among parameters are."""

    variables: dict[str, int] = field(default_factory=lambda: {"ego": 0})
    params: dict[str, int] = field(default_factory=dict[str, int])
    lists: dict[str, int] = field(default_factory=dict[str, int])
    noise: bool = False
    """Whether something is mutated by more than 0, so that a run that is rejected may have been given noise."""
    properties: dict[str, int] = field(default_factory=lambda: dict(KNOWN))
    classes: list[tuple[str, str]] = field(default_factory=lambda: [("Object", "[]")])

    def program(self, program: Program) -> str:
        """The list of its statements. Raises `Unsupported` for what the core has not."""
        return listed(f"({one})" for one in self.statements(program.statements))

    # statements

    def statements(self, block: Block) -> Iterator[str]:
        """Those that the core has; a class is told where its objects are."""
        for statement in block:
            match statement:
                case Pass():
                    pass
                case ClassDefinition():
                    self.classes.append((statement.name, self.defaults(statement)))
                case Assignment(targets=(Name(name=name),), value=value):
                    if name in (BUILTINS.keys() | {"workspace", *dict(self.classes)}) - {"ego"}:
                        raise beyond("assignments to names that mean something else")
                    told = self.expression(value)
                    yield f"Assign {numbered(self.variables, name)}%nat {told}"
                case ExpressionStatement(value=value):
                    yield f"Expression {self.expression(value)}"
                case Param(assignments=assignments):
                    for one in assignments:
                        yield from self.param(one.name, one.value)
                case Require(condition=condition):
                    yield f"Require {statement.span.line}%nat {self.expression(condition)}"
                case SoftRequire(probability=Constant(value=int() | float() as p), condition=condition) if 0 <= p <= 1:
                    yield f"SoftRequire {statement.span.line}%nat {rational(p)} {self.expression(condition)}"
                case Mutate(objects=objects, scale=scale):
                    by = f"(Constant (Number {fraction(Fraction(1))}))" if scale is None else self.expression(scale)
                    self.noise |= scale is None or scale != Constant(value=0)
                    yield f"Mutate {listed(self.expression(o) for o in objects)} {by}"
                case _:
                    raise beyond(type(statement).__name__)

    def param(self, name: str, value: Expression) -> Iterator[str]:
        """A parameter; the items of a tuple or list are parameters of the core, with numbers for names."""
        if isinstance(value, TupleDisplay | ListDisplay):
            self.lists[name] = len(value.items)
            for i, item in enumerate(value.items):
                yield from self.param(f"{name}.{i}", item)
        else:
            self.lists.pop(name, None)
            yield f"Param {numbered(self.params, name)}%nat {self.expression(value)}"

    def read(self, name: str, found: Mapping[str, object]) -> object:
        """The value of a parameter, of the values that those of the core have."""
        return [self.read(f"{name}.{i}", found) for i in range(self.lists[name])] if name in self.lists else found[name]

    def defaults(self, class_: ClassDefinition) -> str:
        """The default value expressions of a class right below Object."""
        above = [s.name if isinstance(s, Name) else "" for s in class_.superclasses]
        if above not in ([], ["Object"]) or class_.body or class_.name in BUILTINS or class_.name in dict(self.classes):
            raise beyond("classes below others, with methods, or defined twice")
        if any(default.attributes for default in class_.properties):
            raise beyond("additive and dynamic properties")
        return listed(f"({self.property(d.name)}%nat, {self.expression(d.value, own=True)})" for d in class_.properties)

    def property(self, name: str) -> int:
        """The number of a property that is given a value."""
        if name in BEYOND:
            raise beyond(f"the property {name}")
        return numbered(self.properties, name, 10)

    # expressions

    def expression(self, e: Expression, own: bool = False) -> str:
        """An expression; in a default value expression, `own`, it may read the properties of self and makes no objects."""
        match e:
            case Constant(value=bool() as value):
                return f"(Constant (Truth {str(value).lower()}))"
            case Constant(value=int() | float() as value) if isfinite(value):
                return f"(Constant (Number {rational(value)}))"
            case ObjectOrValue(value=Name(name=name)) if name in dict(self.classes):
                return self.object(name, (), own)
            case ObjectOrValue(value=value):
                return self.expression(value, own)
            case ObjectOrOperator(head=Name(name=name), as_object=made, as_operator=operator):
                return self.expression(made if name in dict(self.classes) else operator, own)
            case ObjectDefinition(class_=Name(name=name), specifiers=specifiers):
                return self.object(name, specifiers, own)
            case Name(name=name):
                if name == "self" or name in dict(self.classes) or (name in BUILTINS and name != "ego"):
                    raise beyond(f"the value of {name}")
                return f"(Name {numbered(self.variables, name)}%nat)"
            case Attribute(value=Name(name="self"), name=name) if own:
                return f"(Self {self.property(name)}%nat)"
            case Attribute(value=value, name="x" | "y" as name):
                return f"(Attribute {self.expression(value, own)} Coordinate_{name})"
            case Attribute(value=value, name=name) if name in self.properties:
                return f"(Attribute {self.expression(value, own)} (Property {self.properties[name]}%nat))"
            case UnaryOperation(operator="-" | "not" as sign, operand=operand):
                return f"({'Negative' if sign == '-' else 'Not'} {self.expression(operand, own)})"
            case VectorOf(x=x, y=y):
                return self.binary("@", x, y, own)
            case BinaryOperation(operator=sign, left=left, right=right) if sign in BINARY:
                return self.binary(sign, left, right, own)
            case BooleanOperation(operator=sign, operands=operands):
                *before, last = (self.expression(operand, own) for operand in operands)
                for operand in reversed(before):
                    last = f"(Boolean {str(sign == 'and').lower()} {operand} {last})"
                return last
            case Comparison(left=left, operators=(sign,), operands=(right,)) if sign in BINARY:
                return self.binary(sign, left, right, own)
            case Comparison(left=left, operators=(sign,), operands=(right,)) if sign in MIRRORED and (
                isinstance(left, Constant) or isinstance(right, Constant)
            ):
                return self.binary(MIRRORED[sign], right, left, own)  # one of the two has no effects: the order does not matter
            case Call(function=Name(name="Uniform"), arguments=arguments, keywords=()) if arguments:
                return f"(Discrete {listed(f'({self.expression(a, own)}, {fraction(Fraction(1))})' for a in arguments)})"
            case Call(function=Name(name="Discrete"), arguments=(DictDisplay(items=items),), keywords=()):
                return f"(Discrete {listed(self.weighted(items, own))})"
            case _:
                raise beyond(type(e).__name__)

    def weighted(self, items: Sequence[tuple[Expression | None, Expression]], own: bool) -> Iterator[str]:
        """Values with their weights, which are numbers in the core."""
        if len({repr(key) for key, _ in items}) < len(items):
            raise beyond("a value twice in Discrete")
        for key, weight in items:
            if key is None or not isinstance(weight, Constant) or not isinstance(weight.value, (int, float)):
                raise beyond("weights that are calculated")
            yield f"({self.expression(key, own)}, {rational(weight.value)})"

    def binary(self, sign: str, left: Expression, right: Expression, own: bool) -> str:
        """An operator, with both sides."""
        return f"(Binary {BINARY[sign]} {self.expression(left, own)} {self.expression(right, own)})"

    def object(self, name: str, specifiers: Sequence[Specifier], own: bool) -> str:
        """An object definition: it carries the default values of its class, and the number of the class as a property."""
        if own:
            raise beyond("objects that default values create")
        number = next((i for i, (known, _) in enumerate(self.classes) if known == name), None)
        if number is None:
            raise beyond(f"the class {name}")
        told = [f"(With {CLASS}%nat, Constant (Number {rational(number)}))"]
        for one in specifiers:
            match one:
                case AtSpecifier(vector=TupleDisplay(items=(x, y))):
                    told.append(f"(At, {self.binary('@', x, y, own)})")
                case AtSpecifier(vector=vector):
                    told.append(f"(At, {self.expression(vector)})")
                case WithSpecifier(property=p, value=value):
                    told.append(f"(With {self.property(p)}%nat, {self.expression(value)})")
                case _:
                    raise beyond(type(one).__name__)
        return f"(Object {self.classes[number][1]} {listed(told)})"


def numbered(names: dict[str, int], name: str, least: int = 0) -> int:
    """The number of a name, a fresh one at its first use."""
    if name not in names:
        fresh = max((least - 1, *names.values())) + 1
        names[name] = fresh + (fresh == CLASS)
    return names[name]


def rational(value: float) -> str:
    """The number as it is written."""
    return fraction(Fraction(str(value)))


def beyond(what: str) -> Unsupported:
    """What the core has not."""
    return Unsupported(f"the core has no place for {what}")
