"""A world that moves as it was recorded, whatever the agents do: the same for every implementation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..data.scene import Scene
from ..data.simulation import Body, Pose
from ..semantics.space.vectors import Vector
from ..simulators.protocol import Surroundings
from ..simulators.still import Still

World = Sequence[Mapping[str, Mapping[str, object]]]
"""For each time step, properties in JSON by the numbers of objects; what it does not name stays as it is."""
FARTHEST = 2.0
"""Metres that an object moves in a time step, at most, along each axis."""


class RecordedWorld(Still):
    """Time steps of one second in which objects are where they were recorded, and any value is an action."""

    properties = frozenset({"position", "heading"})

    def __init__(self, world: World) -> None:
        super().__init__()
        self.world = world
        self.passed = 0
        self.poses: list[Pose] = []

    def create(self, bodies: Sequence[Body], scene: Surroundings) -> None:
        """Objects are where they were made."""
        self.poses += [{name: body.properties[name] for name in self.properties} for body in bodies]

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """Let a time step pass, and take the recorded values of its end."""
        self.passed += 1
        for number, recorded in self.world[self.passed].items() if self.passed < len(self.world) else ():
            if number.isdecimal() and int(number) < len(self.poses):
                found = {name: Vector(*v) if isinstance(v, list) else v for name, v in recorded.items() if name in self.properties}
                self.poses[int(number)] = {**self.poses[int(number)], **found}
        return ()

    def read(self, id: int) -> Pose:
        """Return the current properties of the object."""
        return self.poses[id]

    def destroy(self) -> None:
        """The next simulation begins at the beginning."""
        self.passed = 0
        self.poses = []


def random_walk_world(scene: Scene, steps: int, seed: int) -> World:
    """A world in which the objects of a scene, from where they are, go and turn at random."""
    generator = np.random.Generator(np.random.Philox(seed))
    places = [np.array([thing["position"][0], thing["position"][1]]) for thing in scene.to_json()["objects"]]  # type: ignore[index]
    world: list[Mapping[str, Mapping[str, object]]] = [{}]
    for _ in range(steps):
        places = [place + generator.uniform(-FARTHEST, FARTHEST, 2) for place in places]
        headings = generator.uniform(-math.pi, math.pi, len(places))
        world.append({str(k): {"position": place.tolist(), "heading": float(headings[k])} for k, place in enumerate(places)})
    return world
