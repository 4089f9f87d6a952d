"""The modules that a text names: files beside it, those that are open in the editor, and those that come with the project."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

from ..interpreter.language.dialects import MARK
from ..interpreter.language.modules import HARMLESS, folder_of, leads_away, path_of
from ..semantics.python.imports import sibling_module_key
from ..simulators import worlds
from ..simulators.worlds import WORLDS, driving
from .outline import Definition, outline

LONGEST = 1_000_000
"""Longer files are not looked into."""
GIVEN_BY_MAPS: Mapping[str, tuple[str, ...]] = {driving.MAP: ("network",)}
"""The names of modules that depend on the map of a program."""


class SourceModule(NamedTuple):
    """A module: the file, if there is one, and the text of a Scenic module or the names of one of Python."""

    name: str
    path: Path | None
    text: str = ""
    names: tuple[str, ...] = ()

    @property
    def outline(self) -> Definition:
        """The definitions in the text."""
        return outline(self.text)

    @property
    def folder(self) -> Path | None:
        """The folder of the module, in which it finds others; None if it has no file."""
        return None if self.path is None else self.path.parent

    @property
    def old(self) -> bool:
        """Whether `import m` brings the names of m as well (dialect pldi19)."""
        mark = MARK.match(self.text)
        return mark is not None and mark.group(1) == "pldi19"


class ModuleShelf:
    """Finds modules by name; `opened` gives the text of a file that is open in the editor."""

    def __init__(self, opened: Callable[[Path], str | None]) -> None:
        self.opened = opened

    def find(self, name: str, level: int, importer: SourceModule) -> SourceModule | None:
        """The module that `name`, with `level` dots before it, means in a module; as an import finds it: beside the program first."""
        folder = importer.folder
        found = None if folder is None else self.beside(sibling_module_key(name, level or 1, "."), folder)
        return found or (None if level else shipped_module(name))

    def beside(self, key: str, folder: Path) -> SourceModule | None:
        """The module in a file of the folder, or below it."""
        if not key.strip("."):
            return None
        stem = path_of(key, folder)
        for end in (".scenic", ".py"):
            path = stem.with_name(stem.name + end)
            text = None if leads_away(path, folder_of(key, folder)) else self.text(path)
            if text is not None:
                return SourceModule(key.lstrip("."), path, text)
        return None

    def text(self, path: Path) -> str | None:
        """The text of a file, as it is in the editor if it is open there; None if there is none, or none to be read."""
        text = self.opened(path)
        if text is not None:
            return text if len(text) <= LONGEST else ""
        try:
            if not path.is_file() or path.stat().st_size > LONGEST:
                return None
            return path.read_text(encoding="utf-8")
        except (OSError, ValueError):
            return None

    def names(self, importer: SourceModule) -> list[str]:
        """The names of modules that an import may begin with."""
        folder = importer.folder
        try:
            found = [] if folder is None else [path.stem for path in folder.glob("*.scenic") if path != importer.path and path.stem.isidentifier()]
        except OSError:
            found = []
        return sorted({*found, *WORLDS, *HARMLESS, driving.MAP})


@cache
def shipped_module(name: str) -> SourceModule | None:
    """A module that comes with the project, or one of Python that programs may import without trust."""
    if name in GIVEN_BY_MAPS:
        return SourceModule(name, None, names=GIVEN_BY_MAPS[name])
    if name in HARMLESS:
        return SourceModule(name, None, names=tuple(n for n in HARMLESS[name] if not n.startswith("_")))
    if name not in WORLDS:
        return None
    content = WORLDS[name]()
    if not isinstance(content, str):
        return SourceModule(name, None, names=tuple(content))
    return SourceModule(name, files_by_text().get(content), content)


@cache
def files_by_text() -> Mapping[str, Path]:
    """The files of the modules that come with the project, by what is in them."""
    folder = Path(worlds.__file__).parent
    return {path.read_text(encoding="utf-8"): path for path in folder.rglob("*.scenic")}
