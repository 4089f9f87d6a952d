"""`Network.fromFile`: the maps that a program reads beside its own, which are read before it runs, as that one is."""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import ClassVar

from ....maps import network
from ....maps.reading import read_map
from ....semantics.kernel.errors import ImportRefused, ScenicError
from ....semantics.kernel.scopes import descendants
from ....semantics.syntax import Program
from ....semantics.syntax.python_expressions import Attribute, Call, Constant, Name

Found = network.Network | Exception
WITHOUT_EFFECT = frozenset({"useCache", "writeCache", "ref_points"})
"""Parameters of the released `fromFile` that change nothing here: maps are kept while they are in use, and curves are exact."""
OUTSIDE = "Network.fromFile reads what the main program names by a text, localPath(a text), or globalParameters.map: maps are read before it runs"


def read(path: Path) -> Found:
    """The map of a file, or why it cannot be had."""
    if path.suffix.lower() != ".xodr":
        return ImportRefused(f"the map of a program is an OpenDRIVE file (.xodr), not {path.name}")
    try:
        return read_map(path)
    except ScenicError as problem:
        return ImportRefused(problem.message)


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


def class_for(program: Program, directory: Path | None, own: Iterable[tuple[str, Path]]) -> type:
    """The class `Network` for a program, whose `own` map it may read again; all networks are its instances."""
    maps = {text: read(path) for text, path in dict([*own, *named(program, directory)]).items()}

    class Network(ABC):  # noqa: B024 (networks are registered with it)
        """The released library's name of networks."""

        scenic_names: ClassVar[frozenset[str]] = frozenset({"fromFile"})

        def __init__(self, *arguments: object, **options: object) -> None:
            raise TypeError("a Network is made by reading a map: Network.fromFile(path)")

        @classmethod
        def fromFile(cls, path: str, *more: object, **options: object) -> network.Network:
            """The map of a file that was read before. Raises `ValueError` where it could not be, `TypeError` for options that would change it."""
            other = next((name for name in options if name not in WITHOUT_EFFECT), None)
            if other is not None:
                raise TypeError(f"Network.fromFile has no {other} in this reference")
            found = maps.get(path) if isinstance(path, str) else None
            if found is None:
                raise ValueError(OUTSIDE)
            if isinstance(found, Exception):
                raise ValueError(str(found))
            return found

    Network.register(network.Network)
    return Network
