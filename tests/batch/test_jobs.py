"""Many scenes as jobs: whoever draws them, and however many at a time, the lines and tables are the interpreter's, byte for byte."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path

import numpy as np
import pytest
import scenic_ref
from scenic_ref.data import scene_tables
from scenic_ref.data.scene import Scene
from scenic_ref.data.scene_tables import Columns, Groups, columns_of, rows_in, some, together
from scenic_ref.data.table_files import SUFFIXES as ALL
from scenic_ref.data.table_files import open_table
from scenic_ref.data.typed_columns import JSON, TEXT, TypedColumn, in_first_order, valid_in
from scenic_ref.inference.batch import Block
from scenic_ref.inference.batch.jobs.block_tables import Tables
from scenic_ref.inference.batch.jobs.scene_lines import PACE_KNOWN, Lines, lines_of
from scenic_ref.inference.batch.jobs.worker_pools import Pace, block_of, delay_interrupts, run_jobs_in_order
from scenic_ref.semantics.store.errors import AttemptsExhausted

SUFFIXES = [pytest.param(s, marks=pytest.mark.extra("parquet") if s in (".parquet", ".arrow") else ()) for s in ALL]
EXAMPLES = Path(__file__).parents[2] / "examples"
PROGRAMS = {
    "values": (
        "x = Range(0, 1)\nb = x < 0.5\nc = Uniform(1, 'two %d \"§\\n', None, (3, x))\nd = Discrete({1: 1, 2.5: 3})\n"
        "ego = Object at (d, 0), with a [x, (x, c), {'k': x, '%': b}], with t b, with u c, with w {'inf': 1e308 * 10 * x}\n"
        "other = Object at (9, Range(0, 3)), facing Range(-900, 900) deg, with width d, with length 2\nparam 'p%s' = x, time = c\n"
    ),
    "constant": "ego = Object at (1, 2), with s 'a%b'\n",
    "rejected": "x = Range(0, 1)\nego = Object at (x, 0)\nrequire x > 0.4\nrequire[0.5] x > 0.6\n",
}


def scenario_of(name: str) -> scenic_ref.Scenario:
    return scenic_ref.loads(PROGRAMS[name]) if name in PROGRAMS else scenic_ref.load(EXAMPLES / name)


def whole_lines(lines: Iterable[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode()


def same(one: Columns, other: Columns) -> bool:
    """Whether two tables have the same rows, number for number and text for text, in the same types."""

    def bits(column: TypedColumn) -> object:
        column = in_first_order(column) if column.kind in (TEXT, JSON) else column
        there = valid_in(column)
        return column.kind, column.values[there].tobytes(), list(column.texts), there.tolist()

    return list(one) == list(other) and all(bits(one[name]) == bits(other[name]) for name in one)


def without(block: Block, lost: np.ndarray, scenes: Iterable[Scene]) -> Block:
    """A block of which some rows were left to the interpreter."""
    columns = {number: column[~lost] for number, column in block.columns.items()}
    others = {scene.index: scene for scene, gone in zip(scenes, lost.tolist(), strict=True) if gone}
    return block._replace(rows=block.rows[~lost], columns=columns, others=others)


@pytest.mark.parametrize("name", [*PROGRAMS, "gallery/two_cars.scenic", "gallery/noise.scenic", "paper/mutated_taxi.scenic"])
def test_lines_and_tables_are_those_of_the_interpreter_s_scenes(name):
    scenario = scenario_of(name)
    batch = scenario.batch
    assert batch is not None
    block = block_of(batch, 5, 3, 43)
    scenes = [scenario.sample(5, index) for index in range(3, 43)]
    assert lines_of(batch.template, block, 5) == whole_lines(scene.to_line() for scene in scenes)
    assert same(Tables(batch.template).of(block, 5), columns_of(json.loads(scene.to_line()) for scene in scenes))


@pytest.mark.extra("fast")
@pytest.mark.parametrize("name", [*PROGRAMS, "gallery/two_cars.scenic", "gallery/noise.scenic", "finite.scenic"])
def test_compiled_code_makes_the_same_lines(name):
    batch = scenario_of(name).batch
    assert batch is not None
    lines = Lines(batch.template)
    assert lines.compile()
    block = block_of(batch, 5, 3, 300)
    expected = lines_of(batch.template, block, 5)
    for lost in (block.rows < 0, block.rows % 3 == 0, block.rows < 8, block.rows > 290, block.rows >= 0):
        some = without(block, lost, batch.scenes_of(block, 5))
        assert b"".join(map(bytes, lines.of(some, 5))) == expected
    few = block_of(batch, 5, 9, 9)
    assert b"".join(map(bytes, lines.of(few, 5))) == lines_of(batch.template, few, 5) == b""


@pytest.mark.extra("fast")
def test_lines_are_compiled_once_that_is_worth_it():
    batch = scenario_of("rejected").batch
    assert batch is not None
    lines, block = Lines(batch.template), block_of(batch, 0, 0, 30)
    for _ in range(2):
        list(lines.of(block, 0, ahead=10**9))
    assert lines.rows is None and 0 < lines.pace * 30 < lines.spent < PACE_KNOWN
    lines.spent = 1.01 * PACE_KNOWN
    list(lines.of(block, 0, ahead=1))
    assert lines.rows is None
    assert b"".join(map(bytes, lines.of(block, 0, ahead=10**9))) == lines_of(batch.template, block, 0)
    assert lines.rows is not None


def test_runs_that_were_left_to_the_interpreter_stand_in_their_places():
    batch = scenario_of("values").batch
    assert batch is not None
    whole = block_of(batch, 0, 10, 50)
    part = without(whole, whole.rows % 3 == 0, batch.scenes_of(whole, 0))
    assert lines_of(batch.template, part, 0) == lines_of(batch.template, whole, 0)
    assert same(Tables(batch.template).of(part, 0), Tables(batch.template).of(whole, 0))


def test_the_sizes_of_jobs_change_neither_scenes_nor_attempts():
    batch = scenario_of("rejected").batch
    assert batch is not None
    whole = block_of(batch, 1, 0, 600)
    parts = [block_of(batch, 1, start, min(start + 97, 600)) for start in range(0, 600, 97)]
    assert b"".join(lines_of(batch.template, part, 1) for part in parts) == lines_of(batch.template, whole, 1)
    assert np.concatenate([part.attempts for part in parts]).tolist() == whole.attempts.tolist()


def test_a_scene_s_failed_requirements_are_told_as_the_interpreter_does_however_many_are_drawn():
    scenario = scenic_ref.loads("x = Range(0, 1)\nego = Object at (0, 0)\nrequire x > 0.9\n")
    assert scenario.batch is not None
    block = block_of(scenario.batch, 0, 0, 200, max_attempts=5)
    assert isinstance(block.error, AttemptsExhausted)
    with pytest.raises(AttemptsExhausted) as alone:
        scenario.sample(0, len(block.attempts), max_attempts=5)
    assert (block.error.message, block.error.stuck, block.error.hint) == (alone.value.message, alone.value.stuck, alone.value.hint)


def test_sample_many_gives_the_same_scenes_by_every_backend_and_says_why_not():
    scenario = scenario_of("rejected")
    lines = [[s.to_line() for s in scenario.sample_many(30, 2, start=7, backend=b)] for b in ("auto", "batch", "interpreter")]
    assert lines[0] == lines[1] == lines[2]
    assert scenario.not_lifted is None
    printing = scenic_ref.loads("x = Range(0, 1)\nprint(1)\nego = Object at (x, 0)\n")
    assert [s.index for s in printing.sample_many(12, backend="batch")] == list(range(12))
    assert (printing.batch, printing.not_lifted) == (None, "<string>:2:1: the program prints, in `print(1)`")
    with pytest.raises(scenic_ref.errors.UsageError, match="no backend magic"):
        scenario.sample_many(1, backend="magic")  # type: ignore[arg-type]


def test_jobs_grow_while_they_are_quick_and_shrink_while_they_are_slow():
    pace = Pace(16, objects=4096)
    sizes = []
    for start, stop in pace.parts(5, 100):
        sizes.append(stop - start)
        pace.took(stop - start, 5.0 if len(sizes) > 3 else 0.0)
    assert (sum(sizes), sizes[0], max(sizes)) == (95, 16, 16)
    pace = Pace(8)
    for scenes, seconds, size in ((8, 0.1, 32), (8, 0.1, 32), (32, 1.5, 32), (32, 0.1, 128), (128, 5.0, 64), (16, 5.0, 32), (64, 0.0, 128)):
        pace.took(scenes, seconds)
        assert pace.size == size


def test_results_come_in_order_and_few_jobs_are_under_way():
    """Of each two jobs the second is done first."""
    lock, begun, given = threading.Lock(), [], []
    done = [threading.Event() for _ in range(40)]

    def work(job: int) -> int:
        with lock:
            begun.append(job)
            assert len(begun) - len(given) <= 6
        if job % 2 == 0:
            done[job + 1].wait()
        done[job].set()
        return job

    with ThreadPoolExecutor(4) as pool:
        for result in run_jobs_in_order(pool, work, range(40), 5):
            given.append(result)
    assert given == list(range(40))


def test_results_that_are_there_when_nobody_asks_for_more_are_not_lost():
    """Of three jobs the first is never done while the others are."""
    others, end = threading.Barrier(3), threading.Event()

    def work(job: int) -> int:
        if job == 1:
            end.wait()
        if job > 1:
            others.wait()
        return job

    unread: list[object] = []
    with ThreadPoolExecutor(3) as pool:
        found = run_jobs_in_order(pool, work, range(4), 4, unread)
        assert next(found) == 0
        others.wait()
        wait(list(found.gi_frame.f_locals["waiting"])[1:])
        found.close()
        end.set()
    assert unread == [2, 3]


def test_an_error_in_a_job_is_raised_in_its_place_and_ends_the_rest():
    def work(job: int) -> int:
        return 1 // (3 - job)

    with ThreadPoolExecutor(2) as pool:
        found = run_jobs_in_order(pool, work, range(100), 4)
        assert [next(found) for _ in range(3)] == [0, 0, 1]
        with pytest.raises(ZeroDivisionError):
            next(found)


DYING = """
import os, signal, threading
from scenic_ref.inference.batch.jobs.worker_pools import processes
from scenic_ref.semantics.store.errors import InternalError

