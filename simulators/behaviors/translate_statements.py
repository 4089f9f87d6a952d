"""Behaviors and monitors as Python generators, one small function per statement form; `courses` has what they call.

A generator yields the actions of a time step, and goes on in the next one. A block within a statement with interrupts is a generator of its own,
which returns how it was left: None at its end, else "break", "continue" or "return", for the block around it to do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any, ClassVar, NamedTuple

from ...semantics.machine.premises import SHARED
from ...semantics.machine.values import Instance, Random
from ...semantics.machine.world_queries import Clock
from ...semantics.space.vectors import Vector
from ...semantics.store.postponed_values import Waiting
from ...semantics.store.scenic_classes import ScenicClass
from ...semantics.store.scopes import MISSING, NO_NAMES, Names, descendants, function_names
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import statements as s
from ...semantics.syntax.nodes import Expression, Node
from .fallback import Untranslated
from .host_calls import METHODS, NUMBERS, OPEN
from .operations import ACTION_TYPES, PLAIN, Raised
from .translate_expressions import Expressions, syntax_size

NAMES: Mapping[str, object] = {
    "Random": Random, "MISSING": MISSING, "Instance": Instance, "NUMBERS": NUMBERS, "PLAIN": PLAIN, "ACTIONS": ACTION_TYPES,
    "WRAPPED": frozenset({Random, Waiting}), "Clock": Clock, "ANY": any, "ALL": all, "Raised": Raised,
    "CLASSES": frozenset({ScenicClass, Random}), "Vector": Vector, "OPEN": OPEN, "METHODS": METHODS, "SEQUENCES": frozenset({list, tuple}),
}  # fmt: skip
"""What every source may refer to."""

class ExceptClause(NamedTuple):
    """A clause `except`: what gives its classes (None: it catches everything), the name of the exception in it, its block."""

    type: Callable[[], Any] | None
    name: str | None
    body: Callable[[], Iterator[Any]]


TIMELESS = (
    s.Assignment, s.AugmentedAssignment, s.ExpressionStatement, s.FunctionDefinition, s.Delete, s.Assert, s.Import, s.ImportFrom, s.ClassDefinition,
    s.Require, s.SoftRequire, s.Raise,
)  # fmt: skip
"""Statements without blocks of their own level, for the machine to perform if there is no translation."""


class Statements(Expressions):
    """The source of a coroutine's body, line by line, by the `translations` of its statements.

    `loops` is how many loops of the generator that is being written are open; within a block of a statement with interrupts (`nested`) others are
    around it.
    """

    translations: ClassVar[Mapping[type, Callable[[Any, Any], None]]]

    def __init__(self, names: Names, readings: Mapping[str, str], *, plain_scope: bool, has_agent: bool) -> None:
        super().__init__(names, readings, plain_scope=plain_scope, has_agent=has_agent)
        self.loops = 0
        self.nested = 0

    def block(self, block: s.Block) -> None:
        """⟨s1; s2⟩, as an indented block."""
        self.indent += 1
        for statement in block:
            self.statement(statement)
        self.line("pass")
        self.indent -= 1

    def statement(self, node: Node) -> None:
        """One statement. Raises `Untranslated`."""
        translation = self.translations.get(type(node))
        if translation is not None:
            translation(self, node)
        elif isinstance(node, TIMELESS):
            self.line(f"q.reduced(S, {self.constant(node)})")
        else:
            raise Untranslated(WORDS.get(type(node), type(node).__name__), node.span.line)

    # Python's statements

    def passed(self, node: Node) -> None:
        """`pass`, and declarations that act when names are resolved."""

    def expression(self, node: s.ExpressionStatement) -> None:
        """⟨E⟩ for its effect: a text, such as that which describes a behavior, has none."""
        if isinstance(node.value, p.Call) and self.is_translated_call(node.value):
            self.line(f"q.discarded(S, {self.constant(node)}, {self.carried(node.value)})")
        elif not isinstance(node.value, p.Constant):
            self.line(f"q.reduced(S, {self.constant(node)})")

    def assignment(self, node: s.Assignment) -> None:
        """σ[x / v] for variables of the coroutine's own, and attributes of the program's instances; other targets are bound by the machine."""
        target, k = node.targets[0], self.constant(node)
        if len(node.targets) == 1 and isinstance(target, p.Name) and self.is_own(target.name):
            self.line(f"B[{target.name!r}] = {self.carried(node.value)}")
            return
        t = self.temporary()
        self.line(f"{t} = {self.carried(node.value)}")
        if len(node.targets) == 1 and isinstance(target, p.Attribute):
            self.line(f"q.assign_attribute(S, {k}, {t}, {self.value(target.value)})")
            return
        items = target.items if len(node.targets) == 1 and isinstance(target, (p.TupleDisplay, p.ListDisplay)) else ()
        names = [item.name for item in items if isinstance(item, p.Name) and self.is_own(item.name)]
        if items and len(names) == len(items):
            bound = "".join(f"B[{name!r}], " for name in names)
            self.line(f"if type({t}) in SEQUENCES and len({t}) == {len(items)}: {bound}= {t}")
            self.line(f"else: q.assigned(S, {k}, {t})")
        else:
            self.line(f"q.assigned(S, {k}, {t})")

    def is_own(self, name: str) -> bool:
        """Whether a variable belongs to the coroutine, and to nobody else."""
        return name in self.names.local and name not in SHARED

    def augmented(self, node: s.AugmentedAssignment) -> None:
        """`x += E`, where x is read before E is evaluated; what is no number the machine changes or binds."""
        if not (isinstance(node.target, p.Name) and self.is_own(node.target.name)):
            self.line(f"q.reduced(S, {self.constant(node)})")
            return
        name, a, b = repr(node.target.name), self.temporary(), self.temporary()
        self.line(f"{a} = {self.value(node.target)}")
        self.line(f"{b} = {self.value(node.value)}")
        small = f"type({a}) is int and type({b}) is int and -{LARGE} < {a} < {LARGE} and -{LARGE} < {b} < {LARGE}"
        if node.operator in ("+", "-", "*"):
            self.line(f"if (type({a}) is float and type({b}) is float) or ({small}): B[{name}] = {a} {node.operator} {b}")
            self.line(f"else: q.augmented(S, {self.constant(node)}, {a}, {b})")
        else:
            self.line(f"q.augmented(S, {self.constant(node)}, {a}, {b})")

    def if_(self, node: s.If) -> None:
        """`if B: ... else: ...`."""
        self.line(f"if {self.truth(node.test)}:")
        self.block(node.then)
        if node.otherwise:
            self.line("else:")
            self.block(node.otherwise)

    def while_(self, node: s.While) -> None:
        """`while B: ...`."""
        self.line(f"while {self.truth(node.test)}:")
        self.loop(node)

    def for_(self, node: s.For) -> None:
        """`for x in I: ...`."""
        t, source = self.temporary(), self.iterable(node.iterable)
        self.line(f"for {t} in q.elements(S, {self.constant(node.iterable)}, {source}):")
        self.indent += 1
        self.bound(node.target, "B", self.names, t)
        self.indent -= 1
        self.loop(node)

    def loop(self, node: s.While | s.For) -> None:
        """The body of a loop, and what comes after its last turn; turns are counted where no time need pass in one."""
        self.loops += 1
        if not passes_time(node.body):
            head = node.test if isinstance(node, s.While) else node.target
            self.line(f"    q.turn({syntax_size(head, *node.body)})")
        self.block(node.body)
        self.loops -= 1
        if node.otherwise:
            self.line("else:")
            self.block(node.otherwise)

    def leave(self, node: s.Break | s.Continue) -> None:
        """`break`, `continue`: of the block around it, if the loop is not within this one."""
        word = "break" if isinstance(node, s.Break) else "continue"
        self.line(word if self.loops else f"return {word!r}")

    def return_(self, node: s.Return) -> None:
        """`return` ends a behavior; its value is nobody's, but is reduced."""
        if node.value is not None:
            self.line(self.value(node.value))
        self.line("return 'return'")

    # Dynamic statements

    def take(self, node: d.Take) -> None:
        """`take E1, ..., En`."""
        t, names, here = self.temporary(), [self.temporary() for _ in node.actions], self.constant(node)
        known = " and ".join(f"type({name}) in ACTIONS" for name in names)
        self.line(f"{t} = ({''.join(f'({name} := {self.taken(a)}), ' for name, a in zip(names, node.actions))})")
        self.line(f"q.leaf, q.node = I, {here}")
        self.line(f"yield {t} if {known} and I.agent is not None else q.taken({here}, {t})")
        self.line("if I.invariants: q.check_invariants(I)")

    def taken(self, node: Expression) -> str:
        """The source of an action; one of constants is made once."""
        return self.without_origin(self.call(node, once=True)) if isinstance(node, p.Call) and self.is_translated_call(node) else self.value(node)

    def wait(self, node: d.Wait) -> None:
        """`wait`."""
        self.line(f"q.leaf, q.node = I, {self.constant(node)}")
        self.line("yield ()")
        self.line("if I.invariants: q.check_invariants(I)")

    def wait_for(self, node: d.WaitFor) -> None:
        """`wait for T`, `wait until B`."""
        whole = self.function((s.While(test=p.Constant(value=True), body=(d.Wait(span=node.span),), span=node.span),))
        clause = self.limit(node, node.limit)
        self.line(f"yield from q.abortable(q.interruptible(I, {self.constant(node)}, ({clause},), {whole}()))")

    def terminate(self, node: d.Terminate) -> None:
        """`terminate`, `terminate simulation`."""
        self.line(f"q.terminate({self.constant(node)})")

    def abort(self, node: d.Abort) -> None:
        """`abort`."""
        self.line(f"q.abort({self.constant(node)})")

    def do(self, node: d.Do) -> None:
        """`do B1, ..., Bn`, with or without a limit."""
        t = self.temporary()
        self.line(f"{t} = q.invocations({self.constant(node)}, ({''.join(f'{self.value(i)}, ' for i in node.invocations)}))")
        self.limited(node, f"q.invoke(I, {t}, {node.limit is not None})")

    def pick(self, node: d.DoChoose | d.DoShuffle) -> None:
        """`do choose`, `do shuffle`."""
        t = self.temporary()
        weights = "".join(f"{self.value(w)}, " for w in node.weights) or "1, " * len(node.invocations)
        options = "".join(f"{self.value(i)}, " for i in node.invocations)
        self.line(f"{t} = q.options({self.constant(node)}, ({options}), ({weights}))")
        self.limited(node, f"q.pick(I, {self.constant(node)}, {t}, {node.limit is not None})")

    def limited(self, node: d.Do | d.DoChoose | d.DoShuffle, task: str) -> None:
        """A task, within the limit of its statement."""
        if node.limit is None:
            self.line(f"yield from {task}")
            return
        clause = self.limit(node, node.limit)
        self.line(f"yield from q.abortable(q.interruptible(I, {self.constant(node)}, ({clause},), {task}))")
        self.line("if I.invariants: q.check_invariants(I)")

    def limit(self, node: Node, limit: d.TimeLimit | d.Until) -> str:
        """The clause of a limit: what ends the statement, where that stands, and the handler, which aborts."""
        place = node if isinstance(limit, d.TimeLimit) else limit.condition
        if isinstance(limit, d.Until):
            condition = self.condition(limit.condition)
        else:
            condition = f"q.deadline({self.constant(node)}, {self.value(limit.amount)})"
        return f"({condition}, {self.constant(place)}, {self.function((d.Abort(span=node.span),))})"

    def try_(self, node: s.Try) -> None:
        """`try`, with `interrupt when` or without."""
        course = f"{self.function(node.body)}()"
        if node.interrupts:
            clauses = "".join(f"({self.condition(i.condition)}, {self.constant(i.condition)}, {self.function(i.body)}), " for i in node.interrupts)
            course = f"q.interruptible(I, {self.constant(node)}, ({clauses}), {course})"
        if node.handlers or node.otherwise:
            handlers = "".join(f"{self.handler(h)}, " for h in node.handlers)
            course = f"q.attempt(S, {course}, ({handlers}), {self.function(node.otherwise) if node.otherwise else None})"
        if node.final:
            course = f"q.at_last({course}, {self.function(node.final)})"
        if node.interrupts:
            course = f"q.abortable({course})"
        t = self.temporary()
        self.line(f"{t} = yield from {course}")
        self.line(f"if {t} == 'return': return 'return'")
        if self.loops:
            self.line(f"if {t} == 'break': break")
            self.line(f"if {t} == 'continue': continue")
        elif self.nested:
            self.line(f"if {t} is not None: return {t}")

    def handler(self, handler: s.Handler) -> str:
        """A clause `except`."""
        kind = "None"
        if handler.type is not None:
            kind, type_ = self.new_name("c"), handler.type
            self.line(f"def {kind}():")
            self.returned(lambda: self.value(type_))
        return f"ExceptClause({kind}, {handler.name!r}, {self.function(handler.body)})"

    def condition(self, condition: Expression) -> str:
        """A condition that is looked at again and again, as a function."""
        name = self.new_name("c")
        self.line(f"def {name}():")
        self.returned(lambda: self.holds(condition))
        return name

    def returned(self, value: Callable[[], str]) -> None:
        """The body of a function that gives a value, with what the value needs before it."""
        self.indent += 1
        self.line(f"return {value()}")
        self.indent -= 1

    def function(self, block: s.Block) -> str:
        """A block as a generator of its own."""
        name = self.new_name("f")
        self.line(f"def {name}():")
        loops, self.loops, self.nested = self.loops, 0, self.nested + 1
        self.block(block)
        self.line("    return")
        self.line("    yield")
        self.loops, self.nested = loops, self.nested - 1
        return name


