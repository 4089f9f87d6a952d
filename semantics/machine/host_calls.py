"""The border between the machine and Python code that it did not interpret: operations, builtins, library methods.

Out: `host` runs a Python operation and tells the program's exceptions from our own mistakes. In: host code that was
given a function of the program (a key for `sorted`, the value of a vector field) calls it through the `Door`, where a
draw is refused, never lost.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from collections.abc import Generator as Yielding
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..space.absence import Absent
from ..store.budget import PLAIN, STEP, Budget, items_of, values_of
from ..store.errors import FuelExhausted, NeedsElements, RunError, ScenicError
from ..store.generators import Generator
from ..store.memory_errors import short_of_memory
from ..store.undo_log import Slot, Version
from ..syntax.nodes import Span
from .config import PASS, Abrupt, Config, State, Value
from .outcome import Draw, Fault, Next, Outcome, Stuck
from .reachable_changes import changed_since, is_reached, lost_change
from .run_loop import Arrived, Machine, Unfinished, drive_machine
from .sandbox_table import is_value, own_word
from .value_nesting import too_deep
from .values import CONTAINERS, Function, Instance, Origin, unwrap, value_in_run, wrap

DOOR_FUEL = 1_000_000
DEEPEST_CALLS = 40
"""So many calls by host code may be inside each other; each takes some of Python's stack."""
Lift = Callable[[Callable[..., object], list[object], dict[str, object]], object]
"""Applies an operation of Python to arguments with symbols in them, when the machine runs on symbols (DESIGN, section 1)."""
NUMBERS_PER_CALL = 1_000_000
"""Instances made behind the door have numbers of their own, so that none is ever taken for another."""


class HostException(Exception):
    """An exception that belongs to the program: host code raised it on the program's behalf; whether it did may be random.

    `span` is where the mistake stands, if that is known more narrowly than by what is being reduced.
    """

    def __init__(self, exception: Exception, origin: Origin | None = None, span: Span | None = None) -> None:
        super().__init__(exception)
        self.exception = exception
        self.origin = origin
        self.span = span


class Misapplied(HostException):
    """The arguments of a call do not fit the parameters, whatever their values are.

    `argument` is the one that does not: the name of a keyword, or the number of a positional argument; None where one is
    missing.
    """

    def __init__(self, exception: Exception, argument: str | int | None = None) -> None:
        super().__init__(exception)
        self.argument = argument


class DoorStuck(Exception):
    """A requirement failed inside a function that host code called."""

    def __init__(self, outcome: Stuck) -> None:
        super().__init__(outcome.requirement.text)
        self.outcome = outcome


