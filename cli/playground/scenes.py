"""Scenes for the page: one after the other as they are drawn, with what rejected the attempts so far, also where no scene is found in time."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace

from ...api.diagnostics import of_warning, warnings_about
from ...data.scene import Scene
from ...inference.batch import Block
from ...inference.batch.jobs.worker_pools import jobs
from ...inference.comparison.relations import table_of
from ...inference.comparison.scene_columns import ABSENT, OTHERWISE, leaves, unit_of
from ...inference.enumeration import content_of_scene
from ...inference.rejection import DEFAULT_ATTEMPTS
from ...interpreter.runtime.program_run import Witness
from ...semantics.kernel.errors import AttemptsExhausted, ScenicError
from ...semantics.kernel.outcome import Requirement
from ...semantics.readings import READINGS
from ...semantics.syntax import dynamics as d
from ...simulators.worlds.driving import notes
from ..drawing import Drawing, Softness, drawing_of, listen
from .asked import PlayRequest
from .shown import diagnostic_shown, exhausted_of, scene_shown, tally_shown
from .texts import Json, cut_text

FIRST, GROWTH = 100, 5
"""Attempts after which what rejected them is told the first time; then after so many times as many."""
PATIENCE = 1.0
"""Seconds after which many runs at a time are tried."""
SURVEYED = 6
"""Scenes by which readings are compared."""
MOST_TOLD = 3
"""Features of which it is told that they differ."""
MOST_PRINTED = 100
MOST_FEATURES, LONGEST_NAME = 2_000, 300
DYNAMIC = (
    d.BehaviorDefinition, d.MonitorDefinition, d.ScenarioDefinition, d.RequireAlways, d.RequireEventually, d.RequireMonitor, d.TerminateWhen,
    d.TerminateAfter, d.Record,
)  # fmt: skip
"""The statements that are about time."""

Send = Callable[[Json], None]


class Found:
    """What was found so far of the scenes of a request, and what the attempts at them met."""

    def __init__(self, coins: bool) -> None:
        self.coins = coins
        self.scenes: list[Scene] = []
        self.stuck: Counter[Requirement] = Counter()
        self.attempts = 0
        self.soft: dict[object, Softness] = {}

    def add(self, scene: Scene, stuck: Counter[Requirement]) -> None:
        """One more scene."""
        self.scenes.append(scene)
        self.stuck.update(stuck)
        self.attempts += scene.attempts

    def look(self, softnesses: tuple[Softness, ...]) -> None:
        """Soft requirements of one more scene."""
        for one in softnesses:
            self.soft[one.span] = self.soft[one.span].plus(one) if one.span in self.soft else one

    def told(self, more: Counter[Requirement] | None = None) -> Json:
        """The statistics; `more` rejected attempts at a scene that is not found yet."""
        more = more or Counter()
        return tally_shown(len(self.scenes), self.attempts + more.total(), (self.stuck + more).items(), self.soft.values(), coins=self.coins)


def draw_scenes(asked: PlayRequest, send: Send) -> None:
    """Tell what is wrong with the program, then each scene, what rejected, and which features the scenes have. Raises the program's error."""
    drawing = drawing_of(asked.source)
    scenario = drawing.scenario
    send({
        "kind": "checked", "diagnostics": [diagnostic_shown(of_warning(w)) for w in warnings_about(scenario)],
        "notes": list(map(cut_text, notes(scenario.settings.library, scenario.program, scenario.params))),
        "dynamic": any(isinstance(s, DYNAMIC) for s in scenario.program.statements),
    })  # fmt: skip
    printed: list[str] = []
    found = Found(drawing.throws_coins_for_scenes)
    try:
        for scene, stuck in scenes_of(drawing, asked, lambda more: send(found.told(more)), printed):
            found.add(scene, stuck)
            send({"kind": "scene", **scene_shown(scene)})
            if drawing.has_soft_requirements:
                found.look(drawing.softness(asked.seed, scene.index, scene.attempts))
            if printed:
                send({"kind": "printed", "scene": scene.index, "lines": [cut_text(line) for line in printed[:MOST_PRINTED]], "count": len(printed)})
    except ScenicError as error:
        if printed:
            send({"kind": "printed", "scene": None, "lines": [cut_text(line) for line in printed[:MOST_PRINTED]], "count": len(printed)})
        if found.scenes or not isinstance(error, AttemptsExhausted) or error.attempts >= FIRST:
            send(found.told(Counter(dict(exhausted_of(error)))))
        raise
    send(found.told())
    send({"kind": "features", "features": features_in(found.scenes), "names": names_in(found.scenes)})


def features_in(scenes: list[Scene]) -> list[Json]:
    """The features of the scenes and the relations between their objects, by name, and whether they differ from scene to scene."""
    columns = [c for c in table_of(scenes).columns.values() if OTHERWISE not in c.name and len(c.name) <= LONGEST_NAME]
    return [{"name": c.name, "unit": unit_of(c.name), "varies": len(set(map(str, c.values))) > 1} for c in columns[:MOST_FEATURES]]


