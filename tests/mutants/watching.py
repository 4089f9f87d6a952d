"""Which lines of `semantics` run while something is done: `Lines`. This file stands alone: processes that tests start load it by its path."""

from __future__ import annotations

import atexit
import json
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType

ROOT = Path(__file__).resolve().parents[2]
FOLDER = str(ROOT / "semantics") + os.sep
MONITORING = getattr(sys, "monitoring", None)
"""From Python 3.12, a line costs once; before, each time that it runs."""


class Lines:
    """The lines of `semantics` that ran since they were last taken."""

    def __init__(self) -> None:
        self.seen: set[tuple[str, int]] = set()
        self.files: dict[str, str | None] = {}

    def file(self, name: str) -> str | None:
        """The file of a code object, relative to the root; None if it is not of `semantics`."""
        if name not in self.files:
            real = os.path.realpath(name)
            self.files[name] = os.path.relpath(real, ROOT) if real.startswith(FOLDER) else None
        return self.files[name]

    def start(self) -> None:
        """Watch from here on."""
        if MONITORING is not None:
            MONITORING.use_tool_id(MONITORING.COVERAGE_ID, "mutants")
            MONITORING.register_callback(MONITORING.COVERAGE_ID, MONITORING.events.LINE, self.line)
            MONITORING.set_events(MONITORING.COVERAGE_ID, MONITORING.events.LINE)
        else:
            threading.settrace(self.call)
            sys.settrace(self.call)

    def take(self) -> dict[str, list[int]]:
        """The lines by file; from here on they count anew."""
        found: dict[str, list[int]] = {}
        for file, number in sorted(self.seen):
            found.setdefault(file, []).append(number)
        self.seen.clear()
        if MONITORING is not None:
            MONITORING.restart_events()
        else:
            sys.settrace(self.call)  # Python ends the watch where `call` itself finds no room on the stack
        return found

    def line(self, code: CodeType, number: int) -> object:
        """`sys.monitoring`: a line is about to run."""
        file = self.file(code.co_filename)
        if file is not None:
            self.seen.add((file, number))
        return MONITORING.DISABLE  # pyright: ignore[reportOptionalMemberAccess]

    def call(self, frame: FrameType, event: str, argument: object) -> Callable[..., object] | None:
        """`sys.settrace`: a function is entered."""
        file = self.file(frame.f_code.co_filename)
        if file is None:
            return None
        add = self.seen.add

        def inner(frame: FrameType, event: str, argument: object) -> Callable[..., object]:
            if event == "line":
                add((file, frame.f_lineno))
            return inner

        return inner


def forget() -> None:
    """Empty the caches of functions of `semantics`, so that what one vector computed runs again in the next."""
    for name, module in list(sys.modules.items()):
        if name.startswith("scenic_ref.semantics"):
            for found in list(vars(module).values()):
                clear = getattr(found, "cache_clear", None)
                if clear is not None:
                    clear()


def watch_until_the_end(folder: str) -> None:
    """Watch this process, and leave its lines in the folder when it ends by itself."""
    lines, process = Lines(), os.getpid()

    def leave() -> None:
        if os.getpid() == process:
            (Path(folder) / f"{process}.json").write_text(json.dumps(lines.take()))

    atexit.register(leave)
    lines.start()


def left_in(folder: str) -> dict[str, list[int]]:
    """The lines that processes left in the folder, which is emptied."""
    found: dict[str, set[int]] = {}
    for path in Path(folder).glob("*.json"):
        for file, numbers in json.loads(path.read_text()).items():
            found.setdefault(file, set()).update(numbers)
        path.unlink()
    return {file: sorted(numbers) for file, numbers in found.items()}
