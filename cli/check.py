"""`scenic-ref check`: whether a program is well-formed, and whether samples have its distribution."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from ..sampling.program_source import DEFAULT_FUEL, Source
from .options import (
    DEFAULT_MEMORY,
    DEFAULT_SECONDS,
    DebugOption,
    DialectOption,
    FileArgument,
    FuelOption,
    LimitMemoryOption,
    LimitSecondsOption,
    ModelOption,
    ParamOption,
    ProfileOption,
    ReadingOption,
    ScenarioOption,
    TrustOption,
    limits_of,
    pairs,
    read_source,
)
from .shell_completion import one_of

if TYPE_CHECKING:
    from ..inference.comparison import Verdict

DEFAULT_SEED = 20_190_625
EXIT_CODES = {"equivalent": 0, "different": 1, "inconclusive": 5}


def check(
    context: typer.Context,
    file: FileArgument,
    samples: Annotated[
        str | None, typer.Option("--samples", metavar="PATH", help="Scenes of any implementation: JSON Lines in the scene format, or .csv.")
    ] = None,
    alpha: Annotated[float, typer.Option("--alpha", metavar="RISK", help="The risk of a false alarm.")] = 1e-9,
    detect_tv: Annotated[
        float, typer.Option("--detect-tv", metavar="DISTANCE", help="The difference, in total variation of a feature, that must not be missed.")
    ] = 0.01,
    tolerance: Annotated[
        float,
        typer.Option(
            "--tolerance", metavar="NUMBER",
            help="Numbers are equal if they differ by at most this, relative to the larger of 1 and the program's number."
        ),
    ] = 5e-6,
    ignore: Annotated[
        list[str] | None, typer.Option("--ignore", metavar="FEATURE", help="Do not compare a feature: objects[1].width, 1.speed, class, ...")
    ] = None,
    mapped: Annotated[
        list[str] | None, typer.Option("--map", metavar="A=B", help="A feature or class that the samples call A and the program B.")
    ] = None,
    reference: Annotated[
        str | None, typer.Option("--reference", metavar="PATH", help="Scenes of the program that were drawn earlier; by default they are drawn now.")
    ] = None,
    report: Annotated[str | None, typer.Option("--report", metavar="PATH", help="Write the comparison as a page, .html.")] = None,
    junit: Annotated[str | None, typer.Option("--junit", metavar="PATH", help="Write the verdict as JUnit XML.")] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Take warnings for errors: with any, the exit code is 1.")] = False,
    form: Annotated[
        str,
        typer.Option(
            "--format", metavar="FORMAT", autocompletion=one_of("text", "json", "github", "sarif"),
            help="How to tell what is wrong with the program: text, json, github or sarif.",
        ),
    ] = "text",
    seed: Annotated[int, typer.Option("--seed", metavar="SEED", help="The seed of the scenes that the samples are compared with.")] = DEFAULT_SEED,
    workers: Annotated[int, typer.Option("--workers", metavar="PROCESSES", min=1, help="Draw with so many processes.")] = 1,
    profile: ProfileOption = None,
    reading: ReadingOption = None,
    dialect: DialectOption = None,
    model: ModelOption = None,
    scenario: ScenarioOption = None,
    param: ParamOption = None,
    fuel: FuelOption = DEFAULT_FUEL,
    limit_memory: LimitMemoryOption = DEFAULT_MEMORY,
    limit_seconds: LimitSecondsOption = DEFAULT_SECONDS,
    trust: TrustOption = False,
    debug: DebugOption = False,
) -> None:
    """Check a program, or compare samples with it.

    The program is parsed, checked and run once; the answer is "ok" or the error, and warnings: properties that nothing reads though their names
    are nearly those of others, parameters that nothing reads, imports that nothing uses, names in bodies that nothing
    binds, headings in degrees, `Uniform` of one list. Exit codes: 0 ok, 1 an error, or with --strict a warning.

    With --samples: were these scenes drawn from the program's distribution? Exit codes: 0 equivalent, 1 different, 2 wrong usage, 5
    inconclusive (too few samples for --detect-tv).
    """
    from ..semantics.store.errors import UsageError
    from .session import escape_controls

    session = context.obj
    session.seed = seed
    source = read_source(
        session, file, profile=profile, reading=reading, dialect=dialect, model=model, param=param, fuel=fuel, trust=trust,
        limits=limits_of(limit_memory, limit_seconds), scenario=scenario,
    )
    if samples is None:
        options = ("alpha", "detect_tv", "tolerance", "ignore", "mapped", "reference", "report", "junit", "seed", "workers")
        given = [f"--{name.replace('_', '-').replace('mapped', 'map')}" for name in options if is_given(context, name)]
        if given:
            raise UsageError(f"{given[0]} needs --samples", hint="scenic-ref check FILE --samples PATH")
        from .diagnostic_formats import check_program

        raise typer.Exit(check_program(source, form, session, strict=strict))
    if strict or form != "text":
        raise UsageError("--strict and --format are about the program alone: they cannot be given with --samples", hint="--report writes a page")
    asked = Compared(samples, reference, alpha, detect_tv, tolerance, tuple(ignore or ()), dict(pairs(mapped, "--map", "A=B")), seed, workers)
    verdict = compare_samples(source, asked, report, junit)
    print(escape_controls(str(verdict)))
    raise typer.Exit(EXIT_CODES[verdict.kind])


def is_given(context: typer.Context, name: str) -> bool:
    """Whether the option stands on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


class Compared(NamedTuple):
    """Which samples to compare, with what, and how."""

    samples: str
    reference: str | None
    alpha: float
    detect_tv: float
    tolerance: float
    ignore: tuple[str, ...]
    mapped: dict[str, str]
    seed: int
    workers: int


def compare_samples(source: Source, asked: Compared, report: str | None, junit: str | None) -> Verdict:
    """The verdict on the samples, with its reports written. Raises `UsageError` and the program's errors."""
    from ..testing.judge import judge_samples
    from .check_reports import check_report_paths, write_junit, write_page
    from .reference_scenes import References, replay_of

    samples, reference = asked.samples, asked.reference
    read = {"the program itself": source.file, "the file of samples": samples, "the file of references": reference}
    check_report_paths(report, junit, read)
    replay = replay_of(source, samples, reference, asked.alpha, asked.detect_tv, asked.seed, asked.tolerance, asked.ignore, asked.mapped)
    verdict = judge_samples(
        samples, source.load(), alpha=asked.alpha, detect_tv=asked.detect_tv, seed=asked.seed, tolerance=asked.tolerance, ignore=asked.ignore,
        map=asked.mapped, reference=reference, draw=lambda total: References(source, asked.workers, total), replay=replay,
    )  # fmt: skip
    if report is not None:
        write_page(report, verdict, source, samples)
    if junit is not None:
        write_junit(junit, verdict, source, samples)
    return verdict
