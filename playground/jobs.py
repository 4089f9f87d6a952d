"""The jobs of the page: scenes as they are drawn, histograms of many scenes, traces and simulations."""

from __future__ import annotations

import base64
import json
import math
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from ..api import Scenario
from ..api.diagnostics import of_error, of_warning, warnings_about
from ..api.scene_expressions import NAME, expression_of, law_of, value_in_final_state
from ..cli.replay_page import network_of
from ..cli.simulation_run import when
from ..cli.trace_output import WhichRun, page_of, trace_attempt, traced_simulation
from ..data.scene import Scene, in_json, json_value
from ..data.simulation import to_line
from ..inference.batch import Block
from ..inference.batch.jobs.worker_pools import jobs
from ..inference.comparison.relations import add_relations, table_of
from ..inference.comparison.scene_columns import ABSENT, OTHERWISE, leaves, unit_of
from ..inference.enumeration import Enumeration, content_of_scene
from ..inference.rejection import DEFAULT_ATTEMPTS
from ..interpreter.runtime.program_run import Accepted, Witness
from ..pictures.replay_pages import land_below, map_below, run_shown
from ..pictures.scene_figures import check_format, picture
from ..sampling.scene_sampler import Drawing, Softness, drawing_of, listen
from ..semantics.machine.outcome import Requirement
from ..semantics.machine.values import unwrap
from ..semantics.readings import READINGS
from ..semantics.store.errors import AttemptsExhausted, RunsExhausted, ScenicError, UsageError
from ..semantics.syntax import dynamics as d
from ..simulators import SIMULATORS, by_name
from ..simulators.loop import Failed
from ..simulators.protocol import Simulator
from ..simulators.worlds.driving import notes
from .json_views import Json, cut_text, cut_value, diagnostic_shown, exhausted_of, requirements_shown, scene_shown, tally_shown
from .request import PlayRequest

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
    """The scenes found so far for a request, and the requirements that rejected attempts at them."""

    def __init__(self, coins: bool) -> None:
        self.coins = coins
        self.scenes: list[Scene] = []
        self.stuck: Counter[Requirement] = Counter()
        self.attempts = 0
        self.soft: dict[object, Softness] = {}

    def add(self, scene: Scene, stuck: Counter[Requirement]) -> None:
        """Add one scene to those found."""
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
    """Return the names of the objects by number; an object without a name has the name of its class."""
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


MOST_RUNS = 20_000
"""Runs of an enumeration."""
MOST_ATTEMPTS = 40
"""Of the law of attempts, which never ends."""
MOST_LISTED = 400
"""Values of an exact law that the page is told of, the likeliest first."""
EVERY = 0.25
"""Seconds between two portions of values."""


def draw_values(asked: PlayRequest, send: Send) -> None:
    """Send the values of what was asked for in many scenes, in portions. Raises the program's error, and that of the expression."""
    scenario = drawing_of(asked.source).scenario
    values = of_expression(scenario, asked) if asked.expression else of_feature(scenario, asked)
    portion: list[object] = []
    told = time.monotonic()
    for value in values:
        portion.append(value)
        if time.monotonic() - told > EVERY:
            send({"kind": "values", "values": portion})
            portion, told = [], time.monotonic()
    send({"kind": "values", "values": portion})


def of_feature(scenario: Scenario, asked: PlayRequest) -> Iterator[object]:
    """The values of a feature, or of a relation between objects, by name; None in a scene that has none of that name."""
    scenario.rehearse()
    for table in scenario.feature_tables(asked.count, asked.seed, start=asked.start):
        column = add_relations(table).columns.get(asked.feature)
        for row in range(table.n):
            yield None if column is None else shown_value(column.values[row])


def of_expression(scenario: Scenario, asked: PlayRequest) -> Iterator[object]:
    """The values of an expression where the runs of the scenes have ended."""
    expression = expression_of(asked.expression, asked.source.dialect)
    for index, attempts in accepted_attempts(scenario, asked):
        ended = scenario.last_run(asked.seed, index, attempts)
        assert isinstance(ended, Accepted)
        yield shown_value(json_value(unwrap(value_in_final_state(expression, ended.state))[0]))


def accepted_attempts(scenario: Scenario, asked: PlayRequest) -> Iterator[tuple[int, int]]:
    """The scenes of a request by number, each with the attempt that gave it, counted from 1. Raises the program's error."""
    scenario.rehearse()
    if scenario.impossible is not None:
        raise scenario.impossible
    if scenario.batch is None:
        yield from ((index, scenario.sample(asked.seed, index).attempts) for index in range(asked.start, asked.start + asked.count))
        return
    for block in jobs(scenario.batch, asked.count, asked.seed, asked.start, DEFAULT_ATTEMPTS):
        yield from ((block.start + k, int(attempt) + 1) for k, attempt in enumerate(block.attempts))


def shown_value(value: object) -> object:
    """A value of the scene format, or of a column, as a number, a truth value, a text, or None."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, (int, float)):
        number = float(value) if abs(value) < 2**1000 else math.inf
        return number if math.isfinite(number) else str(value)[:40]
    if isinstance(value, dict) and set(value) == {"repr"}:
        value = str(value["repr"])
    return cut_text(value if isinstance(value, str) else in_json(value, allow_nan=True), 200)


def exact_law(asked: PlayRequest, send: Send) -> None:
    """Send the exact law of what was asked for, or why there is none. Raises the program's error, and that of the expression."""
    scenario = drawing_of(asked.source).scenario
    try:
        if asked.expression:
            found = law_of(scenario, expression_of(asked.expression, asked.source.dialect), max_runs=MOST_RUNS)
        else:
            found = scenario.enumerate(max_runs=MOST_RUNS)
    except (UsageError, RunsExhausted) as problem:
        send({"kind": "nolaw", "why": cut_text(problem.message)})
        return
    ranked = sorted(law_by_value(found, asked), key=lambda item: -item[1])
    send({
        "kind": "law", "acceptance": str(found.acceptance), "approximately": float(found.acceptance), "runs": found.runs, "values": len(ranked),
        "law": [{"value": value, "probability": cut_text(str(p), 60), "approximately": float(p)} for value, p in ranked[:MOST_LISTED]],
    })  # fmt: skip


