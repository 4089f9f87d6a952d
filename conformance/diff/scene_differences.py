"""Whether another implementation gives a program the meaning that it has here: errors, acceptance, distribution, actions in a replayed world."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from ...api import Scenario
from ...inference.comparison import compare
from ...inference.comparison.feature_names import feature_matcher
from ...inference.comparison.scene_columns import leaves
from ...semantics.store.built_in_classes import view_distance
from ...semantics.store.errors import AttemptsExhausted, ProgramError, UsageError
from ...semantics.store.scopes import descendants
from ...semantics.syntax import dynamics
from ...testing.judge import judge_samples, verdict_on_none
from ..implementations.harness_client import External
from ..implementations.line_process import ImplementationFault
from ..implementations.protocol import NeverAccepted, Refused, SceneRecord, Task, Unsupported
from .sequential_diff import (
    AT_ONCE,
    AskedProgram,
    DiffSettings,
    ProgramVerdict,
    of_errors,
    of_verdict,
    scenario_or_error,
    sequential_verdict,
)
from .simulation_differences import in_simulations

PRUNED = ("attempts",)
"""What is compared by itself, without pruning: one that prunes needs fewer."""
PRINTED = re.compile(r"<(distribution|function|module|built-in|built-in function) [^<>]+>")
"""What is in the text of a value that no two implementations print alike."""


def differences(program: AskedProgram, other: External, settings: DiffSettings) -> ProgramVerdict:
    """The verdict on a program: the first difference that is found, in scenes, in their acceptance, or in simulations.

    The parts share the risk of a false alarm; each has as much of the time that is left as those after it.
    """
    deadline = time.monotonic() + settings.seconds
    try:
        scenario = scenario_or_error(program.load, {})
        more = {} if isinstance(scenario, ProgramError) else parts(scenario, other)
        settings = settings._replace(alpha=settings.alpha / (len(more) + 1))
        if not isinstance(scenario, ProgramError) and settings.part in more:
            return replace(more[settings.part](program, scenario, other, settings), part=settings.part)
        found = in_scenes(program, scenario, other, settings._replace(seconds=settings.seconds / (len(more) + 1)))
        if isinstance(scenario, ProgramError) or found.kind != "distribution" or settings.part == found.part:
            return found
        for number, (name, part) in enumerate(more.items()):
            if found.verdict == "differ":
                break
            left = max(deadline - time.monotonic(), 0.0) / (len(more) - number)
            later = replace(part(program, scenario, other, settings._replace(seconds=left)), part=name)
            both = {found.verdict, later.verdict}
            if both == {"agree"}:
                found = replace(found, kind=f"{found.kind}, {later.kind}")
            elif later.verdict == "differ" or found.verdict == "agree":
                found = later
        return found
    except Unsupported as reason:
        return ProgramVerdict(program.name, "skipped", "unsaid", str(reason))
    except ImplementationFault as fault:
        return ProgramVerdict(program.name, "differ", fault.kind, str(fault), math.inf)


def parts(scenario: Scenario, other: External) -> dict[str, Callable[[AskedProgram, Scenario, External, DiffSettings], ProgramVerdict]]:
    """Return the comparisons besides that of the scenes' distribution, by the capability each needs."""
    other.introduced()
    wanted = {"attempts": in_acceptance, **({"simulations": in_simulations} if is_dynamic(scenario) else {})}
    return {name: part for name, part in wanted.items() if name in other.said["capabilities"]}


def is_dynamic(scenario: Scenario) -> bool:
    """Whether the program says what happens over time."""
    nodes = (node for statement in scenario.program.statements for node in descendants(statement))
    return any(type(node).__module__ == dynamics.__name__ for node in nodes)


# Scenes


def in_scenes(program: AskedProgram, scenario: Scenario | ProgramError, other: External, settings: DiffSettings) -> ProgramVerdict:
    """Errors, and the distribution of the scenes."""
    drawing = ScenesThere(program.task, other, settings)
    return sequential_verdict(
        program, scenario, other, settings, drawing.grow, lambda here, alpha: compare_scenes(program.name, here, drawing, settings, alpha)
    )


class ScenesThere:
    """The answers of the other implementation: its error, or the scenes that it has given so far."""

    def __init__(self, task: Task, other: External, settings: DiffSettings) -> None:
        self.task, self.other, self.settings = task, other, settings
        self.deadline = time.monotonic() + settings.seconds
        self.scenes: list[SceneRecord] = []
        self.refused: Refused | None = None
        self.never = False
        self.asked = 0

    def grow(self, wanted: int) -> bool:
        """Draw until there are so many scenes, or the time is over; whether there are more than before."""
        before = len(self.scenes)
        while len(self.scenes) < wanted and not (self.refused or self.never) and (not self.scenes or time.monotonic() < self.deadline):
            count = min(wanted - len(self.scenes), AT_ONCE)
            self.asked += 1
            try:
                drawn = self.other.scenes(self.task, count, seed=self.settings.seed + self.asked, attempts=self.settings.attempts)
                self.scenes += drawn
            except Refused as refused:
                self.refused = refused
            except NeverAccepted:
                self.never = True
        return len(self.scenes) > before