class Door:
    """The one way in: `call` runs a function of the program to its value in the state of the surrounding host call."""

    __slots__ = ("budget", "called", "calls", "depth", "enter", "expand", "in_turn", "lift", "operands", "origin", "reached", "state", "through")

    def __init__(
        self, enter: Callable[[Function, tuple[object, ...], Mapping[str, object], State], Config], expand: Callable[[NeedsElements, Config], Next]
    ) -> None:
        self.enter = enter
        self.expand = expand
        self.budget = Budget()
        self.state: State | None = None
        self.origin: Origin | None = None
        self.called = False
        self.calls = 0
        self.depth = 0
        """How many calls are inside each other."""
        self.in_turn = False
        """Whether the surrounding host call calls the function once for each element, whatever it gives: as a key."""
        self.lift: Lift | None = None
        self.operands: tuple[object, ...] = ()
        """What the surrounding host call may be looking through, and the numbers of the containers in it, once they were asked for (`through`)."""
        self.through: tuple[object, frozenset[int]] = ((), frozenset())
        self.reached: tuple[object, dict[int, object]] = ((), {})
        """The same for what functions of the program reach that are called with drawn values, which stays so while they change none of it."""

    def call(self, function: Function, arguments: tuple[object, ...], keywords: Mapping[str, object]) -> object:
        """The value of `function(*arguments, **keywords)`, with nothing random left in it (its origin is kept)."""
        if self.state is None:
            raise RunError(f"{function.name} is called outside any run", function.span)
        operands, in_turn, versions = self.operands, self.in_turn, self.budget.versions
        busy, given = versions.busy, versions.given
        if function.looks:
            if self.through[0] is not operands:
                self.through = operands, frozenset(numbers_of(operands))
            versions.busy = (*busy, self.through[1])
        if self.depth >= DEEPEST_CALLS:
            raise RunError(
                f"{function.name} is called by library code too deep inside of such calls", function.span, rule="E-Call-Host",
                hint="does it call itself, as a property, a key or an operator does?",
            )
        self.depth += 1
        try:
            return self.answer(function, arguments, keywords, self.state)
        finally:
            self.depth -= 1
            self.operands, self.in_turn, versions.busy, versions.given = operands, in_turn, busy, given

    def answer(self, function: Function, arguments: tuple[object, ...], keywords: Mapping[str, object], state: State) -> object:
        """The value of a call in a state."""
        outer, operands, self.called = self.origin, self.operands, True
        versions = self.budget.versions
        versions.note(Slot(self, "calls", self.calls))
        self.calls = number = self.calls + 1
        begun = state._replace(made=state.made + self.calls * NUMBERS_PER_CALL, version=versions.settled())
        decided = versions.given or (None if self.in_turn or state.may_branch else outer)
        scopes: dict[int, object] | None = None if decided is None else {}
        versions.given = None
        config = self.run(function, self.enter(function, arguments, keywords, begun), state.settings.machine, scopes)
        match config.control:
            case Abrupt(kind="raise", value=BaseException() as exception):
                raise exception
            case Value(value=value):
                if type(value) is Generator and value.calls >= number:  # it would be another one if the library made its call again
                    config = self.run(function, self.expand(NeedsElements(value), Config(PASS, (), config.state)).config, state.settings.machine)
                check_unchanged(function, begun, config.state)
                if decided is not None and (changed := changed_since(begun.version, scopes or {}, self)):
                    if self.reached[0] is not operands:
                        self.reached = operands, {}
                    roots = (function, arguments, keywords, operands, begun.objects, begun.params, begun.modules)
                    if is_reached(changed, roots, self.reached[1], self.budget):
                        raise lost_change(function.name)
                result, origin = unwrap(value)
                if any(i.number >= begun.made for i in instances_in(result)):
                    raise RunError(
                        f"{function.name} returns a new object or point to library code that calls it", function.span, rule="E-Call-Host",
                        hint="return its position instead",
                    )
                self.state, self.origin = state, outer or self.origin or origin
                return result
            case _:
                return None

    def run(self, function: Function, config: Config, machine: Machine, scopes: dict[int, object] | None = None) -> Config:
        """The configuration in which the body of a function has ended; `scopes` gets the variables of the scopes in which it ran.

        Raises `RunError` for a draw, `DoorStuck`, and the program's error.
        """

        def paid(config: Config) -> Outcome:
            self.budget.spend(STEP)
            if scopes is not None:
                scopes[id(config.state.sigma.bindings)] = config.state.sigma.bindings
            return machine(config)

        def refuse(draw: Draw) -> object:
            raise RunError(
                f"{function.name} draws a random value while library code calls it", draw.node.span, rule="E-Call-Host",
                hint="draw the value before the call and use it inside the function",
            )

        end, _ = drive_machine(paid, config, refuse, DOOR_FUEL, until=lambda config: not config.stack)
        match end:
            case Arrived(config=ended):
                return ended
            case Unfinished():
                raise FuelExhausted(f"{function.name}, which library code calls, takes too many steps", function.span)
            case Fault(error=error):
                raise error
            case Stuck() as outcome:
                raise DoorStuck(outcome)
            case _:
                raise RunError(f"{function.name} ends the program while library code calls it", function.span)


def has_entered_program(door: Door, version: Version) -> bool:
    """Whether host code called a function of the program since the version: what Python then raises, where nobody expects it, is the program's."""
    return any(type(note) is Slot and note.subject is door for note in version.undo)


def numbers_of(operands: Iterable[Any]) -> Iterator[int]:
    """The numbers (`id`) of the containers among the operands of a host call, of those in them, and of what a method is of."""
    level = [own_word(o, "__self__", o) for o in operands]
    seen: set[int] = set()
    while level:
        found = {id(o): o for o in level if isinstance(o, CONTAINERS)}
        yield from found.keys() - seen
        seen |= found.keys()
        parts = (p for o in found.values() for p in (*items_of(o), *(values_of(o) if isinstance(o, dict) else ())))
        level = [p for p in map(value_in_run, parts) if isinstance(p, CONTAINERS) and id(p) not in seen]


