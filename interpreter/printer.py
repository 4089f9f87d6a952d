"""Abstract syntax as source text that parses back to the same tree: `to_source`."""



from __future__ import annotations

import keyword
from collections.abc import Iterable, Iterator

from ..semantics.syntax import Block, Expression, Node, Program, Specifier, Statement
from ..semantics.syntax import dynamics as d
from ..semantics.syntax import statements as s
from ..semantics.syntax.python_expressions import BooleanOperation, Comparison, Parameter, Starred
from .dialects import DEFAULT, DIALECTS
from .nesting import room
from .printer_expressions import ExpressionPrinter

INDENT = "    "
Item = tuple[Node | None, Iterator[str]]
"""What stands in a block, and its lines; a block within that belongs to no node (`setup`) has none."""


@room()
def to_source(what: Program | Node | Block, dialect: str = DEFAULT) -> str:
    """The text of a program (in its own dialect, which its first line names), a block, a statement or an expression.

    Parsing it gives an equal tree; positions are not part of equality.
    """
    if isinstance(what, Program):
        mark = "" if what.dialect == DEFAULT else f"# dialect: {what.dialect}\n"
        return mark + to_source(what.statements, what.dialect)
    printer = StatementPrinter(DIALECTS[dialect])
    if isinstance(what, tuple):
        return "".join([line + "\n" for statement in what for line in printer.lines(statement)])
    if isinstance(what, Statement):
        return "".join([line + "\n" for line in printer.lines(what)])
    if isinstance(what, Specifier):
        return printer.specifier(what)
    if isinstance(what, Expression):
        return printer.test(what)
    raise TypeError(f"no statement, specifier or expression: {type(what).__name__}")


