"""Calls in compiled code: functions of the program as Python functions, host code that is known without the machine, all else by the rule of calls.

A function draws with the addresses of the coroutine that calls it, as in the machine. One that host code would call, such as that of a property, may
not draw, nor change the scene.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from enum import Enum
from types import NoneType
from typing import TYPE_CHECKING, Any, NoReturn

from ...semantics.kernel.allowed import is_hidden, is_user_made
from ...semantics.kernel.config import Abrupt, Config, Value
from ...semantics.kernel.driving import taken_over
from ...semantics.kernel.generators import EXHAUSTED, Generator
from ...semantics.kernel.host import DEEPEST_CALLS, HostException
from ...semantics.kernel.queries import CLOCK, Clock, attribute_of_clock
from ...semantics.kernel.scenic_classes import ScenicClass
from ...semantics.kernel.scopes import MISSING, Scope
from ...semantics.kernel.sets import Set
from ...semantics.kernel.values import Dynamic, Function, Instance, Method, Module, Random, plain, unwrap
from ...semantics.python.assignment import bind_target, conclude_assignment, conclude_augmented
from ...semantics.python.calls import conclude_call, invocation
from ...semantics.python.comprehensions import inner_scope
from ...semantics.python.elementwise import LISTING
from ...semantics.python.expression_statements import Discard, resume_discard
from ...semantics.python.expressions import conclude_attribute, conclude_subscript, container
from ...semantics.python.functions import make_function
from ...semantics.python.generators import Walk, pull, taken, walk
from ...semantics.scenes.object_definitions import ClassOf
from ...semantics.step import step
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax import statements as s
from ...semantics.syntax.expressions import ObjectOrValue
from ...semantics.syntax.nodes import Node
from . import natives
from .code import name_of
from .equations import ACTION_TYPES, PLAIN, STEPS, Equations, Raised
from .leaving import LeftToMachine
from .natives import KNOWN, SHORT, SLOWLY, NativeMethod, attempted, is_known

if TYPE_CHECKING:
    from .code import Library

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
                self.library.nanoseconds[name_of(function)] += time.thread_time_ns() - begun
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
        self.choose, self.price = refused, max(OF_HOST, self.fuel // (STEPS * MOST_OF_HOST))
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
            found = natives.attribute(subject, node.name)
        return plain(self.concluded(scope, conclude_attribute, node, [subject]) if found is SLOWLY else found)

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
                own[name] = plain(result)
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
            given: list[Any] = [plain(a) for a in arguments]
            more: dict[str, Any] = {name: plain(v) for name, v in zip(names, named)}
            if all(type(a) in PLAIN for a in (*given, *more.values())):
                return function(*given, **more)
        else:
            found = natives.call(function, arguments, dict(zip(names, named)) if named else NOTHING, self.state.objects)
            if found is not SLOWLY:
                return found
        return self.concluded(scope, conclude_call, node, [function, *arguments, *named])

    def called(self, scope: Scope, node: p.Call, function: Any, subject: Any, arguments: tuple[Any, ...]) -> Any:
        """⟨E.name(E_1, ..., E_n)⟩, where ⟨E⟩ → `subject`."""
        if type(function) is NativeMethod:
            if KNOWN.issuperset(map(type, arguments)):
                found = attempted(function.function, (subject, *arguments), NOTHING)
                if found is not SLOWLY:
                    return found
            function = getattr(subject, function.name)
        return self.call(scope, node, function, arguments)

    def method(self, scope: Scope, subject: Any, node: p.Attribute, name: str) -> Any:
        """What `E.name(...)` calls."""
        if type(subject) is Instance and name not in self.state.objects[subject.number]:
            found = subject.class_.method(node.name)
            if type(found) is Function:
                return Method(found, subject, found.door)
        return self.attribute(scope, subject, node, name)

    def object_or_value(self, scope: Scope, node: ObjectOrValue, head: Any) -> Any:
        """The object of a Scenic class, made by the machine; any other value as it is."""
        if type(plain(head)) is not ScenicClass:
            return head
        base = self.base(scope)
        return self.settled(step, taken_over(Config(Value(plain(head)), (ClassOf(node), base), self.here(scope))), base)

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
        """What a loop goes through: a list or tuple, which may grow, a range, or the elements of anything else, one by one."""
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
                    item, source = taken(source, self.here(scope))
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
            return plain(container(Set if kind == "set" else dict, found, self.here(scope)))
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
        """⟨E[I:J:K]⟩ → c[i:j:k]."""
        if type(subject) in (list, tuple) and all(type(place) in (int, NoneType) for place in places) and places[2] != 0:
            return subject[slice(*places)]
        return self.concluded(scope, conclude_subscript, node, [subject, *places])

    def rows(self, scope: Scope, node: p.Call, function: Any, arguments: tuple[Any, ...]) -> Any:
        """⟨f(E_1, ..., E_n)⟩ for a loop, which nobody else can ask for elements."""
        if all(type(a) in (list, tuple, range) and len(a) < SHORT for a in arguments):
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
    """What a class of the program, or one above it, has under a name; None if nothing."""
    return next((vars(one)[name] for one in class_.__mro__ if name in vars(one)), None)


def refused(drawn: object) -> NoReturn:
    """A draw where there may be none, which the machine says."""
    raise LeftToMachine("a draw in a property")
