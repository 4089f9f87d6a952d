"""The outcomes of one step of the machine (DESIGN, section 1)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Literal, NamedTuple

from ..space.distributions import Discrete, Distribution, Uniform
from ..store.errors import ScenicError
from ..syntax.nodes import Node, Span

if TYPE_CHECKING:
    from ..store.undo_log import Version
    from .config import Config, State
    from .values import Instance


class Requirement(NamedTuple):
    """A condition that a run must meet: what kind, where it stands, and a sentence naming it."""

    kind: str
    span: Span
    text: str

    @property
    def failure(self) -> str:
        """A sentence that says that it does not hold."""
        if self.kind in ("containment", "visibility"):
            return self.text.replace(" is ", " is not ", 1)
        if self.kind == "collision":
            return self.text.replace(" do not intersect", " intersect").replace("no two of", "some of", 1)
        if self.kind == "field":
            return self.text.replace(" has a value there", " has no value there")
        if self.kind == "region":
            return self.text.replace(" is not empty", " is empty")
        if self.kind == "given":
            return f"it is not so that {self.text}"
        return f"{self.text} fails" if self.kind in ("require", "precondition") else self.text


class Change(NamedTuple):
    """A change by a step, for people: `where` is σ, π, O or "print"; `name` and `value` say what became what.

    `instance` is the object some of whose properties were assigned: which, the states before and after tell.
    """

    where: Literal["σ", "π", "O", "print", ""]
    name: str
    value: object
    instance: Instance | None = None


class Next(NamedTuple):
    """A rule fired with probability 1; `rule` is "" for the bookkeeping between rules.

    Where something random decides whether an operand is reduced (reading `boolean-random`), `beyond` is the configuration that reduces it in
    runs in which it is not needed.
    """

    rule: str
    config: Config
    node: Node | None = None
    change: Change | None = None
    beyond: Config | None = None


class KnownDraw(NamedTuple):
    """The known result of a draw: its value, or, if there are finitely many, its possible places among those
    of the distribution.
    """

    value: object
    places: tuple[int, ...] | None = None

    def of(self, distribution: Distribution) -> Distribution:
        """The distribution, given this."""
        support = distribution.support() if self.places is not None else None
        if support is None or self.places is None:
            return Uniform((self.value,))
        kept = tuple(support[place] for place in self.places)
        return Discrete(kept) if len(kept) > 1 else Uniform(tuple(value for value, _ in kept))


class GivenValues(NamedTuple):
    """The given parts of the runs (`Scenario.condition_on`): draws by address, and the values of global
    parameters at the end, by name.
    """

    draws: Mapping[tuple[int, ...], KnownDraw] = {}
    params: Mapping[str, object] = {}


class Draw(NamedTuple):
    """A probabilistic rule asks for a value of `distribution`; `resume(value)` is the configuration after it.

    `address` names the draw within the run. `per_scene` draws are made once for all attempts at one scene (reading
    `soft=scene`). A coin chooses between two rules: `rule`, and `otherwise` for tails.
    """

    rule: str
    address: tuple[int, ...]
    distribution: Distribution
    node: Node
    resume: Callable[[object], Config]
    per_scene: bool = False
    otherwise: str = ""

    def fires(self, drawn: object) -> str:
        """The rule that fires if this is drawn."""
        return self.otherwise if self.otherwise and not drawn else self.rule


class Observe(NamedTuple):
    """A requirement was checked and holds."""

    rule: str
    requirement: Requirement
    config: Config


class Done(NamedTuple):
    """The run ended with a scene: (π, O) of `state`."""

    rule: str
    state: State


class Stuck(NamedTuple):
    """No rule applies: `requirement` does not hold. `beyond` is the configuration if it had, where there is one."""

    rule: str
    requirement: Requirement
    beyond: Config | None = None


class Fault(NamedTuple):
    """The program is wrong, or the paper is silent: `error` says where and how."""

    error: ScenicError


class Act(NamedTuple):
    """The policy has chosen the actions of a time step: those of each agent, by its number; agents that take none are left out."""

    rule: str
    actions: Mapping[int, tuple[object, ...]]
    state: State


class Finish(NamedTuple):
    """The policy says that the scenario ends, and why: all requirements are satisfied."""

    rule: str
    reason: str
    state: State


Outcome = Next | Draw | Observe | Done | Stuck | Fault | Act | Finish


def date_outcome(outcome: Outcome, version: Version) -> Outcome:
    """The outcome with the version that stands in memory in its configurations or its state."""
    if type(outcome) is Next:
        beyond = None if outcome.beyond is None else in_version(outcome.beyond, version)
        return Next(outcome.rule, in_version(outcome.config, version), outcome.node, outcome.change, beyond)
    match outcome:
        case Draw(resume=resume):
            return outcome._replace(resume=partial(in_version_after, resume, version))
        case Observe(config=config):
            return outcome._replace(config=in_version(config, version))
        case Stuck(beyond=beyond):
            return outcome if beyond is None else outcome._replace(beyond=in_version(beyond, version))
        case Done(state=state) | Act(state=state) | Finish(state=state):
            return outcome._replace(state=state.in_version(version))
        case _:
            return outcome


def in_version_after(resume: Callable[[object], Config], version: Version, drawn: object) -> Config:
    """Return the configuration after a draw, in that version, whatever was stepped since."""
    if version.undo:
        version.versions.go_to(version)
    return in_version(resume(drawn), version)


def in_version(config: Config, version: Version) -> Config:
    """The configuration in that version."""
    state = config.state
    return config if state.version is version else type(config)(config.control, config.stack, state.in_version(version))