class StatementPrinter(ExpressionPrinter):
    """Prints statements in one dialect, as lines."""

    def lines(self, node: Statement) -> Iterator[str]:
        """The lines of a statement, without line ends."""
        yield from getattr(self, "lines_" + type(node).__name__, self.simple)(node)

    def clause(self, head: str, statements: Block, more: Iterable[Item] = ()) -> Iterator[str]:
        """`head:` and its block, with `more` items before its statements."""
        yield head + ":"
        yield from self.block([*more, *self.statements(statements)])

    def statements(self, statements: Block) -> list[Item]:
        """The items of a block that are statements."""
        return [(statement, self.lines(statement)) for statement in statements]

    def block(self, items: list[Item]) -> Iterator[str]:
        """The indented lines of the items of a block."""
        for _, lines in items:
            for line in lines:
                yield INDENT + line
        if not items:
            yield INDENT + "pass"

    def one(self, node: Node, text: str) -> Iterator[str]:
        """The text of a node that has a line of its own."""
        yield text

    def optional(self, head: str, statements: Block | None) -> Iterator[str]:
        """`head:` and its block, if there is one."""
        if statements:
            yield from self.clause(head, statements)

    # -- Simple statements

    def simple(self, node: Statement) -> Iterator[str]:
        """The one line of a simple statement."""
        yield from self.one(node, self.line(node))

    def line(self, node: Statement) -> str:
        match node:
            case s.ExpressionStatement():
                return self.list_of_tests(node.value)
            case s.Assignment():
                return " = ".join([self.target(t) for t in node.targets] + [self.list_of_tests(node.value)])
            case s.AugmentedAssignment():
                return f"{self.test(node.target)} {node.operator}= {self.list_of_tests(node.value)}"
            case s.Return():
                return "return" + ("" if node.value is None else " " + self.list_of_tests(node.value))
            case s.Break() | s.Continue() | s.Pass() | d.Wait() | d.Abort():
                return type(node).__name__.lower()
            case s.Delete():
                return "del " + (", ".join([self.test(t) for t in node.targets]) or "()")
            case s.Assert():
                return f"assert {self.operand(node.test)}" + ("" if node.message is None else f", {self.operand(node.message)}")
            case s.Raise():
                return "raise" + "".join([self.option("", node.exception)[1:], self.option("from", node.cause)])
            case s.Global() | s.Nonlocal():
                return f"{type(node).__name__.lower()} {', '.join(node.names)}"
            case s.Import():
                return "import " + ", ".join([imported(name) for name in node.names])
            case s.ImportFrom():
                names = ", ".join([imported(name) for name in node.names]) or "*"
                return f"from {'.' * node.level}{node.module} import {names}"
            case _:
                return self.scenic_line(node)

    def scenic_line(self, node: Statement) -> str:
        match node:
            case s.Model():
                return f"model {node.name}"
            case s.Param():
                return "param " + ", ".join([f"{parameter_name(a.name)} = {self.item(a.value)}" for a in node.assignments])
            case s.ChooseSimulator():
                return f"simulator {self.operand(node.value)}"
            case s.Require():
                return f"require {self.condition(node.condition)}{called(node.name)}"
            case s.SoftRequire():
                return f"require[{self.test(node.probability)}] {self.operand(node.condition)}{called(node.name)}"
            case d.RequireAlways():
                return f"require always ({self.test(node.condition)}){called(node.name)}"
            case d.RequireEventually():
                return f"require eventually ({self.test(node.condition)}){called(node.name)}"
            case d.RequireMonitor():
                return f"require monitor {self.operand(node.monitor)}{called(node.name)}"
            case d.TerminateWhen():
                return f"terminate {'simulation ' * node.simulation}when {self.operand(node.condition)}{called(node.name)}"
            case d.TerminateAfter():
                return f"terminate after{self.limit(node.limit).removeprefix(' for')}"
            case d.Terminate():
                return "terminate" + " simulation" * node.simulation
            case d.WaitFor():
                return f"wait{self.limit(node.limit)}"
            case d.Record():
                when = "" if node.time == "always" else f"{node.time} "
                period, delay = (self.limit(limit).removeprefix(" for") for limit in (node.period, node.delay))
                return f"record {when}({self.test(node.value)}){period and ' every' + period}{delay and ' after' + delay}{called(node.name)}"
            case s.Mutate():
                names = " ".join(["mutate", ", ".join([name.name for name in node.objects])]).rstrip()
                return names + ("" if node.scale is None else f" by ({self.test(node.scale)})")
            case d.Take():
                return "take " + ", ".join([f"({self.test(a)})" for a in node.actions])
            case d.Do():
                return f"do {self.invoked(node.invocations)}{self.limit(node.limit)}"
            case d.DoChoose() | d.DoShuffle():
                word = "choose" if isinstance(node, d.DoChoose) else "shuffle"
                return f"do {word} {self.weighted(node.invocations, node.weights)}{self.limit(node.limit)}"
            case d.Override():
                return f"override {self.operand(node.object)} {self.specifiers(node.specifiers)}"
            case _:
                raise TypeError(f"no statement: {type(node).__name__}")

    def condition(self, node: Expression) -> str:
        """`node` behind `require`: a comparison, or `and` and `or`, that begin with a bracket or a word need no more brackets."""
        text = self.test(node)
        return text if isinstance(node, Comparison | BooleanOperation) and (text[0] == "(" or text[0].isalnum()) else self.argument(node)

    def invoked(self, nodes: tuple[Expression, ...]) -> str:
        return ", ".join([f"({self.test(node)})" for node in nodes])

    def weighted(self, nodes: tuple[Expression, ...], weights: tuple[Expression, ...]) -> str:
        """The alternatives of `do choose`, with their weights if they have any."""
        if not weights:
            return self.invoked(nodes)
        pairs = [f"{self.operand(node)}: {self.operand(weight)}" for node, weight in zip(nodes, weights, strict=True)]
        return "{" + ", ".join(pairs) + "}"

    def limit(self, limit: d.TimeLimit | d.Until | None) -> str:
        """` for S seconds`, ` for S steps`, ` until B` or nothing."""
        if limit is None:
            return ""
        if isinstance(limit, d.Until):
            return f" until {self.operand(limit.condition)}"
        return f" for {self.operand(limit.amount)} {limit.unit}"

    # -- Compound statements

    def lines_If(self, node: s.If) -> Iterator[str]:
        head = "if"
        while True:
            yield from self.clause(f"{head} {self.operand(node.test)}", node.then)
            match node.otherwise:
                case (s.If() as node,):
                    head = "elif"
                case rest:
                    yield from self.optional("else", rest)
                    return

    def lines_While(self, node: s.While) -> Iterator[str]:
        yield from self.clause(f"while {self.operand(node.test)}", node.body)
        yield from self.optional("else", node.otherwise)

    def lines_For(self, node: s.For) -> Iterator[str]:
        yield from self.clause(f"for {self.target(node.target)} in {self.list_of_tests(node.iterable)}", node.body)
        yield from self.optional("else", node.otherwise)

    def lines_FunctionDefinition(self, node: s.FunctionDefinition) -> Iterator[str]:
        for decorator in node.decorators:
            yield from self.one(decorator, "@" + self.operand(decorator))
        yield from self.clause(f"def {node.name}({self.parameters(node.parameters)})", node.body)

    def lines_Try(self, node: s.Try) -> Iterator[str]:
        yield from self.clause("try", node.body)
        for interrupt in node.interrupts:
            yield from self.clause(f"interrupt when {self.operand(interrupt.condition)}", interrupt.body)
        for handler in node.handlers:
            name = f" as {handler.name}" if handler.name else ""
            yield from self.clause("except" + self.option("", handler.type).replace("  ", " ", 1) + name, handler.body)
        yield from self.optional("else", node.otherwise)
        yield from self.optional("finally", node.final)

    def lines_ClassDefinition(self, node: s.ClassDefinition) -> Iterator[str]:
        superclasses = ", ".join([self.test(c) if isinstance(c, Starred) else self.operand(c) for c in node.superclasses])
        properties = [(item, self.one(item, f"{item.name}{attributes(item)}: {self.default(item.value)}")) for item in node.properties]
        yield from self.clause(f"class {node.name}({superclasses})" if superclasses else f"class {node.name}", node.body, properties)

    def default(self, node: Expression) -> str:
        """A default value: a tuple in brackets where the releases need them, and without where `(a, b)` would be an interval."""
        return self.test(node) if self.dialect.released else self.list_of_tests(node)

    def definition(self, word: str, name: str, parameters: tuple[Parameter, ...]) -> str:
        return f"{word} {name}({self.parameters(parameters)})"

    def guards(self, node: d.BehaviorDefinition | d.ScenarioDefinition) -> Iterator[Item]:
        """Preconditions and invariants."""
        for word, conditions in (("precondition", node.preconditions), ("invariant", node.invariants)):
            yield from ((condition, self.one(condition, f"{word}: {self.operand(condition)}")) for condition in conditions)

    def lines_BehaviorDefinition(self, node: d.BehaviorDefinition) -> Iterator[str]:
        yield from self.clause(self.definition("behavior", node.name, node.parameters), node.body, self.guards(node))

    def lines_MonitorDefinition(self, node: d.MonitorDefinition) -> Iterator[str]:
        one = not (self.dialect.monitor_instances or node.parameters)
        yield from self.clause(f"monitor {node.name}" if one else self.definition("monitor", node.name, node.parameters), node.body)

    def lines_ScenarioDefinition(self, node: d.ScenarioDefinition) -> Iterator[str]:
        yield from self.clause(self.definition("scenario", node.name, node.parameters), (), [*self.guards(node), *self.parts(node)])

    def parts(self, node: d.ScenarioDefinition) -> Iterator[Item]:
        for word, block in (("setup", node.setup), ("compose", node.compose)):
            if block is not None:
                yield None, self.clause(word, block)


def imported(name: s.ImportedName) -> str:
    """`name as alias`."""
    return name.name + (f" as {name.alias}" if name.alias else "")


def called(name: str) -> str:
    """` as name`, or nothing."""
    return f" as {name if name.isidentifier() or name.isdecimal() else repr(name)}" if name else ""


def attributes(item: s.PropertyDefault) -> str:
    """The attributes of a property."""
    return f"[{', '.join(item.attributes)}]" if item.attributes else ""


def parameter_name(name: str) -> str:
    """The name of a global parameter, quoted unless it is an identifier and no keyword."""
    return name if name.isidentifier() and not keyword.iskeyword(name) else repr(name)
