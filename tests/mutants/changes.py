"""Small changes of source code: `mutants` gives all of a file, and `Mutant.finder` what loads the module with one of them.

Not changed: annotations, docstrings and other texts, what is raised and asserted (`strict` of `zip` too), `__repr__` and `__str__`, decorators,
`if TYPE_CHECKING`. Two changes of a statement with the same outcome are one.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from .loading import Mutated

ROOT = Path(__file__).parents[2]
Definition = ast.FunctionDef | ast.AsyncFunctionDef
HEADED = (ast.If, ast.While, ast.For, ast.With, ast.Match, ast.Try, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
TURNED = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}
OTHER_SIGN = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}
UNCALLED = frozenset({"cast", "isinstance", "issubclass", "super", "assert_never", "TypeVar", "NewType"})
"""Calls for which their argument does not stand in."""
TEXTS = frozenset({"__repr__", "__str__"})
BODY = "body to raise"


@dataclass(frozen=True, slots=True)
class Spot:
    """A place in a tree: a field of a node, or an entry of a field that is a list."""

    parent: ast.AST
    name: str
    index: int | None = None

    def get(self) -> ast.AST:
        """What stands there."""
        found = getattr(self.parent, self.name)
        return found if self.index is None else found[self.index]

    def put(self, new: ast.AST | None) -> ast.AST:
        """Put another node there, None for none; what stood there is returned."""
        old = self.get()
        if self.index is None:
            setattr(self.parent, self.name, new)
        elif new is None:
            del getattr(self.parent, self.name)[self.index]
        else:
            getattr(self.parent, self.name)[self.index] = new
        return old


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change. `lines` are those of which one runs before the change can show; `at_import` says that it runs when the module is imported."""

    file: str
    number: int
    line: int
    kind: str
    function: str
    before: str
    after: str
    lines: tuple[int, int]
    at_import: bool
    spot: Spot = field(repr=False, compare=False)
    new: ast.AST | None = field(repr=False, compare=False)
    tree: ast.Module = field(repr=False, compare=False)

    @property
    def module(self) -> str:
        """The name of the module that is changed."""
        parts = Path(self.file).with_suffix("").parts
        return ".".join(("scenic_ref", *(parts[:-1] if parts[-1] == "__init__" else parts)))

    def finder(self) -> Mutated:
        """What gives the module with the change. The tree keeps it: this is for a process that ends with the mutant."""
        old = self.spot.put(self.new)
        if self.new is not None:
            ast.fix_missing_locations(ast.copy_location(self.new, old))
        path = str(ROOT / self.file)
        return Mutated(self.module, path, compile(self.tree, path, "exec"))


@dataclass(frozen=True, slots=True)
class Around:
    """Where the walk is: the function, the statement or its head that is shown, and the lines of which one runs before a change in it shows."""

    function: str = ""
    shown: ast.AST | None = None
    spans: tuple[int, int] = (0, 0)
    in_function: bool = False


def files() -> list[str]:
    """The files of `semantics`, relative to the root."""
    return sorted(str(p.relative_to(ROOT)) for p in (ROOT / "semantics").rglob("*.py"))


def mutants(file: str) -> list[Mutant]:
    """All changes of a file, in the order of the text."""
    tree = ast.parse((ROOT / file).read_text("utf-8"))
    found: list[Mutant] = []
    known: set[tuple[int, str]] = set()
    for around, kind, spot, new in changes(tree):
        old = spot.get()
        before, after = texts(around.shown, spot, new)
        if before == after or (id(around.shown), after) in known:
            continue
        known.add((id(around.shown), after))
        line = getattr(old, "lineno", around.spans[0])
        found.append(
            Mutant(file, len(found), line, kind, around.function, before, after, around.spans, not around.in_function, spot, new, tree)
        )
    return found


def texts(shown: ast.AST | None, spot: Spot, new: ast.AST | None) -> tuple[str, str]:
    """The statement, or its head, before and after the change; only what is changed where that is a whole statement or branch."""
    old = spot.get()
    if shown is None or shown is old or isinstance(old, (ast.stmt, ast.match_case, ast.ExceptHandler)):
        return head(old), "" if new is None else head(new)
    before = ast.unparse(shown)
    spot.put(new)
    after = ast.unparse(shown)
    spot.put(old)
    return before, after


def head(node: ast.AST) -> str:
    """What a statement or branch begins with, in a line."""
    if isinstance(node, Definition):
        return f"def {node.name}: {head(statements(node)[0])}"
    lines = ast.unparse(node).strip().splitlines()
    return " ".join(line.strip() for line in lines[: 2 if isinstance(node, (ast.ExceptHandler, ast.match_case)) else 1])


