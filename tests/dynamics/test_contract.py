"""The contract of simulators: ours keep it, and what breaks a promise is told which."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from scenic_ref.simulators import by_name
from scenic_ref.simulators.actions import SetSpeedAction, SetThrottleAction
from scenic_ref.simulators.kinematic import Kinematic
from scenic_ref.testing import BrokenContract, check_simulator


@pytest.mark.parametrize(("name", "action"), [
    ("still", 3), ("kinematic", SetThrottleAction(1)), ("kinematic", SetSpeedAction(3)), ("kinematic", None),
    pytest.param("pymunk", SetThrottleAction(1), marks=pytest.mark.extra("dynamics")),
    pytest.param("pymunk", None, marks=pytest.mark.extra("dynamics")),
])  # fmt: skip
def test_our_simulators_keep_it(name, action):
    check_simulator(lambda: by_name(name), action)


class Negative(Kinematic):
    def __init__(self):
        super().__init__()
        self.timestep = -1


class Silent(Kinematic):
    def read(self, id):
        return {k: v for k, v in super().read(id).items() if k != "speed"}


class Elsewhere(Kinematic):
    def read(self, id):
        return {**super().read(id), "heading": 0.5}


class NotFinite(Kinematic):
    def read(self, id):
        return {**super().read(id), "speed": math.nan}


class Pairs(Kinematic):
    def read(self, id):
        pose = super().read(id)
        return {**pose, "position": tuple(pose["position"])}


class Mute(Kinematic):
    def step(self, actions):
        super().step(actions)


class Remembering(Kinematic):
    steps = 0

    def step(self, actions):
        self.steps += 1
        return super().step(actions)

    def read(self, id):
        pose = super().read(id)
        return {**pose, "speed": pose["speed"] + self.steps}


class Sharing(Kinematic):
    offset = 0.0

    def create(self, bodies, scene):
        super().create(bodies, scene)
        Sharing.offset += 1

    def read(self, id):
        return {**super().read(id), "speed": Sharing.offset}


class Writing(Kinematic):
    def create(self, bodies, scene):
        for body in bodies:
            body.properties["marked"] = True
        super().create(bodies, scene)


class Hesitating(Kinematic):
    def check(self, body, action):
        return False


class Refusing(Kinematic):
    def check(self, body, action):
        return "never"


class Aimless(Kinematic):
    properties = frozenset({"heading"})

    def read(self, id):
        return {"heading": super().read(id)["heading"]}


BROKEN = {
    Negative: "positive number of seconds", Silent: "all of the `properties`", Elsewhere: "the heading of an object is that of its body",
    NotFinite: "finite number", Pairs: "a position is a `Vector`", Mute: "a sequence of texts", Remembering: "used again",
    Sharing: "used again", Writing: "stay as they are", Hesitating: "None or a reason", Refusing: "can take the action",
    Aimless: "`position` is among",
}  # fmt: skip


@pytest.mark.parametrize("kind", BROKEN, ids=lambda kind: kind.__name__)
def test_a_broken_promise_is_named(kind):
    with pytest.raises(BrokenContract, match=BROKEN[kind]):
        check_simulator(kind, SetThrottleAction(1))


def test_the_example_of_the_documents_keeps_it():
    """`docs/simulation.md`, "A simulator of your own"."""
    text = (Path(__file__).parent.parent.parent / "docs" / "simulation.md").read_text()
    code = next(part for part in text.split("```python\n") if "class OnRails" in part).split("```")[0]
    space: dict[str, object] = {}
    exec(code, space)
    check_simulator(space["OnRails"], action=2.0)  # type: ignore[arg-type]
