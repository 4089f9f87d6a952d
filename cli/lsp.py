"""`scenic-ref lsp`: the language server, which editors start."""

from __future__ import annotations

import os
import sys
from typing import Annotated, BinaryIO

import typer

from .options import DebugOption

DEFAULT_CHECK_SECONDS = "5"


def lsp(
    stdio: Annotated[bool, typer.Option("--stdio", help="Speak on standard input and output: the default, which some editors name.")] = False,
    tcp: Annotated[
        int | None, typer.Option("--tcp", metavar="PORT", min=1, max=65535, help="Speak to one client at a port, from this machine alone.")
    ] = None,
    limit_seconds: Annotated[
        str, typer.Option("--limit-seconds", metavar="SECONDS", help="The processor time for the run that checks a program.")
    ] = DEFAULT_CHECK_SECONDS,
    debug: DebugOption = False,
) -> None:
    """Serve an editor by the Language Server Protocol.

    Diagnostics while one types, what a word means, completion, go to definition, the outline. Programs are run once, in a process of their own
    with the limits of `check`, and never trusted. It needs the extra `lsp`.
    """
    from ..interpreter.runtime.optional_packages import missing_package_error
    from ..semantics.store.errors import UsageError
    from .options import seconds_of

    seconds = seconds_of(limit_seconds)
    if seconds is None:
        raise UsageError("--limit-seconds none: a program that is being typed may run without end", hint="give a number of seconds")
    if stdio and tcp is not None:
        raise UsageError("--stdio and --tcp cannot be given together")
    try:
        from ..editors import server
    except ImportError as problem:
        raise missing_package_error("the language server", "pygls", problem) from None
    if tcp is not None:
        import asyncio

        asyncio.run(server.serve_tcp(tcp, seconds))
        return
    if sys.stdin.isatty():
        print("scenic-ref lsp speaks to editors, which start it themselves (docs/editors.md); Ctrl-D ends it", file=sys.stderr)
    server.serve_editor(*own_streams(), seconds)


def own_streams() -> tuple[BinaryIO, BinaryIO]:
    """Standard input and output for the protocol alone: whoever prints something prints it on standard error from now on."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    os.close(nothing)
    return requests, answers
