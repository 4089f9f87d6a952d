"""Strict reading of tables: every key must be known, every value of its kind; errors name the place."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

from ..semantics.store.errors import UsageError

MISSING = object()


class VectorFields:
    """A table of a vector file that is being read; `where` names it in errors. Every method raises `UsageError`."""

    def __init__(self, where: str, table: object) -> None:
        if not isinstance(table, Mapping):
            raise UsageError(f"{where}: a table is expected, not {table!r}")
        self.where = where
        self.rest = {str(key): value for key, value in table.items()}

    def wrong(self, message: str) -> UsageError:
        """An error in this table."""
        return UsageError(f"{self.where}: {message}")

    def has(self, key: str) -> bool:
        """Whether the key is there and was not read yet."""
        return key in self.rest

    def any(self, key: str, default: object = MISSING) -> object:
        """The value of a key, whatever it is."""
        if key in self.rest:
            return self.rest.pop(key)
        if default is MISSING:
            raise self.wrong(f"the key {key} is missing")
        return default

    def text(self, key: str, default: str | None = None) -> str:
        """The value of a key that holds a text."""
        found = self.any(key, MISSING if default is None else default)
        if not isinstance(found, str):
            raise self.wrong(f"{key} must be a text, not {found!r}")
        return found

    def texts(self, key: str, default: tuple[str, ...] | None = None) -> tuple[str, ...]:
        """The value of a key that holds a list of texts."""
        found = self.any(key, MISSING if default is None else list(default))
        if not isinstance(found, list) or not all(isinstance(item, str) for item in found):
            raise self.wrong(f"{key} must be a list of texts, not {found!r}")
        return tuple(found)

    def text_or_texts(self, key: str) -> tuple[str, ...]:
        """The value of a key that holds a text or a list of texts."""
        found = self.any(key)
        if isinstance(found, str):
            return (found,)
        if not isinstance(found, list) or not all(isinstance(item, str) for item in found):
            raise self.wrong(f"{key} must be a text or a list of texts, not {found!r}")
        return tuple(found)

    def number(self, key: str, default: float | None = None) -> float:
        """The value of a key that holds a finite number."""
        return self.as_number(key, self.any(key, MISSING if default is None else default))

    def count(self, key: str, default: int | None = None) -> int:
        """The value of a key that holds a whole number above 0."""
        found = self.any(key, MISSING if default is None else default)
        if not isinstance(found, int) or isinstance(found, bool) or found < 1:
            raise self.wrong(f"{key} must be a whole number above 0, not {found!r}")
        return found

    def ordinal(self, key: str) -> int:
        """The value of a key that holds a whole number of at least 0."""
        found = self.any(key)
        if not isinstance(found, int) or isinstance(found, bool) or found < 0:
            raise self.wrong(f"{key} must be a whole number of at least 0, not {found!r}")
        return found

    def point(self, key: str) -> tuple[float, float]:
        """The value of a key that holds a pair of numbers."""
        return self.as_point(key, self.any(key))

    def points(self, key: str) -> tuple[tuple[float, float], ...]:
        """The value of a key that holds a list of pairs of numbers."""
        return tuple(self.as_point(key, item) for item in self.items(key))

    def items(self, key: str) -> list[object]:
        """The value of a key that holds a list with something in it."""
        found = self.any(key)
        if not isinstance(found, list) or not found:
            raise self.wrong(f"{key} must be a list with something in it, not {found!r}")
        return found

    def table(self, key: str) -> VectorFields:
        """The value of a key that holds a table."""
        return VectorFields(f"{self.where}, {key}", self.any(key))

    def tables(self, key: str) -> tuple[VectorFields, ...]:
        """The value of a key that holds a list of tables."""
        return tuple(VectorFields(f"{self.where}, {key}[{number}]", item) for number, item in enumerate(self.items(key)))

    def probability(self, key: str) -> Fraction | float:
        """The value of a key that holds a probability."""
        return self.as_probability(key, self.any(key))

    def as_number(self, key: str, found: object) -> float:
        """Return the number; raise the error of the table if it is not finite."""
        if isinstance(found, bool) or not isinstance(found, (int, float)) or not math.isfinite(found):
            raise self.wrong(f"{key} must be a finite number, not {found!r}")
        return float(found)

    def as_point(self, key: str, found: object) -> tuple[float, float]:
        """A pair of numbers."""
        if not isinstance(found, list) or len(found) != 2:
            raise self.wrong(f"{key} must hold pairs of numbers, not {found!r}")
        return self.as_number(key, found[0]), self.as_number(key, found[1])

    def as_probability(self, key: str, found: object) -> Fraction | float:
        """A fraction written as a text, or a number from 0 to 1."""
        try:
            value = Fraction(found) if isinstance(found, str) else self.as_number(key, found)
        except (ValueError, ZeroDivisionError):
            raise self.wrong(f"{key} must be a fraction such as '1/4', not {found!r}") from None
        if not 0 <= value <= 1:
            raise self.wrong(f"{key} must be a probability, not {found!r}")
        return value

    def done(self) -> None:
        """No key may be left over."""
        if self.rest:
            raise self.wrong(f"there is no key {', '.join(sorted(self.rest))}")
