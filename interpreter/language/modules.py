"""Which modules a program may import, found before it runs, since the machine itself reads no files (DESIGN, section 4).

Always allowed: Scenic modules next to the program, the world models that the project ships, and the harmless standard
modules below. Any other Python module runs arbitrary code and needs `trust`.
"""

from __future__ import annotations
import __future__

import importlib
import importlib.util
import random
import re
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from ...semantics.python.imports import key_of, member_key, package_of, sibling_module_key
from ...semantics.python.library import MODULES
from ...semantics.store.budget import refuse_too_long
from ...semantics.store.errors import ImportRefused, ScenicError, UsageError
from ...semantics.store.scopes import descendants
from ...semantics.store.suggestions import nearest
from ...semantics.syntax import Program
from ...semantics.syntax import statements as s
from ..runtime.regular_file import read_regular_file
from .parser import parse

Found = Program | Mapping[str, object] | Exception | None
Library = dict[str, Program | Mapping[str, object] | Exception]
World = Callable[[], str | Mapping[str, object] | Exception]
"""A shipped module: gives the text of a Scenic module, the namespace of a Python one, or why it cannot be had."""


def _members(module: object) -> Mapping[str, object]:
    """Return the members of a Python module that a program can use: the names that do not begin with an
    underscore, and those in its `__all__`, which `*` imports.
    """
    listed = getattr(module, "__all__", None)
    found = {name: getattr(module, name) for name in dir(module) if not name.startswith("_")}
    if isinstance(listed, (list, tuple)) and all(isinstance(name, str) for name in listed):
        found |= {name: getattr(module, name) for name in listed if hasattr(module, name)} | {"__all__": list(listed)}
    return found


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


HARMLESS: Mapping[str, Mapping[str, object]] = {**MODULES, "random": {"Random": Seeded}, "__future__": dict.fromkeys(__future__.all_feature_names)}
"""The standard modules that need no trust."""


class Asked(NamedTuple):
    """A module as a statement names it, in a module of `package`; not `needed` where `from m import n` names m.n, which need not be a module."""

    name: str
    level: int
    package: str
    needed: bool


def library_of(
    program: Program, *, worlds: Mapping[str, World], model: str | None, trust: bool, directory: Path | None, dialect: str | None
) -> Library:
    """Every module that the program, or a module it imports, may ask for by a statement, by its key (`semantics/python/imports.py`)."""
    library: Library = {}
    waiting = [Asked(model, 0, ".", needed=True)] if model else []
    waiting += imported_names(program, ".")
    while waiting:
        asked = waiting.pop()
        key = sibling_module_key(asked.name, asked.level or 1, asked.package if asked.level else ".")
        if (key if asked.level else asked.name) in library or isinstance(library.get(key), (Program, Mapping)):
            continue
        key, found = locate_module(asked, key, program, worlds=worlds, trust=trust, directory=directory, dialect=dialect)
        if found is not None:
            library[key] = found
        if isinstance(found, Program):
            waiting += imported_names(found, package_of(key))
    return library


def locate_module(
    asked: Asked, key: str, program: Program, *, worlds: Mapping[str, World], trust: bool, directory: Path | None, dialect: str | None
) -> tuple[str, Found]:
    """The key of what was asked for, which would be `key` beside the program, and what it is: None for what need not be there and is not."""
    found: Found = find_beside(key, directory=directory, dialect=dialect, importer=program.file)
    if found is not None:
        return key, found
    if not asked.level and (asked.name in worlds or asked.name in HARMLESS):
        return asked.name, find_shipped_module(asked.name, worlds)
    if is_package(key, directory):
        return key, {}
    key = key if asked.level else asked.name
    found = find_python(key, trust=trust, directory=directory) if asked.needed or trust else None
    name = "." * asked.level + asked.name
    if found is None and is_program(key, directory, program.file):
        return key, not_itself(name)
    chosen = {node.name for statement in program.statements for node in descendants(statement) if isinstance(node, s.Model)}
    imported = set(imported_modules(program)) - chosen
    return key, absent(name, worlds, chosen, imported) if found is None and asked.needed else found


def imported_names(program: Program, package: str) -> Iterator[Asked]:
    """The modules that the statements of a program name, wherever they stand."""
    for statement in program.statements:
        for node in descendants(statement):
            match node:
                case s.Import(names=names):
                    yield from (Asked(n.name, 0, package, needed=True) for n in names)
                case s.ImportFrom(module=module, names=names, level=level):
                    yield Asked(module, level, package, needed=True)
                    yield from (Asked(member_key(module, n.name).lstrip("."), level, package, needed=False) for n in names)
                case s.Model(name=name):
                    yield Asked(name, 0, package, needed=True)
                case _:
                    pass


