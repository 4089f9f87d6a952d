"""`scenic-ref conformance --impl`: the results of another implementation, beside what is known of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from ..semantics.kernel.errors import UsageError

if TYPE_CHECKING:
    from ..conformance.external import External
    from ..conformance.known import Judged
    from ..conformance.running import Result


class Kept(NamedTuple):
    """The files beside a judgement: known differences and earlier results, which are read; results and a report, which are written."""

    known: str | None
    results: str | None
    against: str | None
    report: str | None

    def check(self, impl: str | None) -> None:
        """Raise `UsageError` for files that cannot be written, or that need another implementation."""
        from .files import check_ending, check_place

        read = {"the known differences": self.known, "the earlier results": self.against}
        if impl is None:
            for option, path in (("--known", self.known), ("--results", self.results), ("--against", self.against)):
                if path is not None:
                    raise UsageError(f"{option} needs --impl", hint="scenic-ref conformance --impl scenic==3.1.1")
        for option, path in (("--json", self.report), ("--results", self.results)):
            if path is not None and (path != "-" or option == "--results"):
                check_place(path, {name: there for name, there in read.items() if there is not None})
                check_ending(option, path, "results", (".json",))


def judge_another(impl: str, other: External, results: Sequence[Result], kept: Kept, verbose: bool) -> bool:
    """Show the results, write what is to be written; whether everything is as it is known to be. Raises `UsageError`."""
    from pathlib import Path

    from ..conformance.known import beside, differences_at, shipped
    from ..conformance.results import changes, text_of
    from .conformance import show, write_report
    from .files import write

    known = shipped() if kept.known is None else differences_at(Path(kept.known))
    found = beside(other.name, results, known)
    changed = [] if kept.against is None else changes(Path(kept.against), other.name, results)
    if kept.results is not None:
        write(kept.results, text_of(other.name, results))
    if kept.report is not None:
        write_report(kept.report, other.name, results)
    if kept.report != "-":
        show(results, verbose, ())
        tell(impl, other, found, changed)
    return not changed if kept.against is not None and kept.known is None else found.as_expected and not changed


def tell(impl: str, other: External, found: Judged, changed: Sequence[str]) -> None:
    """What is known, what is new, what is stale, and what changed."""
    from ..conformance.explaining import explained
    from .conformance import lines_of

    if found.known:
        classes = Counter(difference.class_ for difference in found.known.values())
        print(f"known differences of {other.name}: {', '.join(f'{count} {class_}' for class_, count in classes.most_common())}")
    for result in found.new:
        print("\n".join(lines_of(result, impl)))
        readings = explained(result.vector, result.dialect, result.verdict.reason, other.profile) if other.profile else None
        if readings:
            print(f"    the same as under {', '.join(f'{id} = {alternative}' for id, alternative in readings.items())}")
    if found.new:
        print(f"differences that are not known: {len(found.new)}")
    for vector in found.stale:
        print(f"listed as a difference, and it is none: {vector}")
    for line in changed:
        print(f"changed: {line}")
