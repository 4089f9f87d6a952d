"""The progress of a run, on a terminal: scenes, rate, attempts per scene, acceptance, time left."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

from .session import console, escape_controls, tell

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import TaskID

INTERVAL = 0.1
A_WHILE = 2.0
"""After so many seconds a single scene has a bar."""
LONG_FOR_ONE_RUN = 3.0
"""Seconds after which a word is said of the run before the first scene."""
LOOK_AFTER, LONG = 30.0, 1800.0
"""After so many seconds it is looked at how many are left, and said if they are as many as this."""
FEW_ACCEPTED = 1e-3
FEW_SCENES = 10
"""With fewer scenes than these, how likely one is is guessed otherwise."""


@contextmanager
def running_once(fuel: int) -> Iterator[None]:
    """While a program runs once before anything else: on a terminal, a word if that takes long."""
    text = f"the program is run once before anything else, which takes a while; after {fuel:,} steps it is given up (--fuel)"
    timer = threading.Timer(LONG_FOR_ONE_RUN, tell, [text])
    timer.daemon = True
    if sys.stderr.isatty():
        with suppress(RuntimeError):  # a thread needs memory, which may be limited
            timer.start()
    try:
        yield
    finally:
        timer.cancel()


class Foresight(Protocol):
    """Estimates about a run before its scenes exist."""

    def runs(self) -> int:
        """How many runs were made so far, if that is known; else 0."""
        ...

    def probability(self) -> float | None:
        """About the probability that a run is accepted, which may take seconds; None if it cannot be guessed."""
        ...


class Progress:
    """The progress bar of a run of `total` scenes, of which `done` are there; silent if standard error is not a terminal."""

    def __init__(self, total: int, done: int = 0, *, what: str = "scenes", foresight: Foresight | None = None) -> None:
        self.total = total
        self.what = what
        self.scenes = self.begun_with = done
        self.attempts = 0
        self.pending = 0
        self.begun = self.shown = time.monotonic()
        self.bar: Bar | None = None
        self.task: TaskID | None = None
        self.is_foretold = False
        self.foresight = foresight
        self.timer: threading.Timer | None = None

    def __enter__(self) -> Progress:
        if self.foresight is not None:
            self.timer = threading.Timer(LOOK_AFTER, self.foretell)
            self.timer.daemon = True
            with suppress(RuntimeError):  # a thread needs memory, which may be limited: then nothing is foretold
                self.timer.start()
        if self.total > 1:
            self.start()
        return self

    def start(self) -> None:
        """Show the bar on a terminal; that of a single scene is shown when it takes a while."""
        if not sys.stderr.isatty():
            return
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        columns = (TextColumn(self.what), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeRemainingColumn(compact=True))
        self.bar = Bar(*columns, console=console(sys.stderr), transient=True)
        self.bar.start()
        self.task = self.bar.add_task("", total=self.total, completed=self.scenes, rate="")

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.timer is not None:
            self.timer.cancel()
        if self.bar is not None:
            self.bar.stop()

    def stuck(self, attempts: int) -> None:
        """How many attempts at the current scene got stuck."""
        self.pending = attempts
        self.foretell()
        self.show()

    def drawn(self, attempts: int, scenes: int = 1) -> None:
        """More scenes were drawn; in how many attempts."""
        self.scenes += scenes
        self.attempts += attempts
        self.pending = 0
        self.foretell()
        self.show()

    def foretell(self) -> None:
        """Say once that it will take long, and which backend would do better, if few runs are accepted.

        Where hardly a scene is there yet, the probability of one is guessed, apart from the work; so this also runs by the clock.
        """
        elapsed = time.monotonic() - self.begun
        if self.is_foretold or elapsed < LOOK_AFTER:
            return
        new, attempts = self.scenes - self.begun_with, self.attempts + self.pending
        if self.foresight is not None:
            attempts = max(attempts, self.foresight.runs())
        left, at_least, share = elapsed / max(new, 1) * (self.total - self.scenes), "" if new else "at least ", new / max(attempts, 1)
        if new < FEW_SCENES and self.foresight is not None:
            if not attempts:
                return
            self.is_foretold = True  # what is guessed is guessed once
            guessed = self.foresight.probability()
            if guessed:
                left, at_least, share = (self.total - self.scenes) * elapsed / (guessed * attempts), "about ", guessed
        if left < LONG:
            return
        self.is_foretold = True
        text = f"note: at this pace it will take {at_least}{left / 3600:.1f} hours more"
        if share < FEW_ACCEPTED:
            seldom = f"about one run in {1 / share:,.0f} is accepted" if at_least == "about " else f"of {attempts:,} attempts {new:,} gave a scene"
            text += f": {seldom}; --backend smc or mcmc would do better, since they come nearer step by step"
        self.say(text)

    def show(self) -> None:
        """Update the bar, not too often."""
        now = time.monotonic()
        if self.bar is None and self.total == 1 and now - self.begun > A_WHILE:
            self.start()
        if self.bar is None or self.task is None or now - self.shown < INTERVAL:
            return
        self.shown = now
        new = self.scenes - self.begun_with
        rate = f"{new / (now - self.begun):.3g}/s" if new else ""
        attempts = self.attempts + self.pending
        each = f"{attempts / max(new, 1):.3g} attempts each" + (f" ({new / attempts:.2%} accepted)" if new else "") if attempts else ""
        self.bar.update(self.task, completed=self.scenes, rate=f"{rate}  {each}")

    def say(self, text: str) -> None:
        """A line on standard error, above the bar."""
        if self.bar is not None:
            self.bar.console.print(escape_controls(text), markup=False, highlight=False)
        else:
            tell(text)
