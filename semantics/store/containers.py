"""Python's containers that call back into a program while they look at their elements: ours, in Python, under Python's names.

What `collections` has for them is C that goes on with an element, or with a node of a list, which a method of the program has just removed
(an `OrderedDict` that `__eq__` of a key empties is the best known case). Here each element that a method of the program is asked about is held.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

import collections
from collections.abc import Hashable, Iterable, Mapping
from operator import index
from typing import Any


class OrderedDict(dict[Any, Any]):
    """`collections.OrderedDict`: a dictionary, which has an order as it is, and what looks at that order."""

    def move_to_end(self, key: Hashable, last: bool = True) -> None:
        """Put an entry last, or first."""
        value = dict.pop(self, key)
        others = [] if last else list(dict.items(self))
        if others:
            dict.clear(self)
        dict.__setitem__(self, key, value)
        for other, kept in others:
            dict.__setitem__(self, other, kept)

    def pop(self, key: Hashable, *default: Any, **named: Any) -> Any:
        """Remove an entry and give its value, or `default` where there is none."""
        if named.keys() - {"default"} or len(default) + len(named) > 1:
            raise TypeError("pop() takes a key and a default")
        return dict.pop(self, key, *default, *named.values())

    def popitem(self, last: bool = True) -> tuple[Any, Any]:
        """Remove the last entry, or the first, and give it."""
        if last:
            return dict.popitem(self)
        key = next(dict.__iter__(self), self)
        if key is self:
            raise KeyError("dictionary is empty")
        return key, dict.pop(self, key)

    def copy(self) -> OrderedDict:
        """Another one with the same entries."""
        made = type(self).__new__(type(self))
        dict.update(made, dict.copy(self))
        return made

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, OrderedDict):
            return dict.__eq__(self, other)
        mine, theirs = list(dict.items(self)), list(dict.items(other))
        return len(mine) == len(theirs) and mine == theirs

    def __ne__(self, other: object) -> bool:
        equal = OrderedDict.__eq__(self, other)
        return equal if equal is NotImplemented else not equal

    __hash__ = None  # type: ignore[assignment]

    def __or__(self, other: Any) -> Any:
        return merge_dictionaries(self, self, other)

    def __ror__(self, other: Any) -> Any:
        return merge_dictionaries(self, other, self)

    def __repr__(self) -> str:
        name, items = type(self).__name__, list(dict.items(self))
        return f"{name}({items!r})" if items else f"{name}()"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (list(dict.items(self)),)


def merge_dictionaries(of: OrderedDict, first: Any, second: Any) -> Any:
    """`first | second` as a dictionary of the class of one of them."""
    if not isinstance(first, dict) or not isinstance(second, dict):
        return NotImplemented
    made = type(of).__new__(type(of))
    dict.update(made, dict(dict.items(first)))
    dict.update(made, dict(dict.items(second)))
    return made


class Counter(collections.Counter[Any]):
    """`collections.Counter`, which counts without Python's shortcut in C."""

    def update(self, iterable: Any = None, /, **counts: Any) -> None:
        """Add elements, or counts."""
        if iterable is not None and not isinstance(iterable, Mapping):
            for element in iterable:
                self[element] = self.get(element, 0) + 1
            iterable = None
        super().update(iterable, **counts)

    def most_common(self, n: Any = None) -> list[tuple[Any, Any]]:
        """The elements with the highest counts, and these."""
        found = sorted(dict.items(self), key=count_of, reverse=True)
        return found if n is None else found[: max(0, index(n))]

    def __add__(self, other: Any) -> Any:
        return as_counter(super().__add__(other))

    def __sub__(self, other: Any) -> Any:
        return as_counter(super().__sub__(other))

    def __or__(self, other: Any) -> Any:
        return as_counter(super().__or__(other))

    def __and__(self, other: Any) -> Any:
        return as_counter(super().__and__(other))

    def __pos__(self) -> Any:
        return as_counter(super().__pos__())

    def __neg__(self) -> Any:
        return as_counter(super().__neg__())


def count_of(entry: tuple[Any, Any]) -> Any:
    """The count of an element of a counter, to be ordered."""
    return copy_inner_lists(entry[1])


def as_counter(counts: Any) -> Any:
    """Return the result of an operator of Python's as a counter of ours."""
    if not isinstance(counts, dict):
        return counts
    made = Counter()
    dict.update(made, dict(dict.items(counts)))
    return made


class deque(collections.deque[Any]):
    """`collections.deque`; where elements are compared, it is a copy of them that is gone through."""

    def __contains__(self, value: object) -> bool:
        return value in elements_of(self)

    def count(self, value: object) -> int:
        """How many elements equal the value."""
        return elements_of(self).count(value)

    def index(self, value: object, start: int = 0, stop: int = 2**62) -> int:
        """The place of the first element, of those from `start` to `stop`, that equals the value."""
        try:
            return elements_of(self).index(value, start, stop)
        except ValueError as problem:
            raise ValueError(str(problem).replace(" list", " deque")) from None

    def remove(self, value: object) -> None:
        """Remove the first element that equals the value."""
        place = deque.index(self, value)
        if place < collections.deque.__len__(self):  # a method of the program may have removed it
            collections.deque.__delitem__(self, place)

    def copy(self) -> deque:
        """Another one with the same elements."""
        return type(self)(elements_of(self), self.maxlen)

    def __eq__(self, other: object) -> Any:
        return elements_of(self) == elements_of(other) if isinstance(other, collections.deque) else NotImplemented

    def __ne__(self, other: object) -> Any:
        return elements_of(self) != elements_of(other) if isinstance(other, collections.deque) else NotImplemented

    def __lt__(self, other: Any) -> Any:
        return copy_inner_lists(elements_of(self)) < copy_inner_lists(elements_of(other)) if isinstance(other, collections.deque) else NotImplemented

    def __le__(self, other: Any) -> Any:
        return copy_inner_lists(elements_of(self)) <= copy_inner_lists(elements_of(other)) if isinstance(other, collections.deque) else NotImplemented

    def __gt__(self, other: Any) -> Any:
        return copy_inner_lists(elements_of(self)) > copy_inner_lists(elements_of(other)) if isinstance(other, collections.deque) else NotImplemented

    def __ge__(self, other: Any) -> Any:
        return copy_inner_lists(elements_of(self)) >= copy_inner_lists(elements_of(other)) if isinstance(other, collections.deque) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


def elements_of(items: Iterable[Any]) -> list[Any]:
    """The elements of a deque in a list that the program does not have."""
    return [*collections.deque.__iter__(items)]  # type: ignore[arg-type]


ATOMS = frozenset((int, float, complex, str, bytes, bool, type(None)))
"""Types whose values are compared without a method of the program."""


def copy_inner_lists(value: Any) -> Any:
    """A value to be ordered: lists in it as copies, which no method of the program can get at and change while they are compared.

    Python goes on with an element of a list that the method which it asks for the order has removed.
    """
    real: Any = list if isinstance(value, list) else tuple if isinstance(value, tuple) else None
    if real is None or ATOMS.issuperset(map(type, real.__iter__(value))) or not keeps_order(type(value), real):
        return value
    return real(map(copy_inner_lists, real.__iter__(value)))


def keeps_order(kind: type, real: type) -> bool:
    """Whether the elements of a class below `list` or `tuple` are compared as those of a list or tuple."""
    return kind is real or all(getattr(kind, name) is getattr(real, name) for name in ("__lt__", "__le__", "__gt__", "__ge__", "__eq__"))