def statements(node: Definition) -> list[ast.stmt]:
    """The body of a function without its docstring, or `...`."""
    return [s for s in node.body if not (isinstance(s, ast.Expr) and isinstance(s.value, ast.Constant))]


def span(*nodes: ast.AST) -> tuple[int, int]:
    """The lines from the first of these nodes to the last."""
    return min(n.lineno for n in nodes), max(n.end_lineno or n.lineno for n in nodes)  # pyright: ignore[reportAttributeAccessIssue]


Change = tuple[Around, str, Spot, "ast.AST | None"]


def changes(tree: ast.Module) -> Iterator[Change]:
    """All changes of a module."""
    yield from of_block(tree, "body", Around())


def of_block(parent: ast.AST, name: str, around: Around) -> Iterator[Change]:
    """The changes of a list of statements."""
    for index, statement in enumerate(getattr(parent, name)):
        yield from of_statement(Spot(parent, name, index), statement, replace(around, shown=statement, spans=span(statement)))


def of_statement(spot: Spot, node: ast.stmt, around: Around) -> Iterator[Change]:
    """The changes of a statement: itself, its head, its branches."""
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            yield from of_definition(spot, node, around)
        case ast.ClassDef():
            yield from of_block(node, "body", replace(around, function=inside(around, node.name)))
        case ast.If(test=ast.Name(id="TYPE_CHECKING")) | ast.Raise() | ast.Assert() | ast.Import() | ast.ImportFrom() | ast.Pass():
            return
        case ast.Expr(value=ast.Constant()):
            return
        case ast.AnnAssign() if node.value is None or "TypeAlias" in ast.unparse(node.annotation):
            return
        case ast.Expr():
            yield around, "statement removed", spot, ast.Pass()
            yield from of_children(node, around)
        case ast.AugAssign():
            yield around, "statement removed", spot, ast.Pass()
            yield from of_expression(Spot(node, "value"), around)
        case ast.Assign() | ast.AnnAssign():
            yield from of_expression(Spot(node, "value"), around)
        case ast.Return():
            if node.value is not None and not (isinstance(node.value, ast.Constant) and node.value.value is None):
                yield around, "return None", Spot(node, "value"), ast.Constant(None)
                yield from of_expression(Spot(node, "value"), around)
        case _:
            yield from of_branches(node, around)


def of_branches(node: ast.stmt, around: Around) -> Iterator[Change]:
    """The changes of a statement with blocks."""
    match node:
        case ast.If() | ast.While():
            headed = replace(around, shown=node.test, spans=span(node.test))
            for constant in (True, False) if isinstance(node, ast.If) else (False,):
                yield headed, "branch removed", Spot(node, "test"), ast.Constant(constant)
            yield from of_expression(Spot(node, "test"), headed)
        case ast.For():
            headed = replace(around, shown=node.iter, spans=span(node.iter))
            yield headed, "branch removed", Spot(node, "iter"), ast.Tuple([], ast.Load())
            yield from of_expression(Spot(node, "iter"), headed)
        case ast.Match():
            yield from of_match(node, around)
        case ast.Try():
            for handler in node.handlers:
                inner = replace(around, spans=span(*handler.body))
                yield from of_block(handler, "body", inner)
                if not isinstance(handler.body[0], ast.Raise):
                    again = ast.ExceptHandler(handler.type, handler.name, [ast.Raise()])
                    yield inner, "branch removed", Spot(node, "handlers", node.handlers.index(handler)), again
        case ast.With():
            for item in node.items:
                yield from of_expression(Spot(item, "context_expr"), replace(around, shown=item.context_expr, spans=span(item.context_expr)))
        case _:
            yield from of_children(node, around)
            return
    for name in ("body", "orelse", "finalbody"):
        if hasattr(node, name):
            yield from of_block(node, name, around)


def of_match(node: ast.Match, around: Around) -> Iterator[Change]:
    """The changes of a `match`: a case left out, its guard."""
    headed = replace(around, shown=node.subject, spans=span(node.subject))
    yield from of_expression(Spot(node, "subject"), headed)
    for index, case in enumerate(node.cases):
        if len(node.cases) > 1 and not isinstance(case.body[0], ast.Raise) and "assert_never" not in ast.unparse(case.body[0]):
            yield headed, "branch removed", Spot(node, "cases", index), None
        if case.guard is not None:
            guarded = replace(around, shown=case.guard, spans=span(case.guard))
            yield guarded, "branch removed", Spot(case, "guard"), ast.Constant(True)
            yield from of_expression(Spot(case, "guard"), guarded)
        yield from of_block(case, "body", around)


