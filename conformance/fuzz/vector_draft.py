"""A finding as the draft of a vector: the program, what it means here, and what somebody has still to derive from the paper."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

from ...api.program_loader import loads
from ...inference.comparison.comparison import with_law
from ...inference.comparison.feature_names import SampleNames
from ...semantics.rules import RULES, SILENT
from ...semantics.store.errors import AttemptsExhausted, ProgramError
from ...testing.judge import enumerate_if_small
from ..diff.sequential_diff import scenario_or_error
from .causes import ENDED, Cause
from .examination import ATTEMPTS, FUEL, OUR_FAULT, CampaignSettings

PLACE = re.compile(r"objects\[(\d+)\]\.(?:properties\.)?(.+)")
PARTS = re.compile(r"(.+)\[([01])\]")
TOLERANCE = 1e-9


def draft_of(cause: Cause, name: str, settings: CampaignSettings) -> str | None:
    """A file of one vector, in which what is expected is ours and no derivation stands yet; None where no matcher says what differs."""
    text = cause.smallest.minimal
    if cause.smallest.kind in ("acceptance", OUR_FAULT, *ENDED):
        return None
    matcher = error_in(text, settings.readings) or what_is_constant(text, settings.readings)
    if matcher is None or "'''" in text:
        return None
    passage = passage_of(cause)
    followed = ", ".join(f'{id} = "{alternative}"' for id, alternative in settings.readings.items())
    return f"""# A draft: what is expected is what this reference says, and is to be derived from the paper before it is used.
# {cause.smallest.kind}, class {cause.class_}: {' '.join(cause.smallest.detail.split())[:400]}
chapter = "Findings"

[[vector]]
name = {json.dumps(name)}
paper = {json.dumps(passage)}
{f"readings = {{ {followed} }}" if followed else "readings = {}"}
program = '''
{text.rstrip()}
'''
{matcher}"""


def passage_of(cause: Cause) -> str:
    """Return the passage of the paper about the finding: the places of its rules."""
    if cause.smallest.kind in ENDED:
        return "none: no program may end the process"
    places = dict.fromkeys(RULES[id].place for id in cause.smallest.rules)
    return "; ".join(place for place in places if place != SILENT) or SILENT


def error_in(text: str, readings: Mapping[str, str]) -> str | None:
    """The matcher of the error that a program is, None if it is none."""
    try:
        found = scenario_or_error(lambda more: loads(text, readings={**readings, **more}, fuel=FUEL), {})
    except ProgramError as error:
        found = error
    if not isinstance(found, ProgramError):
        return None
    rule = f', rule = "{found.rule}"' if found.rule else ""
    return f'error = {{ phase = "{found.phase}", line = {found.span.line}, class = "{type(found).__name__}"{rule} }}\n'


def what_is_constant(text: str, readings: Mapping[str, str]) -> str | None:
    """The matcher of what is the same in all scenes of a program, None if nothing of it can be said."""
    try:
        scenario = loads(text, readings=readings, fuel=FUEL)
        scenario.sample(max_attempts=ATTEMPTS)  # nothing is constant where there is no scene, and facts look for one longer
        facts = scenario.facts
        law = enumerate_if_small(scenario)
    except (AttemptsExhausted, ProgramError):  # also: an error in simulations only
        return None
    if law is not None and law.outcomes:
        facts = with_law(facts, law, SampleNames())
    objects: dict[int, dict[str, object]] = {}
    params: dict[str, object] = {}
    for feature, value in facts.constants.items():
        place = PLACE.fullmatch(feature)
        if not isinstance(value, (bool, int, float)):
            continue
        if place is not None:
            objects.setdefault(int(place[1]), {})[place[2]] = value
        elif feature.startswith("params.") and "[" not in feature:
            params[feature.removeprefix("params.")] = value
    lines = [f"params = {{ {', '.join(f'{name} = {toml(value)}' for name, value in params.items())} }}"] if params else []
    rows = [
        f"    {{ {', '.join([f'index = {k}', *(f'{name} = {toml(value)}' for name, value in pairs(found).items())])} }},"
        for k, found in sorted(objects.items())
    ]
    lines += ["objects = [", *rows, "]"] if rows else []
    if "objects" in facts.constants:
        lines.append(f"count = {facts.constants['objects']}")
    return "\n".join(["[vector.values]", *lines, f"tolerance = {TOLERANCE}"]) + "\n" if lines else None


def pairs(found: Mapping[str, object]) -> dict[str, object]:
    """Properties by name; of vectors those whose two coordinates are known."""
    plain = {name: value for name, value in found.items() if "[" not in name}
    vectors = {match[1] for name in found if (match := PARTS.fullmatch(name))}
    return plain | {name: [found[f"{name}[0]"], found[f"{name}[1]"]] for name in sorted(vectors) if f"{name}[0]" in found and f"{name}[1]" in found}


def toml(value: object) -> str:
    """A number, a truth value or a list of numbers in TOML."""
    return json.dumps(value)