def names_in(scenes: list[Scene]) -> dict[str, str]:
    """What the objects are called, by number: their names, else their classes."""
    named: dict[str, str] = {}
    for scene in scenes:
        for o in scene.objects[:MOST_FEATURES]:
            named.setdefault(str(o.id), cut_text(o.name or ("ego" if o.id == scene.ego_id else o.class_name), 60))
    return named


def scenes_of(
    drawing: Drawing, asked: PlayRequest, tell: Callable[[Counter[Requirement]], None], printed: list[str] | None = None
) -> Iterator[tuple[Scene, Counter[Requirement]]]:  # fmt: skip
    """The scenes of a request with what rejected on the way to each; `tell` hears of what rejected on the way to the next one.

    The interpreter draws them, until one needs long: then they are drawn many at a time, if the program can be made a graph.
    """
    scenario = drawing.scenario
    printed = [] if printed is None else printed
    drawing.rehearse(printed)
    printed.clear()

    def listening(attempt: int) -> Witness:
        printed.clear()
        return lambda outcome, drawn: listen(outcome, printed)

    begun = time.monotonic()
    most, index, stop = FIRST, asked.start, asked.start + asked.count
    together = True
    while index < stop:
        try:
            sampled = scenario.sampled(asked.seed, index, max_attempts=most, witnessed=listening if drawing.prints else None)
        except AttemptsExhausted as error:
            if error.attempts < most or most >= DEFAULT_ATTEMPTS:
                raise
            tell(Counter(dict(exhausted_of(error))))
            most = min(most * GROWTH, DEFAULT_ATTEMPTS)
        else:
            yield sampled.scene, sampled.stuck
            most, index = FIRST, index + 1
        if together and index < stop and time.monotonic() - begun > PATIENCE:
            together = False
            if scenario.impossible is not None:
                raise scenario.impossible
            if scenario.batch is not None:
                yield from many_scenes(drawing, asked, index, tell)
                return


def many_scenes(
    drawing: Drawing, asked: PlayRequest, index: int, tell: Callable[[Counter[Requirement]], None]
) -> Iterator[tuple[Scene, Counter[Requirement]]]:  # fmt: skip
    """The scenes from number `index`, many runs at a time. Raises the program's error."""
    batch, stop = drawing.scenario.batch, asked.start + asked.count
    assert batch is not None
    most = FIRST * GROWTH
    while index < stop:
        try:
            for block in jobs(batch, stop - index, asked.seed, index, most):
                yield from scenes_in(drawing, block, asked.seed)
                index = block.start + len(block.attempts)
        except AttemptsExhausted as error:
            if error.attempts < most or most >= DEFAULT_ATTEMPTS:
                raise
            tell(Counter(dict(exhausted_of(error))))
            most = min(most * GROWTH, DEFAULT_ATTEMPTS)


def scenes_in(drawing: Drawing, block: Block, seed: int) -> Iterator[tuple[Scene, Counter[Requirement]]]:
    """The scenes of a block; what rejected is known of all of them together."""
    stuck = block.stuck
    for number, attempts in enumerate(block.attempts):
        scene = drawing.again(seed, block.start + number, int(attempts) + 1)
        assert scene is not None
        yield scene, stuck
        stuck = Counter()


def survey(asked: PlayRequest, send: Send) -> None:
    """For each reading with another answer: which of the first scenes it changes, and what of them, or the error that it leads to.

    Raises the program's error.
    """
    base = first_scenes(asked, {})
    chosen = drawing_of(asked.source).scenario.readings
    for reading in READINGS.values():
        for answer in reading.alternatives:
            if answer == chosen[reading.id]:
                continue
            found: Json = {"kind": "survey", "reading": reading.id, "answer": answer}
            try:
                pairs = list(zip(base, first_scenes(asked, {reading.id: answer}), strict=True))
                changed = [(one, other) for one, other in pairs if content_of_scene(one) != content_of_scene(other) or one.attempts != other.attempts]
                what = list(dict.fromkeys(name for pair in changed for name in different(*pair)))[:MOST_TOLD]
                send(found | {"changed": [one.index for one, _ in changed], "of": len(pairs), "what": [cut_text(name, 100) for name in what]})
            except ScenicError as error:
                send(found | {"error": cut_text(str(error))})


def different(one: Scene, other: Scene) -> Iterator[str]:
    """The features in which two scenes differ; `attempts` last."""
    first, second = (dict(leaves(scene.to_json())) for scene in (one, other))
    names = [name for name in dict.fromkeys([*first, *second]) if first.get(name, ABSENT) != second.get(name, ABSENT)]
    yield from (name.replace(".properties.", ".") for name in sorted(names, key=lambda name: name == "attempts"))


def first_scenes(asked: PlayRequest, readings: dict[str, str]) -> list[Scene]:
    """The first scenes of a request under other readings. Raises the program's error."""
    source = replace(asked.source, readings=tuple((dict(asked.source.readings) | readings).items()))
    few = replace(asked, source=source, count=min(asked.count, SURVEYED))
    return [scene for scene, _ in scenes_of(Drawing(source.load()), few, lambda more: None)]
