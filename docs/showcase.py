"""Writes docs/images/, what the README and the first page show: scenes, a simulation, a trace.

`make showcase` does so, and a test asks whether they are current.
"""

from __future__ import annotations

import io
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import scenic_ref
from rich.console import Console
from rich.text import Text
from scenic_ref.pictures.movies import movie
from scenic_ref.pictures.scene_figures import SIDE, colours_of, draw, figure_bytes, new_figure, views_of

ROOT = Path(__file__).resolve().parents[1]
PLACE = Path(__file__).parent / "images"
PROGRAMS: Mapping[str, tuple[str, int]] = {
    "a badly parked car": ("gallery/badly_parked_car.scenic", 1), "bumper to bumper": ("gallery/bumper_to_bumper.scenic", 1),
    "a rover at a bottleneck": ("gallery/mars_bottleneck.scenic", 1),
    "a left turn, and somebody comes": ("driving/left_turn_with_oncoming.scenic", 1),
    "a pedestrian crosses": ("driving/pedestrian_crossing.scenic", 1), "a map of one's own": ("maps/trucks.scenic", 1),
}  # fmt: skip
"""What the sheet of scenes shows: titles, programs and seeds."""
SIMULATED, STEPS = "driving/left_turn_with_oncoming.scenic", 45
TRACED, LINES, COLUMNS = "beside.scenic", 34, 104
NETWORK = re.compile(r"@font-face \{.*?\}\s*", re.DOTALL)
"""What a picture of text would load from elsewhere."""


def scenes() -> bytes:
    """A scene of each of the programs."""
    figure = new_figure(3 * SIDE, 2 * (SIDE + 0.3))
    for number, (title, (name, seed)) in enumerate(PROGRAMS.items(), 1):
        scene = scenic_ref.load(ROOT / "examples" / name).sample(seed)
        axes = figure.add_subplot(2, 3, number)
        draw(axes, scene, None, colours_of([scene]), *views_of([scene]), small=True)
        axes.set_title(title, fontsize=10)
    return figure_bytes(figure, "png")


def simulation() -> bytes:
    """A simulation of a program on roads."""
    simulated = scenic_ref.load(ROOT / "examples" / SIMULATED).simulate("kinematic", STEPS, 1).simulation
    return movie(simulated, "a left turn, and somebody comes")


def trace_picture() -> bytes:
    """The beginning of a trace, as it stands in a terminal."""
    command = [sys.executable, "-m", "scenic_ref", "trace", f"examples/{TRACED}"]
    told = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, encoding="utf-8").stdout
    console = Console(record=True, width=COLUMNS, file=io.StringIO())
    for line in told.splitlines()[:LINES]:
        style = "bold" if re.match(r"\S", line) else "cyan" if re.match(r" +\d+  [A-Z]", line) else ""
        console.print(Text(line if len(line) <= COLUMNS else f"{line[: COLUMNS - 1]}\N{HORIZONTAL ELLIPSIS}", style, no_wrap=True))
    return NETWORK.sub("", console.export_svg(title=f"scenic-ref trace examples/{TRACED}", unique_id="trace")).encode()


MADE = {"scenes.png": scenes, "simulation.gif": simulation, "trace.svg": trace_picture}


def main() -> None:
    """Write all of them."""
    PLACE.mkdir(exist_ok=True)
    for name, make in MADE.items():
        (PLACE / name).write_bytes(make())


if __name__ == "__main__":
    main()
