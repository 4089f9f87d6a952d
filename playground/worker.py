"""The process that does one piece of work and ends: the program runs in it, within its limits, and in no other."""

from __future__ import annotations

import signal
import traceback
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection

from ..api.diagnostics import of_error
from ..data.scene import in_json
from ..inference.batch.jobs.worker_pools import end_with_parent
from ..semantics.store.errors import AttemptsExhausted, InternalError, ProgramError, RunError, ScenicError
from .jobs import draw_scenes, draw_values, exact_law, send_picture, send_trace, simulate, survey
from .json_views import Json, cut_text, diagnostic_shown
from .request import PlayRequest

MOST_BYTES = 24_000_000
"""The longest message of a process."""
WORKS: Mapping[str, Callable[[PlayRequest, Callable[[Json], None]], None]] = {
    "scenes": draw_scenes, "histogram": draw_values, "law": exact_law, "trace": send_trace, "survey": survey, "simulate": simulate,
    "picture": send_picture,
}  # fmt: skip
"""What does each work."""


def work(asked: PlayRequest, connection: Connection) -> None:
    """Do the work, and send what is found as lines of JSON; the last one has the kind `end`, whatever happens."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()

    def send(found: Json) -> None:
        try:
            data = in_json(found).encode()
        except ValueError:
            raise RunError("what is to be shown has numbers that are not finite") from None
        if len(data) > MOST_BYTES:
            raise RunError(f"what is to be shown is too large: {len(data):,} bytes", hint="make the scenes smaller, or ask for fewer of them")
        connection.send_bytes(data)

    try:
        WORKS[asked.work](asked, send)
    except MemoryError:
        send(problem(RunError("the program needs more memory than it may have", hint="--limit-memory allows more"), asked))
    except (ProgramError, AttemptsExhausted) as error:
        send(problem(error, asked))
    except ScenicError as error:
        send(problem(error, asked) if not isinstance(error, InternalError) else fault(error))
    except RecursionError:
        send(problem(RunError("the program is nested too deeply"), asked))
    except Exception as error:  # the outermost place: what went wrong is told on the page
        send(fault(error))
    send({"kind": "end"})
    connection.close()


def problem(error: ScenicError, asked: PlayRequest) -> Json:
    """An error, as the page shows it; `exhausted` where attempts are."""
    return {"kind": "error", "exhausted": isinstance(error, AttemptsExhausted), "diagnostic": diagnostic_shown(of_error(error, asked.source.file))}


def fault(error: Exception) -> Json:
    """A fault of ours."""
    what = error.message if isinstance(error, InternalError) else "".join(traceback.format_exception_only(error)).strip()
    return {"kind": "fault", "message": cut_text(f"This is a fault of scenic-ref, not of your program; please report it: {what}")}
