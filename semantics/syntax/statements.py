"""Static statements: the first group of Table "Statements" and what is inherited from Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .nodes import Expression, Node, Statement
from .python_expressions import Name, Parameter

Block = tuple[Statement, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpressionStatement(Statement):
    """An expression as a statement, an object definition for instance."""

    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Assignment(Statement):
    """`target = ... = value`; targets are names, attributes, subscripts, tuples or lists of targets, or starred."""

    targets: tuple[Expression, ...]
    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class AugmentedAssignment(Statement):
    """`target operator= value`."""

    target: Expression
    operator: Literal["+", "-", "*", "/", "//", "%", "**", "<<", ">>", "&", "|", "^"]
    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class If(Statement):
    """`if test: ... else: ...` (`elif` is an `If` alone in `otherwise`)."""

    test: Expression
    then: Block
    otherwise: Block = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class While(Statement):
    """`while test: ... else: ...`."""

    test: Expression
    body: Block
    otherwise: Block = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class For(Statement):
    """`for target in iterable: ... else: ...`."""

    target: Expression
    iterable: Expression
    body: Block
    otherwise: Block = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionDefinition(Statement):
    """`@decorators def name(parameters): body`."""

    name: str
    parameters: tuple[Parameter, ...]
    body: Block
    decorators: tuple[Expression, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Return(Statement):
    """`return value`."""

    value: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Break(Statement):
    """`break`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Continue(Statement):
    """`continue`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pass(Statement):
    """`pass`: the program with nothing left to do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Delete(Statement):
    """`del targets`."""

    targets: tuple[Expression, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Assert(Statement):
    """`assert test, message`."""

    test: Expression
    message: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Raise(Statement):
    """`raise exception from cause`; with no exception, the one being handled."""

    exception: Expression | None = None
    cause: Expression | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Global(Statement):
    """`global names`."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Nonlocal(Statement):
    """`nonlocal names`."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportedName(Node):
    """`name as alias`; for `import a.b.c` the name is dotted."""

    name: str
    alias: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Import(Statement):
    """`import a.b as c, d`."""

    names: tuple[ImportedName, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportFrom(Statement):
    """`from module import names`; no names stands for `*`; `level` counts the leading dots. `as_model` is true of what `model` becomes."""

    module: str
    names: tuple[ImportedName, ...]
    level: int = 0
    as_model: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Handler(Node):
    """`except type as name: body`; a None type catches everything."""

    type: Expression | None
    name: str | None
    body: Block


@dataclass(frozen=True, slots=True, kw_only=True)
class Interrupt(Node):
    """`interrupt when condition: body`."""

    condition: Expression
    body: Block


@dataclass(frozen=True, slots=True, kw_only=True)
class Try(Statement):
    """`try` with `interrupt when`, `except`, `else` and `finally` clauses (Figure "grammar", production `try`)."""

    body: Block
    interrupts: tuple[Interrupt, ...] = ()
    handlers: tuple[Handler, ...] = ()
    otherwise: Block = ()
    final: Block = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Model(Statement):
    """`model name`."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ChooseSimulator(Statement):
    """`simulator E` of the released implementations."""

    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class ParamAssignment(Node):
    """`name = value` in a `param` statement."""

    name: str
    value: Expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Param(Statement):
    """`param name = value, ...`."""

    assignments: tuple[ParamAssignment, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyDefault(Node):
    """`property: value` in a class body; `attributes` are those that the released implementations know: additive, dynamic, final."""

    name: str
    value: Expression
    attributes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassDefinition(Statement):
    """`class name(superclasses): ...`: property defaults (Scenic), and methods and assignments (Python), in order."""

    name: str
    superclasses: tuple[Expression, ...] = ()
    properties: tuple[PropertyDefault, ...] = ()
    body: Block = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Require(Statement):
    """`require B [as name]`."""

    condition: Expression
    name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SoftRequire(Statement):
    """`require[p] B [as name]`."""

    probability: Expression
    condition: Expression
    name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mutate(Statement):
    """`mutate O, ... [by S]`; no objects stands for every Object (reading `mutate-all`)."""

    objects: tuple[Name, ...] = ()
    scale: Expression | None = None