def passes_time(body: s.Block) -> bool:
    """Whether each turn of a loop takes a time step: `take` or `wait` is one of its statements, before which nothing can leave the turn."""
    for statement in body:
        if isinstance(statement, (d.Take, d.Wait)):
            return True
        if any(isinstance(node, s.Continue) for node in descendants(statement)):
            return False
    return False


OF_PYTHON: Mapping[type, Callable[[Any, Any], None]] = {
    s.Pass: Statements.passed, s.Global: Statements.passed, s.Nonlocal: Statements.passed, s.ExpressionStatement: Statements.expression,
    s.Assignment: Statements.assignment, s.AugmentedAssignment: Statements.augmented, s.If: Statements.if_, s.While: Statements.while_,
    s.For: Statements.for_, s.Break: Statements.leave, s.Continue: Statements.leave,
}  # fmt: skip
Statements.translations = {
    **OF_PYTHON, s.Return: Statements.return_, s.Try: Statements.try_,
    d.Take: Statements.take, d.Wait: Statements.wait, d.WaitFor: Statements.wait_for, d.Terminate: Statements.terminate, d.Abort: Statements.abort,
    d.Do: Statements.do, d.DoChoose: Statements.pick, d.DoShuffle: Statements.pick,
}  # fmt: skip
WORDS: Mapping[type, str] = {d.BehaviorDefinition: "the definition of a behavior", d.Override: "`override`", s.Param: "`param`", s.Mutate: "`mutate`"}
"""What has no translation, in words."""
LARGE = 1 << 40
SCOPES = "B, M, U = S.bindings, S.parent.bindings, S.parent.parent.bindings"
OF_METHOD = "B, M, U = S.bindings, S.parent.parent.bindings, S.parent.parent.parent.bindings"
OF_MODULE = "B = M = S.bindings; U = S.parent.bindings"
"""The variables of a coroutine or function, of its module, and those that are built in."""


