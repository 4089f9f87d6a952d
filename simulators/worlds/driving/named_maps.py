"""`Network.fromFile`: the maps that a program reads beside its own, which are read before it runs, as that one is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ....roads.network import Network
from ....roads.network_builder import TOLERANCE, read_map
from ....semantics.python.builtin_rules import WITHOUT_EFFECT
from ....semantics.store.errors import ImportRefused, ScenicError
from ....semantics.store.scopes import descendants
from ....semantics.store.suggestions import did_you_mean
from ....semantics.syntax import Program
from ....semantics.syntax.nodes import NOWHERE, Span
from ....semantics.syntax.python_expressions import Attribute, Call, Constant, DictDisplay, Name, UnaryOperation
from ...actions import short_value_text

LARGEST_TOLERANCE = 10.0
"""Metres by which a point may miss an element at most."""


def read_named_map(path: Path, tolerance: object, directory: Path | None) -> Network | ImportRefused:
    """The map of a file, which a program in the directory names there, or why it cannot be had."""
    if path.suffix.lower() != ".xodr":
        return ImportRefused(f"the map of a program is an OpenDRIVE file (.xodr), not {path.name}")
    try:
        return read_map(path, check_tolerance(tolerance, NOWHERE))
    except ScenicError as problem:
        return ImportRefused(problem.message, hint=problem.hint or beside_program_hint(path, directory))


def beside_program_hint(path: Path, directory: Path | None) -> str:
    """Return a hint for a map that is missing but lies beside the program; "" otherwise."""
    if directory is None or path.is_absolute() or path.exists() or not (directory / path).is_file():
        return ""
    return f"{path.name} is beside the program: write localPath({str(path)!r}), or give the path {directory / path}"


def check_tolerance(tolerance: object, span: Span) -> float:
    """A tolerance. Raises `ImportRefused`."""
    if isinstance(tolerance, bool) or not isinstance(tolerance, (int, float)) or not 0 <= tolerance <= LARGEST_TOLERANCE:
        raise ImportRefused(f"the tolerance of a map is a number of metres from 0 to {LARGEST_TOLERANCE:g}, not {short_value_text(tolerance)}", span)
    return float(tolerance)


def tolerance_in(options: object, span: Span) -> float:
    """The tolerance in the global parameter `map_options`, among options that change nothing here. Raises `ImportRefused`."""
    known = sorted({*WITHOUT_EFFECT, "tolerance"})
    if not isinstance(options, Mapping):
        raise ImportRefused("the parameter map_options must be a dictionary of texts and constants: the map is read before the program runs", span)
    for name in options:
        if name not in known:
            raise ImportRefused(f"there is no map option {name!r}", span, hint=did_you_mean(str(name), known) or f"there are {', '.join(known)}")
    return check_tolerance(options.get("tolerance", TOLERANCE), span)


UNKNOWN = object()
"""What an expression gives that is no constant."""


def constant_value(node: object) -> object:
    """Return the value of a constant written in a program, also one with a sign; UNKNOWN for other
    expressions.
    """
    match node:
        case Constant(value=value):
            return value
        case UnaryOperation(operator="-" | "+" as sign, operand=Constant(value=int() | float() as value)):
            return -value if sign == "-" else value
        case _:
            return UNKNOWN


def constants(node: object) -> object:
    """Return the dictionary of constants written in a program, also by `dict(name=...)`; UNKNOWN for other
    expressions.
    """
    match node:
        case DictDisplay():
            items = {constant_value(k): constant_value(v) for k, v in node.items}
        case Call(function=Name(name="dict"), arguments=()):
            items = {k.name or UNKNOWN: constant_value(k.value) for k in node.keywords}
        case _:
            return UNKNOWN
    return UNKNOWN if UNKNOWN in items or UNKNOWN in items.values() else items


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


def named_maps_of(program: Program, directory: Path | None) -> Iterator[tuple[object, tuple[Path, object]]]:
    """The texts that a program gives to `fromFile` (each with the tolerance, if there is one), and the files that they name."""
    for statement in program.statements:
        for node in descendants(statement):
            match node:
                case Call(function=Attribute(name="fromFile" | "fromOpenDrive"), arguments=(first, *_)) if found := text_and_path(first, directory):
                    given = next((constant_value(k.value) for k in node.keywords if k.name == "tolerance"), None)
                    text, path = found
                    yield text if given is None else (text, given), (path, TOLERANCE if given is None else given)
                case _:
                    pass


def maps_of(
    program: Program, directory: Path | None, own: Mapping[object, tuple[Path, object]], read_once: Callable[[Path, Any], Network | ImportRefused]
) -> dict[object, Network | str]:
    """The maps that a program may read by `fromFile`, its `own` one among them, by the texts that it gives, or why they cannot be had."""
    found = {key: read_once(path, tolerance) for key, (path, tolerance) in {**dict(named_maps_of(program, directory)), **own}.items()}
    return {text: str(one) if isinstance(one, Exception) else one for text, one in found.items()}
