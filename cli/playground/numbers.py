"""Histograms for the page: the values of a feature or of an expression in many scenes, and their exact law where the program is finite."""

from __future__ import annotations

import math
import time
from collections import defaultdict
from collections.abc import Iterator
from fractions import Fraction

from ...api import Scenario
from ...api.scene_expressions import NAME, expression_of, law_of, observed
from ...data.scene import in_json, json_value
from ...inference.batch.jobs.worker_pools import jobs
from ...inference.comparison.relations import related, table_of
from ...inference.enumeration import Enumeration
from ...inference.rejection import DEFAULT_ATTEMPTS
from ...interpreter.runtime.program_run import Accepted
from ...semantics.kernel.errors import RunsExhausted, UsageError
from ...semantics.kernel.values import unwrap
from ..drawing import drawing_of
from .asked import PlayRequest
from .scenes import Send
from .texts import cut_text

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
        column = related(table).columns.get(asked.feature)
        for row in range(table.n):
            yield None if column is None else shown_value(column.values[row])


def of_expression(scenario: Scenario, asked: PlayRequest) -> Iterator[object]:
    """The values of an expression where the runs of the scenes have ended."""
    expression = expression_of(asked.expression, asked.source.dialect)
    for index, attempts in accepted_attempts(scenario, asked):
        ended = scenario.last_run(asked.seed, index, attempts)
        assert isinstance(ended, Accepted)
        yield shown_value(json_value(unwrap(observed(expression, ended.state))[0]))


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
