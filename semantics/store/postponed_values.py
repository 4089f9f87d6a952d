"""Values that wait for a position: `H relative to F` is none by itself (reading `field-dependency`).

The paper's equation for it reads `self.position`, "the position of the object being specified". Where there is none yet, the expression is kept as a
`Waiting`, and every rule that needs its value waits with it; what only hands it on (a variable, an argument, a list) does so.

What a scenario will be asked for that has not begun waits as well, under reading `names-not-begun=waits`: attributes of it wait with it, and what
needs its value is an error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from ..syntax.nodes import Node
from .errors import NeedsPosition, NotBegun
from .scopes import Scope


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Waiting(Node):
    """An expression over a field relative to something, which waits for a position: what is left of `node` are the `values` of its premises.

    It is reduced by whoever has a position: the specifier that it is given to, or `self` of a behavior (reading `field-dependency`). Where it waits
    for a scenario to begin, `missing` says so.
    """

    node: Node
    values: tuple[object, ...]
    conclude: Callable[..., Any]
    scope: Scope
    missing: NotBegun | None = None

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
        return "<waits for a position>" if self.missing is None else "<waits for a scenario>"


def needs_position(waiting: Waiting) -> NeedsPosition | NotBegun:
    """The error where the value is needed, and there is no position, or no scenario."""
    return waiting.missing or NeedsPosition(
        "a vector field relative to something has no value by itself: it needs the position of an object being specified",
        waiting.span, rule="O-RelativeTo-HeadingField", hint="use it inside a specifier, or write `field at position`",
    )  # fmt: skip


def refuse_waiting(arguments: Iterable[object]) -> None:
    """Raises `NeedsPosition` where an argument waits for a position, `NotBegun` where it waits for a scenario."""
    for argument in arguments:
        if type(argument) is Waiting:
            raise needs_position(argument)
