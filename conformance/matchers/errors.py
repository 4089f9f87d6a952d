"""The matchers `rejection` (never accepted) and `error` (of a named phase)."""

from __future__ import annotations

from dataclasses import dataclass

from ...semantics.rules import RULES
from ...semantics.store import errors
from ..implementations.protocol import Implementation, NeverAccepted, Refused, SceneRecord, Simulating, Task
from ..strict_tables import VectorFields
from ..verdict import PASSED, VectorVerdict, failed_verdict, skipped_verdict
from .common import ATTEMPTS, requirements

PHASES = ("parse", "check", "resolve", "run")
REQUIREMENTS = ("require", "containment", "collision", "visibility", "region", "field")


def simulations_of(implementation: Simulating, task: Task, steps: int, attempts: int) -> list[SceneRecord]:
    """Return the first simulation of the implementation."""
    return list(implementation.simulations(task, steps, 1, seed=task.seed, attempts=attempts))


@dataclass(frozen=True, slots=True)
class Rejection:
    """No run is ever accepted, because of one kind of requirement."""

    attempts: int
    requirement: str

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """No scene in `attempts` attempts; an implementation that reports why must name that requirement and no other."""
        try:
            scenes = list(implementation.scenes(task, 1, seed=task.seed, attempts=self.attempts))
        except Refused as refused:
            return failed_verdict(f"{refused.when} instead of never accepted: {refused.message}")
        except NeverAccepted as never:
            told = never.requirements in (None, frozenset({self.requirement}))
            return PASSED if told else failed_verdict(f"never accepted, but not because of {self.requirement} alone: {requirements(never)}")
        return failed_verdict(f"gave {len(scenes)} scenes, and no run may be accepted")


def read_rejection(fields: VectorFields) -> Rejection:
    """The table `rejection` of a vector. Raises `UsageError`."""
    found = Rejection(fields.count("attempts"), fields.text("requirement"))
    fields.done()
    if found.requirement not in REQUIREMENTS:
        raise fields.wrong(f"there is no requirement {found.requirement!r}: there are {', '.join(REQUIREMENTS)}")
    return found


@dataclass(frozen=True, slots=True)
class Error:
    """The program is refused in one of some phases; line, class and rule are compared only if the implementation reports them.

    With `steps`, the error occurs in a simulation of at most this number of time steps.
    """

    phases: tuple[str, ...]
    line: int | None = None
    class_name: str | None = None
    rule: str | None = None
    steps: int | None = None

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """The first scene, or simulation, must not appear, for the right reason."""
        if self.steps is not None and not isinstance(implementation, Simulating):
            return skipped_verdict(f"{implementation.name} does not simulate")
        try:
            found = self.first(implementation, task)
        except Refused as refused:
            return self.compare(refused)
        except NeverAccepted as never:
            return failed_verdict(f"never accepted instead of refused in phase {self.allowed}: {requirements(never)}")
        what = "scenes" if self.steps is None else "simulations"
        return failed_verdict(f"gave {len(found)} {what} instead of an error of phase {self.allowed}")

    def first(self, implementation: Implementation, task: Task) -> list[SceneRecord]:
        """The first scene, or simulation."""
        if self.steps is not None and isinstance(implementation, Simulating):
            return simulations_of(implementation, task, self.steps, ATTEMPTS)
        return list(implementation.scenes(task, 1, seed=task.seed, attempts=ATTEMPTS))

    @property
    def allowed(self) -> str:
        """The phases in words."""
        return " or ".join(self.phases)

    def compare(self, refused: Refused) -> VectorVerdict:
        """An error against the expected one."""
        if not refused.may_be_in(self.phases):
            return failed_verdict(f"{refused.when}, not {self.allowed}: {refused.message}")
        told = (("line", refused.line, self.line), ("class", refused.class_name, self.class_name), ("rule", refused.rule, self.rule))
        for what, found, expected in told:
            if None not in (found, expected) and found != expected:
                return failed_verdict(f"refused with {what} {found}, not {expected}: {refused.message}")
        return PASSED


def read_error(fields: VectorFields) -> Error:
    """The table `error` of a vector. Raises `UsageError`."""
    phases, line = fields.text_or_texts("phase"), fields.count("line") if fields.has("line") else None
    class_name = fields.text("class") if fields.has("class") else None
    rule = fields.text("rule") if fields.has("rule") else None
    steps = fields.count("steps") if fields.has("steps") else None
    fields.done()
    for phase in phases:
        if phase not in PHASES:
            raise fields.wrong(f"there is no phase {phase!r}: there are {', '.join(PHASES)}")
    if not phases:
        raise fields.wrong("phase must name one phase or more")
    if class_name is not None and class_name not in vars(errors):
        raise fields.wrong(f"there is no error class {class_name}")
    if rule is not None and rule not in RULES:
        raise fields.wrong(f"there is no rule {rule}")
    return Error(phases, line, class_name, rule, steps)
