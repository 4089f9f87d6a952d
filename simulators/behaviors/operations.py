"""Calls in compiled code: functions of the program as Python functions, host code that is known without the machine, all else by the rule of calls.

A function draws with the addresses of the coroutine that calls it, as in the machine. One that host code would call, such as that of a property, may
not draw, nor change the scene.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from types import NoneType
from typing import TYPE_CHECKING, Any, NoReturn

from ...semantics.dynamics.coroutines import Coroutine
from ...semantics.machine.conditions import condition_truth, truth
from ...semantics.machine.config import Abrupt, Config, Stack, State, Value
from ...semantics.machine.host_calls import DEEPEST_CALLS, HostException
from ...semantics.machine.operand_kinds import Reader, is_object
from ...semantics.machine.outcome import Draw, Fault, Next, Outcome, Requirement, Stuck
from ...semantics.machine.premises import SHARED, Conclusion, Premises, variable
from ...semantics.machine.run_loop import (
    Arrived,
    Chooser,
    Machine,
    Unfinished,
    Witness,
    drive_machine,
    taken_over,
)
from ...semantics.machine.sandbox_table import is_hidden, is_user_made
from ...semantics.machine.simulation_state import Who
from ...semantics.machine.values import Dynamic, Function, Instance, Method, Module, Random, unwrap, value_in_run
from ...semantics.machine.world_queries import CLOCK, Clock, attribute_of_clock
from ...semantics.python.assignment import bind_target, conclude_assignment, conclude_augmented
from ...semantics.python.calls import conclude_call, invocation
from ...semantics.python.comprehensions import inner_scope
from ...semantics.python.elementwise_builtins import LISTING
from ...semantics.python.expression_statements import Discard, resume_discard
from ...semantics.python.expressions import conclude_attribute, conclude_binary, conclude_subscript, conclude_unary, container
from ...semantics.python.functions import InScope, make_function
from ...semantics.python.generators import Walk, pull, take_element, walk
from ...semantics.scenes.comparisons import conclude_comparison
from ...semantics.scenes.object_definitions import ClassOf
from ...semantics.scenes.operator_application import apply_operator, apply_side, compute, new_oriented_point
from ...semantics.scenes.operators import IN_EQUATIONS, SIDES, Equation, OrientedPointAt, distance
from ...semantics.scenes.released_forms import equations_of
from ...semantics.space.regions import EmptyRegion, Region, UnboundedRegion
from ...semantics.space.vectors import Vector
from ...semantics.step import apply_given_draws, outcome_of_problem, step
from ...semantics.store.errors import NeedsElements, OutOfTime
from ...semantics.store.generators import EXHAUSTED, Generator
from ...semantics.store.scenic_classes import ScenicClass
from ...semantics.store.scopes import MISSING, Scope
from ...semantics.store.sets import Set
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import Distance, ObjectOrValue, SideOf
from ...semantics.syntax.nodes import Expression, Node
from ..actions import ACTIONS
from . import host_calls
from .fallback import LeftToMachine
from .host_calls import KNOWN, NUMBERS, SHORT_LIST, SLOWLY, SMALL, NativeMethod, attempt_host_call, equation, is_known

if TYPE_CHECKING:
    from .compiled_library import Library


PLAIN = frozenset({float, int, bool, type(None)})
"""Types of values that actions are given and that are compared as they are: the machine takes nothing off the run's budget for them."""
ACTION_TYPES = frozenset(ACTIONS.values())
MOST_DEPTH = 50
"""So many behaviors may be inside each other here; each costs some of Python's stack."""
STEPS = 20
"""A node of the syntax tree that is evaluated here, in turns of loops, functions, behaviors and handlers, counts for so many steps of the fuel.

Whether a time step has an end is for the machine to say: all this takes less than half of its fuel.
"""
OF_BEHAVIOR = 50
"""As many nodes does the beginning of a behavior or handler count for."""
VERY_LONG = "a time step of very many turns"


class RunRejected(Exception):
    """A requirement of the run does not hold."""

    def __init__(self, rule: str, requirement: Requirement) -> None:
        super().__init__(requirement.text)
        self.stuck = Stuck(rule, requirement)


