"""The application: its commands, and the options before the command."""

from __future__ import annotations

from typing import Annotated

import typer

from .. import __version__
from .bench import bench
from .check import check
from .conformance import conformance
from .convert import convert
from .diff import diff
from .fuzz import fuzz
from .lsp import lsp
from .map import show_map
from .options import DebugOption
from .play import play
from .readings import readings
from .rules import rules
from .run import run
from .simulate import simulate
from .trace import trace

EXIT_CODES = {
    0: "ok",
    1: "program error, a warning under check --strict, samples that differ, or a vector that failed",
    2: "wrong usage",
    3: "attempts exhausted",
    4: "internal error",
    5: "inconclusive: a comparison, or scenes that cannot be trusted",
    130: "interrupted",
}
"""What the exit codes of all commands mean."""

WIDEST = 1000
"""Columns of help: as many as the terminal has, up to these."""

app = typer.Typer(
    name="scenic-ref",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": WIDEST},
)
"""The command line as a Typer application."""

app.command("run")(run)
app.command("simulate")(simulate)
app.command("trace")(trace)
app.command("play")(play)
app.command("rules")(rules)
app.command("readings")(readings)
app.command("check")(check)
app.command("convert")(convert)
app.command("diff")(diff)
app.command("fuzz")(fuzz)
app.command("conformance")(conformance)
app.command("map")(show_map)
app.command("bench")(bench)
app.command("lsp")(lsp)


def show_version(wanted: bool) -> None:
    """Show the version and exit."""
    if wanted:
        print(f"scenic-ref {__version__}")
        raise typer.Exit


@app.callback(epilog=f"Exit codes: {'; '.join(f'{code} {meaning}' for code, meaning in EXIT_CODES.items())}.")
def scenic_ref(
    version: Annotated[bool, typer.Option("--version", "-V", callback=show_version, is_eager=True, help="Show the version.")] = False,
    debug: DebugOption = False,
) -> None:
    """The executable reference of the Scenic language: run, trace and question its rules."""
