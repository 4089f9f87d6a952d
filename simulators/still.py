"""The simulator in which nothing moves and any value is an action: the world in which a policy is tested alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..data.simulation import Body, Pose
from .protocol import Surroundings


class Still:
    """Nothing moves. `timestep` is in seconds."""

    properties: frozenset[str] = frozenset()
    random = False

    def __init__(self, timestep: float = 1.0) -> None:
        self.timestep = timestep

    def create(self, bodies: Sequence[Body], scene: Surroundings) -> None:
        """Objects stay where they are."""

    def check(self, body: Body, action: object) -> str | None:
        """Any value is an action."""
        return None

    def step(self, actions: Mapping[int, Sequence[object]]) -> Sequence[str]:
        """Let a time step pass without any change."""
        return ()

    def read(self, id: int) -> Pose:
        """Return no properties, since none has changed."""
        return {}

    def destroy(self) -> None:
        """There is nothing to destroy."""
