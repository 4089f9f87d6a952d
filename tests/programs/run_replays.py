"""Recording a run and replaying it: the same answers must give the same scene, with the same density."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from scenic_ref.api import Scenario
from scenic_ref.data.scene import Scene, scene_of
from scenic_ref.interpreter.runtime.answerers import from_stream, from_trace
from scenic_ref.interpreter.runtime.program_run import Accepted, Chooser, generate_scene
from scenic_ref.semantics.machine.outcome import Draw, Outcome

Address = tuple[int, ...]


class WhichValue(NamedTuple):
    """An answer to a draw with finitely many values: which of them."""

    place: int


@dataclass
class Answers:
    """The answers of a run by address, in order, and the sum of the logarithms of their densities."""

    answers: dict[Address, object] = field(default_factory=dict)
    log_density: float = 0.0
    repeated: list[Address] = field(default_factory=list)
    scene: Scene | None = None

    def witness(self, outcome: Outcome, answer: object) -> None:
        """Note a draw."""
        if isinstance(outcome, Draw):
            if outcome.address in self.answers:
                self.repeated.append(outcome.address)
            self.answers[outcome.address] = as_recorded(outcome, answer)
            self.log_density += outcome.distribution.log_density(answer)


def recorded(scenario: Scenario, choose: Chooser) -> Answers:
    """One run with everything that was drawn; its scene is None if it was rejected."""
    recording = Answers()
    result = generate_scene(scenario.start(), choose, fuel=scenario.fuel, witness=recording.witness)
    if isinstance(result, Accepted):
        recording.scene = scene_of(result.state, 0, 0, 1)
    return recording


def first_accepted(scenario: Scenario, seed: int, attempts: int) -> Answers | None:
    """The first accepted run of scene 0, if there is one among the attempts."""
    for attempt in range(attempts):
        recording = recorded(scenario, from_stream(seed, 0, attempt))
        if recording.scene is not None:
            return recording
    return None


def replayed(scenario: Scenario, answers: Mapping[Address, object]) -> Answers:
    """The run that these answers give. Raises `LookupError` at a draw that has none."""

    def refuse(draw: Draw) -> object:
        raise LookupError(f"no answer was recorded for the draw {draw.address}")

    choose = from_trace(answers, refuse)
    return recorded(scenario, lambda draw: as_answered(draw, choose(draw)))


def as_recorded(draw: Draw, answer: object) -> object:
    """The answer as it is kept: by its place among finitely many values, which may be objects that belong to their run."""
    support = draw.distribution.support() or ()
    return next((WhichValue(place) for place, (value, _) in enumerate(support) if value is answer), answer)


def as_answered(draw: Draw, kept: object) -> object:
    """The value of this run that a kept answer stands for."""
    if not isinstance(kept, WhichValue):
        return kept
    support = draw.distribution.support() or ()
    return support[kept.place][0]
