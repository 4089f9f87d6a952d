"""The closed family of errors that a user can meet (DESIGN: four kinds of failure, never mixed).

A *stuck* run is not an error but an outcome; `AttemptsExhausted` is what a report of too many stuck runs raises.
Kinds are told apart by class, never by message text.
"""

from __future__ import annotations

import re
from fractions import Fraction

from ..syntax.nodes import NOWHERE, Span

ADDRESS = re.compile(r"(<[^<>]*) at 0x[0-9a-fA-F]+")


def without_addresses(text: str) -> str:
    """A text without the addresses in memory that Python writes for what has no text of its own: they would differ from run to run."""
    return ADDRESS.sub(r"\1", text) if " at 0x" in text else text


class ScenicError(Exception):
    """Anything that `scenic_ref` raises on purpose.

    `message` is one sentence; `span` says where in the source; `rule` is the id of the rule that could not be applied
    (or ""); `hint` is one suggested repair (or ""), which tracebacks show as a note.
    """

    exit_code = 1
    kind = "error"

    def __init__(self, message: str, span: Span = NOWHERE, *, rule: str = "", hint: str = "") -> None:
        self.message = without_addresses(message)
        super().__init__(self.message)
        self.span = span
        self.rule = rule
        self.hint = hint

    @property
    def hint(self) -> str:
        """One suggested repair, or ""."""
        return self._hint

    @hint.setter
    def hint(self, hint: str) -> None:
        self._hint = hint
        self.__notes__ = [f"hint: {hint}"] if hint else []

    def __reduce__(self) -> tuple[object, ...]:
        """Errors cross processes whole, whatever the arguments of their constructors are."""
        return _again, (type(self), self.args), vars(self)

    def __str__(self) -> str:
        place = f"{self.span}: " if self.span != NOWHERE else ""
        return place + self.message


def _again(kind: type[ScenicError], arguments: tuple[object, ...]) -> ScenicError:
    """An error without its attributes, which the caller gives it."""
    return kind.__new__(kind, *arguments)


class ProgramError(ScenicError):
    """The user's program is wrong; `phase` says when that was found."""

    kind = "program error"
    phase = "run"


class ParseError(ProgramError):
    """The text is not a program of the grammar; `expected` lists what could have stood at `span`."""

    kind = "syntax error"
    phase = "parse"

    def __init__(self, message: str, span: Span, *, expected: tuple[str, ...] = (), hint: str = "") -> None:
        super().__init__(message, span, hint=hint)
        self.expected = expected


class CheckError(ProgramError):
    """The program parses but can never run: `take` outside a behavior, `return` outside a function, ..."""

    kind = "static error"
    phase = "check"


class ResolutionError(ProgramError):
    """Algorithm 1 (resolveSpecifiers) found the specifiers of an object ill-formed."""

    kind = "specifier error"
    phase = "resolve"


class SpecifiedTwice(ResolutionError):
    """A property is specified non-optionally by two specifiers."""


class SpecifiedTwiceOptionally(ResolutionError):
    """A property is specified only optionally, and by two specifiers."""


class MissingProperty(ResolutionError):
    """A specifier depends on a property that the object does not have."""


class CyclicDependencies(ResolutionError):
    """The specifiers depend on each other in a circle; `cycle` lists the properties along it."""

    def __init__(self, message: str, span: Span, *, cycle: tuple[str, ...], rule: str = "", hint: str = "") -> None:
        super().__init__(message, span, rule=rule, hint=hint)
        self.cycle = cycle


class RunError(ProgramError):
    """A rule's premises cannot hold whatever is drawn: a wrong type, an unknown name, a bad parameter."""


class NoEgo(RunError):
    """The scene has no ego, which only a scenario of the compose block would make (reading `compose-only`): there are simulations, no scenes."""


class NeedsPosition(RunError):
    """A value was needed that waits for the position of an object (reading `field-dependency`)."""


class NeedsElements(RunError):
    """Library code goes through a generator, whose elements have not been computed: the machine computes them, and makes the call again."""

    def __init__(self, generator: object) -> None:
        super().__init__("library code keeps a generator and goes through it later", hint="make a list of it first")
        self.generator = generator


class RandomBranch(RunError):
    """Control flow outside a behavior depends on a random value (reading `random-branch`)."""


class UncaughtException(RunError):
    """The program raised a Python exception that nothing caught; `exception` is it."""

    def __init__(self, message: str, span: Span, *, exception: BaseException, hint: str = "") -> None:
        super().__init__(message, span, hint=hint)
        self.exception = exception


class SimulatorError(RunError):
    """A simulator raised an exception, or gave numbers that are none."""

    kind = "simulator error"


class ImportRefused(RunError):
    """The import runs arbitrary Python code and `--trust` was not given, or reaches a private name."""


class FuelExhausted(RunError):
    """One run took more steps than allowed: probably an endless loop."""


class OutOfTime(FuelExhausted):
    """Raised when the work of the program takes more processor time than it may."""


class Gap(ScenicError):
    """The paper says nothing and no reading covers it."""

    kind = "gap in the paper"


class UsageError(ScenicError):
    """The command line or the API was used wrongly: an unknown profile, a file that cannot be read or written."""

    exit_code = 2
    kind = "usage error"


class AttemptsExhausted(ScenicError):
    """No run was accepted within the limit; `stuck` counts the reasons of the stuck runs, most frequent first."""

    exit_code = 3
    kind = "attempts exhausted"

    def __init__(self, message: str, span: Span = NOWHERE, *, attempts: int, stuck: tuple[tuple[object, int], ...]) -> None:
        super().__init__(message, span)
        self.attempts = attempts
        self.stuck = stuck


class RunsExhausted(ScenicError):
    """An enumeration has more than the allowed number of runs; those made cover the part `covered` of the probability."""

    exit_code = 3
    kind = "runs exhausted"

    def __init__(self, message: str, span: Span = NOWHERE, *, runs: int, covered: Fraction, hint: str = "") -> None:
        super().__init__(message, span, hint=hint)
        self.runs = runs
        self.covered = covered


class InternalError(ScenicError):
    """A fault of scenic_ref itself; please report it with the program and the seed."""

    exit_code = 4
    kind = "internal error"


class GuardViolation(Exception):
    """A precondition or invariant does not hold."""


class PreconditionViolation(GuardViolation):
    """A precondition does not hold where a behavior or scenario begins."""


class InvariantViolation(GuardViolation):
    """An invariant does not hold where a behavior or scenario begins or goes on."""


class NotBegun(AttributeError):
    """A variable was asked of a scenario that has not begun; a condition of an interrupt that does so is not true (reading `names-not-begun`)."""


NotBegun.__name__ = AttributeError.__name__  # as the program's `except` and messages know it

GUARD_VIOLATIONS = {c.__name__: c for c in (GuardViolation, PreconditionViolation, InvariantViolation)}
"""Exceptions that a program may name and catch."""
