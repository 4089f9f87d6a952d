"""`scenic-ref conformance`: the vectors, run on scenic-ref itself or on another implementation."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from .options import DebugOption

if TYPE_CHECKING:
    from ..conformance.implementations.harness_client import External
    from ..conformance.implementations.protocol import Implementation
    from ..conformance.judge import Result
    from ..conformance.reports import Chapter
    from ..conformance.vector import ConformanceVector

WRONG = ("failed", "errored")
HEADING = ("vectors", "passed", "failed", "skipped", "errored", "chapter")


def conformance(
    chapter: Annotated[str | None, typer.Option("--chapter", metavar="TITLE", help="Only the chapters whose title contains this.")] = None,
    vector: Annotated[list[str] | None, typer.Option("--vector", metavar="NAME", help="Only the vector of that name; may be repeated.")] = None,
    dialect: Annotated[
        str | None, typer.Option("--dialect", metavar="DIALECT", help="Run the programs in that dialect: paper, pldi19, scenic-2.1 or scenic-3.")
    ] = None,
    impl: Annotated[
        str | None,
        typer.Option("--impl", metavar="IMPLEMENTATION", help="Another one: scenic==3.1.1, scenic==2.1.0, or a command of the harness protocol."),
    ] = None,
    seconds: Annotated[float, typer.Option("--seconds", metavar="SECONDS", help="How long an answer of it may take.")] = 60.0,
    known: Annotated[
        str | None, typer.Option("--known", metavar="PATH", help="The differences that are known of it, .toml; by default the ones that ship.")
    ] = None,
    results: Annotated[str | None, typer.Option("--results", metavar="PATH", help="Write a line per vector, .json, to be kept.")] = None,
    against: Annotated[str | None, typer.Option("--against", metavar="PATH", help="Compare with such a file: what changed fails.")] = None,
    output: Annotated[str | None, typer.Option("--json", metavar="PATH", help="Write the results as JSON; - for stdout.")] = None,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="List every vector, not only those that did not pass.")] = False,
    seed: Annotated[int, typer.Option("--seed", metavar="SEED", help="The seed of the statistical vectors; a nightly run takes a fresh one.")] = 20,
    debug: DebugOption = False,
) -> None:
    """Run the conformance vectors.

    A vector is a program with what the paper says about its scenes or simulations. A table by chapter of the paper counts the results;
    each vector that did not pass is listed with the reason. The exit code is 0 if nothing failed or errored.

    With --impl the vectors are put to another implementation, in a process of its own. Differences that are known are counted by class;
    the exit code is 0 if all are known and all that are listed still show.
    """
    from ..conformance import Ourselves, load_vectors
    from ..conformance.reports import all_passed
    from .conformance_results import Kept, judge_another

    chosen = select_vectors(load_vectors(), chapter, vector)
    check_dialect(dialect)
    kept = Kept(known, results, against, output)
    kept.check(impl)
    if impl is not None:
        expected = kept.read()
        with open_implementation(impl, seconds) as other:
            found = list(judge_vectors(other, chosen, dialect, seed))
            raise typer.Exit(0 if judge_another(impl, other, found, expected, kept, verbose) else 1)
    implementation = Ourselves()
    found = list(judge_vectors(implementation, chosen, dialect, seed))
    if output is not None:
        write_report(output, implementation.name, found)
    if output != "-":
        show_by_chapter(found)
        for result in found:
            if verbose or result.verdict.status in WRONG:
                print("\n".join(lines_of(result)))
        print(rules_line(found))
    if not all_passed(found):
        raise typer.Exit(1)


def open_implementation(impl: str, seconds: float) -> External:
    """The implementation that the option names, which has said its name. Raises `UsageError`."""
    from ..conformance.implementations.environments import implementation
    from ..conformance.implementations.line_process import ImplementationFault
    from ..semantics.store.errors import UsageError

    if not 0 < seconds < float("inf"):
        raise UsageError(f"--seconds is the time for an answer, not {seconds:g}")
    other = implementation(impl, seconds, lambda line: print(line, file=sys.stderr))
    try:
        other.introduced()
    except ImplementationFault as fault:
        other.close()
        raise UsageError(f"{impl} does not say its name: {fault}", hint="docs/harness.md says what it is asked, and how it answers") from fault
    return other


def select_vectors(vectors: Sequence[ConformanceVector], chapter: str | None, names: list[str] | None) -> list[ConformanceVector]:
    """The vectors that were asked for. Raises `UsageError` if there are none."""
    from ..semantics.store.errors import UsageError

    for name in names or ():
        if name not in {v.name for v in vectors}:
            raise UsageError(f"there is no vector {name}", hint=nearest(name, [v.name for v in vectors]))
    found = [v for v in vectors if (not names or v.name in names) and (chapter is None or chapter.lower() in v.chapter.lower())]
    if not found:
        titles = "".join(f"\n    {title}" for title in dict.fromkeys(v.chapter for v in vectors))
        raise UsageError(f"there is no such vector in a chapter whose title contains {chapter!r}", hint=f"the chapters are{titles}")
    return found


def nearest(name: str, known: Iterable[str]) -> str:
    """A hint with the most similar name."""
    from ..semantics.store.suggestions import did_you_mean

    return did_you_mean(name, known, "`scenic-ref conformance -v` lists them")


def check_dialect(dialect: str | None) -> None:
    """Raise `UsageError` for an unknown dialect."""
    from ..interpreter.language.dialects import choose

    choose("", dialect)


def judge_vectors(implementation: Implementation, vectors: Sequence[ConformanceVector], dialect: str | None, seed: int) -> Iterator[Result]:
    """The results, one after the other, with a progress bar on a terminal."""
    from ..conformance import judge

    if not sys.stderr.isatty() or len(vectors) == 1:
        for vector in vectors:
            yield judge(implementation, vector, dialect, seed=seed)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("vectors"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[name]}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=len(vectors), name="")
        for vector in vectors:
            bar.update(task, name=vector.name)
            yield judge(implementation, vector, dialect, seed=seed)
            bar.advance(task)


def write_report(path: str, name: str, results: Sequence[Result]) -> None:
    """The JSON report. Raises `UsageError` if the file cannot be written."""
    from ..conformance.reports import report_json
    from .output_paths import write

    text = json.dumps(report_json(name, results), ensure_ascii=False, indent=2)
    if path == "-":
        print(text)
    else:
        write(path, text + "\n")


def show_by_chapter(results: Sequence[Result]) -> None:
    """The table by chapter."""
    from ..conformance.reports import by_chapter

    chapters = by_chapter(results)
    if sys.stdout.isatty():
        show_on_terminal(chapters)
    else:
        from .text_columns import columns

        print("\n".join(columns(HEADING, [row(c) for c in with_total(chapters)])))


def with_total(chapters: Sequence[Chapter]) -> list[Chapter]:
    """The chapters, and all of them together if there are several."""
    from collections import Counter

    from ..conformance.reports import Chapter

    together = sum((c.counts for c in chapters), Counter())
    return [*chapters, Chapter("all chapters", together)] if len(chapters) > 1 else list(chapters)


def row(chapter: Chapter) -> tuple[str, ...]:
    """The cells of a chapter."""
    from ..conformance.verdict import STATUSES

    return (str(chapter.vectors), *(str(chapter.counts[status]) for status in STATUSES), chapter.title)


def show_on_terminal(chapters: Sequence[Chapter]) -> None:
    """The table in colours."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD)
    *numbers, title = HEADING
    table.add_column(title)
    for name in numbers:
        table.add_column(name, justify="right", no_wrap=True)
    for chapter in with_total(chapters):
        *cells, name = row(chapter)
        wrong = chapter.counts["failed"] + chapter.counts["errored"]
        table.add_row(escape(name), *cells, style="red" if wrong else None)
    Console().print(table)


def lines_of(result: Result, impl: str | None = None, dialect: str = "paper") -> list[str]:
    """A vector with its verdict, and the command that runs it alone if it did not pass; `dialect` is the one that is taken if none is named."""
    import shlex

    vector, verdict = result.vector, result.verdict
    lines = [f"{verdict.status}: {vector.name} ({vector.paper})" + (f": {verdict.reason}" if verdict.reason else "")]
    if verdict.status in WRONG:
        in_dialect = f" --dialect {result.dialect}" if result.dialect not in ("", dialect) else ""
        of_it = "" if impl is None else f" --impl {shlex.quote(impl)}"
        lines.append(f"    scenic-ref conformance --vector {vector.name}{of_it}{in_dialect}    # {vector.file}")
    return lines


def rules_line(results: Sequence[Result]) -> str:
    """How many rules of the catalogue the vectors show."""
    from ..conformance.reports import UNREACHABLE, rules_missing, rules_shown
    from ..semantics.rules import RULES

    reachable = [rule for rule in RULES if rule not in UNREACHABLE]
    missing = rules_missing(results)
    line = f"rules fired: {len(rules_shown(results))} of {len(reachable)}"
    return f"{line} (not: {', '.join(missing)})" if 0 < len(missing) <= 10 else line
