"""Views of scenes and programs for notebooks and prompts: one line, a picture with a table, the text."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from itertools import islice
from math import degrees
from typing import TYPE_CHECKING

from ..semantics.python.string_methods import stable_repr
from ..semantics.store.errors import UsageError
from .scene_figures import colours_of, draw, picture, views_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..data.scene import Scene, SceneObject

LONGEST = 60
"""Characters of a value that are shown."""
MOST_ROWS = 30
"""Objects, or parameters, that a table shows."""
COLUMNS = ("", "name", "class", "x, m", "y, m", "heading, °", "width, m", "length, m")


def line_of_object(o: SceneObject) -> str:
    """An object in one line."""
    x, y = o.position
    name = f" {o.name}" if o.name else ""
    return f"<{o.class_name}{name} at ({x:.6g}, {y:.6g}), heading {o.heading:.6g}>"


def line_of_scene(scene: Scene) -> str:
    """A scene in one line."""
    few = [o.name or o.class_name for o in scene.objects[:5]]
    more = ", ..." if len(scene.objects) > len(few) else ""
    told = f": {', '.join(few)}{more}" if few else ""
    return (
        f"<scene {scene.index} of seed {scene.seed}, {count_phrase(scene.attempts, 'attempt')}, {count_phrase(len(scene.objects), 'object')}{told}>"
    )


def count_phrase(number: int, thing: str) -> str:
    """Return a number with its noun, in the plural except for 1."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


def page_of_scene(scene: Scene) -> str:
    """A scene in HTML: its picture, its objects and its parameters; texts of the program are escaped."""
    objects = [row_of(scene, o) for o in scene.objects[:MOST_ROWS]]
    params = [(name, short_repr(value)) for name, value in islice(scene.params.items(), MOST_ROWS)]
    parts = [f"<div>{escape(line_of_scene(scene))}</div>", image_of(scene), table(COLUMNS, objects, len(scene.objects))]
    if params:
        parts.append(table(("parameter", "value"), params, len(scene.params)))
    return "\n".join(parts)


def row_of(scene: Scene, o: SceneObject) -> tuple[str, ...]:
    """An object in the table, as in `COLUMNS`."""
    numbers = (*o.position, degrees(o.heading), o.width, o.length)
    return (str(o.id), (o.name or "") + (" (ego)" if o.id == scene.ego_id and o.name != "ego" else ""), o.class_name, *(f"{n:.6g}" for n in numbers))


def short_repr(value: object) -> str:
    """The text of a value, or its beginning."""
    return short_text(stable_repr(value))  # type: ignore[arg-type]


def short_text(text: str) -> str:
    """A text, or its beginning."""
    return text if len(text) <= LONGEST else text[:LONGEST] + "…"


def image_of(scene: Scene) -> str:
    """The picture, or why there is none."""
    try:
        data = base64.b64encode(picture([scene])).decode("ascii")
    except UsageError as problem:
        return f"<div>{escape(problem.message)}</div>"
    return f'<img alt="the scene from above" style="max-width: 480px" src="data:image/png;base64,{data}">'


def table(head: Sequence[str], rows: Sequence[Sequence[str]], count: int) -> str:
    """A table of texts, of which there are `count` rows in all."""
    lines = [f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows]
    if count > len(rows):
        lines.append(f'<tr><td colspan="{len(head)}">and {count - len(rows):,} more</td></tr>')
    return f"<table><thead><tr>{''.join(f'<th>{escape(cell)}</th>' for cell in head)}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def line_of_program(file: str, dialect: str, readings: Mapping[str, str], params: Mapping[str, object], *, given: bool) -> str:
    """A scenario in one line: `readings` are those that differ from the paper's profile."""
    settings = [f"dialect {dialect}"] if dialect != "paper" else []
    settings += [f"{name}={alternative}" for name, alternative in readings.items()]
    settings += [f"{name} = {short_repr(value)}" for name, value in params.items()]
    settings += ["something given"] if given else []
    return f"<scenario of {file}{': ' if settings else ''}{', '.join(settings)}>"


def page_of_program(line: str, text: str) -> str:
    """A scenario in HTML: its line, and the text of its program, escaped."""
    return f"<div>{escape(line)}</div>\n<pre>{escape(text)}</pre>"


def plot_scene(scene: Scene, ax: Axes | None) -> Axes:
    """The scene drawn in axes, in those of a new figure of pyplot if None. Raises `UsageError` for a scene that cannot be drawn."""
    if ax is not None and not hasattr(ax, "add_patch"):
        raise UsageError(f"ax is axes of matplotlib, or None for new ones, not {short_repr(ax)}")
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.figure(layout="constrained").add_subplot()
    draw(ax, scene, None, colours_of([scene]), *views_of([scene]), small=False)
    return ax
