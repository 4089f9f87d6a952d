"""Scenes, requirements, errors and texts of programs as the page shows them: plain JSON, neither too long nor able to hide what they say."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping

from ..api.diagnostics import Diagnostic, diagnostic_json
from ..cli.run_report import rejecting_requirements
from ..cli.session import escape_controls
from ..data.scene import OWN_FIELDS, Scene, SceneObject
from ..inference.enumeration import content_of_scene
from ..inference.rejection import acceptance
from ..pictures.map_layers import Window, map_features_in, marks
from ..pictures.replay_pages import land_around, map_in
from ..pictures.scene_figures import (
    CROWD,
    FARTHEST,
    LETTER,
    LINE,
    bounds_of,
    is_all,
    shorten_name,
    view_of,
    window_of,
)
from ..roads.network import MapWorkspace
from ..sampling.scene_sampler import Softness
from ..semantics.machine.outcome import Requirement
from ..semantics.store.errors import AttemptsExhausted, ScenicError, UsageError
from ..semantics.syntax.nodes import Span

LONGEST_TEXT, LONGEST_LIST, DEEPEST = 400, 100, 6

Json = dict[str, object]


def cut_value(value: object, depth: int = 0) -> object:
    """A value in JSON, shortened where it is long or deep; control characters, and those that turn the direction of writing, are escaped."""
    match value:
        case str():
            return cut_text(value)
        case list() if depth < DEEPEST:
            rest = [f"… {len(value) - LONGEST_LIST:,} more"] if len(value) > LONGEST_LIST else []
            return [cut_value(v, depth + 1) for v in value[:LONGEST_LIST]] + rest
        case dict() if depth < DEEPEST:
            return {cut_text(str(k)): cut_value(v, depth + 1) for k, v in list(value.items())[:LONGEST_LIST]}
        case list() | dict():
            return "…"
        case int() if not isinstance(value, bool) and value.bit_length() > 53:
            return cut_text(hex(value))
        case _:
            return value


def cut_text(text: str, longest: int = LONGEST_TEXT) -> str:
    """A text that is not too long."""
    return escape_controls(text if len(text) <= longest else f"{text[:longest]}… ({len(text):,} characters)")


IN_PAGE = (
    ("give --trust if you know the code", "start `scenic-ref play --trust` if you know the code"),
    ("--limit-memory allows more", "start `scenic-ref play` with a larger --limit-memory"),
    ("--limit-seconds allows more", "start `scenic-ref play` with a larger --limit-seconds"),
    ("raise --fuel if it really takes that long", "if it really takes that long, start `scenic-ref play` with a larger --fuel"),
    ("try --backend smc, or more --max-attempts", "make them less strict here, or save the program, and use `scenic-ref run --backend smc`"),
    ("the interpreter can: --backend interpreter", "save the program, and use `scenic-ref run`"),
    ("(-p map=site.geojson)", "(`scenic-ref play --map site.geojson`)"),
)
"""Advice for a command line, and what it is on the page."""


def on_page(advice: str) -> str:
    """The advice for who has the page, where it is for who has a command line."""
    for command, page in IN_PAGE:
        advice = advice.replace(command, page)
    return advice


MOST_OBJECTS = 1_000
"""A scene with more objects is not drawn on the page."""
MOST_REQUIREMENTS = 50
SIZE, SMALL, NAMED = 240, 9, 24
"""The width of a picture of a scene on the page, the size of small letters there, and what the name of an object takes above or below it."""


def scene_shown(scene: Scene) -> Json:
    """A scene with its window, and what lies below its objects there; `problem` says why it cannot be drawn."""
    written = scene.to_json()
    found: Json = {
        "scene": scene.index, "seed": scene.seed, "attempts": scene.attempts, "ego": scene.ego_id, "count": len(scene.objects),
        "params": cut_value(written["params"]), "digest": hashlib.sha256(content_of_scene(scene).encode("utf-8", "replace")).hexdigest()[:16],
        "problem": "",
    }  # fmt: skip
    if len(scene.objects) > MOST_OBJECTS:
        return found | {"objects": [], "problem": f"{len(scene.objects):,} objects are too many to be drawn here"}
    objects = [object_shown(o.to_json()) for o in scene.objects]
    try:
        window = window_of(scene)
    except UsageError:
        return found | {"objects": objects, "problem": f"it has coordinates of {FARTHEST:g} m or more"}
    view = view_of(scene.ego) if scene.ego_id is not None else []
    seen = bool(view) and is_all(view, window)
    return found | {"objects": objects, "window": window, "view": view, "allSeen": seen, "ground": ground_of(scene, window)}


def object_shown(written: Mapping[str, object]) -> Json:
    """An object in the scene format."""
    own = {name: written[name] for name in OWN_FIELDS}
    name = written["name"]
    return {
        "id": written["id"], "name": None if name is None else cut_text(str(name)), "class": cut_text(str(written["class"])), **own,
        "properties": cut_value(written["properties"]),
    }  # fmt: skip


def ground_of(scene: Scene, window: Window) -> Json:
    """Return the ground below the objects: the roads, or the workspace with the program's own map, whose
    features are named if there is room.
    """
    if isinstance(scene.workspace, MapWorkspace):
        return map_in(scene.workspace.network, window)
    return land_around(scene, window) | {"marks": marks_shown(scene, window)}


def marks_shown(scene: Scene, window: Window) -> list[Json]:
    """The names and directions of the features of a map of one's own."""
    west, south, east, north = window
    unit = max(east - west, north - south) / SIZE
    named = [o for o in scene.objects if o.name or len(scene.objects) <= CROWD]
    scale = west, south, west + 0.3 * (east - west), south + 0.1 * (north - south)
    taken = [scale, *map(bounds_of, scene.objects), *(named_room(o, unit) for o in named)]
    found = marks(
        map_features_in(scene.site, window), window, taken, lambda text: len(shorten_name(text)) * LETTER * SMALL * unit, LINE * SMALL * unit
    )
    return [{"text": shorten_name(mark.text), "at": [mark.x, mark.y], "ahead": mark.ahead} for mark in found]


