"""Requests of the page: one piece of work on one program, as JSON that is checked before anything is done."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, get_args

from ..interpreter.runtime.limits import Limits
from ..sampling.program_source import Source
from ..semantics.store.errors import UsageError

MOST_BYTES = 2_000_000
"""The longest request."""
LONGEST_NAME = 64
MOST_SEED = 2**53
MOST_SCENES, MOST_VALUES, MOST_STEPS = 100, 20_000, 10_000

Work = Literal["scenes", "histogram", "law", "trace", "survey", "simulate", "picture"]
WORKS: tuple[Work, ...] = get_args(Work)


@dataclass(frozen=True, slots=True)
class PlayRequest:
    """A piece of work for the page `page`, of which only the latest in each `slot` is wanted; what it does with the numbers depends on the work."""

    page: str
    slot: str
    work: Work
    source: Source
    seed: int
    start: int
    count: int
    attempt: int | None
    feature: str
    expression: str
    simulator: str
    steps: int
    timestep: float | None
    form: str
    seconds: float | None

    @property
    def limits(self) -> Limits:
        """The limits of the program."""
        return self.source.limits


def request_of(body: bytes, source: Source) -> PlayRequest:
    """The request that the page has sent, about its program with the options of `source`. Raises `UsageError` for anything else."""
    try:
        asked = json.loads(body)
    except (ValueError, RecursionError):
        raise UsageError("this is no JSON") from None
    if not isinstance(asked, dict):
        raise UsageError("a request is an object")
    work: Work | None = next((one for one in WORKS if one == asked.get("work")), None)
    if work is None:
        raise UsageError(f"there is no work {asked.get('work')!r:.40}")
    program, readings = asked.get("program"), asked.get("readings", {})
    if not isinstance(program, str):
        raise UsageError("`program` is a text")
    if not isinstance(readings, dict) or not all(isinstance(v, str) for v in readings.values()) or len(readings) > 1000:
        raise UsageError("`readings` maps the names of readings to alternatives")
    chosen = replace(source, text=program, readings=tuple((source_readings(source) | readings).items()))
    attempt, timestep = asked.get("attempt"), asked.get("timestep")
    if timestep is not None and not (isinstance(timestep, (int, float)) and not isinstance(timestep, bool) and 0.001 <= timestep <= 1000):
        raise UsageError("`timestep` is a number of seconds from 0.001 to 1000")
    return PlayRequest(
        text_parameter(asked, "page"), text_parameter(asked, "slot"), work, chosen, integer_parameter(asked, "seed", -MOST_SEED, MOST_SEED),
        integer_parameter(asked, "start", 0, MOST_SEED),
        integer_parameter(asked, "count", 1, MOST_VALUES if work == "histogram" else MOST_SCENES, 1),
        None if attempt is None else integer_parameter(asked, "attempt", 1, MOST_SEED), text_parameter(asked, "feature", 1000),
        text_parameter(asked, "expression", 10_000),
        text_parameter(asked, "simulator"), integer_parameter(asked, "steps", 0, MOST_STEPS), timestep, text_parameter(asked, "form"),
        source.limits.seconds,
    )  # fmt: skip


def source_readings(source: Source) -> dict[str, str]:
    """The readings that the command line chose."""
    return dict(source.readings)


def text_parameter(asked: Mapping[str, object], name: str, longest: int = LONGEST_NAME) -> str:
    """A text of the request, "" by default. Raises `UsageError`."""
    found = asked.get(name, "")
    if not isinstance(found, str) or len(found) > longest:
        raise UsageError(f"`{name}` is a text of at most {longest:,} characters")
    return found


def integer_parameter(asked: Mapping[str, object], name: str, least: int, most: int, otherwise: int = 0) -> int:
    """A whole number of the request. Raises `UsageError`."""
    found = asked.get(name, otherwise)
    if type(found) is not int or not least <= found <= most:
        raise UsageError(f"`{name}` is a whole number from {least:,} to {most:,}")
    return found