def law_by_value(found: Enumeration, asked: PlayRequest) -> list[tuple[object, Fraction]]:
    """The values of what was asked for, each with its probability."""
    if asked.feature == "attempts" and not asked.expression:
        return [(k, found.attempts_probability(k)) for k in range(1, MOST_ATTEMPTS + 1)]
    if asked.expression:
        values = [shown_value(json_value(unwrap(scene.params[NAME])[0])) for scene in found.scenes]
    else:
        column = table_of(found.scenes).columns.get(asked.feature)
        values = [None if column is None else shown_value(column.values[row]) for row in range(len(found.scenes))]
    law: dict[tuple[type, object], Fraction] = defaultdict(Fraction)  # True is no 1
    for value, (probability, _) in zip(values, found.outcomes, strict=True):
        law[type(value), value] += probability
    return [(value, probability) for (_, value), probability in law.items()]


MOST_EVENTS = 20_000
MOST_POSES = 200_000
"""Poses of a simulation on the page: objects times time steps."""
MOST_PICTURED = 36


def send_trace(asked: PlayRequest, send: Send) -> None:
    """Send every rule that fired in a run for a scene, or for a simulation. Raises `AttemptsExhausted`, `UsageError`."""
    which = WhichRun(asked.seed, asked.start, asked.attempt, DEFAULT_ATTEMPTS)
    found = traced_simulation(asked.source, which, simulator_of(asked), asked.steps) if asked.steps else trace_attempt(asked.source, which)
    texts = {asked.source.file: asked.source.text}
    events = len(found.trace.events)
    del found.trace.events[MOST_EVENTS:]
    page = page_of(found, texts)
    sources = page.pop("sources")
    assert isinstance(sources, dict)
    send({
        "kind": "trace", "scene": asked.start, "attempt": found.attempt, "count": events,
        **{name: cut_text(value, 2000) if isinstance(value, str) else value for name, value in page.items()},
        "sources": {file: text for file, text in sources.items() if file != asked.source.file},
        "error": None if found.error is None else diagnostic_shown(of_error(found.error, asked.source.file)),
    })  # fmt: skip


def simulator_of(asked: PlayRequest) -> Simulator:
    """The simulator of a request, one of those that are shipped. Raises `UsageError`."""
    if asked.simulator not in SIMULATORS:
        raise UsageError(f"there is no simulator {asked.simulator}")
    return by_name(asked.simulator, asked.timestep)


def simulate(asked: PlayRequest, send: Send) -> None:
    """Send simulations as pages play them, and what rejected others. Raises the errors of the program and the simulator."""
    drawing = drawing_of(asked.source)
    scenario = drawing.scenario
    stuck: Counter[Failed] = Counter()
    attempts = found = 0

    def count(how: Failed) -> None:
        nonlocal attempts
        attempts += 1
        stuck[how] += 1

    try:
        for index in range(asked.start, asked.start + asked.count):
            run = scenario.simulate(simulator_of(asked), asked.steps, asked.seed, index, max_attempts=DEFAULT_ATTEMPTS, on_failed=count)
            attempts, found = attempts + 1, found + 1
            simulation = run.simulation
            if len(simulation.moments) * max(1, len(simulation.moments[-1].objects)) > MOST_POSES:
                raise UsageError("this simulation is too long to be shown here", hint="take fewer time steps")
            written = json.loads(to_line(simulation, run.attempts))
            land = land_below(simulation.scene, written)
            network = network_of(scenario) if land is None else None
            ground = land or {"areas": []} if network is None else map_below(network, [written])
            records = {cut_text(name, 60): cut_value(values) for name, values in written.get("records", {}).items()}
            send({"kind": "run", "attempts": run.attempts, "ground": ground, "records": records, "run": cut_run(run_shown(written))})
    finally:
        rejected = when(stuck)
        send({"kind": "simulated", "runs": found, "attempts": attempts, "stuck": requirements_shown(rejected.items())})


def cut_run(run: dict[str, object]) -> dict[str, object]:
    """A simulation whose texts are not too long."""
    steps = run["steps"]
    assert isinstance(steps, list)
    kept = [
        {
            "objects": [
                {name: cut_value(value) for name, value in pose.items() if name in ("id", "position", "heading", "speed", "width", "length")}
                for pose in step["objects"]
            ],
            "actions": cut_value(step["actions"]), "events": cut_value(step["events"]), "doing": cut_value(step["doing"]), "step": step["step"],
        }
        for step in steps
    ]  # fmt: skip
    return {**{name: cut_value(value) for name, value in run.items() if name not in ("steps", "objects")}, "objects": run["objects"], "steps": kept}


def send_picture(asked: PlayRequest, send: Send) -> None:
    """Send the picture that `run --plot` would draw of the scenes. Raises the program's error, and `UsageError` where there is none."""
    check_format(asked.form)
    scenes = [scene for scene, _ in scenes_of(drawing_of(asked.source), asked, lambda more: None)][:MOST_PICTURED]
    data = picture(scenes, format=asked.form)
    name = f"{Path(asked.source.file).stem}.{asked.form}"
    send({"kind": "file", "name": name, "form": asked.form, "data": base64.b64encode(data).decode()})

