"""Scenes as tables on a terminal."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .drawing import DrawnScene
from .outputs import Output
from .session import console, escaped

if TYPE_CHECKING:
    from rich.table import Table

    from .portions import Portion

MOST_SHOWN = 5


class Terminal(Output):
    """The objects of the first scenes, shown when all are drawn."""

    def __init__(self) -> None:
        self.scenes: list[dict[str, Any]] = []
        self.more = 0

    def write(self, drawn: DrawnScene) -> None:
        """Keep the scene if it is to be shown."""
        self._keep([drawn.line])

    def write_many(self, portion: Portion) -> None:
        """Keep the scenes that are to be shown."""
        self._keep(b"".join(map(bytes, portion.lines)).splitlines())

    def _keep(self, lines: Sequence[str | bytes]) -> None:
        room = MOST_SHOWN - len(self.scenes)
        self.scenes += map(json.loads, lines[:room])
        self.more += len(lines[room:])
        self.written += len(lines)

    def close(self) -> None:
        """Show the scenes that were drawn."""
        shown_on = console(sys.stdout)
        for scene in self.scenes:
            shown_on.print(table_of(scene))
        if self.more:
            shown_on.print(f"... and {self.more:,} more; -o PATH writes all of them", style="dim")


def table_of(scene: dict[str, Any]) -> Table:
    """The objects of a scene in the scene format."""
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    params = ", ".join(f"{name} = {shown(value)}" for name, value in scene["params"].items())
    title = f"seed {scene['seed']}, scene {scene['scene']} (metres, degrees)"
    table = Table(
        title=title, title_justify="left", title_style="bold", caption=escape(escaped(params)) or None, caption_justify="left", caption_style="dim",
        box=SIMPLE_HEAD,
    )
    for name in ("", "name", "class"):
        table.add_column(name)
    for name in ("x", "y", "heading", "width", "length"):
        table.add_column(name, justify="right", no_wrap=True)
    for o in scene["objects"]:
        x, y = o["position"]
        numbers = (f"{x:.2f}", f"{y:.2f}", f"{math.degrees(o['heading']):.1f}", f"{o['width']:.2f}", f"{o['length']:.2f}")
        named = (escape(escaped(o["name"] or "")), escape(escaped(o["class"])))
        table.add_row(str(o["id"]), *named, *numbers, style="bold" if o["id"] == scene["ego"] else None)
    return table


def shown(value: object) -> str:
    """A parameter, short."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict) and set(value) == {"repr"}:
        return str(value["repr"])
    return str(value)
