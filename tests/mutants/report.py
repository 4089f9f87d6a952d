"""What a run over mutants says: tables by file, by rule and by kind of change, and the page of the documentation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .changes import Mutant
from .results import Results
from .suite import BUDGET
from .vectors import AT_LEAST, SLOWER, Catalogued


@dataclass(frozen=True, slots=True)
class Row:
    """How many mutants were drawn, are equivalent, and were noticed by the vectors and by the whole suite, of those that are not."""

    name: str
    drawn: int
    equivalent: int
    vectors: int
    suite: int

    @property
    def told(self) -> int:
        """Those that can be noticed."""
        return self.drawn - self.equivalent

    def cells(self, with_suite: bool) -> list[str]:
        """The row in words."""
        counts = [f"{n} ({percent(n, self.told)})" for n in ((self.vectors, self.suite) if with_suite else (self.vectors,))]
        return [self.name, str(self.drawn), str(self.equivalent), *counts]


def percent(part: int, whole: int) -> str:
    """A share, rounded down."""
    return f"{1000 * part // whole / 10:.1f} %" if whole else "-"


@dataclass(frozen=True, slots=True)
class Report:
    """The mutants that were drawn, of how many and by which seed, and what came of them."""

    seed: int
    of: int
    chosen: Sequence[Mutant]
    rules: Sequence[Catalogued]
    results: Results
    is_equivalent: Callable[[Mutant], bool]
    with_suite: bool

    def row(self, name: str, chosen: Sequence[Mutant]) -> Row:
        """The row of some mutants. One that was noticed after all is not equivalent."""
        equivalent = [m for m in chosen if self.is_equivalent(m) and not self.results.by_suite(m)]
        noticed = sum(map(self.results.by_vectors, chosen)), sum(map(self.results.by_suite, chosen))
        return Row(name, len(chosen), len(equivalent), *noticed)

    def by_file(self) -> list[Row]:
        """A row per file, and one of all."""
        names = sorted({m.file for m in self.chosen})
        return [*(self.row(name, [m for m in self.chosen if m.file == name]) for name in names), self.all()]

    def all(self) -> Row:
        """The row of all mutants."""
        return self.row("all files", self.chosen)

    def by_kind(self) -> list[Row]:
        """A row per kind of change."""
        return [self.row(kind, [m for m in self.chosen if m.kind == kind]) for kind in sorted({m.kind for m in self.chosen})]

    def by_rule(self) -> list[Row]:
        """A row per rule in whose function something was changed."""
        rows = [self.row(rule.rule, [m for m in self.chosen if rule.holds(m)]) for rule in self.rules]
        return [r for r in rows if r.drawn]


def lines(first: str, rows: Sequence[Row], with_suite: bool) -> list[str]:
    """A table in Markdown."""
    head = [first, "mutants", "equivalent", "noticed by vectors", *(["by the suite"] if with_suite else [])]
    table = [head, *(r.cells(with_suite) for r in rows)]
    widths = [max(len(cells[i]) for cells in table) for i in range(len(head))]
    written = ["| " + " | ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(cells, widths))) + " |" for cells in table]
    rule = "|" + "|".join("-" * (w + 2) if i == 0 else "-" * (w + 1) + ":" for i, w in enumerate(widths)) + "|"
    return [written[0], rule, *written[1:]]


def shown(report: Report) -> list[str]:
    """The tables, and what was missed."""
    found = [*lines("file", report.by_file(), report.with_suite), "", *lines("kind", report.by_kind(), report.with_suite), ""]
    found += [*lines("rule", report.by_rule(), report.with_suite), ""]
    for mutant in report.chosen:
        if not report.results.by_suite(mutant) and not report.is_equivalent(mutant):
            found += [f"missed: {mutant.file}:{mutant.line} {mutant.function} ({mutant.kind})", f"    - {mutant.before}", f"    + {mutant.after}"]
    return found


PAGE = """# Mutants

How firmly do the tests hold what the code of the rules says? `make mutants` changes `semantics/`
in one small way at a time and looks who notices: a comparison is turned (`<` to `<=`), an operand
is dropped, a sign or a number changed, a branch removed, `isinstance(...)` made `False`, a call
replaced by its argument, a result by `None`, a body by a `raise`. First those of the
[conformance vectors](vectors.md) are tried that run the changed line; if none of them notices, the
tests that do. A change is noticed if a vector or a test fails, crashes, or is not done in {slower}
times its processor time and {least} seconds.

    make mutants                                            # {drawn} of them, by a fresh seed
    python -m tests.mutants -n 200 --jobs 8 --vectors-only  # fewer, quicker
    python -m tests.mutants --files regions -o found.jsonl  # what the file holds is not done again
    python -m tests.mutants --bodies                        # do a rule's vectors need its function?

Annotations, docstrings, texts of messages, what is raised or asserted, and decorators are not
changed. A change that no program and no test can tell is *equivalent*: these are listed, each with
its reason, in `tests/mutants/equivalent.toml`, and the shares are of the others.

The figures below are of {drawn} changes, drawn with the seed {seed} from {of}. Of the {told} that
are not equivalent, **the vectors alone notice {vectors}, {and_suite}**. The tests for one change
may take {budget:.0f} seconds, and only what a test does in its own process is looked at, so that
the whole suite may notice more than the last column says.

## By file

{files}

## By kind of change

{kinds}

## By rule

Changes in the function that the catalogue names for a rule.

{rules}
"""


def page(report: Report) -> str:
    """The page of the documentation."""
    everything, table = report.all(), report.with_suite
    share = f"the whole suite {percent(everything.suite, everything.told)}" if table else "the suite was not tried"
    return PAGE.format(
        slower=SLOWER, least=AT_LEAST, drawn=everything.drawn, seed=report.seed, of=report.of, told=everything.told, budget=BUDGET,
        vectors=percent(everything.vectors, everything.told), and_suite=share,
        files="\n".join(lines("file", report.by_file(), table)), kinds="\n".join(lines("kind", report.by_kind(), table)),
        rules="\n".join(lines("rule", report.by_rule(), table)),
    )
