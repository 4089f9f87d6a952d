"""The process that checks programs for the language server: `python -m scenic_ref.editors.check_worker`, lines of JSON in and out.

It has the walls of `scenic-ref check` around each program (`docs/security.md`), and ends when nobody writes to it any more.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from typing import BinaryIO

from ..api import loads
from ..api.diagnostics import check_and_rehearse, diagnostic_json, of_error, of_warning
from ..interpreter.runtime.limits import Limits
from ..interpreter.runtime.process_sandbox import WALL
from ..semantics.store.errors import RunError, ScenicError

Request = Mapping[str, object]


def diagnostics_of(request: Request) -> list[dict[str, object]]:
    """Return the problems of the program in a request: `text` in `file`, modules beside it in `folder`, under
    limits of `memory` and `seconds`.
    """
    file, text, folder = str(request["file"]), str(request["text"]), request["folder"]
    WALL.build(Limits(int(str(request["memory"])), float(str(request["seconds"]))))
    try:
        scenario, warnings, error = check_and_rehearse(partial(loads, text, file=file, directory=None if folder is None else Path(str(folder))))
        del scenario
    except ScenicError as problem:
        warnings, error = [], problem
    except MemoryError:
        warnings, error = [], RunError("this needs more memory than a program may have while it is checked")
    finally:
        WALL.open()
    return [*(diagnostic_json(of_error(one, file)) for one in (error,) if one is not None), *(diagnostic_json(of_warning(one)) for one in warnings)]


def answer_check(line: bytes) -> dict[str, object]:
    """The answer to a request; what is no fault of the program is told as `failure`."""
    try:
        return {"diagnostics": diagnostics_of(json.loads(line))}
    except Exception as problem:  # the server tells its log
        return {"failure": f"{type(problem).__name__}: {problem}"}


def listen(requests: BinaryIO, waiting: SimpleQueue[bytes]) -> None:
    """Take requests in, and end the process, whatever it does, when there will be no more."""
    for line in requests:
        waiting.put(line)
    os._exit(0)


def serve_checks() -> None:
    """Say by a line that there is somebody, then answer requests in their order.

    Programs, and what they import, have neither the standard input nor the output.
    """
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):
        os.dup2(nothing, stream)
    waiting: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=listen, args=(requests, waiting), daemon=True).start()
    with suppress(BrokenPipeError, KeyboardInterrupt):
        answers.write(b"{}\n")
        answers.flush()
        while True:
            answers.write(json.dumps(answer_check(waiting.get())).encode() + b"\n")
            answers.flush()


if __name__ == "__main__":
    sys.exit(serve_checks())
