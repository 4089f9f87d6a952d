"""Which features are compared, and what the samples call them: `--ignore FEATURE` and `--map A=B`.

A FEATURE is a place in the scene format (`objects[1].properties.speed`, and all below it), the same in short (`1.speed`, `1.x`), or a name alone
(`speed`, `class`, `attempts`): that property of all objects, or that parameter. `*` stands for any text.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

from ...data.scene import OWN_FIELDS
from ...semantics.store.errors import UsageError
from ...semantics.store.suggestions import nearest
from .betting import Array
from .scene_columns import OTHERWISE, FeatureTable, last_part

SHORT = re.compile(r"(\d+)\.(\w+)((?:\[\d+\])*)")
OWN = ("class", *OWN_FIELDS[1:])
CLASSES = {"Object2D": "Object", "Point2D": "Point", "OrientedPoint2D": "OrientedPoint"}
"""What the released implementation calls the classes of a plane: the same ones, unless the program has classes of these names."""


def long_name(name: str) -> str:
    """A feature written in short, as its place in the scene format; any other text as it is."""
    short = SHORT.fullmatch(name)
    if short is None:
        return name
    number, part, indices = short.groups()
    place = f"objects[{int(number)}]"
    if part in ("x", "y"):
        return f"{place}.position[{'xy'.index(part)}]{indices}"
    return f"{place}.{part}{indices}" if part in (*OWN, "position") else f"{place}.properties.{part}{indices}"


def feature_matcher(feature: str) -> Callable[[str], bool]:
    """Whether the name of a column is that feature, or lies below it."""
    wanted = long_name(feature)
    if re.fullmatch(r"\w+", wanted):
        forms = [wanted, f"params.{wanted}", f"objects[[]*].{wanted}", f"objects[[]*].properties.{wanted}"]
    else:
        forms = [re.sub(r"\[(?=\d|\*)", "[[]", wanted)]
    forms += [form + end for form in forms for end in (".*", "[[]*")]
    return lambda name: any(fnmatchcase(name.removesuffix(OTHERWISE), form) for form in forms)


@dataclass(frozen=True)
class SampleNames:
    """Features that are not compared, and what the samples call features and classes: by their name, that of the program."""

    ignore: Sequence[str] = ()
    map: Mapping[str, str] = field(default_factory=dict)
    own_classes: frozenset[str] = frozenset()

    def ignored(self, name: str) -> bool:
        """Whether a column is not compared."""
        return any(feature_matcher(feature)(name) for feature in self.ignore)

    def kept(self, table: FeatureTable) -> FeatureTable:
        """The table without the features that are ignored."""
        if not self.ignore:
            return table
        return FeatureTable({name: v for name, v in table.arrays.items() if not self.ignored(name)}, table.n, table.numbers)

    def translated(self, table: FeatureTable) -> FeatureTable:
        """Samples under the program's names, without the features that are ignored."""
        columns: dict[str, Array] = {}
        for name, values in table.arrays.items():
            new = self.feature(name)
            columns[new] = self.with_classes(values) if new.endswith(".class") and values.dtype == object else values
        return self.kept(FeatureTable(columns, table.n, table.numbers))

    def feature(self, name: str) -> str:
        """The program's name for a feature of the samples."""
        for theirs, ours in self.map.items():
            a, b = long_name(theirs), long_name(ours)
            if name == a or name.startswith((f"{a}.", f"{a}[", a + OTHERWISE)):
                return b + name[len(a) :]
            found = re.fullmatch(rf"(objects\[\d+\]\.(?:properties\.)?|params\.){re.escape(theirs)}((?:[.\[ ].*)?)", name)
            if found is not None and re.fullmatch(r"\w+", theirs):
                lead, rest = found.groups()
                place = lead.removesuffix("properties.")
                return (f"{place}{ours}" if ours in (*OWN, "position") or lead == "params." else f"{place}properties.{ours}") + rest
        return name

    def with_classes(self, values: Array) -> Array:
        """A column of classes under the program's names."""
        known = {theirs: ours for theirs, ours in CLASSES.items() if theirs not in self.own_classes} | dict(self.map)
        if not any(v in known for v in set(values)):
            return values
        changed = values.copy()
        for k, v in enumerate(values):
            changed[k] = known.get(v, v)
        return changed

    def check(self, samples: FeatureTable, known: Sequence[str]) -> None:
        """Raise `UsageError` for names that neither side has: in the first samples, or among the features `known` of the program."""
        there = [*samples.arrays, *known]
        classes = {str(v) for name, values in samples.arrays.items() if name.endswith(".class") for v in values}
        for feature in self.ignore:
            if not any(map(feature_matcher(feature), there)):
                raise unknown_feature_error("--ignore", feature, there)
        for theirs in self.map:
            if theirs not in classes and all(self.feature(name) == name for name in samples.arrays if feature_matcher(theirs)(name)):
                raise unknown_feature_error("--map", theirs, [*samples.arrays, *sorted(classes)])


def unknown_feature_error(option: str, name: str, there: Sequence[str]) -> UsageError:
    """The error for a name that does not occur."""
    place = long_name(name).partition(".")[0] if "." in name else ""
    ends = {last_part(n): n for n in reversed(there) if n.startswith(place)}
    near = nearest(last_part(long_name(name)), ends)
    hint = f"did you mean {ends[near]}?" if near is not None else ""
    return UsageError(f"{option} {name}: neither the samples nor the program have that", hint=hint)