def check_unchanged(function: Function, before: State, after: State) -> None:
    """Refuse changes of the state by a function that library code called: they would be lost."""
    kept = ("scene", "params", "ego", "workspace", "late", "dynamic")
    changed = any(getattr(before, name) is not getattr(after, name) for name in kept)
    if changed or any(after.objects[number] is not properties for number, properties in before.objects.items()):
        raise RunError(
            f"{function.name} changes the scene while library code calls it", function.span, rule="E-Call-Host",
            hint="make objects, parameters and requirements outside of the function",
        )


def instances_in(value: object) -> Iterator[Instance]:
    """The instances in a value and in its lists and tuples."""
    if isinstance(value, Instance):
        yield value
    elif isinstance(value, (list, tuple)):
        for item in items_of(value):
            yield from instances_in(item)


def host(door: Door, state: State, operation: Callable[..., object], *arguments: object, **keywords: object) -> object:
    """`operation(*arguments, **keywords)` in Python; what is random inside the arguments makes the result random."""
    origin: Origin | None = None
    plain_arguments = []
    for argument in arguments:
        value, found = unwrap(in_list(argument))
        origin = origin or found
        plain_arguments.append(value)
    plain_keywords = {}
    for name, argument in keywords.items():
        plain_keywords[name], found = unwrap(in_list(argument))
        origin = origin or found
    door.state, door.origin, door.operands = state, None, (operation, *plain_arguments, *plain_keywords.values())
    door.budget.go_through(plain_arguments)
    if origin is not None:
        door.budget.versions.given = None if state.may_branch else origin
    door.in_turn = "key" in keywords
    try:
        result = (
            operation(*plain_arguments, **plain_keywords) if door.lift is None or origin is None
            else door.lift(operation, plain_arguments, plain_keywords)
        )
    except (ScenicError, DoorStuck, HostException, Absent):
        raise
    except RecursionError:
        raise too_deep() from None
    except MemoryError:
        raise short_of_memory() from None
    except Exception as exception:  # whatever library code raises is the program's to catch
        raise HostException(exception, origin or door.origin) from exception
    finally:
        door.budget.versions.given = None
    if type(result) not in PLAIN:
        result = admit_host_result(result, state)
    return wrap(result, origin or door.origin)


@contextmanager
def decided_by(origin: Origin | None, state: State) -> Yielding[None]:
    """Mark that the arguments of the program's functions depend on the draw, if there is one, during the
    block: they may not change what existed before.
    """
    versions = state.settings.door.budget.versions
    before, versions.given = versions.given, None if state.may_branch else origin
    try:
        yield
    finally:
        versions.given = before


def in_list(argument: object) -> object:
    """The elements of a generator that were computed ahead, so that what is random in them is seen; anything else as it is."""
    return (argument.taken_ahead() or argument) if type(argument) is Generator else argument


def admit_host_result(result: object, state: State) -> object:
    """Return the result of host code, paid for and checked; a number of NumPy's as Python's."""
    if isinstance(result, np.generic):
        return result.item()
    state.settings.door.budget.made(result)
    check_value(result, state)
    return result


def check_value(result: object, state: State) -> None:
    """Refuse a value that is none of a program's (`allowed.is_value`)."""
    if type(result) not in PLAIN and not state.settings.trusted and not is_value(result):
        raise RunError(f"a program may not have a value of type {type(result).__name__}", rule="E-Call-Host")


def raw(door: Door, state: State, operation: Callable[..., object], *arguments: object, **keywords: object) -> object:
    """`operation(*arguments, **keywords)` in Python on the values as they are, containers with random elements and all.

    The result is random if functions of the program that it called met something random.
    """
    outer, door.state, door.origin, door.operands = door.origin, state, None, (operation, *arguments, *keywords.values())
    door.in_turn = "key" in keywords
    try:
        result = operation(*arguments, **keywords)
        met = door.origin
    except (ScenicError, DoorStuck, HostException, Absent):
        raise
    except RecursionError:
        raise too_deep() from None
    except MemoryError:
        raise short_of_memory() from None
    except Exception as exception:  # whatever library code raises is the program's to catch
        raise HostException(exception) from exception
    finally:
        door.origin = outer
    check_value(result, state)
    return result if met is None else wrap(unwrap(result)[0], met)