def work(job):
    if job == 3:
        threading.Thread(target=die, args=[threading.main_thread().native_id]).start()
        return bytes(1 << 28)
    return job

def die(thread):
    while not open(f"/proc/self/task/{thread}/syscall").read().startswith(WRITING): pass
    os.kill(os.getpid(), signal.SIGKILL)

WRITING = {"x86_64": "1 ", "aarch64": "64 "}[os.uname().machine]
if __name__ == "__main__":
    try:
        with processes(2) as workers:
            print(list(workers.draw(work, range(40))))
    except InternalError as error:
        print(error.message)
"""


def test_a_worker_that_dies_while_it_sends_a_result_is_told_of(tmp_path):
    """The result is larger than a pipe: what was sent of it says that more will come, and the other worker waits until it may write."""
    if not Path("/proc/self/syscall").exists():
        pytest.skip("this system has no /proc/self/syscall")
    (tmp_path / "dying.py").write_text(DYING)
    found = subprocess.run([sys.executable, "dying.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=True)
    assert found.stdout == "a worker process ended without an answer\n"


@pytest.fixture
def rows() -> Columns:
    scenario = scenario_of("values")
    return columns_of(json.loads(s.to_line()) for s in scenario.sample_many(60, backend="interpreter"))


def test_groups_of_rows_end_with_scenes_and_do_not_depend_on_the_pieces(rows, monkeypatch):
    monkeypatch.setattr(scene_tables, "ROWS_AT_ONCE", 13)
    found = []
    for scenes in (1, 3, 7, 60):
        groups = Groups()
        pieces = [some(rows, slice(k, k + 2 * scenes)) for k in range(0, 120, 2 * scenes)]
        found.append([group for piece in pieces for group in groups.add(piece)] + list(groups.rest()))
    assert [rows_in(group) for group in found[0]] == [14] * 8 + [8]
    assert all(len(other) == 9 and all(map(same, found[0], other)) for other in found)
    assert same(together(found[0]), rows)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_table_has_the_same_bytes_whatever_the_pieces(rows, suffix, tmp_path, monkeypatch):
    monkeypatch.setattr(scene_tables, "ROWS_AT_ONCE", 13)
    written = []
    for scenes in (1, 7, 60):
        table = open_table(tmp_path / f"{scenes}{suffix}")
        for k in range(0, 120, 2 * scenes):
            table.add_columns(some(rows, slice(k, k + 2 * scenes)))
        table.finish()
        table.close()
        written.append((tmp_path / f"{scenes}{suffix}").read_bytes())
    assert written[0] == written[1] == written[2]
    assert len(list(tmp_path.iterdir())) == 3


def test_an_npz_table_is_read_by_numpy_alone(rows, tmp_path):
    table = open_table(tmp_path / "scenes.npz")
    table.add_columns(rows)
    table.finish()
    table.close()
    with np.load(tmp_path / "scenes.npz") as read:
        assert json.loads(read["schema.json"])["schema"] == "scenic-ref/table/2"
        for name, column in rows.items():
            there = valid_in(column)
            assert f"{name}.valid" not in read if there.all() else (read[f"{name}.valid"] == there).all()
            if column.kind in (TEXT, JSON):
                texts = read[f"{name}.jsonl"].decode().splitlines()
                written = [None if k < 0 else texts[k] if column.kind == JSON else json.loads(texts[k]) for k in read[name]]
                assert written == [column.texts[k] if v else None for k, v in zip(column.values, there, strict=True)]
            else:
                assert (read[name].dtype, read[name].tobytes()) == (column.values.dtype, column.values.tobytes())


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_unfinished_table_leaves_nothing(rows, suffix, tmp_path):
    table = open_table(tmp_path / f"scenes{suffix}")
    table.add_columns(rows)
    table.close()
    assert not list(tmp_path.iterdir())


def test_an_interrupt_waits_whichever_thread_the_system_tells_of_it():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    begun = threading.Event()
    teller = threading.Thread(target=lambda: (begun.wait(), signal.raise_signal(signal.SIGINT)))
    teller.start()  # before, since it would inherit that nobody tells it
    done: list[str] = []
    try:
        with pytest.raises(KeyboardInterrupt), delay_interrupts():
            begun.set()
            teller.join()
            done.append("after the interrupt")
        assert done and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def test_scenes_without_objects_have_the_same_columns_whoever_draws_them():
    scenario = scenic_ref.loads("x = Range(0, 1)\nparam p = x\n", readings={"no-ego": "allowed"})
    one_by_one, many = (scenario.sample_many(20, backend=backend).columns() for backend in ("interpreter", "batch"))
    assert {name: (a.dtype, a.shape) for name, a in one_by_one.items()} == {name: (a.dtype, a.shape) for name, a in many.items()}
