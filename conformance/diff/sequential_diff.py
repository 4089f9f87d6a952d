"""The comparison of a program here with another implementation: verdicts, further looks at more and more
answers, and readings that explain differences.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

from ...api import Scenario
from ...inference.comparison import Verdict
from ...semantics.readings import READINGS, select
from ...semantics.store.errors import ProgramError, UsageError
from ..implementations.harness_client import External
from ..implementations.line_process import ImplementationFault
from ..implementations.protocol import Refused, Task
from .explanations import fewest

Kind = Literal["agree", "differ", "inconclusive", "skipped"]
FIRST_LOOK, GROWTH = 100, 3
"""The scenes of the first look at them, and how many times as many the next has."""
MOST_SCENES = 30_000
AT_ONCE = 50
"""Scenes of one request."""
Loading = Callable[[Mapping[str, str]], Scenario]


class DiffSettings(NamedTuple):
    """How sure, how fine and how long: the risk of a false alarm, the total variation that is to show, seconds, time steps.

    `attempts` are made at each scene and simulation, at most. Of the parts of a comparison only `part` is made, if there is one. Without
    `explained`, the readings under which the two agree are not searched for.
    """

    alpha: float
    detect_tv: float
    seed: int
    seconds: float
    steps: int
    ignore: tuple[str, ...] = ()
    attempts: int = 10_000
    part: str | None = None
    explained: bool = True


@dataclass(frozen=True, slots=True)
class ProgramVerdict:
    """A program here and there. `kind` says what was compared or differs, `evidence` is log10 of an e-value, infinite for what cannot be at all.

    `reading` are the readings under which the two do agree, None if none are known; `part` is the part of the comparison that says so.
    """

    program: str
    verdict: Kind
    kind: str
    detail: str = ""
    evidence: float = 0.0
    feature: str | None = None
    reading: Mapping[str, str] | None = None
    part: str = "scenes"

    def to_json(self) -> dict[str, object]:
        """A line of the report: `evidence` is a number or "certain"."""
        evidence = "certain" if math.isinf(self.evidence) else self.evidence
        return {
            "program": self.program, "verdict": self.verdict, "kind": self.kind, "evidence": evidence, "feature": self.feature,
            "reading": None if self.reading is None else dict(self.reading), "detail": self.detail,
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class AskedProgram:
    """A program: its name, what the other implementation is given, and what loads it here under further readings."""

    name: str
    task: Task
    load: Loading


def scenario_or_error(load: Loading, readings: Mapping[str, str]) -> Scenario | ProgramError:
    """The scenario, which runs; or the error that it is."""
    try:
        scenario = load(readings)
        scenario.rehearse()
        return scenario
    except ProgramError as error:
        return error


def sequential_verdict(
    program: AskedProgram, scenario: Scenario | ProgramError, other: External, settings: DiffSettings, grow: Callable[[int], bool],
    beside: Callable[[Scenario | ProgramError, float], ProgramVerdict],
) -> ProgramVerdict:  # fmt: skip
    """The verdict on more and more answers, until there is one; a difference with the readings under which there is none.

    The looks share the risk of a false alarm: each has half of what the one before had.
    """
    wanted, alpha = 1, settings.alpha / 2
    grow(wanted)
    found = beside(scenario, alpha)
    wanted = FIRST_LOOK
    while found.verdict == "inconclusive" and grow(wanted):
        alpha /= 2
        found = beside(scenario, alpha)
        wanted = min(wanted * GROWTH, MOST_SCENES)
    if found.verdict != "differ" or not settings.explained:
        return found
    deadline = time.monotonic() + settings.seconds
    with suppress(ImplementationFault):  # what was found stays found
        grow(FIRST_LOOK)  # one answer shows a difference, and says little of where there is none
    selected = {**select(), **program.task.readings} if isinstance(scenario, ProgramError) else scenario.readings
    return replace(found, reading=find_agreeing_readings(program, other, lambda here: beside(here, alpha), deadline, selected))


def find_agreeing_readings(
    program: AskedProgram, other: External, beside: Callable[[Scenario | ProgramError], ProgramVerdict], deadline: float,
    selected: Mapping[str, str],
) -> Mapping[str, str] | None:  # fmt: skip
    """The fewest readings of the other's profile under which the two agree, or one reading that does; None if none was found in time.

    Readings are named that are none of the selected ones, under which the program was compared.

    That both refuse a program says little: another reading makes an error of nearly every program. It counts for those of the profile only.
    """

    def holds(readings: Mapping[str, str], *, refused: bool = True) -> bool:
        if time.monotonic() >= deadline:
            return False
        try:
            verdict = beside(scenario_or_error(program.load, readings))
        except UsageError:  # there are too few scenes under these readings to say so
            return False
        return verdict.verdict != "differ" and (refused or verdict.kind != "error")

    profile = {id: alternative for id, alternative in other.profile.items() if alternative != selected[id]}
    if profile and holds(profile):
        return fewest(profile, holds)
    single = ({id: alternative} for id, reading in READINGS.items() for alternative in reading.alternatives if alternative != selected[id])
    return next((reading for reading in single if holds(reading, refused=False)), None)


def of_errors(name: str, ours: ProgramError, theirs: Refused | None) -> ProgramVerdict:
    """A program that is an error here."""
    said = f"{type(ours).__name__} in phase {ours.phase} here: {ours.message}"
    if theirs is None:
        return ProgramVerdict(name, "differ", "error", f"{said}; a program there", math.inf)
    if not theirs.may_be_in([ours.phase]):
        return ProgramVerdict(name, "differ", "error", f"{said}; {theirs.when} there: {theirs.message}", math.inf)
    return ProgramVerdict(name, "agree", "error", said)


def of_verdict(name: str, verdict: Verdict, kind: str) -> ProgramVerdict:
    """A statistical verdict in these words."""
    words = "; ".join(line for line in verdict.lines() if not line.startswith(("replay: ", "not compared")))
    if verdict.kind == "different":
        kind = "support" if verdict.impossible and kind == "distribution" else kind
        feature = None if verdict.impossible else verdict.worst
        return ProgramVerdict(name, "differ", kind, words, verdict.evidence, feature)
    return ProgramVerdict(name, "agree" if verdict.kind == "equivalent" else "inconclusive", kind, words, verdict.evidence)
