"""A self-contained page that plays simulations again, and an animation of one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import TYPE_CHECKING, NamedTuple

from ..data.scene import in_json
from ..data.simulation import Simulated
from ..pictures.replay_pages import map_below, run_shown
from ..roads.network import Network
from ..simulators.worlds.driving import MAP
from .output_paths import write
from .progress_bar import Progress

if TYPE_CHECKING:
    from ..api import Scenario

MOST = 50
"""The most simulations on a page."""


class PageRun(NamedTuple):
    """A simulation in the simulation format, and the land below its objects; None where that is the program's map."""

    run: Mapping[str, object]
    land: Mapping[str, object] | None


def write_page(path: str, title: str, runs: Sequence[PageRun], scenario: Scenario) -> None:
    """Write the page. Raises `UsageError` if that cannot be done."""
    on_map = [run for run, land in runs if land is None]
    network = network_of(scenario) if on_map else None
    data = {
        "title": title, "map": None if network is None else map_below(network, on_map),
        "runs": [{**run_shown(run), "land": land} for run, land in runs],
    }  # fmt: skip
    text = in_json(data).replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    template = files("scenic_ref.cli").joinpath("replay.html").read_text(encoding="utf-8")
    write(path, template.replace("/*REPLAY*/null", text))


def network_of(scenario: Scenario) -> Network | None:
    """The map of a program."""
    module = scenario.settings.library.get(MAP)
    found = module.get("network") if isinstance(module, Mapping) else None
    return found if isinstance(found, Network) else None


def write_movie(path: str, title: str, simulation: Simulated) -> None:
    """Write a simulation as a GIF. Raises `UsageError` if that cannot be done."""
    from ..pictures.movies import frames_of, movie

    scene = simulation.scene
    with Progress(len(frames_of(simulation)), what="frames") as progress:
        data = movie(simulation, f"{title}, seed {scene.seed}, simulation {scene.index}", lambda: progress.drawn(0))
    write(path, data)

