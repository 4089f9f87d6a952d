"""Sets whose elements keep the order in which they came (reading `set-order`): a scene may not depend on how Python hashes texts or addresses."""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from typing import Any


class Set(set[Any]):
    """`set`, iterated over in the order of insertion."""

    __slots__ = ("order",)
    __hash__ = None  # type: ignore[assignment]
    order: dict[Any, None]

    def __new__(cls, *arguments: object, **keywords: object) -> Set:
        made = super().__new__(cls)
        made.order = {}  # a class below may do without our `__init__`
        return made

    def __init__(self, items: Iterable[Hashable] = ()) -> None:  # pyright: ignore[reportInconsistentConstructor]
        self.order = dict.fromkeys(items)
        super().__init__(self.order)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.order)

    def __repr__(self) -> str:
        return "{" + ", ".join(map(repr, self.order)) + "}" if self.order else "set()"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (list(self.order),)

    def renewed(self, order: dict[Any, None]) -> None:
        """Replace the elements by these, in order."""
        super().clear()
        super().update(order)
        self.order = order

    def add(self, item: Hashable) -> None:
        super().add(item)
        self.order[item] = None

    def discard(self, item: Hashable) -> None:
        super().discard(item)
        self.order.pop(item, None)

    def remove(self, item: Hashable) -> None:
        super().remove(item)
        del self.order[item]

    def pop(self) -> Any:
        """Remove the element that came first, and give it."""
        for item in self.order:
            self.remove(item)
            return item
        raise KeyError("pop from an empty set")

    def clear(self) -> None:
        self.renewed({})

    def copy(self) -> Set:
        return Set(self.order)

    def union(self, *others: Iterable[Hashable]) -> Set:
        return Set(union_items(self, others))

    def intersection(self, *others: Iterable[Hashable]) -> Set:
        return Set(intersection_items(self, others))

    def difference(self, *others: Iterable[Hashable]) -> Set:
        return Set(difference_items(self, others))

    def symmetric_difference(self, other: Iterable[Hashable]) -> Set:
        return Set(in_one(self, other))

    def update(self, *others: Iterable[Hashable]) -> None:
        self.renewed(dict.fromkeys(union_items(self, others)))

    def intersection_update(self, *others: Iterable[Hashable]) -> None:
        self.renewed(dict.fromkeys(intersection_items(self, others)))

    def difference_update(self, *others: Iterable[Hashable]) -> None:
        self.renewed(dict.fromkeys(difference_items(self, others)))

    def symmetric_difference_update(self, other: Iterable[Hashable]) -> None:
        self.renewed(dict.fromkeys(in_one(self, other)))

    def __or__(self, other: Any) -> Any:
        return Set(union_items(self, (other,))) if is_set(other) else NotImplemented

    def __and__(self, other: Any) -> Any:
        return Set(intersection_items(self, (other,))) if is_set(other) else NotImplemented

    def __sub__(self, other: Any) -> Any:
        return Set(difference_items(self, (other,))) if is_set(other) else NotImplemented

    def __xor__(self, other: Any) -> Any:
        return Set(in_one(self, other)) if is_set(other) else NotImplemented

    def __ior__(self, other: Any) -> Any:
        return self._changed(other, self.update)

    def __iand__(self, other: Any) -> Any:
        return self._changed(other, self.intersection_update)

    def __isub__(self, other: Any) -> Any:
        return self._changed(other, self.difference_update)

    def __ixor__(self, other: Any) -> Any:
        return self._changed(other, self.symmetric_difference_update)

    def _changed(self, other: Any, change: Any) -> Any:
        if not is_set(other):
            return NotImplemented
        change(other)
        return self


class FrozenSet(frozenset[Any]):
    """`frozenset`, iterated over in the order of insertion."""

    order: dict[Any, None]

    def __new__(cls, items: Iterable[Hashable] = ()) -> FrozenSet:
        order = dict.fromkeys(items)
        made = super().__new__(cls, order)
        made.order = order
        return made

    def __iter__(self) -> Iterator[Any]:
        return iter(self.order)

    def __repr__(self) -> str:
        return f"frozenset({Set(self.order)!r})" if self.order else "frozenset()"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (list(self.order),)

    def copy(self) -> FrozenSet:
        return self

    def union(self, *others: Iterable[Hashable]) -> FrozenSet:
        return FrozenSet(union_items(self, others))

    def intersection(self, *others: Iterable[Hashable]) -> FrozenSet:
        return FrozenSet(intersection_items(self, others))

    def difference(self, *others: Iterable[Hashable]) -> FrozenSet:
        return FrozenSet(difference_items(self, others))

    def symmetric_difference(self, other: Iterable[Hashable]) -> FrozenSet:
        return FrozenSet(in_one(self, other))

    def __or__(self, other: Any) -> Any:
        return FrozenSet(union_items(self, (other,))) if is_set(other) else NotImplemented

    def __and__(self, other: Any) -> Any:
        return FrozenSet(intersection_items(self, (other,))) if is_set(other) else NotImplemented

    def __sub__(self, other: Any) -> Any:
        return FrozenSet(difference_items(self, (other,))) if is_set(other) else NotImplemented

    def __xor__(self, other: Any) -> Any:
        return FrozenSet(in_one(self, other)) if is_set(other) else NotImplemented


VIEWS = (type({}.keys()), type({}.items()))


def is_set(value: object) -> bool:
    """Whether an operator of sets takes the value."""
    return isinstance(value, (set, frozenset, *VIEWS))


def union_items(first: Iterable[Any], others: Iterable[Iterable[Any]]) -> Iterator[Any]:
    """The elements of the first, then those of the others."""
    yield from first
    for other in others:
        yield from other


def intersection_items(first: Iterable[Any], others: Iterable[Iterable[Any]]) -> Iterator[Any]:
    """The elements of the first that are in all others."""
    members = [frozenset(other) for other in others]
    return (item for item in list(first) if all(item in other for other in members))


def difference_items(first: Iterable[Any], others: Iterable[Iterable[Any]]) -> Iterator[Any]:
    """The elements of the first that are in none of the others."""
    gone = {item for other in others for item in other}
    return (item for item in list(first) if item not in gone)


def in_one(first: Any, second: Iterable[Any]) -> Iterator[Any]:
    """The elements of the first that are not in the second, then the other way round."""
    others = dict.fromkeys(second)
    yield from [item for item in first if item not in others]
    yield from [item for item in others if item not in first]