def imported_modules(program: Program) -> Iterator[str]:
    """The modules that `import` and `from` name in a program, wherever they stand; `model` is no such statement."""
    for statement in program.statements:
        for node in descendants(statement):
            if isinstance(node, s.Import):
                yield from (one.name for one in node.names)
            elif isinstance(node, s.ImportFrom):
                yield node.module


THEIRS = re.compile(
    r"scenic\.(?:core|syntax|formats)\b|scenic\.domains\.driving\b|scenic\.contracts\b"
    r"|scenic\.simulators\.(?:airsim|carla|gta|lgsvl|metadrive|newtonian|sumo|unity|utils|webots|xplane)\b"
)
"""Names of modules and packages that the released implementations have."""


def absent(
    name: str, worlds: Mapping[str, World], chosen: Collection[str] = (), imported: Collection[str] = ()
) -> ModuleNotFoundError:
    """The error that there is no such module, with the nearest name that there is, and the world models.

    A module that the released implementations have is named as theirs; `chosen` are the world models that the program has, and
    `imported` are the modules that it imports, which are no world models.
    """
    models = [key for key in worlds if key.endswith(".model") or "." not in key]
    short = {key.split(".")[-2]: key for key in models if key.endswith(".model")}
    if short.get(name) in chosen:
        error = ModuleNotFoundError(f"there is no module {name}: the Python package of that simulator is not installed here")
        error.add_note(f"leave the import out: {short[name]} gives what it stands for without that package")
        return error
    if name in short and name in imported:
        error = ModuleNotFoundError(f"there is no module {name}: the Python package of that simulator is not installed here")
        error.add_note(f"leave the import out; the objects of that simulator come with `model {short[name]}`, without that package")
        return error
    model = f"{name}.model" if f"{name}.model" in worlds else None
    near = model or nearest(name, [*worlds, *HARMLESS]) or (name if name in short else nearest(name, short))
    theirs = THEIRS.match(name) is not None and near is None
    outside = f"the module {name} of the released implementations is outside this reference: {why_outside(name)}"
    error = ModuleNotFoundError(outside if theirs else f"there is no module {name}")
    if near is not None:
        error.add_note(f"did you mean {short.get(near, near)}?")
    elif name.startswith("scenic.") and not theirs:
        error.add_note(f"the releases have none of that name either; world models are {', '.join(models)}")
    elif theirs and name.endswith(".model"):
        error.add_note(f"world models are {', '.join(models)}")
    elif name.isidentifier():
        short_list = [key for key in models if "." not in key or key.startswith("scenic.domains.")]
        error.add_note(f"there is no file {name}.scenic beside the program; world models are {', '.join(short_list)}")
    return error


def is_program(key: str, directory: Path | None, file: str) -> bool:
    """Whether the file of a module beside the program is that of the program itself."""
    path = None if directory is None or not key.strip(".") else path_of(key, directory)
    return path is not None and path.with_name(f"{path.name}.scenic").resolve() == Path(file).resolve()


def not_itself(name: str) -> ModuleNotFoundError:
    """The error that the program cannot be imported."""
    error = ModuleNotFoundError(f"there is no module {name}: its file is that of the program itself, which cannot be imported")
    error.add_note("move what is needed of it into a file of its own, and import that")
    return error


def why_outside(name: str) -> str:
    """Why a module of the released implementations is not here."""
    if any(word in name for word in ("carla", "lgsvl", "metadrive")):
        return "it is about a simulator that this reference does not know; on roads without one, write `model scenic.domains.driving.model`"
    return "it is about a simulator that this reference does not know" if name.startswith("scenic.simulators.") else "it is a part of theirs alone"


def module_named(name: str, library: Library) -> Found:
    """The module that the main program means by a name."""
    return library.get(key_of(name, 0, ".", library))


def with_old_imports(program: Program, library: Library) -> Program:
    """In dialect `pldi19`, `import m` of a Scenic module brings its names as well (the gallery's `import mars`)."""
    if program.dialect != "pldi19":
        return program
    statements: list[s.Statement] = []
    for statement in program.statements:
        statements.append(statement)
        if isinstance(statement, s.Import):
            scenic = [n for n in statement.names if isinstance(module_named(n.name, library), Program)]
            statements += [s.ImportFrom(module=n.name, names=(), span=n.span) for n in scenic]
    return replace(program, statements=tuple(statements))


def find_beside(key: str, *, directory: Path | None, dialect: str | None, importer: str) -> Program | Exception | None:
    """The Scenic module beside the program, an error to raise at the import, None if there is none. The program itself is no module."""
    if directory is None or not key.strip("."):
        return None
    path = path_of(key, directory)
    file = path.with_name(f"{path.name}.scenic")
    if not file.is_file():
        return None
    if leads_away(file, folder_of(key, directory)):
        return linked_program(key.lstrip("."), file, dialect)
    return None if is_program(key, directory, importer) else read_program(file, dialect)


