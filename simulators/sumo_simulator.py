"""Traffic by Eclipse SUMO (extra `sumo`): its drivers on the map of the program, among objects that behaviors move. The only file that imports it.

An object whose behavior takes `SetAutopilotAction(True)` is driven by SUMO from the next time step on: it follows its lane and what is ahead, heeds
right of way and traffic lights, and turns at random. All others move as in `kinematic`, and SUMO's drivers see those that are on a lane.
Each run has a process of SUMO of its own, whose seed is the run's.
"""

from __future__ import annotations

import ctypes
import math
import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ..data.simulation import Body, Pose
from ..interpreter.runtime.optional_packages import missing_package_error
from ..roads.map_generator import generate_map
from ..semantics.store.errors import UsageError
from . import actions as a
from .controls import PROPERTIES, along, checked_timestep
from .kinematic import Moving, move, moving_of, pose_of, take
from .protocol import EndRun, RejectRun, Surroundings
from .worlds.driving import DEFAULT

LONGEST_ROUTE = 200
"""Edges of SUMO's network that a driver plans ahead."""
NARROWEST = 0.1
"""Metres: SUMO has no vehicles without a length or width."""
WAIT, PATIENCE = 0.005, 60.0
"""Seconds between two looks whether a process of SUMO answers, and after which it is given up."""


class OnRoad(Moving):
    """An object on or beside the road; SUMO knows it by its name.

    Its behavior has `wanted` a driver, it is `driven` by one, or it is `gone` from SUMO's roads, at whose end it stands.
    """

    name = ""
    wanted = False
    driven = False
    gone = False


