"""Vector files: every one that the package ships, read strictly. `docs/vectors.md` documents the format."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable

from ..interpreter.language.dialects import DIALECTS
from ..semantics.readings import READINGS
from ..semantics.rules import RULES
from ..semantics.store.errors import UsageError
from .matchers import MATCHERS
from .matchers.errors import Error
from .matchers.simulations import AlwaysRejected, Simulations
from .strict_tables import VectorFields
from .vector import ConformanceVector

DEFAULT_DIALECT = "paper"


def load_vectors() -> tuple[ConformanceVector, ...]:
    """All vectors of the package, in the order of the chapters' folders. Raises `UsageError`."""
    folder = files("scenic_ref.conformance").joinpath("vectors")
    return read_all((str(name), text) for name, text in sorted(texts(folder, "")))


def texts(folder: Traversable, path: str) -> Iterator[tuple[str, str]]:
    """The vector files below a folder: path and content."""
    for entry in folder.iterdir():
        if entry.is_dir():
            yield from texts(entry, f"{path}{entry.name}/")
        elif entry.name.endswith(".toml"):
            yield path + entry.name, entry.read_text("utf-8")


def read_all(named: Iterator[tuple[str, str]]) -> tuple[ConformanceVector, ...]:
    """The vectors of some files; names must be unique over all of them. Raises `UsageError`."""
    found: dict[str, ConformanceVector] = {}
    for file, text in named:
        for vector in read_file(file, text):
            if vector.name in found:
                raise UsageError(f"{file}, vector {vector.name}: this name is taken in {found[vector.name].file}")
            found[vector.name] = vector
    return tuple(found.values())


def read_file(file: str, text: str) -> list[ConformanceVector]:
    """The vectors of one file. Raises `UsageError`, which names the file and the vector."""
    try:
        fields = VectorFields(file, tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"{file}: {error}") from None
    chapter, tables = fields.text("chapter"), fields.items("vector")
    fields.done()
    return [read_vector(file, chapter, table, number) for number, table in enumerate(tables, 1)]


def read_vector(file: str, chapter: str, table: object, number: int) -> ConformanceVector:
    """One `[[vector]]` table. Raises `UsageError`."""
    name = table.get("name") if isinstance(table, Mapping) else None
    fields = VectorFields(f"{file}, vector {name if isinstance(name, str) else number}", table)
    kinds = [kind for kind in MATCHERS if fields.has(kind)]
    if len(kinds) != 1:
        raise fields.wrong(f"exactly one matcher is needed, and there are {len(kinds)}: {', '.join(kinds) or 'none'}")
    matcher = MATCHERS[kinds[0]](fields.table(kinds[0]))
    vector = ConformanceVector(
        name=fields.text("name"), chapter=chapter, file=file, paper=fields.text("paper"), fires=rules(fields, "fires"),
        avoids=rules(fields, "avoids"), readings=read_readings(fields), texts=read_texts(fields), kind=kinds[0],
        matcher=matcher, steps=matcher.steps if isinstance(matcher, (Simulations, AlwaysRejected, Error)) else None, files=read_files(fields),
    )
    fields.done()
    if vector.fires & vector.avoids:
        raise fields.wrong(f"{', '.join(sorted(vector.fires & vector.avoids))} both fires and must not fire")
    return vector


def rules(fields: VectorFields, key: str) -> frozenset[str]:
    """Ids of rules of the catalogue. Raises `UsageError`."""
    found = fields.texts(key, ())
    for rule in found:
        if rule not in RULES:
            raise fields.wrong(f"{key}: there is no rule {rule}")
    return frozenset(found)


def read_readings(fields: VectorFields) -> Mapping[str, str]:
    """The readings that the expectation depends on, with their alternatives. Raises `UsageError`."""
    found = fields.table("readings") if fields.has("readings") else VectorFields("", {})
    chosen = {name: found.text(name) for name in list(found.rest)}
    for name, alternative in chosen.items():
        if name not in READINGS:
            raise fields.wrong(f"there is no reading {name}")
        if alternative not in READINGS[name].alternatives:
            raise fields.wrong(f"the reading {name} has no alternative {alternative}")
    return chosen


RELEASED = ("scenic-2.1", "scenic-3")
SIMULATION = re.compile(r"\bsimulation\.(?=[A-Za-z])")
VIEW_DISTANCE = re.compile(r"\bviewDistance\b")
"""The paper's `simulation.currentTime` and `viewDistance` are `simulation().currentTime` and `visibleDistance` in the releases.

Vectors are written in the paper's spelling; one that has the other as well is left as it is.
"""


def read_texts(fields: VectorFields) -> Mapping[str, str]:
    """The program in each dialect in which it is given. Raises `UsageError`."""
    program = fields.text("program")
    found = dict.fromkeys(fields.texts("dialects", (DEFAULT_DIALECT,)), program)
    variants = fields.table("variants") if fields.has("variants") else VectorFields("", {})
    for dialect in list(variants.rest):
        if dialect in found:
            raise fields.wrong(f"the dialect {dialect} has both the program and a variant")
        found[dialect] = variants.text(dialect)
    for dialect in found:
        if dialect not in DIALECTS:
            raise fields.wrong(f"there is no dialect {dialect}")
    if not found:
        raise fields.wrong("the program is given in no dialect")
    return {dialect: in_release(text) if dialect in RELEASED else text for dialect, text in found.items()}


def in_release(text: str) -> str:
    """A text in the spelling of the releases."""
    spelled = SIMULATION.sub("simulation().", text)
    return spelled if "visibleDistance" in text else VIEW_DISTANCE.sub("visibleDistance", spelled)


MODULE = re.compile(r"(\w+/)*\w+\.scenic")


def read_files(fields: VectorFields) -> Mapping[str, str]:
    """The modules beside the program, by their paths. Raises `UsageError`."""
    found = fields.table("files") if fields.has("files") else VectorFields("", {})
    for path in found.rest:
        if MODULE.fullmatch(path) is None:
            raise fields.wrong(f"files: {path!r} is no path of a Scenic module such as 'lib/roads.scenic'")
    return {path: found.text(path) for path in list(found.rest)}
