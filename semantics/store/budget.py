"""The budget of a run: one limit for everything that host code does and makes on the program's behalf.

The steps of the machine are counted by whoever drives it (`fuel`). A host call is one step, however much it
does; so it pays here for what it goes through and for what it makes, in units that are about a byte of memory
or a nanosecond or two.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

import operator
from collections import deque
from collections.abc import Iterable, Iterator, Sized
from typing import Any

from .errors import FuelExhausted, NeedsElements, RunError
from .sets import FrozenSet, Set
from .undo_log import Note, Slot, Versions

LARGEST_WORK = 400_000_000
"""The units of one run, or of one time step of a simulation."""
LARGEST_SEQUENCE = 2_000_000
"""The most elements or characters of one value."""
LARGEST_INTEGER_BITS = 100_000
STEP = 1000
"""What a step of the machine costs in a function that host code calls."""
ITEM = 64
"""What an element costs that is made when it is asked for."""
COMPARED = 3
"""What an element costs more that is compared."""
PLAIN = (bool, int, float, type(None))


class Budget:
    """The units that are left to a run, and the versions of what it changes in place: what belongs to a run and to no other."""

    __slots__ = ("left", "versions")

    def __init__(self) -> None:
        self.versions = Versions()
        self.renew()

    def renew(self) -> None:
        """Begin anew: a run, a time step of a simulation, a row of a column that is computed one by one."""
        self.left = LARGEST_WORK

    def spend(self, units: int) -> None:
        """Pay. Raises `FuelExhausted` if that is too much."""
        self.left -= units
        if self.left < 0:
            raise FuelExhausted("the program goes through more, or makes more, than one run may", hint="make fewer or smaller lists and texts")

    def go_through(self, arguments: Iterable[object]) -> None:
        """Pay for what host code goes through."""
        for value in arguments:
            if type(value) not in PLAIN and isinstance(value, Sized):
                self.spend(host_size(value))

    def compared(self, *values: object) -> None:
        """Pay, besides, for the elements that a comparison looks into."""
        for value in values:
            if isinstance(value, (list, tuple, deque)):
                self.spend(COMPARED * container_length(value))

    def made(self, value: object) -> None:
        """Pay for what was made, without what is inside."""
        if type(value) not in PLAIN or type(value) is int:
            self.spend(type(value).__sizeof__(value))  # type: ignore[arg-type]

    def metered(self, items: Iterable[object]) -> Metered:
        """The items one by one, each paid for when it is asked for."""
        return Metered(iter(items), self)


class Place:
    """A place between two items of an iterator: what comes there is asked for once, and known from then on."""

    __slots__ = ("item", "items", "next")

    def __init__(self, items: Iterator[object]) -> None:
        self.items = items
        self.item: object = None
        self.next: Place | None = None


class Metered:
    """An iterator of a program, at a place; nothing goes through it without paying, and Ctrl-C is heard between two items."""

    __slots__ = ("budget", "place", "running", "since")

    def __init__(self, items: Iterator[object], budget: Budget) -> None:
        self.place = Place(items)
        self.budget = budget
        self.running = False
        self.since: list[Note] | None = None

    def __iter__(self) -> Metered:
        return self

    def __next__(self) -> object:
        place, versions = self.place, self.budget.versions
        if place.next is None:
            if self.running:  # Python's iterators do not survive it
                raise ValueError("iterator already executing")
            self.running = True
            try:
                place.item = next(place.items)
            except NeedsElements as needed:
                raise (needed if needed.generator is place.items else RunError(needed.message, hint=needed.hint, rule="E-Call-Host")) from None
            finally:
                self.running = False
            place.next = Place(place.items)
        self.budget.spend(ITEM + (8 * len(place.item) if isinstance(place.item, (tuple, str, list)) else 0))
        if self.since is not versions.current.undo:  # one note per version
            self.since = versions.current.undo
            versions.note(Slot(self, "place", place))
        self.place = place.next
        return place.item

    def __repr__(self) -> str:
        return "<iterator>"


def host_size(value: Sized) -> int:
    """How many elements host code meets that goes through the value; 0 for a class, or where the program itself counts them."""
    if isinstance(value, range):
        return ITEM * (max(0, (value.stop - value.start + value.step - (1 if value.step > 0 else -1)) // value.step))
    return 0 if isinstance(value, type) else container_length(value)


VIEWS = (type({}.keys()), type({}.values()), type({}.items()))
COUNTED: tuple[type[Any], ...] = (list, tuple, dict, str, Set, FrozenSet, set, frozenset, bytes, deque, *VIEWS)


def container_length(value: object) -> int:
    """How many elements a container of Python really has, whatever a class of the program says of it; 0 for anything else."""
    return next((counted.__len__(value) for counted in COUNTED if isinstance(value, counted)), 0)


def items_of(container: Any) -> Iterable[Any]:
    """The elements of a container of Python (of a dictionary the keys), whatever a class of the program says of it; what it says of anything else."""
    if type(container) in EXACT:
        return container
    return next((counted.__iter__(container) for counted in COUNTED if isinstance(container, counted)), container)


def values_of(entries: dict[Any, Any]) -> Iterable[Any]:
    """The values of a dictionary, whatever a class of the program says of them."""
    return dict.values(entries)


EXACT = frozenset((list, tuple, dict))


def plain_data(value: Any) -> Any:
    """A number or text of a class of the program as Python's own, whatever the class says of it; anything else as it is."""
    if isinstance(value, str):
        return str.__str__(value)
    if isinstance(value, float):
        return float.__float__(value)
    return int.__add__(value, 0) if isinstance(value, int) and not isinstance(value, bool) else value


def as_whole_number(number: Any) -> int:
    """The whole number that library code takes a value for, whatever a class of the program says of it. Raises `TypeError`."""
    return int.__add__(operator.index(number), 0)


def refuse_too_long(count: int) -> None:
    """Raise an error where one value would get so many elements or characters."""
    count = as_whole_number(count)
    if count > LARGEST_SEQUENCE:
        raise RunError(f"{count:,} elements or characters are too many for one value: at most {LARGEST_SEQUENCE:,}", rule="E-Call-Host")


def refuse_too_large(bits: float) -> None:
    """Raise an error where a whole number would get so many binary digits."""
    if bits > LARGEST_INTEGER_BITS:
        raise RunError(f"a whole number of {bits:,.0f} binary digits is too large: at most {LARGEST_INTEGER_BITS:,}", rule="E-Call-Host")
