"""The course of a benchmark: programs one after the other, implementations taking turns."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from ..interpreter.runtime.optional_packages import is_installed
from ..semantics.store.errors import UsageError
from .end_to_end import FORMATS, NEED_ARROW, RunToFile
from .figures import Cell, Figures, load_averages
from .growth import WHAT, contenders, programs
from .implementations import Contender, MeasuredProgram, Ours, OursOverTime, Released, parse_release
from .processes import Process

NO_NUMBA = "numba is not installed: the compiled evaluator is not measured (pip install 'scenic-ref[fast]')"
NO_ARROW = "pyarrow is not installed: Parquet and Arrow are not measured (pip install 'scenic-ref[parquet]')"
NO_TORCH = "torch is not installed: the evaluation by torch is not measured (pip install 'scenic-ref[torch]')"

Tell = Callable[[str], None]
"""Says how far a benchmark has come."""


@dataclass(frozen=True, slots=True)
class CourseRequest:
    """A request for measurements."""

    programs: tuple[str, ...]
    seconds: float
    repeat: int
    against: tuple[str, ...] = ()
    released: str | None = None
    prune: bool = False
    growth: bool = False
    seed: int = 0
    end_to_end: bool = False
    trust: bool = False
    formats: tuple[str, ...] = FORMATS
    steps: int | None = None
    """Simulations of so many time steps are measured, if this is given, and not scenes."""

    def json(self) -> dict[str, object]:
        """The options that decide the figures."""
        found: dict[str, object] = {"seconds": self.seconds, "repeat": self.repeat, "prune": self.prune, "seed": self.seed}
        return found | {"end to end": self.end_to_end} | ({} if self.steps is None else {"steps": self.steps})


def measure_request(request: CourseRequest, tell: Tell, finish: Callable[[Figures], None]) -> Figures:
    """Measure all that is requested, and return the figures; `finish` gets them, after Ctrl-C those that there are.

    Raises `UsageError` before anything is measured, and `KeyboardInterrupt` after `finish`.
    """
    todo = programs_of(request)
    with tempfile.TemporaryDirectory() as directory:
        others = [parse_release(text).at(Path(directory), request.steps) for text in request.against]
        if len({other.name for other in others}) < len(others):
            raise UsageError("--against names the same implementation twice")
        numba, torch, arrow = is_installed("numba"), is_installed("torch"), is_installed("pyarrow")
        for there, missing in ((numba, NO_NUMBA), (arrow, NO_ARROW) if request.end_to_end else (torch, NO_TORCH)):
            if not there and request.steps is None:
                tell(missing)
        rivals: list[Contender] = [*own(request, numba, torch, arrow), *others]
        standard = others[0].name if others else rivals[0].name
        figures = Figures(
            tuple(r.name for r in rivals), standard, load={"before": load_averages()}, what="scenes" if request.steps is None else "time steps"
        )
        try:
            for number, program in enumerate(todo, 1):
                tell(f"[{number}/{len(todo)}] {program.name}")
                take_turns(program, rivals, request, figures.cells)
            if request.growth:
                measure_growth(Path(directory), numba, request, figures, tell)
        except KeyboardInterrupt:
            figures.interrupted = True
        figures.load["after"] = load_averages()
        finish(figures)
        if figures.interrupted:
            raise KeyboardInterrupt
    return figures


def own(request: CourseRequest, numba: bool, torch: bool, arrow: bool) -> Iterator[Contender]:
    """The backends of this package that are measured."""
    if request.steps is not None:
        return (OursOverTime(backend, request.steps) for backend in ("interpreter", "compiled"))
    return file_contenders(numba, arrow, request.formats) if request.end_to_end else ours(numba, torch, request.prune)


def ours(numba: bool, torch: bool, prune: bool) -> Iterator[Ours]:
    """The backends that are measured; by torch on the processor."""
    yield Ours("interpreter")
    for pruned in (False, True)[: 1 + prune]:
        yield Ours("numpy", pruned)
        if numba:
            yield Ours("numba", pruned)
        if torch and not pruned:
            yield Ours("torch")


def file_contenders(numba: bool, arrow: bool, formats: Sequence[str]) -> Iterator[Contender]:
    """The fastest backend, which draws only, and the command with a file in each of the formats that can be written here."""
    yield Ours("numba" if numba else "numpy")
    yield from (RunToFile(format) for format in formats if arrow or format not in NEED_ARROW)


def programs_of(request: CourseRequest) -> list[MeasuredProgram]:
    """The programs, which are there and have different names. Raises `UsageError`."""
    found: list[MeasuredProgram] = []
    for path in request.programs:
        if not Path(path).is_file():
            raise UsageError(f"there is no file {path}")
        name = Path(path).stem
        if any(name == other.name for other in found):
            raise UsageError(f"two programs are called {name}")
        found.append(MeasuredProgram(name, str(Path(path).resolve()), translation(path, request.released), request.trust))
    if found and request.released is not None and not any(p.released for p in found):
        raise UsageError(f"--released: {request.released} holds none of the programs", hint=f"it should hold {found[0].name}.scenic, for example")
    return found


def translation(path: str, directory: str | None) -> str | None:
    """The file of a program for released implementations, None if there is none."""
    other = Path(path) if directory is None else Path(directory) / Path(path).name
    return str(other.resolve()) if other.is_file() else None


def take_turns(program: MeasuredProgram, rivals: Sequence[Contender], request: CourseRequest, cells: list[Cell]) -> None:
    """Measure a program by all implementations: each prepares it, then they draw in turns. `cells` gets the figures as they come."""
    with ExitStack() as stack:
        turns: list[tuple[Process, Cell]] = []
        for rival in rivals:
            cell = Cell(program.name, rival.name)
            cells.append(cell)
            if isinstance(rival, Released) and program.released is None:
                cell.skipped = f"there is no {program.name}.scenic for this implementation"
                continue
            process = stack.enter_context(Process(rival, program, request.seed))
            cell.ready = process.ready
            cell.skipped = process.ready.get("skipped")
            turns.append((process, cell))
        for _ in range(request.repeat):
            for process, cell in turns:
                if cell.skipped is None:
                    cell.take(process.sample(request.seconds))


def measure_growth(directory: Path, numba: bool, request: CourseRequest, figures: Figures, tell: Tell) -> None:
    """Measure the programs that grow."""
    for kind in WHAT:
        cells = figures.growth.setdefault(kind, [])
        for size, program in programs(kind, directory):
            tell(f"[growth] {size:,} {kind}")
            take_turns(program, contenders(kind, size, numba), request, cells)