def named_room(o: SceneObject, unit: float) -> Window:
    """Return the room that the page may use for the name of an object, above or below it."""
    west, south, east, north = bounds_of(o)
    half = max(east - west, len(shorten_name(o.name or o.class_name)) * LETTER * SMALL * unit) / 2
    middle = (west + east) / 2
    return middle - half, south - NAMED * unit, middle + half, north + NAMED * unit


def span_json(span: Span) -> Json:
    """A place in a source; `line` is 0 for none."""
    return {"file": cut_text(span.file), "line": span.line, "column": span.column, "endLine": span.end_line, "endColumn": span.end_column}


def diagnostic_shown(one: Diagnostic) -> Json:
    """A diagnostic as `check --format json` has it, with texts that are not too long, and advice that can be followed on the page."""
    said = one._replace(hint=on_page(one.hint))
    return {name: cut_value(value) if name != "message" else cut_text(str(value), 2000) for name, value in diagnostic_json(said).items()}


def requirements_shown(stuck: Iterable[tuple[Requirement, int]]) -> list[Json]:
    """The requirements that rejected, as reports group them."""
    found = rejecting_requirements(stuck)[:MOST_REQUIREMENTS]
    return [{"count": one.often, "text": cut_text(one.text), "among": one.among, **span_json(one.span)} for one in found]


def tally_shown(
    scenes: int, attempts: int, stuck: Iterable[tuple[Requirement, int]], soft: Iterable[Softness] = (), *, coins: bool = False
) -> Json:  # fmt: skip
    """How many attempts were made at how many scenes, how likely a run is accepted (None without scenes), and what rejected the others.

    The attempts do not tell the former where `coins` are thrown once for a scene.
    """
    found = acceptance(scenes, attempts)
    return {
        "kind": "tally", "coins": coins, "scenes": scenes, "attempts": attempts, "level": found.level,
        "acceptance": [found.estimate, found.low, found.high] if scenes and not coins else None, "stuck": requirements_shown(stuck),
        "soft": [{"held": s.held, "known": s.known, "probability": float(s.probability), **span_json(s.span)} for s in soft],
    }  # fmt: skip


def exhausted_of(error: ScenicError) -> list[tuple[Requirement, int]]:
    """Return the requirements that rejected the exhausted attempts, with their counts."""
    return [(r, n) for r, n in error.stuck if isinstance(r, Requirement)] if isinstance(error, AttemptsExhausted) else []

