"""A campaign: programs examined by some processes, one line of a file each, so that it can be interrupted and go on."""

from __future__ import annotations

import json
import signal
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from itertools import count
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ...inference.batch.jobs.worker_pools import end_with_parent
from ...semantics.store.errors import UsageError
from ..implementations.environments import implementation
from ..implementations.harness_client import External
from .causes import seen_often
from .examination import OUR_FAULT, CampaignSettings, FuzzedProgram, examine
from .themed_programs import generate_themed_program

FORMAT = "scenic-ref/campaign/1"
others: list[External] = []
"""The implementation of this process."""


class Journal:
    """The lines of a campaign: its settings, then what became of each program. Raises `UsageError` for a file of another campaign."""

    def __init__(self, path: Path, settings: CampaignSettings, name: str, *, resume: bool) -> None:
        self.path, self.examined = path, list[FuzzedProgram]()
        first = {"format": FORMAT, "implementation": name, "settings": asdict(settings)}
        if path.exists() and not resume:
            raise UsageError(f"{path} holds a campaign already", hint="--resume goes on with it")
        if not path.exists():
            self.write(first, "x")
            return
        kept, lines = read_campaign(path)
        same = all(kept["settings"].get(key) == first["settings"][key] for key in ("impl", "seed", "alpha", "readings"))
        if not same or kept["implementation"] != name:
            raise UsageError(f"{path} holds a campaign with other settings", hint="impl, seed, alpha and profile stay the same")
        self.examined += lines

    def add(self, found: FuzzedProgram) -> None:
        """Add one more examined program, and write it."""
        self.examined.append(found)
        self.write(asdict(found), "a")

    def write(self, line: Mapping[str, object], mode: str) -> None:
        """A line, on the disk before the next."""
        try:
            with open(self.path, mode, encoding="utf-8") as file:
                file.write(json.dumps(line, ensure_ascii=False) + "\n")
        except OSError as error:
            raise UsageError(f"{self.path} cannot be written: {error.strerror or error}") from None


def read_campaign(path: Path) -> tuple[dict[str, dict[str, object]], list[FuzzedProgram]]:
    """The settings and programs of a campaign; a last line that was cut off is left out. Raises `UsageError`."""
    try:
        *whole, last = path.read_text("utf-8").split("\n")  # nothing, or a line that was cut off
        first = json.loads(whole[0])
        if first.get("format") != FORMAT:
            raise ValueError(f"its format is not {FORMAT}")
        if last:
            path.write_text("".join(f"{line}\n" for line in whole), "utf-8")
        return first, [as_examined(json.loads(line)) for line in whole[1:]]
    except (OSError, ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        raise UsageError(f"{path} is not a campaign: {error}") from error


def as_examined(told: Mapping[str, Any]) -> FuzzedProgram:
    """A line of a campaign."""
    return FuzzedProgram(**{**told, "rules": tuple(told["rules"]), "properties": tuple(told["properties"])})


def start(settings: CampaignSettings) -> None:
    """A process that examines has an implementation of its own, leaves Ctrl-C to the one that asked, and ends with it, however that ends."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    others[:] = [implementation(settings.impl, settings.answer, lambda line: None)]


def examined_here(number: int, settings: CampaignSettings, often: frozenset[tuple[str, str]]) -> FuzzedProgram:
    """A program, in such a process. A fault of ours is a finding as well."""
    began = time.monotonic()
    try:
        return examine(number, settings, others[0], often)
    except Exception as fault:
        theme, text = generate_themed_program(settings.seed, number)
        words, told = f"{type(fault).__name__}: {fault}"[:200], "".join(traceback.format_exception(fault)[-3:])
        return FuzzedProgram(number, theme, "differ", OUR_FAULT, time.monotonic() - began, text, words, told, minimal=text, confirmed=True)


def campaign(settings: CampaignSettings, journal: Journal, seconds: float, workers: int, tell: Callable[[FuzzedProgram], None]) -> None:
    """Examine programs for some time. Whoever interrupts it loses those that were being examined."""
    until = time.monotonic() + seconds
    done = {found.number for found in journal.examined}
    numbers = (number for number in count() if number not in done)
    while time.monotonic() < until:
        for found in examined_by(workers, settings, journal, numbers, until):
            journal.add(found)
            tell(found)


def examined_by(
    workers: int, settings: CampaignSettings, journal: Journal, numbers: Iterator[int], until: float
) -> Iterator[FuzzedProgram]:
    """Programs as they become ready, until the time is over or a process dies: what it examined is a finding."""
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=start, initargs=(settings,))
    pending: dict[Future[FuzzedProgram], int] = {}
    broken: list[int] = []
    try:
        while pending or time.monotonic() < until:
            while len(pending) < workers and time.monotonic() < until:
                number = next(numbers)
                pending[pool.submit(examined_here, number, settings, seen_often(journal.examined))] = number
            ready, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in ready:
                broken[:] = [pending.pop(future)]
                yield future.result()
    except BrokenProcessPool:
        for number in [*broken, *pending.values()]:
            theme, text = generate_themed_program(settings.seed, number)
            yield FuzzedProgram(number, theme, "differ", OUR_FAULT, 0.0, text, "a process died", minimal=text, confirmed=True)
    finally:
        kill_pool(pool)


def kill_pool(pool: ProcessPoolExecutor) -> None:
    """Nothing of a pool is left, whatever it was doing."""
    processes = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes:
        process.terminate()
    for process in processes:
        process.join()
