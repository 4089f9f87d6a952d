"""One program of a campaign: compared, and if it differs shrunk, compared afresh, and told by its cause."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ...api.program_loader import loads
from ...interpreter.language.conversion import convert
from ...interpreter.language.modules import library_of
from ...interpreter.language.parser import parse
from ...pictures.side_by_side import Boxes, boxes_of
from ...semantics.store.errors import AttemptsExhausted, ProgramError, UsageError
from ...semantics.store.scopes import descendants
from ...semantics.syntax.specifiers import WithSpecifier
from ...semantics.syntax.statements import PropertyDefault
from ...simulators.worlds import WORLDS
from ..diff.scene_differences import differences, is_dynamic
from ..diff.sequential_diff import AskedProgram, DiffSettings, Loading, ProgramVerdict, scenario_or_error
from ..implementations.harness_client import External
from ..implementations.line_process import ImplementationFault
from ..implementations.protocol import NeverAccepted, Refused, Task, Unsupported
from ..implementations.reference import Ourselves
from .shrinking import shrunk
from .themed_programs import generate_themed_program

FUEL = 300_000
OUR_FAULT = "our fault"
"""The kind of finding that an internal error is."""
TOGETHER = " & "
"""Between two features that are compared together."""
ATTEMPTS, SCARCE = 1_000, 2
"""Attempts at each scene that is compared; in so many times as many the first must be found, without which a program is not compared."""
FEW = 100
"""Attempts while a program is made smaller."""
FRESH = 1_000_003
"""What is added to the seed for the scenes of the second comparison."""
SHRINKING_RISK = 1e-6
PLAIN = "ego = Object at 1 @ 2\nparam p = 1\n"
"""What fires the rules that say nothing about a cause."""
NOISE = re.compile(r"0x[0-9a-f]+|-?\d+(?:\.\d+)?(?:e[-+]?\d+)?|params\.\w+")
SHOWN = 30
"""Scenes of each side in the picture of a finding."""
PLACED = re.compile(r"position|heading|width|length|margin|distance|overlap")
"""Words of differences that can be seen."""
IMPOSSIBLE = re.compile(r"impossible: (\S+)")


@dataclass(frozen=True, slots=True)
class CampaignSettings:
    """A campaign: against what, its seed, the risk of a false alarm in all of it, and how much is done for a program.

    `budget` seconds for a program's comparison, `answer` for an answer, `shrinking` for making a program small; `readings` are those under
    which both are compared.
    """

    impl: str
    seed: int = 0
    alpha: float = 1e-3
    detect_tv: float = 0.3
    steps: int = 4
    budget: float = 6.0
    answer: float = 10.0
    shrinking: float = 90.0
    readings: Mapping[str, str] = field(default_factory=dict)

    def share(self, number: int) -> float:
        """The part of the risk that program `number` has: all parts together are no more than the whole."""
        return self.alpha / ((number + 1) * (number + 2))


@dataclass(frozen=True, slots=True)
class FuzzedProgram:
    """The result of examining a program. Of a finding, `minimal` is the smallest program that shows it, and
    `rules` are those it is about.

    `words` name the difference without its numbers. `confirmed` says that it was made small, perhaps to no
    program at all, and that fresh scenes of the smallest program show it again. `here` and `there` are the
    boxes of some scenes of each side, if the difference is one that can be seen.
    """

    number: int
    theme: str
    verdict: str
    kind: str
    seconds: float
    text: str = ""
    words: str = ""
    detail: str = ""
    evidence: float | None = None
    reading: Mapping[str, str] | None = None
    minimal: str = ""
    rules: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    confirmed: bool = False
    here: Boxes = ()
    there: Boxes = ()


def examine(number: int, settings: CampaignSettings, other: External, often: frozenset[tuple[str, str]]) -> FuzzedProgram:
    """Program `number` of a campaign. What differs in one of the ways that were seen `often` is not made small again."""
    theme, text = generate_themed_program(settings.seed, number)
    began = time.monotonic()
    plain = DiffSettings(settings.share(number) / 2, settings.detect_tv, settings.seed, settings.budget, settings.steps, attempts=ATTEMPTS)
    verdict = compare_program(text, other, settings, plain)
    words = words_of(verdict)
    if verdict.verdict != "differ" or (verdict.kind, words) in often:
        seconds = time.monotonic() - began
        return FuzzedProgram(number, theme, verdict.verdict, verdict.kind, seconds, text if verdict.verdict == "differ" else "", words)
    until = time.monotonic() + settings.shrinking

    def shows(smaller: str, look: DiffSettings) -> ProgramVerdict | None:
        found = compare_program(smaller, other, settings, look)
        return found if found.verdict == "differ" and is_same_difference(found, verdict) else None

    trial = plain._replace(alpha=SHRINKING_RISK, attempts=FEW, part=verdict.part, explained=False, seconds=settings.budget / 2)
    minimal = shrunk(text, lambda smaller: shows(smaller, trial) is not None, lambda: time.monotonic() > until)
    again = shows(minimal, plain._replace(seed=settings.seed + FRESH))
    if again is None:
        minimal, again = text, shows(text, plain._replace(seed=settings.seed + FRESH))
    told = again or verdict
    words = words_of(told)
    here, there = boxes_of_both_sides(minimal, other, settings) if told.kind == "acceptance" or PLACED.search(words) else ((), ())
    return FuzzedProgram(
        number, theme, "differ", told.kind, time.monotonic() - began, text, words, told.detail,
        None if math.isinf(told.evidence) else told.evidence, told.reading, minimal, rules_of(minimal, settings), properties_of(minimal),
        again is not None, here, there,
    )  # fmt: skip


def boxes_of_both_sides(text: str, other: External, settings: CampaignSettings) -> tuple[Boxes, Boxes]:
    """The boxes of some scenes of a program here and in the other implementation, for a picture; none where there is no scene."""
    try:
        here: Boxes = boxes_of([scene.to_json() for scene in loads(text, readings=settings.readings, fuel=FUEL).sample_many(SHOWN, settings.seed)])
    except (AttemptsExhausted, ProgramError):
        here = ()
    try:
        there: Boxes = boxes_of(list(other.scenes(task_of(text, other, settings.readings), SHOWN, seed=settings.seed, attempts=ATTEMPTS)))
    except (ImplementationFault, NeverAccepted, Refused, Unsupported):
        there = ()
    return here, there


def compare_program(text: str, other: External, settings: CampaignSettings, look: DiffSettings) -> ProgramVerdict:
    """The verdict on a program; `skipped` if it cannot be said there."""
    try:
        task = task_of(text, other, settings.readings)
    except ProgramError as error:
        return ProgramVerdict("", "skipped", "unsaid", error.message)
    load = lambda readings: loads(text, readings={**settings.readings, **readings}, fuel=FUEL)  # noqa: E731
    try:
        scarce = SCARCE * look.attempts
        if are_rare(load, look.seed, scarce):
            return ProgramVerdict("", "inconclusive", "acceptance", f"no scene in {scarce:,} attempts here")
        return differences(AskedProgram("", task, load), other, look)
    except (UsageError, AttemptsExhausted, ProgramError) as unclear:  # `ProgramError`: in some of the runs only
        return ProgramVerdict("", "inconclusive", "distribution", unclear.message)


def are_rare(load: Loading, seed: int, attempts: int) -> bool:
    """Whether scenes of a program are not found in so many attempts, though none of its values shows that there are none."""
    scenario = scenario_or_error(load, {})
    if isinstance(scenario, ProgramError):
        return False
    try:
        if scenario.impossible is None:
            scenario.sample(seed, max_attempts=attempts)
    except AttemptsExhausted:
        return True
    except ProgramError:  # in some of the runs, or where the scene is looked at
        return False
    return False


def task_of(text: str, other: External, readings: Mapping[str, str]) -> Task:
    """The program in a dialect of the other. Raises `ProgramError` if it cannot be said there; what is no program is given as it is."""
    followed = {id: alternative for id, alternative in readings.items() if other.follows(id, alternative)}
    try:
        program = parse(text, "<invented>", None)
    except ProgramError:
        return Task(text, other.dialects[0], followed)
    if program.dialect in other.dialects:
        return Task(text, program.dialect, followed)
    library = library_of(program, worlds=WORLDS, model=None, trust=False, directory=Path(), dialect=program.dialect)
    return Task(convert(program, other.dialects[0], library), other.dialects[0], followed)


def words_of(verdict: ProgramVerdict) -> str:
    """The difference without what is of this program only: numbers, names of parameters, places."""
    if verdict.verdict != "differ":
        return ""
    impossible = IMPOSSIBLE.search(verdict.detail)
    what = impossible.group(1) if impossible else verdict.feature or verdict.detail
    return NOISE.sub("#", what)[:200]


def is_same_difference(smaller: ProgramVerdict, larger: ProgramVerdict) -> bool:
    """Whether a smaller program differs in the same words, or in one of the two features that differ together in the larger one."""
    words = words_of(smaller), words_of(larger)
    if {smaller.kind, larger.kind} <= {"support", "distribution"}:
        return set(words[0].split(TOGETHER)) <= set(words[1].split(TOGETHER))
    return smaller.kind == larger.kind and words[0] == words[1]


def rules_of(text: str, settings: CampaignSettings) -> tuple[str, ...]:
    """The rules that fire in a program and not in the plainest one; of an error, the rule that cannot be applied."""
    ours = Ourselves()
    try:
        scenario = loads(text, readings=settings.readings, fuel=FUEL)
        scenario.rehearse()
        fired = ours.fired(Task(text, scenario.program.dialect, settings.readings), frozenset(), seed=settings.seed)
        if is_dynamic(scenario):
            task = Task(text, scenario.program.dialect, settings.readings)
            fired |= ours.fired_in_simulations(task, settings.steps, frozenset(), seed=settings.seed)
    except ProgramError as error:
        return (error.rule,) if error.rule else ()
    return tuple(sorted(fired - ours.fired(Task(PLAIN, "paper"), frozenset(), seed=0)))


def properties_of(text: str) -> tuple[str, ...]:
    """The properties that a program gives to objects."""
    try:
        program = parse(text, "<invented>", None)
    except ProgramError:
        return ()
    nodes = (node for statement in program.statements for node in descendants(statement))
    given = {n.property if isinstance(n, WithSpecifier) else n.name for n in nodes if isinstance(n, (WithSpecifier, PropertyDefault))}
    return tuple(sorted(given))
