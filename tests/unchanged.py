"""Whether this tree gives the same bytes as another revision: scenes, simulations, traces and exact distributions.

    python tests/unchanged.py REVISION [--scenes N] [--jobs K]

Every example and every vector of REVISION is drawn by both trees, by the interpreter and by the batch backend, with two seeds; the gallery also
pruned; all of them enumerated, as far as that goes; programs over time also as recordings of each simulator; the rules of one run as a trace. The
two trees run in processes of their own. Words for people may differ: of an error, its class and place are compared.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import io
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import cache, partial
from multiprocessing import Pool
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenic_ref.conformance.vector import ConformanceVector

ROOT = Path(__file__).resolve().parent.parent
SEEDS = (0, 7)
STEPS = 12


def main() -> int:
    """Compare two trees, or (for the processes of the comparison) print the digests of one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("revision")
    parser.add_argument("--scenes", type=int, default=5, help="scenes of each program and seed by the interpreter, ten times as many by batch")
    parser.add_argument("--jobs", type=int, default=max(1, (os.cpu_count() or 2) // 2), help="processes for each tree")
    parser.add_argument("--of", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.of is not None:
        json.dump(digests(options.of, options.scenes, options.jobs), sys.stdout)
        return 0
    with tempfile.TemporaryDirectory() as folder:
        old = Path(folder) / "tree"
        old.mkdir()
        archive = subprocess.run(["git", "-C", str(ROOT), "archive", options.revision], check=True, capture_output=True).stdout
        subprocess.run(["tar", "-x", "-C", str(old)], input=archive, check=True)
        running = [started(tree, old, options, Path(folder) / name) for name, tree in (("before", old), ("after", ROOT))]
        before, after = (json.loads(process.communicate()[0]) for process in running)
    wrong = sorted(key for key in before.keys() | after.keys() if before.get(key) != after.get(key))
    for key in wrong:
        print(f"{key}\n  before: {before.get(key)}\n  after:  {after.get(key)}")
    print(f"{len(before)} outputs compared, {len(wrong)} differ")
    return 1 if wrong else 0


def started(tree: Path, programs: Path, options: argparse.Namespace, place: Path) -> subprocess.Popen[str]:
    """A process that imports the package from `tree` and prints the digests of what the programs of `programs` give."""
    place.mkdir()
    (place / "scenic_ref").symlink_to(tree)
    numbers = ["--scenes", str(options.scenes), "--jobs", str(options.jobs)]
    command = [sys.executable, str(Path(__file__).resolve()), options.revision, "--of", str(programs), *numbers]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": str(place)}, cwd=place)


def digests(programs: Path, scenes: int, jobs: int) -> dict[str, str]:
    """What each program gives, by program and kind of output."""
    names = [*sorted(map(str, (programs / "examples").rglob("*.scenic"))), *vectors(programs)]
    with Pool(jobs) as pool:
        return {key: digest for found in pool.imap_unordered(partial(of_program, programs, scenes), names) for key, digest in found}


def of_program(programs: Path, scenes: int, name: str) -> list[tuple[str, str]]:
    """What an example, by its path, or a vector, by its name, gives."""
    known = vectors(programs)
    return list(of_vector(known[name], scenes) if name in known else of_example(Path(name), programs / "examples", scenes))


def of_example(path: Path, folder: Path, scenes: int) -> Iterator[tuple[str, str]]:
    """An example through the command line, as a user runs it."""
    text = path.read_text()
    dialect = ("--dialect", "pldi19") if "pldi19" in path.parts else ()
    name = str(path.relative_to(folder))
    for seed in SEEDS:
        common = (str(path), *dialect, "--seed", str(seed))
        yield f"{name} interpreter {seed}", command("run", *common, "-n", str(scenes), "--backend", "interpreter")
        yield f"{name} batch {seed}", command("run", *common, "-n", str(10 * scenes), "--backend", "batch")
        if "behavior" in text or "dynamic" in path.parts:
            for simulator in ("kinematic", "pymunk", "still"):
                yield f"{name} {simulator} {seed}", command("simulate", *common, "-n", "2", "--simulator", simulator, "--steps", str(STEPS))
    if path.parent.name == "gallery":
        yield f"{name} pruned", command("run", str(path), *dialect, "-n", str(3 * scenes), "--prune")
    yield f"{name} trace", command("trace", str(path), *dialect)
    yield f"{name} enumerated", command("run", str(path), *dialect, "--backend", "enumerate", "--max-runs", "200")


def command(*words: str) -> str:
    """The digest of the file that a command of ours writes, and its exit code."""
    from scenic_ref.cli import main as scenic_ref

    code: object = 0
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()) as shown:
        written = Path(folder) / ("out.json" if "enumerate" in words else "out.jsonl")
        argv, sys.argv = sys.argv, ["scenic-ref", *words, *([] if words[0] == "trace" else ["-o", str(written)])]
        try:
            code = scenic_ref()
        except SystemExit as ended:
            code = ended.code
        finally:
            sys.argv = argv
        content = written.read_bytes() if written.exists() else shown.getvalue().encode()
    return f"exit {code}, {len(content)} bytes, {hashlib.sha256(content).hexdigest()[:16]}"


@cache
def vectors(programs: Path) -> dict[str, ConformanceVector]:
    """The vectors of a tree, by name."""
    from scenic_ref.conformance.vector_files import read_all, texts

    return {v.name: v for v in read_all(sorted(texts(programs / "conformance" / "vectors", "")))}  # type: ignore[arg-type]


def of_vector(vector: ConformanceVector, scenes: int) -> Iterator[tuple[str, str]]:
    """Scenes of both backends, simulations, the exact distribution and the rules of the first run, or the error."""
    from scenic_ref.conformance.implementations.reference import Ourselves, load_unless_refused, trace_first_run

    ours, batch = Ourselves(), Ourselves.by_batch()
    task = vector.task(next(iter(vector.texts)))
    for seed in SEEDS:
        yield f"{vector.name} scenes {seed}", outcome(lambda s=seed: list(ours.scenes(task, scenes, seed=s, attempts=50)))
        yield f"{vector.name} batch {seed}", outcome(lambda s=seed: list(batch.scenes(task, 10 * scenes, seed=s, attempts=50)))
        if vector.steps is not None:
            yield f"{vector.name} simulations {seed}", outcome(lambda s=seed: list(ours.simulations(task, STEPS, 2, seed=s, attempts=20)))
    yield f"{vector.name} exact", outcome(lambda: ours.enumerated(task))
    scenario = load_unless_refused(task)
    if scenario is not None:
        yield f"{vector.name} trace", outcome(lambda: [(e.kind, e.rule) for e in trace_first_run(scenario, 0, 0).events])


def outcome(draw: Callable[[], object]) -> str:
    """The digest of what is drawn; of an error, its class, phase and line."""
    try:
        text = repr(draw())
    except Exception as error:
        inner = error.__cause__ or error
        where = getattr(getattr(inner, "span", None), "line", None)
        return f"{type(inner).__name__} in phase {getattr(inner, 'phase', None)}, line {where}"
    return f"{len(text)} characters, {hashlib.sha256(text.encode()).hexdigest()[:16]}"


if __name__ == "__main__":
    sys.exit(main())