class FunctionBody(Statements):
    """The source of the body of a function, which takes no time: what leaves a block in Python leaves it here."""

    def return_(self, node: s.Return) -> None:
        """`return E`: a value that keeps what it was drawn from."""
        self.line("return None" if node.value is None else f"return {self.carried(node.value)}")

    def try_(self, node: s.Try) -> None:
        """`try`."""
        if node.interrupts:
            raise Untranslated("`interrupt when` in a function", node.span.line)
        if node.final:
            self.at_last(node)
        elif node.handlers:
            self.handling(node)
        else:
            self.line("if True:")
            self.block(node.body)

    def at_last(self, node: s.Try) -> None:
        """`finally`: however what stands before it is left, but not where the run ends in it."""
        goes_on = self.temporary()
        self.line(f"{goes_on} = True")
        self.line("try:")
        self.indent += 1
        self.line("try:")
        self.indent += 1
        self.try_(replace(node, final=()))
        self.line("pass")
        self.indent -= 1
        self.line("except Raised: raise")
        self.line("except BaseException:")
        self.line(f"    {goes_on} = False")
        self.line("    raise")
        self.indent -= 1
        self.line("finally:")
        self.line(f"    if {goes_on}:")
        self.indent += 1
        self.block(node.final)
        self.indent -= 1

    def handling(self, node: s.Try) -> None:
        """`try` with `except` and `else`."""
        problem, exception = self.temporary(), self.temporary()
        self.line("try:")
        self.block(node.body)
        self.line(f"except Raised as {problem}:")
        self.indent += 1
        self.line(f"{exception} = {problem}.abrupt.value")
        for handler in node.handlers:
            if handler.type is not None:
                self.line(f"if q.catches({self.value(handler.type)}, {exception}):")
            else:
                self.line("if True:")
            self.indent += 1
            self.handled(handler, exception)
            self.indent -= 1
            self.line("else:")
            self.indent += 1
        self.line("raise")
        self.indent -= 1 + len(node.handlers)
        if node.otherwise:
            self.line("else:")
            self.block(node.otherwise)

    def handled(self, handler: s.Handler, exception: str) -> None:
        """The block of a handler, while the exception is handled, whose name is then forgotten."""
        outer = self.temporary()
        self.line(f"{outer}, q.handling = q.handling, (*q.handling, {exception})")
        if handler.name is not None:
            self.line(f"S.home({handler.name!r}).bindings[{handler.name!r}] = {exception}")
        self.line("try:")
        self.block(handler.body)
        self.line("finally:")
        self.line(f"    q.handling = {outer}")
        if handler.name is not None:
            self.line(f"    S.home({handler.name!r}).bindings.pop({handler.name!r}, None)")