def in_words(scenario: Scenario, settings: DiffSettings) -> list[str]:
    """The features that have no JSON form here, or print such values, if there is a scene: how an implementation prints them is its own matter."""
    try:
        scene = scenario.sample(settings.seed, max_attempts=settings.attempts).to_json()
    except AttemptsExhausted:
        return []
    return [name for name, value in leaves(scene) if (isinstance(value, dict) and value.keys() == {"repr"}) or PRINTED.search(str(value))]


def rename_view_distance(scenes: Sequence[SceneRecord], scenario: Scenario) -> Sequence[SceneRecord]:
    """The scenes with the name that the view distance has here, which others call `viewDistance` (reading `view-distance`)."""
    distance = view_distance(scenario.readings)
    if distance == "viewDistance":
        return scenes

    def renamed(thing: Mapping[str, Mapping[str, object]]) -> Mapping[str, object]:
        given = thing.get("properties", {})
        own = {distance if name == "viewDistance" else name: v for name, v in given.items()}
        return thing if distance in given else {**thing, "properties": own}

    return [{**scene, "objects": list(map(renamed, scene["objects"]))} for scene in scenes]  # type: ignore[call-overload]


def compare_scenes(name: str, scenario: Scenario | ProgramError, drawing: ScenesThere, settings: DiffSettings, alpha: float) -> ProgramVerdict:
    """Compare the other implementation's answers with the program here."""
    refused = drawing.refused
    if isinstance(scenario, ProgramError):
        return of_errors(name, scenario, refused)
    if refused is not None:
        error = error_of(scenario, settings)
        if error is not None:
            return of_errors(name, error, refused)
        return ProgramVerdict(name, "differ", "error", f"{refused.when} there, and a program here: {refused.message}", math.inf)
    try:
        if not drawing.scenes:
            return of_verdict(name, verdict_on_none(scenario, alpha, settings.detect_tv, settings.seed, "", settings.attempts), "acceptance")
        first = dict(leaves(drawing.scenes[0]))
        ignore = [feature for feature in (*PRUNED, *settings.ignore, *in_words(scenario, settings)) if any(map(feature_matcher(feature), first))]
        scenes = rename_view_distance(drawing.scenes, scenario)
        verdict = judge_samples(scenes, scenario, alpha=alpha, detect_tv=settings.detect_tv, seed=settings.seed, ignore=ignore)
        return of_verdict(name, verdict, "distribution")
    except ProgramError as error:  # in some of the runs only
        return of_errors(name, error, refused)
    except AttemptsExhausted as none:
        if not drawing.scenes:
            return ProgramVerdict(name, "agree", "acceptance", "no run is accepted")
        return ProgramVerdict(name, "inconclusive", "acceptance", f"here no scene was found: {none.message}")
    except UsageError as rare:
        if drawing.scenes:
            raise
        return ProgramVerdict(name, "inconclusive", "acceptance", rare.message)


def error_of(scenario: Scenario, settings: DiffSettings) -> ProgramError | None:
    """The error that the first scene of a program ends with, though it runs; such as that it has no ego before it is simulated."""
    try:
        scenario.sample(settings.seed, max_attempts=settings.attempts)
    except AttemptsExhausted:
        return None
    except ProgramError as error:
        return error
    return None


# Acceptance


def in_acceptance(program: AskedProgram, scenario: Scenario, other: External, settings: DiffSettings) -> ProgramVerdict:
    """How many attempts scenes take."""
    drawing = ScenesThere(replace(program.task, prune=False), other, settings)

    def beside(here: Scenario | ProgramError, alpha: float) -> ProgramVerdict:
        if isinstance(here, ProgramError) or drawing.refused is not None or not drawing.scenes:
            return ProgramVerdict(program.name, "inconclusive", "acceptance", "without pruning, there is no scene")
        theirs = [{"attempts": scene.get("attempts")} for scene in drawing.scenes]
        verdict = compare(theirs, AttemptsOf(here), alpha=alpha, detect_tv=settings.detect_tv, seeds=(settings.seed, settings.seed))
        return of_verdict(program.name, verdict, "acceptance")

    return sequential_verdict(program, scenario, other, settings, drawing.grow, beside)


class AttemptsOf:
    """The numbers of attempts at the scenes of a scenario, and nothing else of them."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0) -> Iterator[SceneRecord]:
        """Return the attempts of scenes `start` to `start + n - 1`."""
        return ({"attempts": scene.attempts} for scene in self.scenario.sample_many(n, seed, start=start))