def inside(around: Around, name: str) -> str:
    """The name of what is defined there."""
    return f"{around.function}.{name}" if around.function else name


def of_definition(spot: Spot, node: Definition, around: Around) -> Iterator[Change]:
    """The changes of a function: its defaults, its statements, and all of its body."""
    if node.name in TEXTS:
        return
    body = statements(node)
    if not body:
        return
    inner = replace(around, function=inside(around, node.name), in_function=True, spans=span(*body))
    if not (len(body) == 1 and isinstance(body[0], ast.Raise)):
        yield inner, BODY, spot, without_body(node)
    for name in ("defaults", "kw_defaults"):
        for index, default in enumerate(getattr(node.args, name)):
            if default is not None:
                yield from of_expression(Spot(node.args, name, index), replace(inner, shown=node.args))
    yield from of_block(node, "body", inner)


def without_body(node: Definition) -> Definition:
    """The function with a raise for its body."""
    new = type(node)(**{name: getattr(node, name, None) for name in node._fields})
    new.body = [ast.Raise(ast.Name("AssertionError", ast.Load()))]
    return new


def of_children(node: ast.AST, around: Around) -> Iterator[Change]:
    """The changes of the expressions in a node."""
    for name, value in ast.iter_fields(node):
        if isinstance(value, list):
            for index, entry in enumerate(value):
                if isinstance(entry, ast.AST):
                    yield from of_expression(Spot(node, name, index), around)
        elif isinstance(value, ast.AST):
            yield from of_expression(Spot(node, name), around)


def of_expression(spot: Spot, around: Around) -> Iterator[Change]:
    """The changes of an expression, and of those in it."""
    node = spot.get()
    if isinstance(node, ast.JoinedStr) or is_text(node) or (isinstance(node, ast.keyword) and node.arg == "strict"):
        return
    for kind, new in instead_of(node, around):
        yield around, kind, spot, new
    if isinstance(node, ast.Compare):
        for index, operator in enumerate(node.ops):
            yield around, "comparison", Spot(node, "ops", index), TURNED[type(operator)]()
    if isinstance(node, ast.comprehension):
        for index in range(len(node.ifs)):
            yield around, "branch removed", Spot(node, "ifs", index), ast.Constant(True)
    yield from of_expression(Spot(node, "args", 1), around) if is_cast(node) else of_children(node, around)


def is_text(node: ast.AST) -> bool:
    """Whether it is a text that is put together of others."""
    sides = (node.left, node.right) if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add) else ()
    return any(isinstance(side, ast.JoinedStr) or is_text(side) or (isinstance(side, ast.Constant) and isinstance(side.value, str)) for side in sides)


def is_cast(node: ast.AST) -> bool:
    """Whether it is a call of `cast`, whose first argument is a type."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "cast"


def instead_of(node: ast.AST, around: Around) -> Iterator[tuple[str, ast.expr]]:
    """The expressions that take the place of one."""
    match node:
        case ast.BoolOp():
            for dropped in node.values:
                rest = [v for v in node.values if v is not dropped]
                yield "operand", rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)
        case ast.BinOp(op=ast.BitOr()) if not around.in_function:
            return
        case ast.BinOp():
            yield "operand", node.left
            yield "operand", node.right
            if type(node.op) in OTHER_SIGN:
                yield "sign", ast.BinOp(node.left, OTHER_SIGN[type(node.op)](), node.right)
        case ast.UnaryOp(op=ast.Not() | ast.USub()):
            yield "sign", node.operand
        case ast.Constant(value=bool()):
            yield "constant", ast.Constant(not node.value)
        case ast.Constant(value=int() | float()):
            yield "constant", ast.Constant(node.value + 1)
        case ast.IfExp():
            yield "branch removed", node.body
            yield "branch removed", node.orelse
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass")):
            yield "isinstance to False", ast.Constant(False)
        case ast.Call(func=ast.Name(id=name)) if name in UNCALLED:
            return
        case ast.Call() if node.args and not isinstance(node.args[0], ast.Starred):
            yield "call to argument", node.args[0]
        case ast.Call(func=ast.Attribute(value=receiver), args=[], keywords=[]):
            yield "call to argument", receiver
        case _:
            return