def is_package(key: str, directory: Path | None) -> bool:
    """Whether this is the program's folder, one above it, or one below with Scenic modules."""
    if directory is None:
        return False
    path = path_of(key, directory)
    return not key.strip(".") or (path.is_dir() and not leads_away(path, folder_of(key, directory)) and any(path.glob("*.scenic")))


def find_shipped_module(name: str, worlds: Mapping[str, World]) -> Program | Mapping[str, object] | Exception:
    """The module that comes with the project, or that every Python has and that is harmless."""
    found = worlds[name]() if name in worlds else HARMLESS[name]
    return parsed_once(found, f"<{name}>") if isinstance(found, str) else found


@lru_cache(maxsize=64)
def parsed_once(text: str, file: str) -> Program:
    """A shipped module, parsed once for a process: what is made of its syntax tree is then made once as well."""
    return parse(text, file)


def find_python(key: str, *, trust: bool, directory: Path | None) -> Mapping[str, object] | Exception | None:
    """The Python module, or why it is refused; None if there is none."""
    name = key[1:] if key.startswith(".") else key
    if not name or name.startswith(".") or not python_module_exists(name, directory, only_beside=key.startswith(".")):
        return None
    if not trust:
        return ImportRefused(
            f"importing {name} runs Python code that could do anything on this machine, so it needs --trust",
            hint="give --trust if you know the code, or use math, itertools, functools, collections, enum",
        )
    return load_python(name, directory)


def leads_away(path: Path, folder: Path) -> bool:
    """Whether a link leads from the folder in which a module is looked for to a file elsewhere."""
    return not path.resolve().is_relative_to(folder.resolve())


def linked_program(name: str, path: Path, dialect: str | None) -> Program | Exception:
    """A module elsewhere; if it is not a program, the message tells nothing of its content."""
    try:
        return read_program(path, dialect)
    except (ScenicError, OSError):
        return ImportRefused(f"{name} is a link to a file outside the program's folder that is not a Scenic program")


def path_of(key: str, directory: Path) -> Path:
    """Return the path of a module beside the program, without the ending."""
    stripped = key.lstrip(".")
    return folder_of(key, directory).joinpath(*stripped.split(".")) if stripped else folder_of(key, directory)


def folder_of(key: str, directory: Path) -> Path:
    """The folder that a key begins in: the program's, or one above it for each dot after the first."""
    return directory.joinpath(*[".."] * (len(key) - len(key.lstrip(".")) - 1))


def read_program(path: Path, dialect: str | None) -> Program:
    """Parse and check a file."""
    from .checks import check_runnable

    program = parse(read_text(path, largest=LARGEST_MODULE), str(path), dialect)
    check_runnable(program)
    return program


LARGEST_MODULE = 16 << 20
"""Bytes that a module may have which a program imports."""


def read_text(path: Path, what: str = "a Scenic program", largest: int | None = None) -> str:
    """The text of a file, a program if nothing else is said. Raises `UsageError` for directories, missing and unreadable files, and binary data.

    `largest`: it must be an ordinary file of at most so many bytes, since a program names it; else it may be a pipe, but has no end beyond
    `LARGEST_MODULE` either.
    """
    try:
        if largest is None:
            with path.open("rb") as file:
                data = file.read(LARGEST_MODULE + 1)
            if len(data) > LARGEST_MODULE:
                raise UsageError(f"{path} is too large: {what} has at most {LARGEST_MODULE >> 20} MiB")
        else:
            data = read_regular_file(path, largest)
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except IsADirectoryError:
        raise UsageError(f"{path} is a directory, not {what}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    if b"\0" in data:
        raise UsageError(f"{path} is not a text file")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is not a text file in UTF-8 (byte {error.start})") from None


def python_module_exists(name: str, directory: Path | None, *, only_beside: bool) -> bool:
    """Whether Python would find the module, or the package that it would be in, without running any of it."""
    first = name.partition(".")[0]
    if directory is not None:
        places = [path_of(f".{name}", directory), path_of(f".{first}", directory)]
        if any(place.with_name(f"{place.name}.py").is_file() or (place / "__init__.py").is_file() for place in places):
            return True
    if only_beside or is_package(f".{first}", directory):
        return False
    try:
        return importlib.util.find_spec(first) is not None
    except (ImportError, ValueError):
        return False


def load_python(name: str, directory: Path | None) -> Mapping[str, object] | Exception | None:
    """Import a Python module that the user trusts; None if it turns out not to exist."""
    if directory is not None and str(directory) not in sys.path:
        sys.path.insert(0, str(directory))
    try:
        return _members(importlib.import_module(name))
    except ScenicError:
        raise
    except Exception as exception:  # trusted code may fail in any way; the import statement reports it
        if isinstance(exception, ModuleNotFoundError) and exception.name is not None and f"{name}.".startswith(f"{exception.name}."):
            return None
        return ImportRefused(f"importing {name} failed: {type(exception).__name__}: {exception}")
