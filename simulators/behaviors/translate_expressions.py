"""Expressions as Python source: what has no rule of its own between operands and value stands in the source itself, all else calls `Equations`.

Every translation gives a plain value, or, where the rule of the paper only passes a value on (`premises.CARRIERS`), one that keeps what it was drawn
from. A node without translation is reduced by the machine.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...semantics.machine.premises import SHARED
from ...semantics.scenes.released_forms import EQUATIONS, REWRITINGS
from ...semantics.store.built_in_classes import canonical
from ...semantics.store.scopes import NO_NAMES, Names, descendants, target_names
from ...semantics.syntax import expressions as e
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax.nodes import Node
from .operations import PLAIN

ORDER = frozenset({"<", ">", "<=", ">="})
SPELLED = frozenset({"+", "-", "*"})
"""Operators that stand in the source where both operands are floats."""


class Expressions:
    """The source of expressions in a scope with these own `names`; what the source refers to is collected in `constants`.

    In the source, `q` are the `Courses`, `S` is σ, `B` its own variables, `M` those of the module right around it (`plain_scope`), and `U` those that
    are built in. `self` is one of the variables where there is an agent. `scopes` are the scopes that are open, the innermost last, each with the
    name of its variables in the source: those of comprehensions stand within the one that is translated. What an expression needs beside itself, a
    function for each comprehension, stands in the `lines` before it.
    """

    def __init__(self, names: Names, readings: Mapping[str, str], *, plain_scope: bool, has_agent: bool) -> None:
        self.names = names
        self.scopes: list[tuple[str, Names]] = [("B", names)]
        self.has_agent = has_agent
        self.readings = readings
        self.plain_scope = plain_scope
        self.constants: dict[str, object] = {}
        self.temporaries = 0
        self.functions = 0
        self.lines: list[str] = []
        self.indent = 1

    def line(self, text: str) -> None:
        """A line of the source."""
        self.lines.append("    " * self.indent + text)

    def new_name(self, kind: str) -> str:
        """The name of a function in the source."""
        self.functions += 1
        return f"{kind}{self.functions}"

    def constant(self, value: object) -> str:
        """The name of a value in the source."""
        name = f"k{len(self.constants)}"
        self.constants[name] = value
        return name

    def temporary(self) -> str:
        """A new variable of the source."""
        self.temporaries += 1
        return f"t{self.temporaries}"

    def value(self, node: Node) -> str:
        """The source of an expression whose value is plain."""
        match node:
            case p.Constant(value=found):
                return self.literal(found)
            case p.Name():
                return self.without_origin(self.name(node))
            case p.Attribute():
                return self.attribute(node)
            case p.BinaryOperation():
                return self.binary(node)
            case p.UnaryOperation(operator="not", operand=inner) if self.is_truth_value(inner):
                return f"(not {self.value(inner)})"
            case p.UnaryOperation(operand=inner):
                return f"q.unary(S, {self.constant(node)}, {self.value(inner)})"
            case p.BooleanOperation():
                return self.boolean(node)
            case p.Comparison():
                return self.comparison(node)
            case p.Conditional(test=test, then=then, otherwise=otherwise):
                return f"({self.value(then)} if {self.truth(test)} else {self.value(otherwise)})"
            case p.Call():
                return self.without_origin(self.call(node)) if self.is_translated_call(node) else self.reduced(node)
            case p.TupleDisplay(items=items) | p.ListDisplay(items=items) if not any(isinstance(item, p.Starred) for item in items):
                shown = "".join(f"{self.value(item)}, " for item in items)
                return f"({shown})" if isinstance(node, p.TupleDisplay) else f"[{shown}]"
            case p.Subscript():
                return self.without_origin(self.subscript(node))
            case p.Comprehension(kind="list" | "set" | "dict"):
                return self.comprehension(node)
            case e.ObjectOrValue():
                return self.without_origin(self.object_or_value(node))
            case p.Lambda(parameters=parameters) if not any(q.default is not None for q in parameters):
                return f"q.function(S, {self.constant(node)})"
            case _ if (rewriting := REWRITINGS.get(type(node))) is not None and rewriting.applies(node):
                return self.value(rewriting.rewrite(node))
            case e.SideOf(object=subject):
                return f"q.side(S, {self.constant(node)}, {self.value(subject)})"
            case _ if type(node) in EQUATIONS:
                operands = [getattr(node, name) for name in EQUATIONS[type(node)][0]]
                if all(operand is not None for operand in operands):
                    return f"q.operator(S, {self.constant(node)}, {', '.join(map(self.value, operands))})"
                return self.reduced(node)
            case _:
                return self.reduced(node)

    def carried(self, node: Node) -> str:
        """The source of an expression whose value keeps what it was drawn from."""
        match node:
            case p.Name():
                return self.name(node)
            case p.Constant():
                return self.value(node)
            case p.Call() if self.is_translated_call(node):
                return self.call(node)
            case e.ObjectOrValue():
                return self.object_or_value(node)
            case p.Subscript():
                return self.subscript(node)
            case p.Conditional(test=test, then=then, otherwise=otherwise):
                return f"({self.carried(then)} if {self.truth(test)} else {self.carried(otherwise)})"
            case _ if type(node) in TRANSLATED or type(node) in EQUATIONS:
                return self.value(node)
            case _:
                return f"q.reduced(S, {self.constant(node)})"

    def comprehension(self, node: p.Comprehension, *, lazily: bool = False) -> str:
        """`[E for x in I if B]`: a function of its scope and its first iterable; one that yields the elements, if it is asked for them `lazily`."""
        first = self.iterable(node.clauses[0].iterable)
        name, variables, source, found = self.new_name("g"), f"B{len(self.scopes)}", self.temporary(), self.temporary()
        names = NO_NAMES._replace(local=frozenset(n for clause in node.clauses for n in target_names(clause.target)))
        self.line(f"def {name}(S, {source}):")
        self.scopes.append((variables, names))
        outer, self.indent = self.indent, self.indent + 1
        self.line(f"S = q.inner_scope({self.constant(node)}, S)")
        self.line(f"{variables}, {found} = S.bindings, []")
        size = syntax_size(node)
        for clause in node.clauses:
            items = source if clause is node.clauses[0] else self.iterable(clause.iterable)
            element = self.temporary()
            self.line(f"for {element} in q.elements(S, {self.constant(clause.iterable)}, {items}):")
            self.indent += 1
            self.line(f"q.turn({size})")
            self.bound(clause.target, variables, names, element)
            for condition in clause.conditions:
                self.line(f"if not {self.truth(condition)}: continue")
        shown = self.value(node.element) if node.key is None else f"({self.value(node.key)}, {self.value(node.element)})"
        self.line(f"yield {shown}" if lazily else f"{found}.append({shown})")
        self.indent = outer + 1
        if not lazily:
            self.line(f"return {found}" if node.kind == "list" else f"return q.container(S, {node.kind!r}, {found})")
        self.indent = outer
        self.scopes.pop()
        return f"{name}(S, {first})"

    def reduced(self, node: Node) -> str:
        """Return the code for the value to which the machine reduces a node."""
        return self.without_origin(f"q.reduced(S, {self.constant(node)})")

    def without_origin(self, source: str) -> str:
        """A value without what it was drawn from."""
        t = self.temporary()
        return f"({t} if type({t} := {source}) is not Random else {t}.value)"

    def object_or_value(self, node: e.ObjectOrValue) -> str:
        """`E` where an object may stand: an object definition if it is a Scenic class, else its value."""
        t = self.temporary()
        return f"({t} if type({t} := {self.carried(node.value)}) not in CLASSES else q.object_or_value(S, {self.constant(node)}, {t}))"

    def subscript(self, node: p.Subscript) -> str:
        """⟨E[I]⟩, whose value keeps what it was drawn from."""
        container, index = self.value(node.value), node.index
        if isinstance(index, p.Slice):
            parts = ", ".join("None" if part is None else self.value(part) for part in (index.lower, index.upper, index.step))
            return f"q.part(S, {self.constant(node)}, {container}, {parts})"
        return f"q.item(S, {self.constant(node)}, {container}, {self.value(index)})"

    def iterable(self, node: Node) -> str:
        """Return the code for the elements of a loop: the machine need not make the rows of `zip` and
        `enumerate`, since nobody else asks for them.
        """
        match node:
            case p.Call(function=p.Name() as function, keywords=()) if self.is_translated_call(node) and node.arguments:
                f, arguments = self.temporary(), "".join(f"{self.carried(a)}, " for a in node.arguments)
                return self.without_origin(f"q.rows(S, {self.constant(node)}, ({f} := {self.carried(function)}), ({arguments}))")
            case _:
                return self.value(node)

    def literal(self, found: object) -> str:
        """A constant: the very value of the syntax tree, which `is` tells from equal ones."""
        return repr(found) if found is None or found is True or found is False else self.constant(found)

    def name(self, node: p.Name) -> str:
        """⟨x⟩ → σ(x), with what it was drawn from."""
        name = node.name
        if name in SHARED:
            return f"q.variable(S, {self.constant(node)})"
        for variables, names in reversed(self.scopes):
            if name in names.local:
                return f"{variables}[{name!r}]"
        if name == "self" and self.has_agent:
            return "B['self']"
        t = self.temporary()
        places = [f"S.lookup({name!r})"]
        if self.plain_scope:
            places = [f"{scope}.get({name!r}, MISSING)" for scope in ("MU" if name in BUILT_IN else "M")]
        found = " or ".join(f"({t} := {place}) is not MISSING" for place in places)
        return f"({t} if {found} else q.variable(S, {self.constant(node)}))"

    def attribute(self, node: p.Attribute) -> str:
        """⟨E.name⟩: a property, a coordinate, or what a lane or another thing of a map holds, in the source itself."""
        o, v, name = self.temporary(), self.temporary(), canonical(node.name, self.readings)
        there = f"({v} := q.state.objects[{o}.number].get({name!r}, MISSING)) is not MISSING and type({v}) not in WRAPPED"
        first = f"type({o} := {self.value(node.value)})"
        otherwise = f"q.attribute(S, {o}, {self.constant(node)}, {name!r})"
        if name == "currentTime":
            return f"(q.now if {first} is Clock else {otherwise})"
        if name in ("x", "y"):
            return f"({o}.{name} if {first} is Vector else {otherwise})"
        return f"({v} if {first} is Instance and {there} else {o}.{name} if (type({o}), {name!r}) in OPEN else {otherwise})"

    def binary(self, node: p.BinaryOperation) -> str:
        """Arithmetic: of floats in the source itself."""
        left, right = self.value(node.left), self.value(node.right)
        if node.operator not in SPELLED:
            return f"q.binary(S, {self.constant(node)}, {left}, {right})"
        a, b = self.temporary(), self.temporary()
        floats = f"(type({a} := {left}) is float) & (type({b} := {right}) is float)"
        return f"({a} {node.operator} {b} if {floats} else q.binary(S, {self.constant(node)}, {a}, {b}))"

    def comparison(self, node: p.Comparison) -> str:
        """`E1 < E2 <= E3`: each link as long as the ones before it hold; what stands between two links is evaluated once."""
        *before, last = zip(node.operators, node.operands, strict=True)
        left = self.value(node.left)
        source, closing = "", ""
        for operator, operand in before:
            right, held = self.temporary(), self.temporary()
            single = replace(node, operators=(operator,), operands=(operand,))
            link = self.link(single, left, f"({right} := {self.value(operand)})")
            whether = f"({held} if ({held} := {link}) is True or {held} is False else q.is_true(S, {held}, {self.constant(single)}))"
            source, closing, left = f"{source}(", f" if {whether} else {held}){closing}", right
        operator, operand = last
        single = node if not before else replace(node, operators=(operator,), operands=(operand,))
        return f"{source}{self.link(single, left, self.value(operand))}{closing}"

    def link(self, node: p.Comparison, left: str, right: str) -> str:
        """One link, of the sources of its operands: numbers are compared in the source itself."""
        (operator,) = node.operators
        a, b = self.temporary(), self.temporary()
        one, other = f"({a} := {left})", f"({b} := {right})"
        otherwise = f"q.comparison(S, {self.constant(node)}, {a}, {b})"
        if operator in ("is", "is not"):
            return f"({one} {operator} {other})"
        if operator in ORDER:
            return f"({a} {operator} {b} if (type{one} in NUMBERS) & (type{other} in NUMBERS) else {otherwise})"
        if operator in ("==", "!="):
            return f"({a} {operator} {b} if (type{one} in PLAIN) & (type{other} in PLAIN) else {otherwise})"
        return f"q.comparison(S, {self.constant(node)}, {left}, {right})"

    def is_truth_value(self, node: Node) -> bool:
        """Whether the value of a translation is True or False."""
        match node:
            case p.Constant(value=bool()):
                return True
            case p.UnaryOperation(operator="not", operand=inner):
                return self.is_truth_value(inner)
            case p.BooleanOperation(operands=operands):
                return all(map(self.is_truth_value, operands))
            case _:
                return False

    def truth(self, node: Node) -> str:
        """The truth of what decides control flow."""
        if self.is_truth_value(node):
            return self.value(node)
        t = self.temporary()
        return f"({t} if ({t} := {self.value(node)}) is True or {t} is False else q.is_true(S, {t}, {self.constant(node)}))"

    def holds(self, node: Node) -> str:
        """Whether the condition of a requirement, guard, interrupt or end holds."""
        t = self.temporary()
        return f"({t} if ({t} := {self.value(node)}) is True or {t} is False else q.holds(S, {t}, {self.constant(node)}))"

    def boolean(self, node: p.BooleanOperation) -> str:
        """`and`, `or`: the last operand that is looked at."""
        *before, last = node.operands
        source = self.value(last)
        for operand in reversed(before):
            t, u = self.temporary(), self.temporary()
            decides = f"({u} if ({u} := {self.value(operand)}) is True or {u} is False else q.is_true(S, {u}, {self.constant(operand)}))"
            source = f"({source} if ({t} := {decides}) else {u})" if node.operator == "and" else f"({u} if ({t} := {decides}) else {source})"
        return source

    def method_call(self, node: p.Call, function: p.Attribute, arguments: str) -> str:
        """`E.name(E_1, ..., E_n)`: a method of a lane or another thing of a map is known by the class of the subject."""
        o, name = self.temporary(), canonical(function.name, self.readings)
        method = f"(METHODS.get((type({o} := {self.value(function.value)}), {name!r})) or q.method(S, {o}, {self.constant(function)}, {name!r}))"
        return f"q.called(S, {self.constant(node)}, {method}, {o}, ({arguments}))"

    def is_translated_call(self, node: p.Call) -> bool:
        """Whether all arguments are given one by one."""
        return not any(isinstance(a, p.Starred) for a in node.arguments) and all(k.name is not None for k in node.keywords)

    def bound(self, target: Node, variables: str, names: Names, element: str) -> None:
        """σ[x / v] for the variables of a loop, which are those of a scope with these `names`, or belong to others."""
        items = (target,) if isinstance(target, p.Name) else target.items if isinstance(target, (p.TupleDisplay, p.ListDisplay)) else ()
        own = [item.name for item in items if isinstance(item, p.Name) and item.name in names.local and item.name not in SHARED]
        if not items or len(own) < len(items):
            self.line(f"q.bind(S, {self.constant(target)}, {element})")
        elif isinstance(target, p.Name):
            self.line(f"{variables}[{target.name!r}] = {element}")
        else:
            self.line(f"if type({element}) in SEQUENCES and len({element}) == {len(own)}:")
            self.line(f"    {''.join(f'{variables}[{name!r}], ' for name in own)}= {element}")
            self.line(f"else: q.bind(S, {self.constant(target)}, {element})")

    def call(self, node: p.Call, *, once: bool = False) -> str:
        """A call, whose value keeps what it was drawn from; that of an action's class with plain arguments stands in the source itself.

        `once`: an action of constants is made once, since nobody can tell it from another.
        """
        match node:
            case p.Call(function=p.Name() as function, arguments=(p.Comprehension(kind="generator") as given,), keywords=()):
                f, k = self.temporary(), self.constant(node)
                return (
                    f"(q.quantified(S, {k}, {f}, {self.comprehension(given, lazily=True)}) if ({f} := {self.carried(function)}) is ANY or {f} is ALL"
                    f" else q.call(S, {k}, {f}, (q.reduced(S, {self.constant(given)}), )))"
                )
            case _:
                pass
        names = [self.temporary() for _ in node.arguments]
        arguments = "".join(f"{self.carried(a)}, " for a in node.arguments)
        if isinstance(node.function, p.Attribute) and not node.keywords:
            return self.method_call(node, node.function, arguments)
        if node.keywords or not isinstance(node.function, p.Name) or not (node.arguments or once):
            named = f", ({''.join(f'{self.carried(k.value)}, ' for k in node.keywords)})" if node.keywords else ""
            return f"q.call(S, {self.constant(node)}, {self.carried(node.function)}, ({arguments}){named})"
        f, k = self.temporary(), self.constant(node)
        function = f"type({f} := {self.carried(node.function)}) is type and {f} in ACTIONS"
        if once and all(isinstance(a, p.Constant) and type(a.value) in PLAIN for a in node.arguments):
            known = self.constant({})
            return f"(({known}.get({f}) or q.action({known}, {f}, ({arguments}))) if {function} else q.call(S, {k}, {f}, ({arguments})))"
        given = "".join(f"({t} := {self.carried(a)}), " for t, a in zip(names, node.arguments))
        several, plain = self.temporary(), " and ".join(f"type({t}) in PLAIN" for t in names)
        return f"({f}({', '.join(names)}) if ({function}) & bool({several} := ({given})) and {plain} else q.call(S, {k}, {f}, {several}))"


BUILT_IN = frozenset({"simulation", "abs", "min", "max", "round", "len", "range", "int", "float", "str", "Range", "Uniform", "Discrete", "Normal"})
"""Names of the outermost scope that behaviors use most."""
TRANSLATED = frozenset({
    p.Attribute, p.BinaryOperation, p.UnaryOperation, p.BooleanOperation, p.Comparison, p.TupleDisplay, p.ListDisplay, p.Comprehension, p.Lambda,
})  # fmt: skip


def syntax_size(*nodes: Node) -> int:
    """How many nodes of the syntax tree stand in these."""
    return sum(1 for node in nodes for _ in descendants(node))
