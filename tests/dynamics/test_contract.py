"""The contract of simulators: ours keep it, and what breaks a promise is told which."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import SimulatorError
from scenic_ref.simulators import EndRun, RejectRun, by_name
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


class Undeclared(Kinematic):
    random = None


class Secretive(Kinematic):
    """What it draws follows from the seed, which it does not say."""

    def create(self, bodies, scene):
        super().create(bodies, scene)
        self.seed = scene.seed

    def read(self, id):
        return {**super().read(id), "speed": float(self.seed)}


class Overbearing(Kinematic):
    def check(self, body, action):
        raise RejectRun("I do not like it")


class Fussy(Kinematic):
    def create(self, bodies, scene):
        raise RejectRun("there is no place")


class Hasty(Kinematic):
    def create(self, bodies, scene):
        raise EndRun("it is over")


BROKEN = {
    Negative: "positive number of seconds", Silent: "all of the `properties`", Elsewhere: "the heading of an object is that of its body",
    NotFinite: "finite number", Pairs: "a position is a `Vector`", Mute: "a sequence of texts", Remembering: "used again",
    Sharing: "used again", Writing: "stay as they are", Hesitating: "None or a reason", Refusing: "can take the action",
    Aimless: "`position` is among", Undeclared: "`random` is True or False", Secretive: "nothing follows from the seed",
    Overbearing: "check.. neither rejects nor ends", Fussy: "rejects the scene of this check .there is no place", Hasty: "only step.. ends a run",
}  # fmt: skip


@pytest.mark.parametrize("kind", BROKEN, ids=lambda kind: kind.__name__)
def test_a_broken_promise_is_named(kind):
    with pytest.raises(BrokenContract, match=BROKEN[kind]):
        check_simulator(kind, SetThrottleAction(1))


class Noisy(Kinematic):
    """No two runs of it are quite the same, as those of a simulator on several threads."""

    noise = 1e-7
    calls = 0

    def read(self, id):
        pose = super().read(id)
        self.calls += 1
        return {**pose, "position": pose["position"] + Vector(self.noise * (self.calls % 3), 0.0), "speed": pose["speed"] + self.noise}


def test_a_simulator_that_is_not_reproducible_keeps_the_contract_up_to_a_tolerance():
    check_simulator(Noisy, SetThrottleAction(1), tolerance=1e-6)
    with pytest.raises(BrokenContract, match="after create"):
        check_simulator(Noisy, SetThrottleAction(1))
    with pytest.raises(BrokenContract, match="after create"):
        check_simulator(Noisy, SetThrottleAction(1), tolerance=1e-8)


class Lottery(Kinematic):
    """Random, as it says: the seed decides on the speeds."""

    random = True

    def create(self, bodies, scene):
        super().create(bodies, scene)
        self.seed = scene.seed

    def read(self, id):
        return {**super().read(id), "speed": float(self.seed)}


class Unrepeatable(Lottery):
    drawn = 0

    def read(self, id):
        Unrepeatable.drawn += 1
        return {**super().read(id), "speed": float(self.drawn)}


def test_a_random_simulator_is_a_function_of_its_seed():
    check_simulator(Lottery, SetThrottleAction(1))
    with pytest.raises(BrokenContract, match="used again"):
        check_simulator(Unrepeatable, SetThrottleAction(1))


class Small(Kinematic):
    """A world of 20 m for those who are in its west, which ends after 5 time steps."""

    forgetful = False
    steps = 0

    def create(self, bodies, scene):
        super().create(bodies, scene)
        if any(body.properties["position"].x < -100 for body in bodies):
            raise RejectRun("beyond the west")

    def step(self, actions):
        super().step(actions)
        self.steps += 1
        if self.steps == 5:
            raise EndRun("the show is over", ["the curtain falls"])
        return ()

    def destroy(self):
        if not self.forgetful:
            super().destroy()
            self.steps = 0


class Littering(Small):
    """It cleans up only what it did not reject."""

    def create(self, bodies, scene):
        try:
            super().create(bodies, scene)
            self.forgetful = False
        except RejectRun:
            self.forgetful = True
            raise


class Mistaken(Small):
    """After its end there is nothing to read."""

    def read(self, id):
        return super().read(id) if self.steps < 5 else {}


FAR = "class Car:\n    width: 2\n    length: 4\nego = Car at (-200, 0)\n"


def test_rejecting_and_ending_are_checked():
    check_simulator(Small, SetThrottleAction(1), rejected=FAR, ends_within=5)
    with pytest.raises(BrokenContract, match="is rejected, with `RejectRun`"):
        check_simulator(Kinematic, SetThrottleAction(1), rejected=FAR)
    with pytest.raises(BrokenContract, match="ended within 4 time steps, with `EndRun`"):
        check_simulator(Small, SetThrottleAction(1), ends_within=4)
    with pytest.raises(BrokenContract, match="after a run that it rejected it can be used again"):
        check_simulator(Littering, SetThrottleAction(1), rejected=FAR)
    with pytest.raises(BrokenContract, match="after the last time step read"):
        check_simulator(Mistaken, SetThrottleAction(1), ends_within=5)


def test_the_example_of_the_documents_keeps_it():
    """`docs/simulation.md`, "A simulator of your own"."""
    text = (Path(__file__).parent.parent.parent / "docs" / "simulation.md").read_text()
    code = next(part for part in text.split("```python\n") if "class OnRails" in part).split("```")[0]
    space: dict[str, object] = {}
    exec(code, space)
    check_simulator(space["OnRails"], action=2.0)  # type: ignore[arg-type]
    check_simulator(space["OnRails"], action=900.0, rejected="ego = Object at (0, 2000)", ends_within=3)  # type: ignore[arg-type]


class Refilling(Kinematic):
    """Gives one mapping, with what it says of the object that was asked for last."""

    def __init__(self):
        super().__init__()
        self.said = {}

    def read(self, id):
        self.said.update(super().read(id))
        return self.said


TWO = "ego = Object with speed 3\nObject at (10, 0), with speed 4\n"


def test_a_simulator_may_give_the_same_mapping_for_each_object():
    runs = [scenic_ref.loads(TWO).simulate(simulator, 3).simulation for simulator in (Refilling(), Kinematic())]
    assert runs[0].moments == runs[1].moments
    assert runs[1].moments[-1].objects[0]["position"] != runs[1].moments[-1].objects[1]["position"]


class WrongAndRejected(Kinematic):
    def read(self, id):
        if id == 1:
            raise RejectRun("no more")
        return {**super().read(id), "speed": math.nan}


def test_a_wrong_value_is_told_though_the_next_object_is_rejected():
    with pytest.raises(SimulatorError, match="gives nan as the speed") as found:
        scenic_ref.loads(TWO).simulate(WrongAndRejected(), 3)
    assert found.value.span.line == 1
