"""Why an implementation fails a vector: the readings under which this reference fails it alike."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import replace

from ...semantics.readings import select
from ..implementations.protocol import Refused, Unsupported
from ..implementations.reference import Ourselves
from ..vector import ConformanceVector

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
SAME = 1e-6


def explain_failure(vector: ConformanceVector, dialect: str, reason: str, profile: Mapping[str, str]) -> Mapping[str, str] | None:
    """The fewest readings of a profile under which this reference fails the vector for the same reason; None if there are none.

    `reason` is that of the implementation's verdict. Readings are left out one by one, so that none of those that stay can be.
    """
    paper = select()
    chosen = {id: alternative for id, alternative in profile.items() if alternative != paper[id] and id not in vector.readings}
    if not fails_alike(vector, dialect, reason, chosen):
        return None
    return fewest(chosen, lambda fewer: fails_alike(vector, dialect, reason, fewer))


def fewest(readings: Mapping[str, str], holds: Callable[[Mapping[str, str]], bool]) -> Mapping[str, str]:
    """Readings of which none can be left out, from more for which it holds."""
    chosen = dict(readings)
    for id in readings:
        fewer = {other: alternative for other, alternative in chosen.items() if other != id}
        if holds(fewer):
            chosen = fewer
    return chosen


def fails_alike(vector: ConformanceVector, dialect: str, reason: str, readings: Mapping[str, str]) -> bool:
    """Whether this reference fails the vector for that reason, under these readings besides those of the vector."""
    task = vector.task(dialect)
    try:
        verdict = vector.matcher.match(Ourselves(), replace(task, readings={**task.readings, **readings}))
    except (Refused, Unsupported):
        return False
    return verdict.status == "failed" and is_same_reason(verdict.reason, reason)


def is_same_reason(ours: str, theirs: str) -> bool:
    """Whether two reasons say the same: the same kind of failure, and the same values where they tell them."""
    mine, other = NUMBER.split(ours), NUMBER.split(theirs)
    if "refused" in (ours.partition(" ")[0], theirs.partition(" ")[0]):  # the words of errors differ
        return ours.startswith("refused") and theirs.startswith("refused") and ("instead" in ours) == ("instead" in theirs)
    for kind in ("contradict", "which lies outside", "which is none of", "is not one of"):  # the samples differ
        if kind in ours or kind in theirs:
            return kind in theirs and kind in ours and ours.partition(" is ")[0].partition(kind)[0] == theirs.partition(" is ")[0].partition(kind)[0]
    numbers = zip(NUMBER.findall(ours), NUMBER.findall(theirs))
    return mine == other and all(math.isclose(float(a), float(b), rel_tol=SAME, abs_tol=SAME) for a, b in numbers)
