"""`scenic-ref run --backend importance|smc|mcmc`: scenes where few runs are accepted, and what they are worth."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple

import typer

from ..data.scene import in_json
from ..data.table_files import SUFFIXES
from ..inference.chain_diagnostics import diagnose_repetitions, rhat
from ..inference.result import Inferred
from ..pictures.chain_plots import inference_data_in, needs_arviz, picture_with_chains
from ..pictures.scene_figures import picture
from ..sampling.program_source import Source
from ..sampling.scene_sampler import DrawnScene, drawing_of
from .output_paths import LINES, PICTURES, check_ending, check_file, check_place, write
from .scene_outputs import open_output, prepare_output
from .scene_run import rehearse
from .session import Session, console, tell

if TYPE_CHECKING:
    from rich.status import Status

BACKENDS = ("importance", "smc", "mcmc")
INCONCLUSIVE = 5
MOST_PLOTTED = 16


class InferenceRequest(NamedTuple):
    """Which scenes to draw, by which backend, and where to write them and the report."""

    backend: str
    scenes: int
    seed: int
    max_attempts: int
    output: str | None
    plot: str | None
    report: str | None
    resample: bool
    inference_data: str | None
    stream: str = "jsonl"


def produce_inference(source: Source, request: InferenceRequest, session: Session) -> None:
    """Draw the scenes, write them, report on them; exit code 5 if they cannot be trusted. Raises the program's errors and `UsageError`."""
    check_paths(source, request)
    prepare_output(request.output, request.stream)
    drawing = drawing_of(source)
    rehearse(drawing)
    with Sign(request.backend) as sign, open_output(request.output, resume=False, stream=request.stream) as output:
        found = drawing.scenario.infer(
            request.backend, request.scenes, request.seed, resample=request.resample, max_attempts=request.max_attempts, on_progress=sign.show,
        )
        for scene in found.scenes:
            output.write(DrawnScene(scene.index, scene.attempts, scene.to_line(), Counter(), (), ()))
        output.finish()
    for line in lines(found, request.seed):
        tell(line)
    if request.report is not None:
        write(request.report, in_json(found.report(), indent=1) + "\n")
    if request.inference_data is not None:
        assert found.draws is not None
        write(request.inference_data, inference_data_in(request.inference_data, found.names, found.draws, found.report()))
    if request.plot is not None:
        plot(found, request.plot)
    if found.doubts:
        raise typer.Exit(INCONCLUSIVE)


def lines(found: Inferred, seed: int) -> list[str]:
    """Return the lines that report an inference."""
    p, d = found.acceptance, found.diagnosis
    scenes = "1 scene" if len(found.scenes) == 1 else f"{len(found.scenes):,} scenes"
    told = [
        f"{scenes} of seed {seed} by {found.backend}: {found.attempts:,} runs, {found.seconds:.1f} s of a processor",
        f"P(a run is accepted) = {p.estimate:.3g}, between {p.low:.3g} and {p.high:.3g} ({p.level:.1%})",
        f"all draws are worth {d.bulk:,.0f} independent ones for means, {d.tail:,.0f} for quantiles; R-hat is at most {d.rhat:.3f}",
    ]
    return [*told, *(f"note: {note}" for note in found.notes), *(f"warning: not to be trusted: {doubt}" for doubt in found.doubts)]


def check_paths(source: Source, request: InferenceRequest) -> None:
    """Find wrong paths before the work begins. Raises `UsageError`."""
    for path in (request.output, request.plot, request.report, request.inference_data):
        if path is not None and path != "-":
            check_place(path, {"the program itself": source.file})
    if request.output is not None:
        check_ending("-o", request.output, "scenes", (*LINES, *SUFFIXES))
    if request.plot is not None:
        check_ending("--plot", request.plot, "pictures", PICTURES)
    check_file("--report", request.report, "reports", (".json",))
    check_file("--inference-data", request.inference_data, "inference data", (".json", ".nc"))
    if request.inference_data is not None and Path(request.inference_data).suffix.lower() == ".nc":
        needs_arviz()


def plot(found: Inferred, path: str) -> None:
    """Draw the first scenes into one picture, with traces and ranks of what chains or populations drew. Raises `UsageError`."""
    scenes, format = found.scenes[:MOST_PLOTTED], Path(path).suffix[1:].lower()
    if found.draws is None:
        write(path, picture(scenes, format=format))
        return
    kind = "chain" if found.backend == "mcmc" else "population"
    write(path, picture_with_chains(scenes, found.names, found.draws, rhats(found), kind, format=format))


def rhats(found: Inferred) -> list[float]:
    """The R-hat of each quantity, as the report has it: over chains, or over populations."""
    assert found.draws is not None
    return [rhat(own) if found.backend == "mcmc" else diagnose_repetitions(own[None]).rhat for own in found.draws]


class Sign:
    """A sign of life on a terminal while scenes are sought."""

    def __init__(self, backend: str) -> None:
        self.backend = backend
        self.status: Status | None = None

    def __enter__(self) -> Sign:
        if sys.stderr.isatty():
            self.status = console(sys.stderr).status(self.backend)
            self.status.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.status is not None:
            self.status.stop()

    def show(self, text: str) -> None:
        """How far the work is."""
        if self.status is not None:
            self.status.update(f"{self.backend}: {text}")
