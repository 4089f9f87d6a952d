"""`Network.fromFile`: the maps that a program reads beside its own, which are read before it runs, as that one is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from ....maps.network import Network
from ....maps.reading import read_map
from ....semantics.kernel.errors import ImportRefused, ScenicError
from ....semantics.kernel.scopes import descendants
from ....semantics.syntax import Program
from ....semantics.syntax.nodes import NOWHERE, Span
from ....semantics.syntax.python_expressions import Attribute, Call, Constant, Name


def read(path: Path, span: Span = NOWHERE, directory: Path | None = None) -> Network | Exception:
    """The map of a file, which a program in the directory names there, or why it cannot be had."""
    if path.suffix.lower() != ".xodr":
        return ImportRefused(f"the map of a program is an OpenDRIVE file (.xodr), not {path.name}", span)
    try:
        return read_map(path)
    except ScenicError as problem:
        return ImportRefused(problem.message, span, hint=problem.hint or beside(path, directory))


def beside(path: Path, directory: Path | None) -> str:
    """What to write where a map that is not there is beside the program; "" otherwise."""
    if directory is None or path.is_absolute() or path.exists() or not (directory / path).is_file():
        return ""
    return f"{path.name} is beside the program: write localPath({str(path)!r}), or give the path {directory / path}"


def text_and_path(node: object, directory: Path | None) -> tuple[str, Path] | None:
    """The text that an expression gives, and the file that it names; None for other expressions."""
    match node:
        case Constant(value=str() as path):
            return path, Path(path)
        case Call(function=Name(name="localPath"), arguments=(Constant(value=str() as path),), keywords=()):
            folder, slash, _ = node.span.file.rpartition("/")
            return path if path.startswith("/") else folder + slash + path, (directory or Path()) / path
        case _:
            return None


def named(program: Program, directory: Path | None) -> Iterator[tuple[str, Path]]:
    """The texts that a program gives to `fromFile`, and the files that they name."""
    for statement in program.statements:
        for node in descendants(statement):
            match node:
                case Call(function=Attribute(name="fromFile"), arguments=(first, *_)) if found := text_and_path(first, directory):
                    yield found
                case _:
                    pass


def maps_of(program: Program, directory: Path | None, own: Iterable[tuple[str, Path]]) -> dict[str, Network | str]:
    """The maps that a program may read by `fromFile`, its `own` one among them, by the texts that it gives, or why they cannot be had."""
    found = {text: read(path) for text, path in dict([*own, *named(program, directory)]).items()}
    return {text: str(one) if isinstance(one, Exception) else one for text, one in found.items()}