class Traffic:
    """The simulator; `timestep` is in seconds, and whole milliseconds. Raises `UsageError` if SUMO is not installed."""

    properties = PROPERTIES
    random = True

    def __init__(self, timestep: float = 0.1) -> None:
        self.timestep = checked_timestep(timestep)
        if abs(timestep * 1000 - round(timestep * 1000)) > 1e-6 or timestep * 1000 < 0.5:
            raise ValueError(f"a time step of sumo must be a whole number of milliseconds, not {timestep:g} s")
        try:
            import sumo  # type: ignore[import-not-found]
            import traci  # type: ignore[import-not-found]
        except ImportError as problem:
            raise missing_package_error("the simulator sumo", "traci" if problem.name == "traci" else "sumo", problem) from None
        self.traci, self.programs = traci, Path(sumo.SUMO_HOME) / "bin"
        self.maps: dict[object, bytes] = {}
        self.process: subprocess.Popen[bytes] | None = None
        self.world: Any = None
        self.bodies: list[OnRoad] = []
        self.scene = Surroundings()
        self.met: frozenset[tuple[int, int]] = frozenset()

    # Beginning and end

    def create(self, bodies: Sequence[Body], scene: Surroundings) -> None:
        """Objects begin with their property `velocity`, else `speed` along their heading, else at rest."""
        self.world = self.world or self.started(scene)
        self.scene = scene
        vehicle = self.world.vehicle
        for body in bodies:
            moving = moving_of(body, OnRoad)
            moving.name = f"object {body.id}"
            self.bodies.append(moving)
            vehicle.add(moving.name, "", departSpeed="0")
            vehicle.setLength(moving.name, max(moving.length, NARROWEST))
            vehicle.setWidth(moving.name, max(float(body.properties["width"]), NARROWEST))  # type: ignore[arg-type]
            self.put(moving)

    def started(self, scene: Surroundings) -> Any:
        """The connection to a new process of SUMO, on the map of the program. Raises `UsageError`, `RuntimeError`."""
        port = free_port()
        with TemporaryDirectory(prefix="scenic-ref-sumo-") as folder:  # gone before the first time step
            net = Path(folder) / "map.net.xml"
            net.write_bytes(self.map_of(scene))
            options = [
                "--net-file", str(net), "--step-length", f"{self.timestep:.3f}", "--seed", str(scene.seed), "--remote-port", str(port),
                "--no-step-log", "--no-warnings", "--duration-log.disable", "--time-to-teleport", "-1", "--collision.action", "warn",
                "--collision.check-junctions", "--collision.mingap-factor", "0",
            ]  # fmt: skip
            command = [str(self.programs / "sumo"), *options]
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True,
                preexec_fn=ends_with_us(),
            )  # fmt: skip
            world = self.connected(self.process, port)
            world.getVersion()  # it answers when it has read its map
            return world

    def connected(self, process: subprocess.Popen[bytes], port: int) -> Any:
        """The connection to a process of SUMO. Raises `RuntimeError`."""
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until and process.poll() is None:
            with suppress(OSError):
                return self.traci.connection.Connection("localhost", port, process, None, True, None)
            time.sleep(WAIT)
        process.kill()
        raise RuntimeError(f"SUMO does not answer: {last_line(process.communicate()[1]) or 'it says nothing'}")

    def map_of(self, scene: Surroundings) -> bytes:
        """SUMO's network for the map of a program, made once. Raises `UsageError`."""
        if scene.network is None:
            raise UsageError("the simulator sumo needs a map, and this program has none", hint="write model scenic.domains.driving.model")
        named = scene.params.get("map")
        file = Path(named) if isinstance(named, str) else None
        now = None if file is None else file.stat()
        key = None if now is None else (named, now.st_mtime_ns, now.st_size)
        if key not in self.maps:
            self.maps[key] = self.converted(
                generate_map("grid", **DEFAULT).encode() if file is None else file.read_bytes(), named or "of the program"
            )
        return self.maps[key]

    def converted(self, opendrive: bytes, name: object) -> bytes:
        """SUMO's network for a map in the OpenDRIVE format. Raises `UsageError`."""
        with TemporaryDirectory(prefix="scenic-ref-sumo-") as folder:
            source, net = Path(folder) / "map.xodr", Path(folder) / "map.net.xml"
            source.write_bytes(opendrive)
            options = ["--opendrive-files", str(source), "--output-file", str(net), "--offset.disable-normalization", "--no-warnings"]
            done = subprocess.run([str(self.programs / "netconvert"), *options], stdin=subprocess.DEVNULL, capture_output=True, check=False)
            if done.returncode or not net.exists():
                raise UsageError(f"SUMO's netconvert cannot read the map {name}: {last_line(done.stderr)}")
            return net.read_bytes()

    def destroy(self) -> None:
        """End the process of SUMO."""
        world, process = self.world, self.process
        self.world, self.process, self.bodies, self.met = None, None, [], frozenset()
        if world is not None:
            with suppress(Exception):  # it may be gone already
                world.close(False)
        if process is not None:
            process.kill()
            process.communicate()

    # Time steps

    def check(self, body: Body, action: object) -> str | None:
        """Whether it is one of our actions, and this object can take it."""
        return action.reason_against(body) if isinstance(action, a.Action) else f"it is none of {', '.join(a.ACTIONS)}"

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """The actions; then all others than SUMO's drivers move, and SUMO lets one time step pass for these."""
        for id, taken in actions.items():
            for action in taken:
                if isinstance(action, a.SetAutopilotAction):
                    self.bodies[id].wanted = bool(action.enabled)
                else:
                    take(self.bodies[id], action)
        for body in self.bodies:
            body.driven = body.driven and body.wanted
            if not body.driven and not body.gone:
                move(body, self.timestep)
                self.put(body)
        self.world.simulationStep()
        events = [*self.left(), *self.collisions()]
        for id, body in enumerate(self.bodies):
            if body.driven:
                self.look(body)
            elif body.wanted and not body.gone:
                self.drive(id, body)
        ego = self.scene.ego
        if ego is not None and self.bodies[ego].gone:
            raise EndRun(f"object {ego}, which is ego, has reached the end of the roads", events)
        return events

    def drive(self, id: int, body: OnRoad) -> None:
        """Let SUMO drive an object, from its place and with its speed. Raises `RejectRun` where its drivers cannot begin."""
        self.world.vehicle.setRoute(body.name, self.route(id, body))
        self.world.vehicle.setPreviousSpeed(body.name, max(0.0, body.speed))
        body.driven = True

    def route(self, id: int, body: OnRoad) -> list[str]:
        """Edges of SUMO's network from where an object is, by turns at random. Raises `RejectRun`."""
        chance = random.Random(f"{self.scene.seed} {id}")
        edge, place, index = self.world.simulation.convertRoad(body.x, body.y, False, "passenger")
        off = math.dist(self.world.simulation.convert2D(edge, place, index), (body.x, body.y))
        if off > self.world.lane.getWidth(f"{edge}_{index}") / 2:
            raise RejectRun(f"object {id} is {off:.1f} m from the nearest lane of SUMO: there is no place for a driver to begin")
        lane = self.world.vehicle.getLaneID(body.name)
        edge = self.world.vehicle.getRoadID(body.name)
        if not lane or edge.startswith(":"):
            raise RejectRun(f"object {id} is in an intersection, where SUMO's drivers cannot begin")
        place = self.world.vehicle.getLanePosition(body.name)
        angle = -math.radians(self.world.lane.getAngle(lane, place))
        if abs(math.remainder(angle - body.heading, math.tau)) > math.pi / 2:
            raise RejectRun(f"object {id} faces against the traffic of its lane: there is no place for a driver to begin")
        edges = [edge]
        while len(edges) < LONGEST_ROUTE:
            following = sorted(link[0] for link in self.world.lane.getLinks(lane))
            if not following:
                break
            lane = chance.choice(following)
            edges.append(lane.rpartition("_")[0])
        return edges

    def put(self, body: OnRoad) -> None:
        """Tell SUMO where an object is: of a vehicle, the middle of its front."""
        ahead = along(body.length / 2, body.heading)
        angle = math.degrees(-body.heading) % 360
        self.world.vehicle.moveToXY(body.name, "", -1, body.x + ahead[0], body.y + ahead[1], angle, 2)

    def look(self, body: OnRoad) -> None:
        """Read where SUMO has driven an object."""
        vehicle = self.world.vehicle
        x, y = vehicle.getPosition(body.name)
        before = body.heading
        heading = math.remainder(-math.radians(vehicle.getAngle(body.name)), math.tau)
        back = along(body.length / 2, heading)
        body.x, body.y, body.heading = x - back[0], y - back[1], heading
        body.turning = math.remainder(heading - before, math.tau) / self.timestep
        body.run(vehicle.getSpeed(body.name), heading)

    def left(self) -> Iterator[str]:
        """Drivers that have reached the end of the roads, whose vehicles stand there from now on."""
        arrived = set(self.world.simulation.getArrivedIDList())
        for id, body in enumerate(self.bodies):
            if body.driven and body.name in arrived:
                body.driven, body.gone, body.turning = False, True, 0.0
                body.run(0.0, body.heading)
                yield f"object {id} has reached the end of the roads"

    def collisions(self) -> Iterator[str]:
        """The collisions of this time step that were not in the last one."""
        ids = {body.name: id for id, body in enumerate(self.bodies)}
        pairs = ((ids[c.collider], ids[c.victim]) for c in self.world.simulation.getCollisions())
        now = frozenset((min(pair), max(pair)) for pair in pairs)
        yield from (f"collision of objects {one} and {other}" for one, other in sorted(now - self.met))
        self.met = now

    def read(self, id: int) -> Pose:
        """Return the position and motion of the object."""
        return pose_of(self.bodies[id])


def ends_with_us() -> Callable[[], object] | None:
    """Return what a new process does first, so that it ends when this one is killed: on Linux only, elsewhere
    it would wait for a first connection.
    """
    if sys.platform != "linux":
        return None
    library = ctypes.CDLL(None)
    return lambda: library.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def last_line(said: bytes | None) -> str:
    """The last line of what a program wrote."""
    return (said or b"").decode(errors="replace").strip().rpartition("\n")[2]


def free_port() -> int:
    """A port of this machine that nobody listens on."""
    with socket.socket() as found:
        found.bind(("localhost", 0))
        return found.getsockname()[1]
