"""Frames of the dynamic rules that more than one of them looks for on the stack: behaviors and scenarios that run, statements that can be left."""

from __future__ import annotations

from typing import NamedTuple

from ..machine.simulation_state import Clause, Suspended, Who
from ..machine.values import Dynamic
from ..store.scopes import Scope
from ..syntax import dynamics as d
from ..syntax.nodes import Node

BODY = -1
"""The number of the body among the clauses of a statement with interrupts."""


class Invoked(NamedTuple):
    """Frame of a behavior that runs: below it is whoever invoked it by `node`, in the scope `caller`."""

    behavior: Dynamic
    scope: Scope
    caller: Scope
    node: Node


class Together(NamedTuple):
    """Frame of behaviors that run at the same time for one agent: those still running, by their place in the statement.

    Their draws of a time step are numbered below `base`.
    """

    children: tuple[tuple[int, Suspended], ...]
    who: Who
    i: int
    actions: tuple[object, ...]
    left: tuple[tuple[int, Suspended], ...]
    terminates: bool = False
    base: tuple[int, ...] | None = None


class Returning(NamedTuple):
    """Frame below a `do` statement with a limit: it returns, however it ended."""


class Interruptible(NamedTuple):
    """Frame of a statement with interrupts: clause `current` is running (BODY: the body), since time step `since`; `waiting` are those that it
    interrupted, each with its clause and since when that was running, the last one suspended last.
    """

    node: Node
    clauses: tuple[Clause, ...]
    sigma: Scope
    handling: tuple[BaseException, ...]
    depth: int
    first_step: int
    current: int = BODY
    since: int = -1
    waiting: tuple[tuple[int, int, Suspended], ...] = ()


class Abortable(NamedTuple):
    """Frame below an entire statement with interrupts, its `except` and `finally` blocks included: `abort` ends here."""


class Scenarios(NamedTuple):
    """Frame of scenarios that were invoked together: number `i` is next in this time step, `left` go on in the next."""

    node: Node
    numbers: tuple[int, ...]
    i: int = 0
    left: tuple[int, ...] = ()


class Picking(NamedTuple):
    """The task of a choice among invocations: those that are left, with their weights."""

    node: d.DoChoose | d.DoShuffle
    options: tuple[tuple[Dynamic, object], ...]


class Shuffling(NamedTuple):
    """Frame: one of the invocations of `do shuffle` is running; the others follow."""

    picking: Picking