FunctionBody.translations = {**OF_PYTHON, s.Return: FunctionBody.return_, s.Try: FunctionBody.try_}


def coroutine(
    body: s.Block, names: Names, readings: Mapping[str, str], *, plain_scope: bool, has_agent: bool
) -> Callable[..., Iterator[Any]]:
    """The generator function of the body of a behavior or monitor: of the `Courses`, its scope, and its invocation. Raises `Untranslated`."""
    source = Statements(names, readings, plain_scope=plain_scope, has_agent=has_agent)
    source.indent = 0
    source.line("def coroutine(q, S, I):")
    source.line(f"    {SCOPES if plain_scope else 'B = S.bindings'}")
    source.block(body)
    source.line("    return")
    source.line("    yield")
    return define_function(source, "coroutine", body[0])


def condition(
    node: Expression, definition: Node | None, readings: Mapping[str, str], *, plain_scope: bool, decides: bool
) -> Callable[[Any, Any], Any]:
    """The function of the `Equations` and a scope that gives the value of an expression: whether it holds, if it `decides` something.

    The scope is that of a behavior, whose `definition` says what it binds, or of a scenario: then it is the module's where it is plain.
    """
    names = NO_NAMES if definition is None else function_names(definition)
    source = Statements(names, readings, plain_scope=plain_scope, has_agent=definition is not None)
    source.indent = 0
    source.line("def condition(q, S):")
    source.line(f"    {SCOPES if definition is not None and plain_scope else OF_MODULE if plain_scope else 'B = S.bindings'}")
    source.returned(lambda: source.holds(node) if decides else source.value(node))
    return define_function(source, "condition", node)


