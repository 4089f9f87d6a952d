"""Objects that are made once, of which programs see what their classes tell."""

from __future__ import annotations

from functools import cached_property
from inspect import get_annotations
from typing import Any, ClassVar, Self, TypeVar

from ..semantics.space.vectors import Unchanging

HIDDEN = frozenset({
    "polygon", "by_id", "by_uid", "first", "_tree", "strips", "gaps", "nearest", "connecting", "of", "scenic_names", "left", "right", "middle",
    "outermost", "direction_cells", "across", "along", "siblings", "by_class", "source", "again", "turn", "turns", "near",
    "_near", "first_of", "_surfaces", "_directed",
})  # fmt: skip
"""What is no matter of programs."""


F = TypeVar("F", bound="Fixed")


class Fixed(Unchanging):
    """An object whose attributes are given once; programs may ask for those that its class tells of, as annotations, properties and methods."""

    scenic_names: ClassVar[frozenset[str]] = frozenset()

    def __init_subclass__(cls) -> None:
        """Collect the names of members that programs may use."""
        members = (name for name, value in vars(cls).items() if callable(value) or isinstance(value, property | cached_property))
        told = {*get_annotations(cls), *members} - HIDDEN
        cls.scenic_names = frozenset(name for name in told if not name.startswith("__"))

    def __init__(self, *arguments: object, **attributes: object) -> None:
        raise TypeError(f"a {type(self).__name__} is made by reading a map")

    @classmethod
    def of(cls, **attributes: Any) -> Self:
        """One with these attributes."""
        made = cls.__new__(cls)
        vars(made).update(attributes)
        return made

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is immutable")


def complete(element: F, **attributes: object) -> F:
    """An object that, while the network is made, is given what did not exist when it was."""
    vars(element).update(attributes)
    return element


def element_of(network: Any, uid: str) -> Any:
    """The element of a network with that name: how elements are pickled."""
    return network.by_uid[uid]
