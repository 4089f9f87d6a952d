"""`scenic-ref fuzz`: programs invented to find where another implementation departs from this one."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .options import DebugOption

if TYPE_CHECKING:
    from ..conformance.fuzz.examination import FuzzedProgram
    from ..conformance.fuzz.triage import JudgedFinding

JOURNAL, PAGE, JUNIT = "campaign.jsonl", "report.html", "junit.xml"
OF_THE_OTHER = "its own"
SHORTEST, LONGEST = 0.01, 1e7
"""Seconds of a campaign."""
UNITS = {"s": 1, "m": 60, "h": 3600}


def fuzz(
    context: typer.Context,
    impl: Annotated[str, typer.Option("--impl", metavar="IMPLEMENTATION", help="scenic==3.1.1, scenic==2.1.0, or a command of the protocol.")],
    output: Annotated[str, typer.Option("-o", "--output", metavar="DIR", help="The folder of the campaign: its journal and its reports.")],
    time: Annotated[
        str,
        typer.Option(
            "--time", metavar="TIME", help="How long programs are begun: in seconds, or as 90m or 2h. 0, with --resume, only writes the reports anew."
        ),
    ] = "10m",
    seed: Annotated[int, typer.Option("--seed", metavar="SEED", help="The seed of the programs and of all that is drawn.")] = 0,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the campaign of that folder.")] = False,
    workers: Annotated[int, typer.Option("--workers", metavar="PROCESSES", min=1, help="Examine so many programs at a time.")] = 2,
    alpha: Annotated[float, typer.Option("--alpha", metavar="RISK", help="The risk of a false alarm in the whole campaign.")] = 1e-3,
    detect_tv: Annotated[
        float, typer.Option("--detect-tv", metavar="DISTANCE", help="The difference, in total variation, that is to show before distributions agree.")
    ] = 0.3,
    steps: Annotated[int, typer.Option("--steps", metavar="STEPS", min=1, help="Time steps of the simulations of dynamic programs.")] = 4,
    budget: Annotated[float, typer.Option("--budget", metavar="SECONDS", help="About how long the comparison of a program may take.")] = 6.0,
    answer: Annotated[float, typer.Option("--seconds", metavar="SECONDS", help="How long an answer of the implementation may take.")] = 10.0,
    shrinking: Annotated[float, typer.Option("--shrinking", metavar="SECONDS", help="How long a finding may be made smaller, in seconds.")] = 90.0,
    profile: Annotated[
        str,
        typer.Option("--profile", metavar="PROFILE", help="The readings under which both are compared; by default those that it is known to follow.")
    ] = OF_THE_OTHER,
    debug: DebugOption = False,
) -> None:
    """Invent programs until one means something else elsewhere.

    Each program is compared with another implementation as `diff` does it. What differs is made smaller, compared once more with fresh scenes,
    and grouped by cause: the words of the difference, the rules and the properties that the program is about. The folder holds the journal (with
    --resume the campaign goes on), a page, JUnit XML, the programs, and drafts of vectors. In its findings.toml each finding has a class, for you
    to decide: what you write there stays, and is in the reports.

    Exit codes: 0 no finding, 1 findings, 2 wrong usage.
    """
    from ..conformance.fuzz.campaign import Journal, campaign
    from ..conformance.fuzz.causes import causes_of
    from ..conformance.fuzz.examination import CampaignSettings
    from ..conformance.fuzz.triage import findings_at, findings_of
    from ..inference.comparison.comparison import check_settings
    from ..semantics.readings import select
    from ..semantics.store.errors import UsageError
    from .conformance import open_implementation
    from .fuzz_reports import FINDINGS, write_reports

    context.obj.seed = seed
    check_settings(alpha, detect_tv, None)
    seconds = seconds_in(time, at_least=0.0 if resume else SHORTEST)
    for option, value in (("--budget", budget), ("--shrinking", shrinking)):
        if not 0 < value < float("inf"):
            raise UsageError(f"{option} is a time in seconds, not {value:g}")
    folder = Path(output)
    kept = findings_at(folder / FINDINGS) if resume else []
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{output} cannot be made: {error.strerror or error}") from None
    with open_implementation(impl, answer) as other:
        name, paper = other.name, select()
        readings = dict(other.profile if profile == OF_THE_OTHER else select(profile))
    readings = {id: alternative for id, alternative in readings.items() if alternative != paper[id]}
    settings = CampaignSettings(impl, seed, alpha, detect_tv, steps, budget, answer, shrinking, readings)
    journal = Journal(folder / JOURNAL, settings, name, resume=resume)
    context.obj.finished = f"{output} holds what was found; --resume goes on"
    try:
        with campaign_progress(journal.examined, seconds) as tell:
            campaign(settings, journal, seconds, workers, tell)
    finally:  # what was found is reported, however the campaign ends
        causes = causes_of(journal.examined)
        findings = findings_of(causes, kept)
        write_reports(folder, name, settings, journal.examined, causes, findings)
    show_findings(findings, journal.examined, folder)
    raise typer.Exit(1 if any(found.verdict == "differ" for found in journal.examined) else 0)


def seconds_in(text: str, at_least: float) -> float:
    """A length of time as seconds: a number, of seconds or with the unit s, m or h. Raises `UsageError`."""
    from ..semantics.store.errors import UsageError

    number, unit = (text[:-1], text[-1:]) if text[-1:] in UNITS else (text, "s")
    try:
        found = float(number) * UNITS[unit]
    except ValueError:
        found = -1.0
    if not at_least <= found <= LONGEST:
        zero = "" if at_least == 0 else " (0 is for --resume)" if found == 0 else ""
        raise UsageError(f"--time is a length of time such as 600, 90m or 2h, not {text!r}{zero}")
    return found


@contextmanager
def campaign_progress(examined: Sequence[FuzzedProgram], seconds: float) -> Iterator[Callable[[FuzzedProgram], None]]:
    """Says what is found: on a terminal with a bar of the time, elsewhere a line for each finding."""
    from .session import console
    from .session import tell as told

    def line(found: FuzzedProgram) -> None:
        if found.confirmed:
            told(f"program {found.number}: {found.kind}, {found.words}")

    if not sys.stderr.isatty():
        yield line
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (BarColumn(), TimeElapsedColumn(), TextColumn("{task.fields[said]}", markup=False))
    with Progress(*columns, console=console(sys.stderr), transient=True) as bar:
        task = bar.add_task("", total=seconds, said="")
        began = bar.get_time()

        def moved(found: FuzzedProgram) -> None:
            bar.update(task, completed=min(bar.get_time() - began, seconds), said=verdict_counts(examined))
            if found.confirmed:
                bar.console.print(f"program {found.number}: {found.kind}, {found.words}", markup=False, highlight=False)

        yield moved


def verdict_counts(examined: Sequence[FuzzedProgram]) -> str:
    """How many programs were examined, and what became of them."""
    counts = Counter(found.verdict for found in examined)
    told = ", ".join(f"{counts[verdict]:,} {verdict}" for verdict in ("agree", "differ", "inconclusive", "skipped") if counts[verdict])
    return f"{len(examined):,} programs: {told}" if told else "no program was examined"


def show_findings(findings: Sequence[JudgedFinding], examined: Sequence[FuzzedProgram], folder: Path) -> None:
    """The findings, each with its smallest program."""
    from .session import escape_controls

    for number, found in enumerate(findings, 1):
        programs = f"{found.programs} program{'' if found.programs == 1 else 's'}"
        reading = f", agrees under {found.reading}" if found.reading else ""
        print(f"\n{number}. {escape_controls(found.kind)}: {escape_controls(found.words)} ({programs}, {found.class_}{reading})")
        print("\n".join(f"    {escape_controls(line)}" for line in found.program.splitlines()))
    alike = sum(found.verdict == "differ" for found in examined) - sum(found.programs for found in findings)
    rest = f", and {alike:,} more that differ are alike or were not shown again by fresh scenes" if alike and findings else ""
    print(f"\n{verdict_counts(examined)}; {len(findings)} cause{'' if len(findings) == 1 else 's'}{rest}. {folder / PAGE} shows them.")
