"""`python -m tests.mutants`: small changes of `semantics`, and who notices them."""

from __future__ import annotations

import argparse
import importlib
import os
import random
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from . import suite, vectors
from .changes import BODY, Mutant, files, mutants
from .processes import Work, each
from .report import Report, page, shown
from .results import Kept, Results, State, equivalents, key
from .vectors import Known, Trial, outcome


def arguments() -> argparse.ArgumentParser:
    """The options."""
    parser = argparse.ArgumentParser("python -m tests.mutants", description=__doc__)
    parser.add_argument("-n", type=int, default=2000, help="how many mutants are drawn (2000)")
    parser.add_argument("--seed", type=int, help="the seed by which they are drawn; a fresh one if left out, which is printed")
    parser.add_argument("--jobs", type=int, default=1, help="how many processes work at a time (1)")
    parser.add_argument("--files", nargs="+", metavar="TEXT", help="only files of semantics/ whose path contains one of these texts")
    parser.add_argument("--vectors-only", action="store_true", help="what the vectors miss is not tried by the suite")
    parser.add_argument("--tests", nargs="+", metavar="TEXT", default=[""], help="only files of tests whose path contains one of these texts")
    parser.add_argument("--quick", action="store_true", help="only tests that are not slow, as `make test` runs them")
    parser.add_argument("--budget", type=float, default=suite.BUDGET, help="seconds that the tests for one mutant may take together (60)")
    parser.add_argument("-o", metavar="PATH", type=Path, help="a line for each result, appended; what it holds already is not done again")
    parser.add_argument("--missed", action="store_true", help="of those that are drawn, only those that vectors missed before, by the file of -o")
    parser.add_argument("--table", metavar="PATH", type=Path, help="write the page of the documentation")
    parser.add_argument("--bodies", action="store_true", help="a raise for the body of each rule's function: do its vectors notice?")
    return parser


def main() -> int:
    """The exit code: 0, 130 if interrupted; 1 if a body of a rule was not noticed."""
    options = arguments().parse_args()
    with tempfile.TemporaryDirectory() as place:  # for what processes leave that are ended in the middle of a test
        os.environ["TMPDIR"] = tempfile.tempdir = place
        return run(options)


def run(options: argparse.Namespace) -> int:
    """What was asked for."""
    seed = options.seed if options.seed is not None else int(time.time())
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    started = time.monotonic()
    wanted = [f for f in files() if not options.files or any(text in f for text in options.files)]
    everything = [m for file in wanted for m in mutants(file)]
    print(f"{len(everything)} mutants in {len(wanted)} files; watching what the vectors run", file=sys.stderr)
    state = State.now()
    kept = Kept(options.o, state)
    known = vectors.survey(options.jobs, kept.vectors)
    kept.write()
    load(known.libraries)
    if options.bodies:
        return bodies(everything, known, options.jobs)
    chosen = random.Random(seed).sample(everything, min(options.n, len(everything)))
    print(f"{len(chosen)} of {len(everything)} mutants drawn with the seed {seed}", flush=True)
    results = Results(options.o, state)
    results.against(map(vectors.mark, known.tables.values()))
    if options.missed:
        chosen = [m for m in chosen if key(m) in results.missed]
    excused = equivalents()
    try:
        untried = (m for m in chosen if key(m) not in results.vectors)
        trials = (vectors.trial(m, known, missed=results.missed.get(key(m), frozenset())) for m in untried)
        tried("vectors", trials, vectors.by_vectors(known), results, options.jobs)
        missed = [m for m in chosen if not results.by_vectors(m) and key(m) not in results.suite and not any(e.names(m) for e in excused)]
        if missed and not options.vectors_only:
            load(["pytest", "_pytest.assertion.rewrite", "hypothesis"])
            covered = suite.survey_tests(known.covered.at_import, options.tests, options.jobs, kept.tests, quick=options.quick)
            kept.write()
            tried("suite", (suite.trial_by_tests(m, covered, options.budget) for m in missed), suite.by_tests(), results, options.jobs)
    except KeyboardInterrupt:
        print(f"\ninterrupted: the results so far are {f'in {options.o}' if options.o else 'lost, since there is no -o'}", file=sys.stderr)
        return 130
    report = Report(seed, len(everything), chosen, known.rules, results, lambda m: any(e.names(m) for e in excused), not options.vectors_only)
    print("\n".join(shown(report)))
    print(f"{time.monotonic() - started:.0f} s", file=sys.stderr)
    if options.table is not None:
        options.table.write_text(page(report), "utf-8")
    return 0


def load(libraries: Sequence[str]) -> None:
    """Import what every process needs, once; what a library does not give by itself is imported where it is used."""
    for name in libraries:
        with suppress(Exception):
            importlib.import_module(name)


def tried(stage: str, trials: Iterator[Trial], work: Work, results: Results, jobs: int) -> None:
    """Try mutants, and keep each result at once."""
    for done, (trial, told, status) in enumerate(each(trials, work, jobs), 1):
        found = outcome(told, status)
        if found["by"] is None and trial.left:
            found["left"] = trial.left
        results.add(stage, trial.mutant, found)
        if sys.stderr.isatty() or done % 50 == 0:
            print(f"{stage}: {done} mutants tried", end="\r" if sys.stderr.isatty() else "\n", file=sys.stderr, flush=True)


def bodies(everything: Sequence[Mutant], known: Known, jobs: int) -> int:
    """Replace the body of each catalogued function by a raise, for each rule; 1 if the vectors of a rule do not notice."""
    trials, missed = [], []
    for rule in known.rules:
        named = [m for m in everything if m.kind == BODY and m.file == rule.file and m.function == rule.function]
        if named:
            nearest = min(named, key=lambda m: abs(m.line - rule.line))
            trials.append(vectors.trial(nearest, known, rule.rule))
        else:
            missed.append(f"{rule.rule}: {rule.function} of {rule.file} has no body that could be replaced")
    for trial, told, status in each(trials, vectors.by_vectors(known), jobs):
        if outcome(told, status)["by"] is None:
            mutant: Mutant = trial.mutant
            missed.append(f"{trial.rule}: {mutant.function} of {mutant.file}:{mutant.line}, {len(trial.names)} vectors show the rule")
    print(f"rules whose vectors notice that their function does nothing: {len(known.rules) - len(missed)} of {len(known.rules)}")
    print("\n".join(f"not noticed: {line}" for line in sorted(missed)))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
