"""Which names a place of a text can use, and what each is: definitions of the text, of modules that it imports, or names of the language."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from ..semantics.store.built_in_classes import BUILT_IN_CLASSES
from .module_library import ModuleShelf, SourceModule
from .outline import EVERYTHING, Definition

SCOPES = frozenset({"module", "function", "behavior", "monitor", "scenario", "class"})
MOST_MODULES = 100
"""So many modules are followed from one place."""
LONGEST_LINE = 200


class Meaning(NamedTuple):
    """The meaning of a name: a definition in a module, a whole module, or (neither) a name that a Python
    module defines.
    """

    module: SourceModule
    definition: Definition | None = None
    whole: bool = False


class Inherited(NamedTuple):
    """A property or method of a class: its definition, or the built-in class that has it."""

    name: str
    meaning: Meaning | None
    owner: str


class NameFinder:
    """Looks names up in one text and in what it imports."""

    def __init__(self, shelf: ModuleShelf, main: SourceModule) -> None:
        self.shelf = shelf
        self.main = main

    def visible(self, offset: int) -> dict[str, Meaning]:
        """The names that can be used at an index of the text, each as it was defined last before it, in the innermost scope that has it."""
        *outer, inner = around(self.main.outline, offset)
        found: dict[str, Meaning] = {}
        for scope in (*(scope for scope in outer if scope.kind != "class"), inner):
            found |= self.defined(scope, self.main, frozenset(), offset)
        return found

    def defined(self, scope: Definition, module: SourceModule, seen: frozenset[str], before: int = 0) -> dict[str, Meaning]:
        """The names that a text or a definition in it binds: each as it was defined last before an index, or first of all behind it."""
        own: dict[str, Definition] = {}
        stars: dict[str, Meaning] = {}
        for one in scope.children:
            if one.kind == "import" and (one.member == EVERYTHING or (module.old and not one.member)):
                source = self.shelf.find(one.module, one.level, module)
                stars |= {} if source is None else self.exported(source, seen)
            if one.kind not in ("param", "property") and one.member != EVERYTHING and (one.name not in own or one.start <= before):
                own[one.name] = one
        return stars | {n: self.imported(one, module, seen) if one.kind == "import" else Meaning(module, one) for n, one in own.items()}

    def exported(self, module: SourceModule, seen: frozenset[str]) -> dict[str, Meaning]:
        """The names that `import *` brings from a module."""
        if module.name in seen or len(seen) > MOST_MODULES:
            return {}
        seen = seen | {module.name}
        found = dict.fromkeys(module.names, Meaning(module)) | self.defined(module.outline, module, seen)
        return {name: meaning for name, meaning in found.items() if not name.startswith("_")}

    def imported(self, one: Definition, module: SourceModule, seen: frozenset[str]) -> Meaning:
        """Return the meaning of an import: a module, or a member of one; the import itself if the module is
        not found.
        """
        source = self.shelf.find(one.module, one.level, module)
        if source is None:
            return Meaning(module, one)
        if not one.member:
            return Meaning(source, whole=True)
        if f"{source.name}.{one.member}" in seen or len(seen) > MOST_MODULES:
            return Meaning(module, one)
        inside = self.defined(source.outline, source, seen | {f"{source.name}.{one.member}"})
        if one.member in source.names:
            return Meaning(source)
        return inside.get(one.member) or self.submodule(one, module) or Meaning(module, one)

    def submodule(self, one: Definition, module: SourceModule) -> Meaning | None:
        """`from package import module`."""
        dotted = f"{one.module}.{one.member}" if one.module else one.member
        found = self.shelf.find(dotted, one.level, module)
        return None if found is None else Meaning(found, whole=True)

    def members(self, meaning: Meaning) -> dict[str, Meaning]:
        """The names behind the dot of a module."""
        return self.exported(meaning.module, frozenset()) if meaning.whole else {}

    def properties(self, name: str, names: Mapping[str, Meaning], seen: frozenset[str] = frozenset()) -> Iterator[Inherited]:
        """The properties and methods of a class, those of the most derived class first; a class without superclasses is derived from Object."""
        if name in BUILT_IN_CLASSES and name not in names:
            for class_ in BUILT_IN_CLASSES[name].lineage:
                yield from (Inherited(own, None, class_.name) for own in class_.own_defaults)
            return
        meaning = names.get(name)
        if meaning is None or meaning.definition is None or meaning.definition.kind != "class" or name in seen:
            return
        definition = meaning.definition
        for child in definition.children:
            yield Inherited(child.name, Meaning(meaning.module, child), name)
        inside = names if meaning.module == self.main else self.defined(meaning.module.outline, meaning.module, frozenset())
        for above in definition.made or ("Object",):
            yield from self.properties(above, inside, seen | {name})

    def is_class(self, name: str, names: Mapping[str, Meaning]) -> bool:
        """Whether a name is that of a class of objects."""
        meaning = names.get(name)
        if meaning is None:
            return name in BUILT_IN_CLASSES
        return meaning.definition is not None and meaning.definition.kind == "class"

    def class_of(self, name: str, offset: int, names: Mapping[str, Meaning]) -> str | None:
        """The class of what a name stands for at an index, as far as the text tells."""
        if self.is_class(name, names):
            return name
        if name == "self":
            return next((d.name for d in reversed(list(around(self.main.outline, offset))) if d.kind == "class"), None)
        meaning = names.get(name)
        if meaning is None or meaning.definition is None or meaning.definition.kind != "variable" or not meaning.definition.made:
            return None
        return meaning.definition.made[0]


def around(root: Definition, offset: int) -> Iterator[Definition]:
    """The definitions whose names can be used at an index, the outermost first."""
    scope: Definition | None = root
    while scope is not None:
        yield scope
        scope = next((child for child in scope.children if child.kind in SCOPES and child.holds(offset)), None)


def definition_line(meaning: Meaning) -> str:
    """Return the definition in one line; for a block, its first line."""
    definition = meaning.definition
    if definition is None:
        return f"import {meaning.module.name}"
    if definition.kind in SCOPES:
        text = re.split(r"[ \t]+#|[\r\n]", meaning.module.text[definition.first : definition.first + LONGEST_LINE], maxsplit=1)[0]
    else:
        text = meaning.module.text[definition.first : min(definition.last, definition.first + LONGEST_LINE)]
    return re.sub(r"(?:\\?\s)+", " ", text).strip()
