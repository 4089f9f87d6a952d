"""The judged findings of campaigns: each with its class, which somebody decides who has read the paper's
passage.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from ...interpreter.language.modules import read_text
from ...pictures.side_by_side import Boxes
from ...semantics.store.errors import UsageError
from ..known_differences import CLASSES
from ..strict_tables import VectorFields
from .causes import OUR_BUG, Cause
from .vector_draft import passage_of

CLASSES_OF_FINDINGS = {**CLASSES, OUR_BUG: "a fault of this reference"}
"""The classes of findings, with what each means."""
ABOUT = """\
# The findings of a campaign. `class`, `why`, `topic` and `passage` are for whoever has read the paper: with a `why`, they stay when it goes on.
# Classes: {classes}.
"""


@dataclass(frozen=True, slots=True)
class JudgedFinding:
    """A finding: the smallest program that shows it, what differs, how many programs do, where the paper says so, and what was decided.

    `here` and `there` are the boxes of some scenes of each side, if the difference is one that can be seen.
    """

    number: int
    kind: str
    words: str
    detail: str
    programs: int
    passage: str
    program: str
    class_: str
    why: str = ""
    topic: str = ""
    reading: str | None = None
    here: Boxes = ()
    there: Boxes = ()

    @property
    def is_judged(self) -> bool:
        """Whether somebody has decided."""
        return bool(self.why)


class CampaignFindings(NamedTuple):
    """The findings of a campaign against the implementation `name`; `about` says how many programs there were."""

    name: str
    about: str
    findings: list[JudgedFinding]


def shipped_findings() -> list[CampaignFindings]:
    """Return the findings of the campaigns against the released implementations that come with this
    reference.
    """
    folder = files("scenic_ref.conformance").joinpath("campaigns")
    return [findings_in(place.read_text("utf-8"), place.name) for place in sorted(folder.iterdir(), key=lambda place: place.name)]


def findings_of(causes: Iterable[Cause], kept: Sequence[JudgedFinding]) -> list[JudgedFinding]:
    """The findings of a campaign; what was decided of a program stays with the cause that this program shows."""
    found = []
    for cause in causes:
        small = cause.smallest
        reading = ", ".join(f"{id} = {alternative}" for id, alternative in small.reading.items()) if small.reading else None
        finding = JudgedFinding(
            small.number, small.kind, small.words, " ".join(small.detail.split()), len(cause.numbers), passage_of(cause), small.minimal, cause.class_,
            "", "", reading, small.here, small.there,
        )  # fmt: skip
        decided = next((k for k in kept if k.is_judged and k.number in cause.numbers), None)
        if decided is not None:
            finding = replace(finding, class_=decided.class_, why=decided.why, topic=decided.topic, passage=decided.passage)
        found.append(finding)
    return found


def findings_at(path: Path) -> list[JudgedFinding]:
    """Return the findings in a file; none if it does not exist. Raises `UsageError` if it cannot be read."""
    return findings_in(read_text(path, "the findings of a campaign"), str(path)).findings if path.exists() else []


def findings_in(text: str, file: str) -> CampaignFindings:
    """The findings in a text, read strictly. Raises `UsageError`."""
    try:
        tables = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise UsageError(f"{file} is not TOML: {error}") from error
    fields = VectorFields(file, tables)
    name, about, found = fields.text("name"), fields.text("about"), fields.any("finding", [])
    fields.done()
    if not isinstance(found, list):
        raise fields.wrong("findings are [[finding]] tables")
    return CampaignFindings(name, about, [read_finding(f"{file}, finding {n}", table) for n, table in enumerate(found, 1)])


def read_finding(place: str, table: object) -> JudgedFinding:
    """One table. Raises `UsageError`."""
    fields = VectorFields(place, table)
    found = JudgedFinding(
        fields.ordinal("number"), fields.text("kind"), fields.text("words"), fields.text("detail"), fields.count("programs"),
        fields.text("passage"), fields.text("program"), fields.text("class"), fields.text("why", ""), fields.text("topic", ""),
        fields.text("reading") if fields.has("reading") else None, read_boxes(fields, "here"), read_boxes(fields, "there"),
    )  # fmt: skip
    fields.done()
    if found.class_ not in CLASSES_OF_FINDINGS:
        raise fields.wrong(f"there is no class {found.class_!r}: there are {', '.join(CLASSES_OF_FINDINGS)}")
    return found


def read_boxes(fields: VectorFields, key: str) -> Boxes:
    """The boxes of some scenes, none if there is no such key. Raises `UsageError`."""
    scenes = fields.any(key, [])
    shaped = isinstance(scenes, list) and all(isinstance(scene, list) and all(isinstance(b, list) and len(b) == 5 for b in scene) for scene in scenes)
    if not shaped:
        raise fields.wrong(f"{key} must hold the boxes of scenes: x, y, heading, width and length of each")
    return [[tuple(fields.as_number(key, value) for value in box) for box in scene] for scene in scenes]  # type: ignore[attr-defined]


def to_toml(campaign: CampaignFindings) -> str:
    """The file of a campaign's findings."""
    classes = "; ".join(f"{name}: {means}" for name, means in CLASSES_OF_FINDINGS.items())
    head = f"name = {json.dumps(campaign.name)}\nabout = {json.dumps(campaign.about)}\n"
    return ABOUT.format(classes=classes) + head + "".join(map(entry, campaign.findings))


def entry(finding: JudgedFinding) -> str:
    """The table of a finding."""
    fields = {
        "number": finding.number, "class": finding.class_, "why": finding.why, "topic": finding.topic, "passage": finding.passage,
        "kind": finding.kind, "words": finding.words, "detail": finding.detail, "programs": finding.programs,
        **({"reading": finding.reading} if finding.reading is not None else {}),
        **({"here": finding.here, "there": finding.there} if finding.here or finding.there else {}),
    }  # fmt: skip
    lines = [f"{name} = {json.dumps(value)}" for name, value in fields.items()]
    program = finding.program
    plain = "'''" not in program and all(c.isprintable() or c == "\n" for c in program)
    return "\n".join(["\n[[finding]]", *lines, f"program = '''\n{program}'''" if plain else f"program = {json.dumps(program)}"]) + "\n"