def function_body(body: s.Block | Node, names: Names, readings: Mapping[str, str], scopes: str) -> Callable[[Any, Any], Any]:
    """The function of the `Courses` and a scope that does what the body of a function or lambda says. Raises `Untranslated`.

    `scopes` is SCOPES or OF_METHOD where the scope around it is that of a module, or of a class in one, else "".
    """
    source = FunctionBody(names, readings, plain_scope=bool(scopes), has_agent=False)
    source.indent = 0
    source.line("def body(q, S):")
    source.line(f"    {scopes or 'B = S.bindings'}")
    if isinstance(body, tuple):
        source.block(body)
        return define_function(source, "body", body[0])
    source.returned(lambda: source.carried(body))
    return define_function(source, "body", body)


def define_function(source: Expressions, name: str, node: Node) -> Callable[..., Any]:
    """The function of that name which a source defines. Raises `Untranslated` for nesting that Python does not have."""
    scope: dict[str, Any] = {**NAMES, "ExceptClause": ExceptClause, **source.constants}
    text = "\n".join(source.lines)
    try:
        exec(compile(text, f"<compiled from line {node.span.line}>", "exec"), scope)  # the text is made from the syntax tree, by the functions above
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise Untranslated("more nesting than Python allows", node.span.line) from None
    return scope[name]
