"""A self-contained page that plays simulations again, and an animation of one."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files

from ..formats.recordings import Simulated, to_json
from ..formats.scenes import in_json
from ..inference.simulation import SampledRun
from .files import write
from .progress import Progress

MOST = 50
"""The most simulations on a page."""


def write_page(path: str, title: str, runs: Sequence[SampledRun]) -> None:
    """Write the page. Raises `UsageError` if that cannot be done."""
    data = {"title": title, "runs": [shown(to_json(run.simulation, run.attempts)) for run in runs]}
    text = in_json(data).replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    template = files("scenic_ref.cli").joinpath("replay.html").read_text(encoding="utf-8")
    write(path, template.replace("/*REPLAY*/null", text))


def write_movie(path: str, title: str, simulation: Simulated) -> None:
    """Write a simulation as a GIF. Raises `UsageError` if that cannot be done."""
    from ..formats.movies import frames_of, movie

    scene = simulation.scene
    with Progress(len(frames_of(simulation)), what="frames") as progress:
        data = movie(simulation, f"{title}, seed {scene.seed}, simulation {scene.index}", lambda: progress.drawn(0))
    write(path, data)


def shown(run: dict[str, object]) -> dict[str, object]:
    """What the page needs of a simulation: the objects by number, those of the scene first."""
    scene, created = run["scene"], run["created"]
    assert isinstance(scene, dict) and isinstance(created, list)
    wanted = ("id", "name", "class", "position", "heading", "width", "length")
    objects = [{name: o[name] for name in wanted if name in o} for o in (*scene["objects"], *created)]
    return {name: run[name] for name in ("seed", "run", "timestep", "steps", "result", "reason")} | {"ego": scene["ego"], "objects": objects}
