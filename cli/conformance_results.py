"""`scenic-ref conformance --impl`: the results of another implementation, beside what is known of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ..semantics.store.errors import UsageError

if TYPE_CHECKING:
    from ..conformance.implementations.harness_client import External
    from ..conformance.judge import Result
    from ..conformance.known_differences import Judged, KnownDifference


class Expected(NamedTuple):
    """The expected results: known differences, and the line of each vector in earlier results (None without
    them).
    """

    known: Sequence[KnownDifference]
    before: Mapping[str, str] | None


class Kept(NamedTuple):
    """The files beside a judgement: known differences and earlier results, which are read; results and a report, which are written."""

    known: str | None
    results: str | None
    against: str | None
    report: str | None

    def check(self, impl: str | None) -> None:
        """Raise `UsageError` for files that cannot be written, or that need another implementation."""
        from .output_paths import check_ending, check_place

        if impl is None:
            for option, path in (("--known", self.known), ("--results", self.results), ("--against", self.against)):
                if path is not None:
                    raise UsageError(f"{option} needs --impl", hint="scenic-ref conformance --impl scenic==3.1.1")
        read = {"the file of known differences": self.known, "the file of earlier results": self.against}
        if self.results is not None:
            check_place(self.results, {**read, "the report": self.report})
            check_ending("--results", self.results, "results", (".json",))
        if self.report is not None and self.report != "-":
            check_place(self.report, read)
            check_ending("--json", self.report, "results", (".json",))

    def read(self) -> Expected:
        """Read the lists of expected results; the default is the list that ships. Raises `UsageError`."""
        from pathlib import Path

        from ..conformance.known_differences import differences_at, shipped_differences
        from ..conformance.results import lines_at

        known = shipped_differences() if self.known is None else differences_at(Path(self.known))
        return Expected(known, None if self.against is None else lines_at(Path(self.against)))


def judge_another(impl: str, other: External, results: Sequence[Result], expected: Expected, kept: Kept, verbose: bool) -> bool:
    """Show the results, write what is to be written; whether everything is as it is known to be. Raises `UsageError`."""
    from ..conformance.known_differences import judge_known_differences
    from ..conformance.results import changes, results_text
    from .conformance import show_by_chapter, write_report
    from .output_paths import write

    found = judge_known_differences(other.name, results, expected.known)
    changed = changes(expected.before or {}, results)
    if kept.results is not None:
        write(kept.results, results_text(other.name, results))
    if kept.report is not None:
        write_report(kept.report, other.name, results)
    if kept.report != "-":
        show_by_chapter(results)
        tell(impl, other, results if verbose else found.new, found, changed)
    only_changes = expected.before is not None and kept.known is None
    return not changed and (only_changes or found.as_expected)


def tell(impl: str, other: External, listed: Sequence[Result], found: Judged, changed: Sequence[str]) -> None:
    """Print the known, new, stale and changed results, and the listed vectors with their verdicts."""
    from ..conformance.diff.explanations import explain_failure
    from .conformance import lines_of

    if found.known:
        classes = Counter(difference.class_ for difference in found.known.values())
        print(f"known differences of {other.name}: {', '.join(f'{count} {class_}' for class_, count in classes.most_common())}")
    for result in listed:
        print("\n".join(lines_of(result, impl, other.dialects[0])))
        readings = explain_failure(
            result.vector, result.dialect, result.verdict.reason, other.profile
        ) if result in found.new and other.profile else None
        if readings:
            print(f"    the same as under {', '.join(f'{id} = {alternative}' for id, alternative in readings.items())}")
    if found.new:
        print(f"differences that are not known: {len(found.new)}")
    for vector in found.stale:
        print(f"listed as a difference, and it is none: {vector}")
    for line in changed:
        print(f"changed: {line}")
