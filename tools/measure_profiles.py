"""Measure the profiles of the releases: which alternative of each reading does a user of the release get, by command line and by API?

    python tools/measure_profiles.py --scenic-3 PYTHON --scenic-2.1 PYTHON -o conformance/results/profiles.json

PYTHON is an interpreter that has the release. For each alternative of a reading one or two vectors are run that tell it from the
others: scenic-ref passes them under that alternative and fails them under each other one. The alternative of which one passes is that
of the release; a refusal, which may have another reason, counts only where no other vector passes. Values may differ by rounding, since
the releases have their geometry from other libraries.
`--reading ID`, which may be repeated, measures these alone and keeps the other lines of the file.
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from scenic_ref.conformance.implementations.harness_client import External
from scenic_ref.conformance.implementations.protocol import SceneRecord, SimulationRecord, Task
from scenic_ref.conformance.implementations.reference import Ourselves, World
from scenic_ref.conformance.judge import judge
from scenic_ref.conformance.matchers.values import SceneValues
from scenic_ref.conformance.vector import ConformanceVector
from scenic_ref.conformance.vector_files import load_vectors, read_file
from scenic_ref.semantics.readings import READINGS, Reading

HERE = Path(__file__).resolve().parent
ADAPTER, OWN = HERE / "release_by_its_defaults.py", HERE / "profile_vectors.toml"
SCHEMA = "scenic-ref/profiles/1"
PROFILES = ("scenic-2.1", "scenic-3")
WAYS: tuple[str, ...] = ("command line", "API")
MOST = 2
"""Vectors of one alternative that are run."""
ROUNDING, ATTEMPTS = 1e-6, 2000
DECIDED_BY_ROUNDING = ("apparent-heading-of-itself-facing-the-viewer",)
"""Vectors whose value is a half turn, which is -pi or pi by rounding in the releases."""
NOT_MEASURED = {
    "time-unit": "A time step of the recording simulator takes one second, so that both alternatives give the same. Where one takes "
    "half a second, tried by hand through the API, `simulation().currentTime` is 0, 1, 2 in both releases: `steps`.",
}
"""Readings that no program can tell apart here, and why."""
UNCHECKED = "A deviation beyond all numbers is an error. One below zero is none: `Normal(0, -1)` is `Normal(0, 1)`."
NOTES = {
    ("rejected-simulation", "scenic-2.1"): "`Simulator.simulate` of 2.1.0 tries a scene 100 times unless `maxIterations` says "
    "otherwise. The profile follows the command line, and 3.1.1, which try it once.",
    ("boolean-random", "scenic-3"): "3.1.1 evaluates all operands of the outermost `and` and `or` of a requirement. In functions that the "
    "requirement calls it is `short-circuit`, which the profile has everywhere, so that guards in functions work.",
    ("invalid-parameters", "scenic-2.1"): UNCHECKED,
    ("invalid-parameters", "scenic-3"): UNCHECKED,
}
"""What a reader of a line has to know besides."""


class Release(NamedTuple):
    """A release, run in both ways."""

    profile: str
    ways: Mapping[str, External]


class AsUsed(External):
    """A release that is asked whatever the reading: which alternative it follows is to be found out."""

    def follows(self, reading: str, alternative: str) -> bool:
        """Say that it does."""
        return True


class Brief(Ourselves):
    """This reference, with as many attempts as the releases make where nothing is said."""

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        """The scenes, of at most `ATTEMPTS` attempts each."""
        return super().scenes(task, count, seed=seed, attempts=min(attempts, ATTEMPTS))

    def simulations(
        self, task: Task, steps: int, count: int, *, seed: int, attempts: int, world: World | None = None
    ) -> Iterator[SimulationRecord]:
        """The simulations, of at most `ATTEMPTS` attempts each."""
        return super().simulations(task, steps, count, seed=seed, attempts=min(attempts, ATTEMPTS), world=world)


def telling(
    vectors: Sequence[ConformanceVector], reading: Reading, alternative: str, profile: str
) -> Iterator[ConformanceVector]:
    """The vectors that tell the alternative from the others in the dialect of that name, the best first."""
    about = [v for v in vectors if v.readings.get(reading.id) == alternative and profile in v.texts]
    candidates = [rounded(v) for v in about if fits(v, reading, profile) and v.name not in DECIDED_BY_ROUNDING]
    for vector in sorted(candidates, key=lambda v: preference(v, reading, alternative)):
        selected = {r.id: r.under(profile) for r in READINGS.values()}
        if tells(vector, reading, profile, selected) or tells(vector, reading, profile, vector.readings):
            yield vector


def fits(vector: ConformanceVector, reading: Reading, profile: str) -> bool:
    """Whether the other readings that it needs are those of the profile."""
    others = {id: alternative for id, alternative in vector.readings.items() if id != reading.id}
    return all(READINGS[id].under(profile) == alternative for id, alternative in others.items())


def rounded(vector: ConformanceVector) -> ConformanceVector:
    """The vector with a tolerance for rounding, where it is about values."""
    matcher = vector.matcher
    if not isinstance(matcher, SceneValues):
        return vector
    return replace(vector, matcher=replace(matcher, tolerance=max(matcher.tolerance, ROUNDING)))


def preference(vector: ConformanceVector, reading: Reading, alternative: str) -> tuple[bool, bool, int]:
    """What sorts first: a vector that expects no error, one named for the alternative, the smallest program."""
    named = vector.name in (f"reading-{reading.id}-{alternative}", f"profile-{reading.id}-{alternative}")
    return vector.kind == "error", not named, len(next(iter(vector.texts.values())))


def tells(vector: ConformanceVector, reading: Reading, profile: str, others: Mapping[str, str]) -> bool:
    """Whether scenic-ref, beside these other readings, passes it under its alternative alone."""
    return all(
        (judge(Brief(), under(vector, {**others, reading.id: tried}), profile).verdict.status == "passed")
        == (tried == vector.readings[reading.id])
        for tried in reading.alternatives
    )


def under(vector: ConformanceVector, readings: Mapping[str, str]) -> ConformanceVector:
    """The vector under these readings; which rules fire is left out."""
    return replace(vector, readings=readings, fires=frozenset(), avoids=frozenset())


def measured(release: Release, reading: Reading, vectors: Sequence[ConformanceVector]) -> dict[str, object]:
    """The line of a reading and a release."""
    line: dict[str, object] = {**dict.fromkeys(WAYS)}
    line |= {"ours": reading.under(release.profile), "vectors": []}
    line |= {"note": NOTES[reading.id, release.profile]} if (reading.id, release.profile) in NOTES else {}
    if reading.id in NOT_MEASURED:
        return line | {"why": NOT_MEASURED[reading.id]}
    chosen = {a: list(islice(telling(vectors, reading, a, release.profile), MOST)) for a in reading.alternatives}
    asked = [(alternative, vector) for alternative, found in chosen.items() for vector in found]
    if not asked:
        return line | {"why": "No vector in this dialect tells the alternatives apart."}
    said: dict[str, list[str]] = {}
    for way, implementation in release.ways.items():
        verdicts = [(a, v, judge(implementation, v, release.profile).verdict) for a, v in asked]
        passed = [(a, v) for a, v, verdict in verdicts if verdict.status == "passed"]
        found = {a for a, v in passed if v.kind != "error"} or {a for a, _ in passed}
        line[way] = found.pop() if len(found) == 1 else None
        if line[way] is None:
            told = "; ".join(f"{v.name}: {verdict.status}{': ' * bool(verdict.reason)}{verdict.reason}" for _, v, verdict in verdicts)
            said.setdefault(told, []).append(way)
    line["vectors"] = [vector.name for _, vector in asked]
    return line | ({"why": " ".join(f"By {' and '.join(ways)}: {told}." for told, ways in said.items())} if said else {})


def text_of(versions: Mapping[str, str], entries: Mapping[str, Mapping[str, object]]) -> str:
    """The file: JSON with a line for each reading and release."""
    head = {"schema": SCHEMA, "date": datetime.datetime.now(datetime.UTC).date().isoformat(), "releases": versions}
    rows = []
    for id, entry in entries.items():
        inner = ",\n".join(f"    {json.dumps(profile)}: {json.dumps(line, ensure_ascii=False)}" for profile, line in entry.items())
        rows.append(f"  {json.dumps(id)}: {{\n{inner}\n  }}")
    return json.dumps(head)[:-1] + ', "readings": {\n' + ",\n".join(rows) + "\n}}\n"


def main() -> None:
    """Measure, and write the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for profile in PROFILES:
        parser.add_argument(f"--{profile}", metavar="PYTHON", required=True, dest=profile)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--reading", action="append", default=[], metavar="ID")
    given = vars(parser.parse_args())
    output, wanted = given["output"], given["reading"]
    releases = [
        Release(profile, {way: AsUsed([given[profile], str(ADAPTER), way.replace(" ", "-").lower()]) for way in WAYS})
        for profile in PROFILES
    ]
    versions = {release.profile: release.ways["API"].name.split()[-1] for release in releases}
    vectors = [*load_vectors(), *read_file(OWN.name, OWN.read_text("utf-8"))]
    chosen = [r for r in READINGS.values() if not r.is_note]
    entries = json.loads(output.read_text("utf-8"))["readings"] if output.exists() else {}
    for reading in chosen:
        if not wanted or reading.id in wanted:
            entries[reading.id] = {release.profile: measured(release, reading, vectors) for release in releases}
            print(reading.id, json.dumps(entries[reading.id]), file=sys.stderr, flush=True)
            output.write_text(text_of(versions, {r.id: entries[r.id] for r in chosen if r.id in entries}), "utf-8")
    for release in releases:
        for implementation in release.ways.values():
            implementation.close()


if __name__ == "__main__":
    main()
