"""The one seam between the machine and the batch backend: values that stand for many at once (DESIGN, section 1: a draw answered by a symbol).

Rules do not meet symbols: they use the functions of `numeric`, and the questions of `machine/operand_kinds.py` about the kind of a value.
What cannot be done with a symbol raises `NotLifted`. It is no `Exception`, so that neither a program nor the machine can take it
for an error of the program.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from .vectors import Vector


class NotLifted(BaseException):
    """Something was done with a symbol that needs the value in one scene; the text says what."""


@dataclass(frozen=True)
class Spread:
    """All items of a container of which there may be as many in one scene as in no other, in their place among the values of a distribution."""

    container: Any


class Listed:
    """A value of which all others of its kind can be listed, such as the lanes of a network: `siblings`, itself among them."""

    @property
    @abstractmethod
    def siblings(self) -> tuple[object, ...]: ...


class Symbol(ABC):
    """A value in many scenes, or in all, as a symbol."""

    __slots__ = ()

    @abstractmethod
    def apply(self, function: Callable[..., object], arguments: tuple[object, ...], result: type | None = None) -> Any:
        """`function(*arguments)` in every scene, symbols among or inside the arguments; a float or a bool, if `result` says so."""

    @abstractmethod
    def always(self, predicate: Callable[[Any], bool]) -> bool:
        """Whether the predicate, about its type and the like, holds of every value that this may be. Raises `NotLifted` if that differs."""

    @abstractmethod
    def each(self, function: Callable[[Any], object]) -> Any:
        """`function` of every value that this may be, as a symbol again."""

    @abstractmethod
    def number(self) -> Any:
        """Return this value as a symbol for floats."""

    @abstractmethod
    def pick(self, values: Sequence[object]) -> Any:
        """`values[int(this)]`."""

    @abstractmethod
    def cases(self) -> Sequence[tuple[Any, object]]:
        """The values that this may be, each with its condition, a truth value. Raises `NotLifted` if they cannot be listed."""

    @abstractmethod
    def of_cases(self, results: Sequence[object]) -> Any:
        """The result that stands where the value of `cases` that this is stands there."""

    @abstractmethod
    def met(self, requirement: Any) -> bool:
        """Note that the truth of this decides a requirement, and give its truth in the scene that is looked at."""

    @abstractmethod
    def where(self, expected: bool, end: object) -> None:
        """Note that what is reduced next, until the stack is `end`, is needed only in the runs in which the truth of this is `expected`."""

    @abstractmethod
    def __bool__(self) -> bool: ...

    def _refuse(self, *ignored: object) -> NoReturn:
        raise NotLifted("a random value is needed as a number of one scene")

    def __hash__(self) -> NoReturn:
        raise NotLifted("a random value is a key, or a member of a set")

    def _refuse_items(self, *ignored: object) -> NoReturn:
        raise NotLifted("the items of a container are needed of which there may be more in one scene than in another")

    __iter__ = __len__ = _refuse_items
    __float__ = __int__ = __index__ = __round__ = __trunc__ = __floor__ = __ceil__ = _refuse


def symbol_in(values: tuple[object, ...]) -> Symbol | None:
    """The first symbol among the values and in the vectors among them."""
    for value in values:
        if isinstance(value, Symbol):
            return value
        if type(value) is Vector:
            if isinstance(value.x, Symbol):
                return value.x
            if isinstance(value.y, Symbol):
                return value.y
    return None
