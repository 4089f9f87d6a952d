"""The command line, `scenic-ref`; `app.EXIT_CODES` says what its exit codes mean.

Everything but `main` is imported when it is first needed, so that `scenic-ref --help` answers at once.
"""

from __future__ import annotations

import os
import sys
import warnings
from itertools import pairwise

from ..interpreter.runtime.supervisor import supervise

INTERRUPTED = 130


def interruption(arguments: list[str], finished: str = "") -> str:
    """The message after Ctrl-C: what was `finished`, and which files there are."""
    if arguments[:1] == ["run"] and not {"enumerate", "importance", "smc", "mcmc"} & {a.removeprefix("--backend=") for a in arguments}:
        from .output_paths import LINES

        output = output_in(arguments)
        if output == "-":
            return "interrupted"
        if os.path.splitext(output)[1].lower() not in LINES or not os.path.exists(output):
            return f"interrupted; {output} was not written"
        more = "" if any(a.partition("=")[0] == "--scene" for a in arguments) else ", and `run --resume` continues it"
        return f"interrupted; {output} holds whole lines{more}; nothing else was written"
    if arguments[:1] == ["simulate"]:
        return f"interrupted; {finished or 'no simulation was finished'}"
    return "interrupted" if arguments[:1] == ["bench"] else f"interrupted; {finished or 'nothing was written'}"


def output_in(arguments: list[str]) -> str:
    """The file of the option -o, the last one if it is given more often; "-" for none."""
    output = "-"
    for one, following in pairwise([*arguments, "-"]):
        if one in ("-o", "--output"):
            output = following
        elif one.startswith(("-o", "--output=")):
            output = one.removeprefix("--output=").removeprefix("-o")
    return output


def main() -> None:
    """The command `scenic-ref`: answers the command line that the process was given, then exits."""
    if sys.stdout is None:  # the caller closed it
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 (for as long as the process lives)
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 (likewise)
    supervise(sys.argv[1:])
    warnings.filterwarnings("ignore", category=RuntimeWarning, module="shapely")  # what overflows there is far away, and the answer says so
    try:
        code = run_command_line(sys.argv[1:])
    except KeyboardInterrupt:
        print(interruption(sys.argv[1:]), file=sys.stderr)
        code = INTERRUPTED
    sys.exit(code)


def open_wall() -> None:
    """Lift the limits of the program that was run, before the next one in this process."""
    walls = sys.modules.get(f"{__package__}.interpreter.runtime.process_sandbox".replace(".cli.", "."))
    if walls is not None:
        walls.WALL.open()


def run_command_line(arguments: list[str]) -> int:
    """The exit code of a command line; its messages go to standard output and standard error."""
    from .session import Session

    session = Session()
    try:
        try:
            from .app import app

            app(arguments, prog_name="scenic-ref", obj=session)
        finally:
            sys.stdout.flush()
            open_wall()
    except SystemExit as done:
        if isinstance(done.__context__, BrokenPipeError):
            session.hang_up()
            return 0
        if done.code == INTERRUPTED:
            print(interruption(arguments, session.finished), file=sys.stderr)
        return done.code if isinstance(done.code, int) else 0 if done.code is None else 1
    except BrokenPipeError:
        session.hang_up()
    except Exception as error:  # the outermost place: everything that went wrong is told here
        from .error_messages import report_error

        return report_error(error, session)
    return 0
