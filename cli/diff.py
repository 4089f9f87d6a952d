"""`scenic-ref diff`: programs of one's own, here and in another implementation."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..sampling.program_source import DEFAULT_FUEL, Source
from .options import (
    DEFAULT_MEMORY,
    DEFAULT_SECONDS,
    DebugOption,
    DialectOption,
    FuelOption,
    LimitMemoryOption,
    LimitSecondsOption,
    ProfileOption,
    ReadingOption,
    TrustOption,
    limits_of,
    read_source,
)

if TYPE_CHECKING:
    from ..api import Scenario
    from ..conformance.diff.sequential_diff import AskedProgram, ProgramVerdict
    from ..conformance.implementations.harness_client import External

DEFAULT_BUDGET = 60.0
DEFAULT_FINENESS = 0.1
DEFAULT_RISK = 1e-6
DEFAULT_STEPS = 20
EXIT_CODES = {"differ": 1, "inconclusive": 5, "skipped": 5, "agree": 0}
"""The exit code of all programs is that of the first of these verdicts that occurs; `skipped` only if nothing else does."""


def diff(
    context: typer.Context,
    file: Annotated[str, typer.Argument(metavar="FILE|DIR", help="A Scenic program, or a folder of them.")],
    impl: Annotated[str, typer.Option("--impl", metavar="IMPLEMENTATION", help="scenic==3.1.1, scenic==2.1.0, or a command of the protocol.")],
    budget: Annotated[float, typer.Option("--budget", metavar="SECONDS", help="About how long a program may take, in seconds.")] = DEFAULT_BUDGET,
    seconds: Annotated[float, typer.Option("--seconds", metavar="SECONDS", help="How long an answer of the implementation may take.")] = 60.0,
    alpha: Annotated[float, typer.Option("--alpha", help="The risk of a false alarm, for each program.")] = DEFAULT_RISK,
    detect_tv: Annotated[
        float, typer.Option("--detect-tv", help="The difference, in total variation, that is to show before two distributions are called equal.")
    ] = DEFAULT_FINENESS,
    steps: Annotated[int, typer.Option("--steps", metavar="STEPS", min=1, help="Time steps of the simulations of dynamic programs.")] = DEFAULT_STEPS,
    ignore: Annotated[
        list[str] | None, typer.Option("--ignore", metavar="FEATURE", help="Do not compare it, where programs have it; may be repeated.")
    ] = None,
    output: Annotated[str | None, typer.Option("--json", metavar="PATH", help="Write a line of JSON for each program; - for stdout.")] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="SEED", help="The seed of everything that is drawn, here and there.")] = 0,
    profile: ProfileOption = None,
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    fuel: FuelOption = DEFAULT_FUEL,
    limit_memory: LimitMemoryOption = DEFAULT_MEMORY,
    limit_seconds: LimitSecondsOption = DEFAULT_SECONDS,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Compare what programs mean here and elsewhere.

    Elsewhere is another implementation. Errors are compared, the support and the distribution of the scenes, how often runs are accepted, and
    what agents do in a world that moves as it was recorded. A program is put into the other's dialect; what cannot be said there is skipped.
    Where the two differ, the readings under which they agree are searched for and named.

    Exit codes: 0 all agree, 1 one differs, 2 wrong usage, 5 inconclusive.
    """
    from ..conformance.diff.scene_differences import differences
    from ..conformance.diff.sequential_diff import DiffSettings
    from ..inference.comparison.comparison import check_settings
    from ..semantics.store.errors import UsageError
    from .conformance import open_implementation
    from .output_paths import check_ending, check_place

    check_settings(alpha, detect_tv, None)
    if not 0 < budget < float("inf"):
        raise UsageError(f"--budget is the time for a program, not {budget:g}")
    context.obj.seed = seed
    places = programs_in(file)
    if output is not None and output != "-":
        check_place(output, {f"the program {place}": place for place in places})
        check_ending("--json", output, "verdicts", (".jsonl", ".ndjson", ".json"))
    limits = limits_of(limit_memory, limit_seconds)
    settings = DiffSettings(alpha, detect_tv, seed, budget, steps, tuple(ignore or ()))
    found: list[ProgramVerdict] = []
    with open_implementation(impl, seconds) as other:
        try:
            for place in programs_with_progress(places):
                source = read_source(
                    context.obj, place, profile=profile, reading=reading, dialect=dialect, model=None, param=None, fuel=fuel, trust=trust,
                    limits=limits,
                )  # fmt: skip
                asked = program_of(source, other)
                verdict = differences(asked, other, settings) if not isinstance(asked, str) else uncompared_verdict(place, asked)
                found.append(verdict)
                if output != "-":
                    print_verdict(verdict)
        finally:  # what was found is written whatever happens
            write_verdicts(output, found)
    if output != "-" and len(places) > 1:
        counts = Counter(verdict.verdict for verdict in found)
        print(", ".join(f"{counts[verdict]} {verdict}" for verdict in ("agree", "differ", "inconclusive", "skipped") if counts[verdict]))
    raise typer.Exit(exit_code(found))


