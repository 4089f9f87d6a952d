"""The work of `scenic-ref play`: it reads the initial program, makes the page, and serves it."""

from __future__ import annotations

import secrets
import sys
from collections.abc import Iterator
from contextlib import suppress
from importlib.resources import files
from pathlib import Path
from typing import Any

from .. import __version__
from ..cli.options import pairs, read_source, with_map
from ..cli.session import Session
from ..data.scene import in_json
from ..editors.pygments_lexer import rules_for_browsers
from ..interpreter.language.dialects import DIALECTS
from ..interpreter.runtime.optional_packages import is_installed, missing_package_error
from ..sampling.program_source import Source
from ..semantics.readings import PROFILES, READINGS, select
from .json_views import cut_text
from .share_links import Linked, is_link, linked_of

SCRIPTS = (
    "asking.js", "editor.js", "drawn.js", "scenes.js", "histogram.js", "trace.js", "readings.js", "replay.js", "beginning.js",
)  # fmt: skip
"""The parts of the page's script, in their order."""
UNNAMED = "program.scenic"
"""What the program is called that was not read from a file."""
SIMULATORS = {"still": "", "kinematic": "", "pymunk": "pymunk"}
"""The simulators that the page offers, and the package that each needs."""


def source_of(session: Session, file: str | None, *, reading: list[str] | None, **options: Any) -> tuple[Source, Linked | None]:
    """The program to begin with, with the options of the command line, and the link that it came from, if it did. Raises `UsageError`."""
    if file is not None and not is_link(file):
        return read_source(session, file, reading=reading, **options), None
    linked = None if file is None else linked_of(file)
    params = with_map(pairs(options.pop("param"), "-p", "NAME=VALUE"), options.pop("map"))
    text = programs()[0]["program"] if linked is None else linked.program
    return Source(
        UNNAMED, text, readings=pairs(reading, "--reading", "ID=ALT"), params=params, beside=False, **options
    ), linked


def begin(source: Source, linked: Linked | None, seed: int, port: int, *, otherwise: bool, browser: bool) -> None:
    """Serve the page until Ctrl-C. Raises `UsageError` without the extra `play`, and for a port that cannot be used."""
    try:
        from .server import HOST, Playground, bind_socket, serve_playground
    except ImportError as problem:
        missing = "uvicorn" if is_installed("starlette") else "starlette"
        raise missing_package_error("play", missing, problem) from None
    page = page_with(page_data(source, linked, seed))
    door = bind_socket(port, otherwise=otherwise)
    token = secrets.token_urlsafe(32)
    number = door.getsockname()[1]
    address = f"http://{HOST}:{number}/{token}/"
    playground = Playground(source, page, part("door.html"), token, number)
    print(address, flush=True)
    if not source.trust:
        print("programs run in the sandbox; Ctrl-C ends the server", file=sys.stderr, flush=True)
    else:
        print("--trust: programs may do whatever you may; Ctrl-C ends the server", file=sys.stderr, flush=True)
    if browser:
        open_in_browser(address)
    serve_playground(playground, door)


def open_in_browser(address: str) -> None:
    """Open the page in the browser, if there is one."""
    import webbrowser

    with suppress(webbrowser.Error, OSError):
        webbrowser.open(address)


def page_data(source: Source, linked: Linked | None, seed: int) -> dict[str, object]:
    """Return the data with which the page begins."""
    readings = [
        {
            "id": r.id, "kind": r.kind, "about": r.about, "question": r.question, "alternatives": dict(r.alternatives), "places": list(r.places),
            "consequence": r.consequence, "paper": r.default,
            "under": {profile: select(profile, dict(source.readings))[r.id] for profile in PROFILES},
        }
        for r in READINGS.values() if not r.is_note
    ]  # fmt: skip
    return {
        "version": __version__, "file": cut_text(source.file), "name": Path(source.file).name, "program": source.text,
        "seed": seed if linked is None else linked.seed,
        "linked": None if linked is None else linked.readings, "readings": readings, "programs": programs(), "rules": rules_for_browsers(),
        "simulators": [name for name, package in SIMULATORS.items() if not package or is_installed(package)], "trust": source.trust,
        "profile": source.profile, "dialect": source.dialect, "dialects": {name: dialect.profile for name, dialect in DIALECTS.items()},
    }  # fmt: skip


def programs() -> list[dict[str, str]]:
    """The programs that the page offers, the first of which it begins with; their first lines say what they show."""
    found: Iterator[Any] = (p for p in files("scenic_ref.playground").joinpath("programs").iterdir() if p.name.endswith(".scenic"))
    texts = [path.read_text(encoding="utf-8") for path in sorted(found, key=lambda path: path.name)]
    return [{"title": text.partition("\n")[0].lstrip("# "), "program": text.partition("\n")[2].lstrip("\n")} for text in texts]


def page_with(data: dict[str, object]) -> str:
    """The page with its style, its script, and what it begins with, which cannot end the element that holds it."""
    script = "".join(part(name) for name in SCRIPTS)
    page = part("page.html").replace("/*STYLE*/\n", part("page.css")).replace("/*SCRIPT*/\n", script)
    return page.replace("/*GIVEN*/null", in_json(data).replace("<", "\\u003c"), 1)


def part(name: str) -> str:
    """A part of the page as it is shipped."""
    return files("scenic_ref.playground").joinpath("page", name).read_text(encoding="utf-8")
