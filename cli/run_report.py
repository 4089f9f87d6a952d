"""The report after a run: attempts per scene, the requirements that rejected most, soft requirements that held too rarely."""

from __future__ import annotations

import math
import os
import time
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from scipy.special import bdtr

from ..data.scene import in_json
from ..inference.rejection import acceptance
from ..inference.result import LEVEL, Probability, backend_report
from ..simulators.loop import OF_SIMULATOR
from .error_messages import WORST, source_line
from .output_paths import write

if TYPE_CHECKING:
    from ..sampling.batch_sampler import Portion
    from ..sampling.scene_sampler import Drawing, DrawnScene, Softness
    from ..semantics.machine.outcome import Requirement
    from ..semantics.syntax.nodes import Span

LONGEST = 60
BY_CHANCE = 1e-3
"""That a soft requirement held as seldom as it did is told if this is the probability, or less."""


@dataclass
class Tally:
    """The statistics of the scenes of a run so far."""

    scenes: int = 0
    attempts: int = 0
    stuck: Counter[Requirement] = field(default_factory=Counter)
    soft: dict[Span, Softness] = field(default_factory=dict)
    left: int = 0
    doubtful: int = 0

    def add(self, drawn: DrawnScene) -> None:
        """Add one scene to the tally."""
        self.scenes += 1
        self.attempts += drawn.attempts
        self.stuck.update(drawn.stuck)
        self._look(drawn.soft)

    def add_portion(self, portion: Portion) -> None:
        self.scenes += len(portion.attempts)
        self.attempts += int(portion.attempts.sum())
        self.stuck.update(portion.stuck)
        self.left += portion.left
        self.doubtful += portion.doubtful
        self._look(portion.soft)

    def _look(self, softnesses: Iterable[Softness]) -> None:
        for softness in softnesses:
            before = self.soft.get(softness.span)
            self.soft[softness.span] = softness if before is None else before.plus(softness)


def processor_seconds() -> float:
    """Of this process and of those that it waited for, so far."""
    return time.process_time() + sum(os.times()[2:4])


def write_report(path: str, drawing: Drawing, tally: Tally, backend: str, earlier: int, seconds: float | None) -> None:
    """Write what was drawn by rejection, as JSON; `earlier` scenes were there before. Raises `UsageError`."""
    warnings = [f"{earlier:,} scenes were there already, and are not counted"] if earlier else []
    scenes, share = tally.scenes, drawing.scenario.share
    found = acceptance(scenes, tally.attempts)
    found = found._replace(estimate=found.estimate * share, low=found.low * share, high=found.high * share)
    if drawing.scenario.in_parts or drawing.throws_coins_for_scenes:
        found = Probability(math.nan, 0.0, 1.0, LEVEL)
        why = "independent parts are drawn apart" if drawing.scenario.in_parts else "coins are thrown once for a scene"
        warnings.append(f"{why}: the attempts do not tell how often a run is accepted")
    write(path, in_json(backend_report(backend, scenes, tally.attempts, found, scenes, scenes, 1.0, seconds, warnings), indent=1) + "\n")


def summary(tally: Tally, seed: int, seconds: float, texts: Mapping[str, str], backend: Iterable[str]) -> list[str]:
    """The lines that follow a run; `backend` says who drew the scenes."""
    if not tally.scenes:
        return []
    scenes = "1 scene" if tally.scenes == 1 else f"{tally.scenes:,} scenes"
    number = tally.attempts / tally.scenes
    mean = f"{number:,.0f}" if number >= 1000 else f"{number:.3g}"
    each = f", {mean} {'attempt' if mean == '1' else 'attempts'} per scene" if tally.scenes > 1 else ""
    attempts = "1 attempt" if tally.attempts == 1 else f"{tally.attempts:,} attempts"
    lines = [f"{scenes} of seed {seed} in {attempts}{each}, {seconds:.1f} s", *backend]
    if tally.stuck:
        lines += requirement_lines(tally.stuck.most_common(), texts, limit=WORST)
    lines += soft_lines(tally.soft.values(), texts)
    return lines


class Rejecting(NamedTuple):
    """Requirements that stand at one place: how often they rejected, and the one of them that did so most, of how many."""

    often: int
    text: str
    span: Span
    among: int


def rejecting_requirements(stuck: Iterable[tuple[Requirement, int]]) -> list[Rejecting]:
    """The requirements that rejected, those of one place together, those that rejected most first."""
    groups: dict[tuple[str, Span, str], Counter[str]] = {}
    for requirement, count in stuck:
        apart = requirement.text if requirement.kind == OF_SIMULATOR else ""
        groups.setdefault((requirement.kind, requirement.span, apart), Counter())[requirement.text] += count
    found = [Rejecting(group.total(), group.most_common(1)[0][0], span, len(group)) for (_, span, _), group in groups.items()]
    return sorted(found, key=lambda one: -one.often)


def requirement_lines(stuck: Iterable[tuple[Requirement, int]], texts: Mapping[str, str], *, limit: int) -> list[str]:
    """The requirements that rejected most, each with its share of the rejections and its place; those of one place together."""
    ordered = rejecting_requirements(stuck)
    total = sum(one.often for one in ordered)
    lines = [f"requirements that rejected most, of {total:,} stuck attempts:" if total > 1 else "the requirement that rejected the stuck attempt:"]
    for one in ordered[:limit]:
        others = f" (and {one.among - 1:,} like it)" if one.among > 1 else ""
        lines.append(f"{one.often:>9,}  {one.often / total:>4.0%}  {one.text}{others}")
        if one.span.line:
            lines.append(f"{'':17}{one.span.file}:{one.span.line}: {shorten_source_line(source_line(one.span, texts) or '')}".rstrip(": "))
    if len(ordered) > limit:
        rest = sum(one.often for one in ordered[limit:])
        lines.append(f"{rest:>9,}  {rest / total:>4.0%}  {len(ordered) - limit} others")
    return lines


def soft_lines(softnesses: Iterable[Softness], texts: Mapping[str, str]) -> list[str]:
    """A note for every soft requirement that held in so few scenes as its probability alone would seldom give."""
    lines: list[str] = []
    for soft in sorted(softnesses, key=lambda s: s.span):
        if not soft.known or bdtr(soft.held, soft.known, float(soft.probability)) > BY_CHANCE:
            continue
        source = shorten_source_line(source_line(soft.span, texts) or "require")
        lines += [
            f"note: {source}  at {soft.span.file}:{soft.span.line}",
            f"      held in {soft.held:,} of {soft.known:,} scenes ({soft.held / soft.known:.1%}), less often than {float(soft.probability):.4g}: "
            "under the reading soft=run",
            "      its coin is thrown in every attempt, stuck ones included; `scenic-ref readings soft` explains this",
        ]
    return lines


def shorten_source_line(line: str) -> str:
    """A source line, stripped and not too long."""
    text = line.strip()
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."
