"""The work that compiled code leaves to the machine: a kind of coroutine, or a whole simulation, which is
then run again from its beginning.

A simulation is a function of the program, the seed and its number, so that the machine finds the same one,
with the same error where there is one; but Python code that a program with `--trust` calls has run once
before.
"""

from __future__ import annotations


class LeftToMachine(Exception):
    """Raised when a simulation needs the machine: for an error of the program, or for code that is not
    compiled (`reason`).

    `again`: a coroutine of it is left to the machine from now on, and the others need not be.
    """

    def __init__(self, reason: str, *, again: bool = False) -> None:
        super().__init__(reason)
        self.reason = reason
        self.again = again


class Untranslated(Exception):
    """A statement or expression that there is no translation of; `line` is where it stands."""

    def __init__(self, what: str, line: int) -> None:
        super().__init__(f"{what} on line {line}")
        self.reason = f"{what} on line {line}"
