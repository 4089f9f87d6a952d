"""Which modules a program may import, found before it runs, since the machine itself reads no files (DESIGN, section 4).

Always allowed: Scenic modules next to the program, the world models that the project ships, and the harmless standard
modules below. Any other Python module runs arbitrary code and needs `trust`.
"""

from __future__ import annotations

import importlib
import importlib.util
import random
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from ..semantics.budget import refuse_too_long
from ..semantics.errors import ImportRefused, ScenicError, UsageError
from ..semantics.library import MODULES
from ..semantics.scopes import descendants
from ..semantics.syntax import Program
from ..semantics.syntax import statements as s
from .parser import parse

Library = dict[str, Program | Mapping[str, object] | Exception]
World = Callable[[], str | Mapping[str, object]]
"""A shipped module: gives the text of a Scenic module, or the namespace of a Python one."""


def _members(module: object, without: tuple[str, ...] = ()) -> Mapping[str, object]:
    return {n: getattr(module, n) for n in dir(module) if not n.startswith("_") and n not in without}


class Seeded(random.Random):
    """`random.Random(seed)`: only with a seed, so that a scene is a function of the program, its seed and its number."""

    scenic_names = frozenset({
        "random", "uniform", "randint", "randrange", "choice", "choices", "sample", "shuffle", "gauss", "normalvariate", "triangular", "betavariate",
        "expovariate", "gammavariate", "lognormvariate", "vonmisesvariate", "paretovariate", "weibullvariate",
    })  # fmt: skip

    def __init__(self, seed: object = None) -> None:
        if not isinstance(seed, (int, str)):
            raise TypeError("random.Random takes a whole number or a text as its seed")
        super().__init__(seed)

    def choices(self, population: Any, weights: Any = None, *, cum_weights: Any = None, k: int = 1) -> list[Any]:
        """Some of the population, each drawn anew."""
        refuse_too_long(k)
        return super().choices(population, weights, cum_weights=cum_weights, k=k)


HARMLESS: Mapping[str, Mapping[str, object]] = {**MODULES, "random": {"Random": Seeded}}
"""The standard modules that need no trust."""


def library_of(
    program: Program, *, worlds: Mapping[str, World], model: str | None, trust: bool, directory: Path | None, dialect: str | None
) -> Library:
    """Every module that the program, or a module it imports, may ask for by a statement."""
    library: Library = {}
    waiting = [(model, True)] if model else []
    waiting += imported_names(program)
    while waiting:
        name, is_needed = waiting.pop()
        if name in library:
            continue
        found = find(name, worlds=worlds, trust=trust, directory=directory, dialect=dialect, importer=program.file)
        if found is None and is_needed:
            near = get_close_matches(name, [*worlds, *HARMLESS], n=1)
            found = ImportRefused(f"there is no module {name}", hint=f"did you mean {near[0]}?" if near else "")
        if found is not None:
            library[name] = found
        if isinstance(found, Program):
            waiting += imported_names(found)
    return library


def imported_names(program: Program) -> Iterator[tuple[str, bool]]:
    """The modules that the statements of a program name, wherever they stand; False for `from m import n`, where m.n may be one."""
    for statement in program.statements:
        for node in descendants(statement):
            match node:
                case s.Import(names=names):
                    yield from ((n.name, True) for n in names)
                case s.ImportFrom(module=module, names=names, level=level):
                    yield "." * level + module, bool(module)
                    yield from ((f"{'.' * level}{module}.{n.name}", False) for n in names)
                case s.Model(name=name):
                    yield name, True
                case _:
                    pass


def with_old_imports(program: Program, library: Library) -> Program:
    """In dialect `pldi19`, `import m` of a Scenic module brings its names as well (the gallery's `import mars`)."""
    if program.dialect != "pldi19":
        return program
    statements: list[s.Statement] = []
    for statement in program.statements:
        statements.append(statement)
        if isinstance(statement, s.Import):
            statements += [s.ImportFrom(module=n.name, names=(), span=n.span) for n in statement.names if isinstance(library.get(n.name), Program)]
    return replace(program, statements=tuple(statements))


def find(
    name: str, *, worlds: Mapping[str, World], trust: bool, directory: Path | None, dialect: str | None, importer: str = ""
) -> Program | Mapping[str, object] | Exception | None:
    """The module of that name; an error to raise at the import; None if there is none."""
    local = scenic_file(name, directory)
    if local is not None and leads_away(local, folder_of(name, directory)):
        return linked_program(name, local, dialect)
    if local is not None and not (importer and local.resolve() == Path(importer).resolve()):
        return read_program(local, dialect)
    if name in worlds:
        found = worlds[name]()
        return parse(found, f"<{name}>") if isinstance(found, str) else found
    if name in HARMLESS:
        return HARMLESS[name]
    if name.startswith("."):
        return None
    if not python_module_exists(name, directory):
        return None
    if not trust:
        return ImportRefused(
            f"importing {name} runs Python code that could do anything on this machine, so it needs --trust",
            hint="give --trust if you know the code, or use math, itertools, functools, collections, enum",
        )
    return load_python(name, directory)


def leads_away(path: Path, folder: Path | None) -> bool:
    """Whether a link leads from the folder in which a module is looked for to a file elsewhere."""
    return folder is not None and not path.resolve().is_relative_to(folder.resolve())


def linked_program(name: str, path: Path, dialect: str | None) -> Program | Exception:
    """A module elsewhere; if it is no program, nothing of what stands there is told but its name."""
    try:
        return read_program(path, dialect)
    except (ScenicError, OSError):
        return ImportRefused(f"{name} is a link to a file outside the program's folder, and that is no Scenic program")


def scenic_file(name: str, directory: Path | None) -> Path | None:
    """NAME.scenic next to the program, dots being folders."""
    base = folder_of(name, directory)
    if base is None:
        return None
    stripped = name.lstrip(".")
    path = base.joinpath(*stripped.split(".")).with_suffix(".scenic") if stripped else base
    return path if path.is_file() else None


def folder_of(name: str, directory: Path | None) -> Path | None:
    """The folder that a module's name begins in: the program's, or one above it for each dot after the first."""
    dots = len(name) - len(name.lstrip("."))
    return directory if directory is None or dots < 2 else directory.joinpath(*[".."] * (dots - 1))


def read_program(path: Path, dialect: str | None) -> Program:
    """Parse and check a file."""
    from .checks import check

    program = parse(read_text(path), str(path), dialect)
    check(program)
    return program


def read_text(path: Path) -> str:
    """The text of a program file. Raises `UsageError` for directories, missing and unreadable files, and binary data."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except IsADirectoryError:
        raise UsageError(f"{path} is a directory, not a Scenic program") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    if b"\0" in data:
        raise UsageError(f"{path} is not a text file")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is not a text file in UTF-8 (byte {error.start})") from None


def python_module_exists(name: str, directory: Path | None) -> bool:
    """Whether Python would find the module, without running any of it."""
    first = name.partition(".")[0]
    if directory is not None and (directory / f"{first}.py").is_file():
        return True
    try:
        return importlib.util.find_spec(first) is not None
    except (ImportError, ValueError):
        return False


def load_python(name: str, directory: Path | None) -> Mapping[str, object] | Exception:
    """Import a Python module that the user trusts."""
    if directory is not None and str(directory) not in sys.path:
        sys.path.insert(0, str(directory))
    try:
        return _members(importlib.import_module(name))
    except ScenicError:
        raise
    except Exception as exception:  # trusted code may fail in any way; the import statement reports it
        return ImportRefused(f"importing {name} failed: {type(exception).__name__}: {exception}")
