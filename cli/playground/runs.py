"""Runs that the page steps through: the trace of a scene, and simulations that are played again; and pictures of scenes."""

from __future__ import annotations

import base64
import json
from collections import Counter
from pathlib import Path

from ...api.diagnostics import of_error
from ...data.simulation import to_line
from ...pictures.replay_pages import land_below, map_below, run_shown
from ...pictures.scene_figures import check_format, picture
from ...semantics.kernel.errors import UsageError
from ...simulators import SIMULATORS, by_name
from ...simulators.loop import Failed
from ...simulators.protocol import Simulator
from ..drawing import drawing_of
from ..options import DEFAULT_ATTEMPTS
from ..pages import network_of
from ..simulating import when
from ..trace_output import WhichRun, page_of, traced, traced_simulation
from .asked import PlayRequest
from .scenes import Send, scenes_of
from .shown import diagnostic_shown, requirements_shown
from .texts import cut, cut_text

MOST_EVENTS = 20_000
MOST_POSES = 200_000
"""Poses of a simulation on the page: objects times time steps."""
MOST_PICTURED = 36


def send_trace(asked: PlayRequest, send: Send) -> None:
    """Send every rule that fired in a run for a scene, or for a simulation. Raises `AttemptsExhausted`, `UsageError`."""
    which = WhichRun(asked.seed, asked.start, asked.attempt, DEFAULT_ATTEMPTS)
    found = traced_simulation(asked.source, which, simulator_of(asked), asked.steps) if asked.steps else traced(asked.source, which)
    texts = {asked.source.file: asked.source.text}
    events = len(found.trace.events)
    del found.trace.events[MOST_EVENTS:]
    page = page_of(found, texts)
    sources = page.pop("sources")
    assert isinstance(sources, dict)
    send({
        "kind": "trace", "scene": asked.start, "attempt": found.attempt, "count": events,
        **{name: cut_text(value, 2000) if isinstance(value, str) else value for name, value in page.items()},
        "sources": {file: text for file, text in sources.items() if file != asked.source.file},
        "error": None if found.error is None else diagnostic_shown(of_error(found.error, asked.source.file)),
    })  # fmt: skip


def simulator_of(asked: PlayRequest) -> Simulator:
    """The simulator of a request, one of those that are shipped. Raises `UsageError`."""
    if asked.simulator not in SIMULATORS:
        raise UsageError(f"there is no simulator {asked.simulator}")
    return by_name(asked.simulator, asked.timestep)


def simulate(asked: PlayRequest, send: Send) -> None:
    """Send simulations as pages play them, and what rejected others. Raises the errors of the program and the simulator."""
    drawing = drawing_of(asked.source)
    scenario = drawing.scenario
    stuck: Counter[Failed] = Counter()
    attempts = found = 0

    def count(how: Failed) -> None:
        nonlocal attempts
        attempts += 1
        stuck[how] += 1

    try:
        for index in range(asked.start, asked.start + asked.count):
            run = scenario.simulate(simulator_of(asked), asked.steps, asked.seed, index, max_attempts=DEFAULT_ATTEMPTS, on_failed=count)
            attempts, found = attempts + 1, found + 1
            simulation = run.simulation
            if len(simulation.moments) * max(1, len(simulation.moments[-1].objects)) > MOST_POSES:
                raise UsageError("this simulation is too long to be shown here", hint="take fewer time steps")
            written = json.loads(to_line(simulation, run.attempts))
            land = land_below(simulation.scene, written)
            network = network_of(scenario) if land is None else None
            ground = land or {"areas": []} if network is None else map_below(network, [written])
            records = {cut_text(name, 60): cut(values) for name, values in written.get("records", {}).items()}
            send({"kind": "run", "attempts": run.attempts, "ground": ground, "records": records, "run": cut_run(run_shown(written))})
    finally:
        rejected = when(stuck)
        send({"kind": "simulated", "runs": found, "attempts": attempts, "stuck": requirements_shown(rejected.items())})


def cut_run(run: dict[str, object]) -> dict[str, object]:
    """A simulation whose texts are not too long."""
    steps = run["steps"]
    assert isinstance(steps, list)
    kept = [
        {
            "objects": [
                {name: cut(value) for name, value in pose.items() if name in ("id", "position", "heading", "speed", "width", "length")}
                for pose in step["objects"]
            ],
            "actions": cut(step["actions"]), "events": cut(step["events"]), "doing": cut(step["doing"]), "step": step["step"],
        }
        for step in steps
    ]  # fmt: skip
    return {**{name: cut(value) for name, value in run.items() if name not in ("steps", "objects")}, "objects": run["objects"], "steps": kept}


def send_picture(asked: PlayRequest, send: Send) -> None:
    """Send the picture that `run --plot` would draw of the scenes. Raises the program's error, and `UsageError` where there is none."""
    check_format(asked.form)
    scenes = [scene for scene, _ in scenes_of(drawing_of(asked.source), asked, lambda more: None)][:MOST_PICTURED]
    data = picture(scenes, format=asked.form)
    name = f"{Path(asked.source.file).stem}.{asked.form}"
    send({"kind": "file", "name": name, "form": asked.form, "data": base64.b64encode(data).decode()})
