"""Differences that are known: which vectors an implementation fails, who is right, and why."""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from ..interpreter.language.modules import read_text
from ..semantics.readings import READINGS
from ..semantics.store.errors import UsageError
from .judge import Result
from .strict_tables import VectorFields
from .vector import ConformanceVector

CLASSES: Mapping[str, str] = {
    "reading": "a choice that the paper leaves, made otherwise",
    "bug": "a fault of the implementation",
    "missing": "a construct of the paper that the implementation does not have",
    "unchecked": "an error by the paper that the implementation does not notice",
    "limits": "a hostile program, against which the implementation sets no limit",
    "wording": "the same by other means: another moment or kind of refusal",
    "ours": "a detail that the paper does not fix, and that this reference fixes",
    "undecided": "not looked into yet",
}
"""The classes of differences, with what each means."""


@dataclass(frozen=True, slots=True)
class KnownDifference:
    """A known difference: the implementations and vectors that show it, its class, what the paper says where, and why they differ.

    `reading` is the alternative under which the two agree, as "soft = scene", for the class `reading`.
    """

    implementations: frozenset[str]
    vectors: frozenset[str]
    class_: str
    why: str
    passage: str
    reading: str | None


def shipped_differences() -> list[KnownDifference]:
    """The known differences of the released implementations."""
    place = files("scenic_ref.conformance").joinpath("known_differences.toml")
    return differences_in(place.read_text("utf-8"), "known_differences.toml")


def differences_at(path: Path) -> list[KnownDifference]:
    """Return the differences in a file. Raises `UsageError` if it cannot be read, or is no list of
    differences.
    """
    return differences_in(read_text(path, "a list of differences"), str(path))


def differences_in(text: str, file: str) -> list[KnownDifference]:
    """The `[[difference]]` tables of a text, read strictly. Raises `UsageError`."""
    try:
        tables = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise UsageError(f"{file} is not TOML: {error}") from error
    if tables.keys() - {"difference"} or not isinstance(tables.get("difference", []), list):
        raise UsageError(f"{file}: there is nothing but [[difference]] tables")
    found = [read_difference(f"{file}, difference {n}", table) for n, table in enumerate(tables.get("difference", []))]
    seen: set[tuple[str, str]] = set()
    for difference in found:
        for pair in ((i, v) for i in difference.implementations for v in difference.vectors):
            if pair in seen:
                raise UsageError(f"{file}: {pair[1]} is listed twice for {pair[0]}")
            seen.add(pair)
    return found


def read_difference(place: str, table: object) -> KnownDifference:
    """One table. Raises `UsageError`."""
    fields = VectorFields(place, table)
    reading = fields.text("reading") if fields.has("reading") else None
    found = KnownDifference(
        frozenset(fields.texts("implementations")), frozenset(fields.texts("vectors")), fields.text("class"), fields.text("why"),
        fields.text("passage"), reading,
    )
    fields.done()
    if found.class_ not in CLASSES:
        raise fields.wrong(f"there is no class {found.class_!r}: there are {', '.join(CLASSES)}")
    if (found.class_ == "reading") != (reading is not None):
        raise fields.wrong("`reading` is for the class reading, which needs it")
    if reading is not None:
        for part in reading.split(", "):
            id, _, alternative = part.partition(" = ")
            if id not in READINGS or alternative not in READINGS[id].alternatives:
                raise fields.wrong(f"there is no reading {part!r}")
    return found


@dataclass(frozen=True, slots=True)
class KnownCause:
    """The differences of one class for one reason, in whatever implementations they show."""

    class_: str
    why: str
    differences: tuple[KnownDifference, ...]

    @property
    def implementations(self) -> list[str]:
        """The implementations in which the cause shows."""
        return sorted({name for difference in self.differences for name in difference.implementations})

    @property
    def passages(self) -> list[str]:
        """The passages of the paper that the differences are about."""
        return list(dict.fromkeys(difference.passage for difference in self.differences))

    @property
    def readings(self) -> list[str]:
        """The readings under which the implementations agree."""
        return list(dict.fromkeys(difference.reading for difference in self.differences if difference.reading))

    def smallest_first(self, vectors: Mapping[str, ConformanceVector]) -> list[str]:
        """The names of its vectors: those that most of the implementations fail, and of these the smallest programs, come first."""
        failing = Counter(dict.fromkeys(vectors, 0))
        for difference in self.differences:
            failing.update({name: len(difference.implementations) for name in difference.vectors})

        def size(name: str) -> tuple[int, int, int, str]:
            text = next(iter(vectors[name].texts.values())).strip()
            return -failing[name], text.count("\n"), len(text), name

        return sorted({name for difference in self.differences for name in difference.vectors}, key=size)


def causes(known: Iterable[KnownDifference]) -> list[KnownCause]:
    """The differences by class and reason, those with the most vectors first."""
    found: dict[tuple[str, str, str | None], list[KnownDifference]] = {}
    for difference in known:
        found.setdefault((difference.class_, difference.why, difference.reading), []).append(difference)
    whole = [KnownCause(class_, why, tuple(differences)) for (class_, why, _), differences in found.items()]
    return sorted(whole, key=lambda cause: -len({name for difference in cause.differences for name in difference.vectors}))


@dataclass(frozen=True, slots=True)
class Judged:
    """Results beside what is known: what each known one is, what is new, and what is listed and did not show."""

    known: Mapping[str, KnownDifference]
    new: tuple[Result, ...]
    stale: tuple[str, ...]

    @property
    def as_expected(self) -> bool:
        """Whether nothing is new and nothing stale."""
        return not self.new and not self.stale


def judge_known_differences(implementation: str, results: Sequence[Result], known: Iterable[KnownDifference]) -> Judged:
    """The results of an implementation beside the differences that are known of it."""
    listed = {vector: difference for difference in known if implementation in difference.implementations for vector in difference.vectors}
    wrong = {result.vector.name: result for result in results if result.verdict.status in ("failed", "errored")}
    ran = {result.vector.name for result in results}
    return Judged(
        {name: listed[name] for name in wrong if name in listed}, tuple(r for name, r in wrong.items() if name not in listed),
        tuple(name for name in listed if name in ran and name not in wrong),
    )  # fmt: skip