class Raised(Exception):
    """An exception of the program, which it may catch."""

    def __init__(self, abrupt: Abrupt) -> None:
        super().__init__(str(abrupt.value))
        self.abrupt = abrupt


class Equations:
    """The state of a simulation while compiled code runs, and the values of expressions in it.

    `state` has the scope, the numbering of draws and the handled exceptions of whichever coroutine ran last: each that goes on has its own (`here`).

    Compiled code changes variables without a note (`versions`), since no run goes back behind it; whatever the machine changes is noted in `state`.

    `prefix` and `draws` are the address of the next draw of the coroutine that runs, whose `who` it is; `handling` are the exceptions that it
    handles. `now` is the time, as `simulation.currentTime` says it. `spent` are the steps of the machine in this time step: half of its fuel is for
    what compiled code does without it: it has evaluated `nodes`, each of which counts for `price`.
    `calls` of compiled functions are open.
    """

    def __init__(self, state: State, choose: Chooser, fuel: int, witness: Witness) -> None:
        self.state = state
        self.choose = choose
        self.fuel = fuel
        self.witness = witness
        self.who = Who("condition", 0)
        self.prefix: tuple[int, ...] = ()
        self.draws = 0
        self.handling: tuple[BaseException, ...] = ()
        self.nodes, self.price = 0, 1
        self.calls = 0
        self.spent = 0
        self.now: float = 0

    # The machine

    def here(self, scope: Scope) -> State:
        """The state in which the coroutine that runs goes on; as many behaviors are inside each other there as may be here at most."""
        version = self.state.version.versions.settled()
        depth = MOST_DEPTH + self.calls
        return self.state._replace(sigma=scope, prefix=self.prefix, draws=self.draws, handling=self.handling, depth=depth, version=version)

    def driven(self, control: Node | Value, scope: Scope) -> Any:
        """Return the value to which the machine reduces a node. Raises `LeftToMachine`, `RunRejected`."""
        base = self.base(scope)
        return self.settled(step, taken_over(Config(control, base, self.here(scope))), base)

    def base(self, scope: Scope) -> Stack:
        """The context of what the coroutine that runs reduces; an exception stops above the frame of the coroutine, which numbers draws as before."""
        return (InScope(scope), (Coroutine(self.who, scope, self.handling, 0, self.prefix, self.draws), ()))

    def settled(self, machine: Machine, config: Config, base: Stack) -> Any:
        """The value with which the machine comes back to the context `base`. Raises `Raised`, `RunRejected`, and `LeftToMachine` for an error."""

        def is_back(config: Config) -> bool:
            kind = type(config.control)
            return (kind is Value and config.stack is base) or (kind is Abrupt and (config.stack is base or config.stack is base[1]))

        end, steps = drive_machine(machine, config, self.choose, self.fuel // 2 - self.spent, witness=self.witness, until=is_back)
        self.spent += steps
        if isinstance(end, Stuck):
            raise RunRejected(end.rule, end.requirement)
        if isinstance(end, Fault) and isinstance(end.error, OutOfTime):
            raise end.error  # the machine would take as long again
        if not isinstance(end, Arrived):
            raise LeftToMachine(VERY_LONG if isinstance(end, Unfinished) else "an error of the program")
        self.state, self.draws = end.config.state, end.config.state.draws
        control = end.config.control
        if isinstance(control, Abrupt):
            if control.kind != "raise":
                raise LeftToMachine("a statement that leaves its block")
            raise Raised(control)
        assert isinstance(control, Value)
        return control.value

    def reduced(self, scope: Scope, node: Node) -> Any:
        """⟨E, σ⟩ → v, by the machine, or a statement that takes no time; a value that was drawn keeps what it was drawn from."""
        return self.driven(node, scope)

    def concluded(self, scope: Scope, conclude: Conclusion, node: Node, values: list[object]) -> Any:
        """The conclusion of a rule from the values of its premises; where it is no value yet, what the machine makes of it."""
        base, state = self.base(scope), self.here(scope)
        *before, last = values
        frame = Premises(node, [None] * len(values), len(before), tuple(before), conclude)
        try:
            outcome = apply_given_draws(conclude(node, values, base, state), state)
        except NeedsElements:  # those of a generator, which the machine computes
            return self.settled(step, taken_over(Config(Value(last), (frame, base), state)), base)
        except Exception as problem:
            outcome = apply_given_draws(outcome_of_problem(problem, Config(Value(last), (frame, base), state)), state)
        if type(outcome) is Draw:
            outcome = self.answered(outcome)
        if type(outcome) is Next and outcome.config.stack is base and type(outcome.config.control) is Value:
            self.state, self.draws = outcome.config.state, outcome.config.state.draws
            return outcome.config.control.value
        first: list[Outcome] = [outcome]
        return self.settled(lambda config: first.pop() if first else step(config), Config(Value(None), (), state), base)

    def answered(self, draw: Draw) -> Outcome:
        """Return the outcome after a draw; a draw that only the machine's loop can answer, or refuse, stays
        as it is.
        """
        try:
            drawn = self.choose(draw)
        except (EmptyRegion, UnboundedRegion):
            return draw
        return Next(draw.rule, draw.resume(drawn), draw.node)

    # Expressions

    def variable(self, scope: Scope, node: p.Name) -> Any:
        """⟨x⟩ → σ(x), with what it was drawn from."""
        if node.name not in SHARED and (found := scope.lookup(node.name)) is not MISSING:
            return found
        return variable(node, self.here(scope))

    def binary(self, scope: Scope, node: p.BinaryOperation, left: Any, right: Any) -> Any:
        """⟨E1 ⊕ E2⟩ → v1 ⊕ v2."""
        if type(left) in NUMBERS and type(right) in NUMBERS and -SMALL < left < SMALL and -SMALL < right < SMALL:
            if node.operator == "+":
                return left + right
            if node.operator == "-":
                return left - right
            if node.operator == "*":
                return left * right
            if node.operator == "/" and right:
                return left / right
            if node.operator == "**" and type(left) is float and (left > 0 or type(right) is int) and left:
                return self.power(scope, node, left, right)
        elif type(left) is Vector and type(right) is Vector:
            if node.operator == "+":
                return left + right
            if node.operator == "-":
                return left - right
        elif type(left) is Vector and type(right) is float and node.operator == "*":
            return left * right
        elif type(left) is list and type(right) is list and node.operator == "+" and len(left) + len(right) < SHORT_TEXT:
            return left + right
        return value_in_run(self.concluded(scope, conclude_binary, node, [left, right]))

    def power(self, scope: Scope, node: p.BinaryOperation, base: float, exponent: float) -> Any:
        """x ** y of a float, which is positive or has a whole number above it."""
        try:
            return base**exponent
        except OverflowError:
            return value_in_run(self.concluded(scope, conclude_binary, node, [base, exponent]))

    def unary(self, scope: Scope, node: p.UnaryOperation, operand: Any) -> Any:
        """⟨⊖E⟩ → ⊖v, computed directly for plain numbers and truth values."""
        if node.operator == "-" and type(operand) in NUMBERS:
            return -operand
        if node.operator == "not" and type(operand) is bool:
            return not operand
        return value_in_run(self.concluded(scope, conclude_unary, node, [operand]))

    def comparison(self, scope: Scope, node: p.Comparison, left: Any, right: Any) -> Any:
        """⟨E1 < E2⟩ → v1 < v2."""
        if type(left) is str and type(right) is str and len(left) + len(right) < SHORT_TEXT:
            if node.operators[0] == "==":
                return left == right
            if node.operators[0] == "!=":
                return left != right
        if isinstance(right, Region) and node.operators[0] in ("in", "not in"):
            found = self.lies_in(left, right) if type(left) is Instance else MISSING
            if found is MISSING:
                found = self.equated(node, IN_EQUATIONS, (left, right))
            if found is not MISSING:
                return found if node.operators[0] == "in" else not found
        return value_in_run(self.concluded(scope, conclude_comparison, node, [(), left, right]))

    def lies_in(self, one: Instance, region: Region) -> Any:
        """Whether an object lies in a region, as `operators.object_is_in` says; MISSING where that is for the machine to say."""
        properties = self.state.objects[one.number]
        position = properties.get("position")
        box = properties.get("heading"), properties.get("width"), properties.get("length")
        if type(position) is not Vector or not NUMBERS.issuperset(map(type, box)) or not is_object(one):
            return MISSING
        try:
            return region.contains_box(position, *box)  # type: ignore[arg-type]
        except OutOfTime:
            raise
        except Exception:
            return MISSING

    def operator(self, scope: Scope, node: Node, *operands: Any) -> Any:
        """An operator of the paper, by the equation for the kinds of its operands."""
        if type(node) is Distance:
            one, other = map(self.position, operands)
            if type(one) is Vector and type(other) is Vector:
                return distance(one, other)
        found = self.equated(node, equations_of(node, self.state.reading("oriented-offset"), self.state.reading("angle")), operands)
        return value_in_run(self.concluded(scope, apply_operator, node, list(operands))) if found is MISSING else found

    def side(self, scope: Scope, node: SideOf, subject: Any) -> Any:
        """`front of O` and its seven siblings."""
        found = self.equated(node, (SIDES[node.side],), (subject,))
        return value_in_run(self.concluded(scope, apply_side, node, [subject])) if found is MISSING else found

    def equated(self, node: Node, equations: Sequence[Equation], operands: Sequence[Any]) -> Any:
        """The right-hand side of the equation for operands of these kinds; MISSING where that is for the machine to say."""
        found = equation(node, equations, operands, self.state)
        if found is None:
            return MISSING
        reader = Reader(self.state)
        try:
            result = compute(found.function, [reader.read(operand, kind) for operand, kind in zip(operands, found.kinds)], reader)
        except OutOfTime:
            raise
        except Exception:
            return MISSING
        if isinstance(result, OrientedPointAt):
            result, self.state = new_oriented_point(result, reader, self.state)
        return result

    def position(self, value: Any) -> Any:
        """The position of an instance; other values as they are."""
        return self.state.objects[value.number].get("position") if type(value) is Instance else value

    def action(self, known: dict[type, Any], kind: type, arguments: tuple[Any, ...]) -> Any:
        """An action of constants in a `take` statement, which is made once: it is nobody's but the simulator's."""
        made = known[kind] = kind(*arguments)
        return made

    # What decides

    def is_true(self, scope: Scope, result: Any, node: Expression) -> bool:
        """The truth of a condition that decides control flow."""
        return truth(value_in_run(result), node, self.here(scope), "this condition")

    def holds(self, scope: Scope, result: Any, node: Expression) -> bool:
        """Whether a condition of a requirement, guard, interrupt or end holds."""
        inner = value_in_run(result)
        if inner is True or inner is False:
            return inner
        return bool(condition_truth(inner, node.span, self.here(scope), "a condition", ""))

    def turn(self, nodes: int = OF_BEHAVIOR) -> None:
        """A loop goes back, or a function, behavior or handler begins. Raises `LeftToMachine` where that may be without end."""
        self.nodes += nodes * self.price
        if self.nodes * STEPS > self.fuel:
            raise LeftToMachine(VERY_LONG)


SHORT_TEXT = 200
"""Characters of two texts that are compared, and elements of two lists that are put together, without a word to the run's budget."""


MOST_CALLS = 60
"""So many calls of compiled functions may be inside each other; each costs some of Python's stack."""
OF_HOST = 2
MOST_OF_HOST = 30_000
"""How much more nodes count for where host code would call the function, whose steps the machine pays for besides; and so many are left to the
machine in any case, whose budget for them does not grow with the fuel."""
KEPT = ("scene", "params", "ego", "workspace", "late", "dynamic", "objects")
"""What a function that host code calls may not change."""
NO_NAMES: tuple[str, ...] = ()
NOTHING: Mapping[str, object] = {}
ZIP, ENUMERATE = LISTING["zip"], LISTING["enumerate"]


class Calls(Equations):
    """The functions of a simulation."""

    library: Library

    # Functions of the program

    def applied(
        self, scope: Scope, node: p.Call, function: Function, arguments: tuple[Any, ...], names: tuple[str, ...], named: tuple[Any, ...]
    ) -> Any:
        """⟨f(E_1, ..., E_n), σ⟩ → v by the body of f, in a scope of its own; by the machine where that is not compiled, or calls are deep."""
        code = self.library.function(function)
        if code is None:
            begun = time.thread_time_ns()
            try:
                return self.concluded(scope, conclude_call, node, [function, *arguments, *named])
            finally:
                self.library.nanoseconds[function_report_name(function)] += time.thread_time_ns() - begun
        calls, known = self.calls, code.names
        if calls >= MOST_CALLS:
            return self.concluded(scope, conclude_call, node, [function, *arguments, *named])
        if known is not None and len(arguments) == len(known) and not names:
            bindings = dict(zip(known, arguments))
        elif (bindings := code.bindings(function, arguments, names, named)) is None:
            return self.concluded(scope, conclude_call, node, [function, *arguments, *named])
        self.turn(code.size)
        self.calls = calls + 1
        try:
            return code.run(self, Scope.of_call(function.scope, function.names, bindings))
        finally:
            self.calls = calls

    def function(self, scope: Scope, node: p.Lambda) -> Function:
        """⟨lambda x: E, σ⟩ → the function x ↦ E that closes over σ."""
        return make_function(node, [None] * len(node.parameters), self.here(scope))

    def property(self, subject: Instance, node: p.Attribute, function: Function) -> Any:
        """⟨E.name⟩ where the class of ⟨E⟩ → o has a property of that name: f(o), as host code calls it."""
        code = self.library.function(function)
        bindings = None if code is None or self.calls >= MOST_CALLS else code.bindings(function, (subject,), NO_NAMES, ())
        if code is None or bindings is None:
            return SLOWLY
        door = function.door
        if door.depth >= DEEPEST_CALLS:
            return SLOWLY
        before, choose, price = self.state, self.choose, self.price
        self.choose, self.price = refuse_property_draw, max(OF_HOST, self.fuel // (STEPS * MOST_OF_HOST))
        self.calls += 1
        door.depth += 1
        try:
            self.turn(code.size)
            result = code.run(self, Scope.of_call(function.scope, function.names, bindings))
        except Raised as raised:
            raise Raised(Abrupt("raise", raised.abrupt.value, node.span)) from raised
        finally:
            self.calls -= 1
            door.depth -= 1
            self.choose, self.price = choose, price
        if self.state is not before and any(getattr(self.state, name) is not getattr(before, name) for name in KEPT):
            raise LeftToMachine("a property that changes the scene")
        if not is_known(result) and type(result) is not Instance and unwrap(result)[1] is not None:
            raise LeftToMachine("a property that is random")
        return result

    # Attributes and calls

    def attribute(self, scope: Scope, subject: Any, node: p.Attribute, name: str) -> Any:
        """⟨E.name⟩ of anything but a property that an instance has; `name` is the canonical one."""
        kind = type(subject)
        if kind is Module:
            found = subject.scope.bindings.get(node.name, SLOWLY)
        elif kind is Clock and name in CLOCK:  # that is what it is on roads, too
            return attribute_of_clock(name, node, self.state)
        elif kind is Instance:
            found = SLOWLY
            member = None if name in self.state.objects[subject.number] else subject.class_.method(node.name)
            getter: Any = member.fget if type(member) is property else None
            if type(getter) is Function:
                found = self.property(subject, node, getter)
        elif is_user_made(subject):
            found = self.own_attribute(subject, node)
        else:
            found = host_calls.attribute(subject, node.name)
        return value_in_run(self.concluded(scope, conclude_attribute, node, [subject]) if found is SLOWLY else found)

    def own_attribute(self, subject: Any, node: p.Attribute) -> Any:
        """⟨E.name⟩ of an instance of a Python class of the program; `SLOWLY` where that is for the machine to say."""
        name = node.name
        if isinstance(subject, type) or is_hidden(name) or name.startswith("__"):
            return SLOWLY
        member = class_member(type(subject), name)
        if isinstance(member, property):
            getter: Any = member.fget
            known = type(getter) is Function and class_member(type(subject), "__getattr__") is None
            return self.property(subject, node, getter) if known else SLOWLY
        own = getattr(subject, "__dict__", NOTHING)
        if type(own) is dict and name in own and not hasattr(type(member), "__set__"):
            return own[name]
        return Method(member, subject, member.door) if type(member) is Function else SLOWLY

    def assign_attribute(self, scope: Scope, node: s.Assignment, result: Any, subject: Any) -> None:
        """⟨E.name = v⟩: of an instance of a Python class of the program at once, of anything else by the machine."""
        target: Any = node.targets[0]
        name = target.name
        if is_user_made(subject) and not isinstance(subject, (type, BaseException)) and not is_hidden(name) and not name.startswith("__"):
            own = getattr(subject, "__dict__", None)
            if type(own) is dict and not hasattr(type(class_member(type(subject), name)), "__set__") and not issubclass(type(subject), Enum):
                own[name] = value_in_run(result)
                return
        self.assigned(scope, node, result)

    def assigned(self, scope: Scope, node: s.Assignment, result: Any) -> None:
        """⟨x = E⟩ where ⟨E⟩ → v, for targets of any form."""
        self.concluded(scope, conclude_assignment, node, [result])

    def call(self, scope: Scope, node: p.Call, function: Any, arguments: tuple[Any, ...], named: tuple[Any, ...] = ()) -> Any:
        """⟨f(E_1, ..., E_n)⟩; arguments keep what they were drawn from. `named` are the values of the keywords of the call."""
        kind = type(function)
        if kind is Random:
            function = function.value
            kind = type(function)
        names = tuple([str(k.name) for k in node.keywords]) if named else NO_NAMES
        if kind is Function:
            return self.applied(scope, node, function, arguments, names, named)
        if kind is Method and type(function.function) is Function:
            return self.applied(scope, node, function.function, (function.instance, *arguments), names, named)
        if kind is Dynamic:
            return invocation(function, arguments, dict(zip(names, named)))
        if kind is type and function in ACTION_TYPES:
            given: list[Any] = [value_in_run(a) for a in arguments]
            more: dict[str, Any] = {name: value_in_run(v) for name, v in zip(names, named)}
            if all(type(a) in PLAIN for a in (*given, *more.values())):
                return function(*given, **more)
        else:
            found = host_calls.call(function, arguments, dict(zip(names, named)) if named else NOTHING, self.state.objects)
            if found is not SLOWLY:
                return found
        return self.concluded(scope, conclude_call, node, [function, *arguments, *named])

    def called(self, scope: Scope, node: p.Call, function: Any, subject: Any, arguments: tuple[Any, ...]) -> Any:
        """⟨E.name(E_1, ..., E_n)⟩, where ⟨E⟩ → `subject`."""
        if type(function) is NativeMethod:
            if KNOWN.issuperset(map(type, arguments)):
                found = attempt_host_call(function.function, (subject, *arguments), NOTHING)
                if found is not SLOWLY:
                    return found
            function = getattr(subject, function.name)
        return self.call(scope, node, function, arguments)

    def method(self, scope: Scope, subject: Any, node: p.Attribute, name: str) -> Any:
        """Return the value that `E.name(...)` calls."""
        if type(subject) is Instance and name not in self.state.objects[subject.number]:
            found = subject.class_.method(node.name)
            if type(found) is Function:
                return Method(found, subject, found.door)
        return self.attribute(scope, subject, node, name)

    def object_or_value(self, scope: Scope, node: ObjectOrValue, head: Any) -> Any:
        """The object of a Scenic class, made by the machine; any other value as it is."""
        if type(value_in_run(head)) is not ScenicClass:
            return head
        base = self.base(scope)
        return self.settled(step, taken_over(Config(Value(value_in_run(head)), (ClassOf(node), base), self.here(scope))), base)

    def discarded(self, scope: Scope, node: s.ExpressionStatement, result: Any) -> None:
        """⟨E⟩ for its effect. Raises `LeftToMachine` for what alone does nothing."""
        if type(result) in PLAIN:
            return
        try:
            resume_discard(Discard(node), result, (), self.here(scope))
        except Exception:
            raise LeftToMachine("an error of the program") from None

    # Containers

    def elements(self, scope: Scope, node: Node, iterable: Any) -> Any:
        """Return the elements of a loop: a list or tuple, which may grow, a range, or the elements of
        anything else, one by one.
        """
        if type(iterable) in (list, tuple, range, zip, enumerate):
            return iterable
        return self.elements_one_by_one(scope, node, iterable)

    def elements_one_by_one(self, scope: Scope, node: Node, iterable: Any) -> Iterator[Any]:
        """The elements of what is no list, tuple or range. Raises `LeftToMachine` for what has none."""
        try:
            source = walk(iterable, node, self.here(scope))
            if type(source) is Walk:
                length = len(iterable) if source.whole is not None else 0
                for item in source.items:
                    if source.whole is not None and len(iterable) != length:
                        break
                    yield item
                if source.whole is None or len(iterable) == length:
                    return
                raise LeftToMachine("an error of the program")
            while True:
                if type(source) is Generator:
                    base = self.base(scope)
                    item = self.settled(step, taken_over(pull(source, base, self.here(scope)).config), base)
                else:
                    item, source = take_element(source, self.here(scope))
                if item is EXHAUSTED:
                    return
                yield item
        except HostException:
            raise LeftToMachine("an error of the program") from None

    def inner_scope(self, node: p.Comprehension, scope: Scope) -> Scope:
        """The scope of a comprehension."""
        return inner_scope(node, scope)

    def bind(self, scope: Scope, target: Node, element: Any) -> None:
        """σ[x / v] for the variables of a loop."""
        bind_target(target, element, self.here(scope))

    def container(self, scope: Scope, kind: str, found: list[Any]) -> Any:
        """The set or dictionary of what a comprehension found."""
        try:
            return value_in_run(container(Set if kind == "set" else dict, found, self.here(scope)))
        except HostException:
            raise LeftToMachine("an error of the program") from None

    def item(self, scope: Scope, node: p.Subscript, subject: Any, index: Any) -> Any:
        """⟨E[I]⟩ → c[i]: an element keeps what it was drawn from."""
        kind = type(subject)
        if type(index) is int and kind in (list, tuple) and -len(subject) <= index < len(subject):
            return subject[index]
        if type(index) is str and kind is dict and (found := subject.get(index, MISSING)) is not MISSING:
            return found
        return self.concluded(scope, conclude_subscript, node, [subject, index])

    def part(self, scope: Scope, node: p.Subscript, subject: Any, *places: Any) -> Any:
        """⟨E[I:J:K]⟩ → c[i:j:k], computed directly for lists and tuples with whole numbers."""
        if type(subject) in (list, tuple) and all(type(place) in (int, NoneType) for place in places) and places[2] != 0:
            return subject[slice(*places)]
        return self.concluded(scope, conclude_subscript, node, [subject, *places])

    def rows(self, scope: Scope, node: p.Call, function: Any, arguments: tuple[Any, ...]) -> Any:
        """⟨f(E_1, ..., E_n)⟩ for a loop, which nobody else can ask for elements."""
        if all(type(a) in (list, tuple, range) and len(a) < SHORT_LIST for a in arguments):
            if function is ZIP:
                return zip(*arguments)
            if function is ENUMERATE and len(arguments) == 1:
                return enumerate(arguments[0])
        return self.call(scope, node, function, arguments)

    def augmented(self, scope: Scope, node: s.AugmentedAssignment, current: Any, operand: Any) -> None:
        """⟨x += E⟩, of what is no number."""
        self.concluded(scope, conclude_augmented, node, [current, operand])

    def quantified(self, scope: Scope, node: p.Call, function: Any, found: Iterator[Any]) -> bool:
        """`any(E for x in I)`, `all(E for x in I)`: no further than needed."""
        wanted = function is any
        try:
            for value in found:
                if type(value) not in PLAIN:
                    raise LeftToMachine("the truth of what is no number")
                if bool(value) is wanted:
                    return wanted
        except Raised as raised:
            if isinstance(raised.abrupt.value, StopIteration):
                raise LeftToMachine("a generator that raises StopIteration") from raised
            raise
        return not wanted


def class_member(class_: type, name: str) -> Any:
    """Return the member that a class of the program, or one above it, has under a name; None if there is
    none.
    """
    return next((vars(one)[name] for one in class_.__mro__ if name in vars(one)), None)


def function_report_name(function: Function) -> str:
    """A function in a report."""
    return f"{function.name} (line {function.span.line})"


def refuse_property_draw(drawn: object) -> NoReturn:
    """A draw where there may be none, which the machine says."""
    raise LeftToMachine("a draw in a property")