def programs_in(place: str) -> list[str]:
    """The program, or those of a folder and the folders in it, in order. Raises `UsageError` if there are none."""
    from ..semantics.store.errors import UsageError

    if not Path(place).is_dir():
        return [place]
    found = sorted(str(path) for path in Path(place).rglob("*.scenic") if path.is_file())
    if not found:
        raise UsageError(f"{place} holds no programs", hint="the names of Scenic programs end in .scenic")
    return found


def programs_with_progress(places: list[str]) -> Iterator[str]:
    """The programs, one after the other, with a progress bar on a terminal."""
    if not sys.stderr.isatty():
        yield from places
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from .session import console

    columns = (TextColumn("programs"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.fields[name]}", markup=False))
    with Progress(*columns, console=console(sys.stderr), transient=True) as bar:
        task = bar.add_task("", total=len(places), name="")
        for place in places:
            bar.update(task, name=place)
            yield place
            bar.advance(task)


def program_of(source: Source, other: External) -> AskedProgram | str:
    """The program as both sides read it; or why it cannot be said there. A program with an error of syntax is given as it stands."""
    from ..conformance.diff.sequential_diff import AskedProgram
    from ..conformance.implementations.protocol import Task
    from ..interpreter.language.conversion import convert
    from ..interpreter.language.dialects import DIALECTS, choose
    from ..interpreter.language.modules import library_of
    from ..interpreter.language.parser import parse
    from ..semantics.readings import select
    from ..semantics.store.errors import ProgramError
    from ..semantics.syntax import Program
    from ..simulators.worlds import WORLDS

    def load(readings: Mapping[str, str]) -> Scenario:
        return replace(source, readings=(*source.readings, *readings.items())).load()

    def asked(text: str, dialect: str, files: Mapping[str, str]) -> AskedProgram:
        paper = select()
        ours = select(DIALECTS[choose(source.text, source.dialect).name].profile if source.profile is None else source.profile, dict(source.readings))
        follows = {id: alternative for id, alternative in ours.items() if alternative != paper[id] and other.follows(id, alternative)}
        return AskedProgram(source.file, Task(text, dialect, follows, files=files), load)

    try:
        program = parse(source.text, source.file, source.dialect)
    except ProgramError:
        if source.dialect in other.dialects:
            return asked(source.text, source.dialect, {})
        return "it has an error of syntax, so that it cannot be put into another dialect; --dialect says in which one it is written"
    folder = Path(source.file).parent
    library = library_of(program, worlds=WORLDS, model=None, trust=source.trust, directory=folder, dialect=source.dialect)
    if "scenic.domains.driving.map" in library or "scenic.domains.driving.model" in library:
        return "it uses the driving library, whose map is not sent to other implementations"
    ours = sorted(name for name in library if name in WORLDS and not name.startswith(("scenic.core.", "scenic.domains.")))
    if ours:
        return f"it imports {', '.join(ours)}, and this reference has a world of its own of that name"
    modules = {module.file: module for module in library.values() if isinstance(module, Program) and is_beside(module.file, folder)}
    if program.dialect in other.dialects:
        files = {name: Path(name).read_text("utf-8") for name in modules}
        target, text = program.dialect, source.text
    else:
        target = other.dialects[0]
        try:
            text = convert(program, target, library)
            files = {name: convert(module, target, library) for name, module in modules.items()}
        except ProgramError as error:
            return f"it cannot be said in {target}: {error.message}"
    return asked(text, target, {str(Path(name).resolve().relative_to(folder.resolve())): content for name, content in files.items()})


def is_beside(file: str, folder: Path) -> bool:
    """Whether a module is a file in that folder, or in one below it."""
    return Path(file).is_file() and Path(file).resolve().is_relative_to(folder.resolve())


def uncompared_verdict(place: str, why: str) -> ProgramVerdict:
    """A program that is not compared."""
    from ..conformance.diff.sequential_diff import ProgramVerdict

    return ProgramVerdict(place, "skipped", "unsaid", why)


def print_verdict(verdict: ProgramVerdict) -> None:
    """A verdict in a few lines."""
    from .session import escape_controls

    print(escape_controls(f"{verdict.verdict}: {verdict.program} ({verdict.kind})"))
    if verdict.detail:
        print(escape_controls(f"    {verdict.detail}"))
    if verdict.reading:
        print(f"    agrees under {', '.join(f'{id} = {alternative}' for id, alternative in verdict.reading.items())}")
    sys.stdout.flush()


def write_verdicts(output: str | None, found: list[ProgramVerdict]) -> None:
    """The lines of JSON. Raises `UsageError` if they cannot be written."""
    from .output_paths import write

    if output is None:
        return
    text = "".join(json.dumps(verdict.to_json(), ensure_ascii=False) + "\n" for verdict in found)
    if output == "-":
        print(text, end="")
    else:
        write(output, text)


def exit_code(found: list[ProgramVerdict]) -> int:
    """Return the exit code for all verdicts together."""
    verdicts = {verdict.verdict for verdict in found}
    compared = verdicts - {"skipped"}
    return next((code for verdict, code in EXIT_CODES.items() if verdict in (compared or verdicts)), 0)
