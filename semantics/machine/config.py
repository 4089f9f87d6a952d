"""The state ⟨s, σ, π, O⟩ of a program: what is left to do, the variables, the global parameters, the objects."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from ..store.scopes import Scope
from ..store.undo_log import Version
from ..syntax.nodes import NOWHERE, Node, Span
from .outcome import Change, GivenValues, Next
from .values import Dynamic, Instance, Module, Origin

if TYPE_CHECKING:
    from ..syntax import Program
    from .host_calls import Door
    from .outcome import Outcome
    from .simulation_state import Declared, Simulation

Properties = Mapping[str, object]


class Settings(NamedTuple):
    """The constants of a run: readings, importable modules, the machine itself (for calls from host code).

    `elsewhere` has the world models in which a name can be found, and `defined` where the program binds one
    at its top level, for suggestions. `dialect` is the program's. A `trusted` program may hold and ask
    anything (`allowed`), since it imports Python code that can do anything.
    """

    readings: Mapping[str, str]
    library: Mapping[str, Program | Mapping[str, object] | Exception]
    machine: Callable[[Config], Outcome]
    door: Door
    params: Mapping[str, object] = {}
    model: str | None = None
    scenario: str | None = None
    trusted: bool = False
    given: GivenValues = GivenValues()
    elsewhere: Mapping[str, tuple[str, ...]] = {}
    defined: Mapping[str, Span] = {}
    dialect: str = "paper"


class Captured(NamedTuple):
    """The captured state of a requirement that waits for the end: a copy of σ, `ego` and `workspace`, O."""

    sigma: Scope
    ego: object
    workspace: object
    objects: Mapping[int, Properties]


class State(NamedTuple):
    """(σ, π, O) of the paper, and what the machine keeps beside them."""

    sigma: Scope
    """σ: the variables of the running code, in the scope of its block."""
    settings: Settings
    """Readings, dialect and limits: they never change during a run."""
    version: Version
    """The version of the scopes and containers, which are updated in place (`semantics.store.undo_log`)."""
    params: Mapping[str, object] = {}
    """π: the global parameters."""
    objects: Mapping[int, Properties] = {}
    """O: the properties of every instance, by its number."""
    scene: tuple[Instance, ...] = ()
    """The Objects among the instances, in the order of their creation."""
    names: Mapping[int, str] = {}
    """The name of an instance in scenes and reports, by its number: `ego`, or the first variable of a module that it was assigned to."""
    ego: object = None
    """The ego, which all modules share; None until one is assigned."""
    workspace: object = None
    """The workspace, which all modules share; None stands for everywhere."""
    prefix: tuple[int, ...] = ()
    """The first part of the address of the next draw; inside a behavior or scenario it is their own."""
    draws: int = 0
    """The last part of that address: how many draws were made under `prefix`."""
    modules: Mapping[str, Module] = {}
    """The modules that were imported in this run, by name."""
    late: tuple[tuple[Node, Captured], ...] = ()
    """The requirements that wait for the end, each with what held at its statement (reading `require-time=end`)."""
    dynamic: tuple[Declared, ...] = ()
    """The statements that the policy asks in each time step (`require always`, `terminate when`, `record`, ...), with their scopes."""
    handling: tuple[BaseException, ...] = ()
    """The exceptions that `except` blocks are handling, the innermost last."""
    depth: int = 0
    """The number of open calls, which is limited."""
    made: int = 0
    """The numbers of instances that are taken; the next instance gets this one."""
    initial: Dynamic | None = None
    """The modular scenario that the run began with, if it is one."""
    simulation: Simulation | None = None
    """The simulation; None while the scene is being generated."""
    settled: Mapping[tuple[object, int, int | None], object] = {}
    """The random values of what waited for a position, by value, object and time step."""
    deciding: bool = False
    """Whether the condition of a requirement is evaluated with plain values (reading `random-branch`)."""

    @property
    def runs(self) -> bool:
        """Whether a scenario runs, and this is not one of its setup blocks."""
        return self.simulation is not None and not self.simulation.setting

    @property
    def may_branch(self) -> bool:
        """Whether what is drawn may decide what happens, so that rules see plain values."""
        return self.deciding or self.runs

    @property
    def address(self) -> tuple[int, ...]:
        """The address of the next draw."""
        return (*self.prefix, self.draws)

    def reading(self, name: str) -> str:
        """The alternative of a reading that this run follows."""
        return self.settings.readings[name]

    def property(self, instance: Instance, name: str) -> object:
        """Return O(instance.name), the value of a property."""
        return self.objects[instance.number][name]

    def with_properties(self, instance: Instance, properties: Properties) -> State:
        """O[instance.p / v] for every p in `properties`."""
        updated = {**self.objects.get(instance.number, {}), **properties}
        return self.with_objects({**self.objects, instance.number: updated})

    def with_objects(self, objects: Mapping[int, Properties]) -> State:
        """Return the state with another O; equal to `_replace`, but faster, for the most frequent step."""
        return tuple.__new__(State, (*self[:OBJECTS], objects, *self[OBJECTS + 1 :]))  # pyright: ignore[reportUnknownMemberType]

    def with_simulation(self, simulation: Simulation) -> State:
        """Return the state with another simulation; equal to `_replace`, but faster."""
        return tuple.__new__(State, (*self[:SIMULATION], simulation, *self[SIMULATION + 1 :]))  # pyright: ignore[reportUnknownMemberType]

    def in_version(self, version: Version) -> State:
        """Return the state in another version."""
        return tuple.__new__(State, (*self[:VERSION], version, *self[VERSION + 1 :]))  # pyright: ignore[reportUnknownMemberType]


class Value(NamedTuple):
    """An expression has been reduced to `value`; a statement to `pass`, whose value is PASS."""

    value: object


PASS = Value(None)


class Abrupt(NamedTuple):
    """A statement left its block: by `break`, `continue`, `return` (with a value), `abort`, `terminate`, or an exception (with the draw that
    it depends on). `caller` is where the program called the library module in which an exception was raised.
    """

    kind: Literal["break", "continue", "return", "raise", "abort", "terminate"]
    value: object = None
    span: Span = NOWHERE
    origin: Origin | None = None
    caller: Span = NOWHERE


OBJECTS = State._fields.index("objects")
VERSION = State._fields.index("version")
SIMULATION = State._fields.index("simulation")
Stack: TypeAlias = tuple[Any, ...]
"""The context in which the control stands: (), or (frame, Stack) with the innermost frame first."""

Reduction = Callable[[Any, Stack, "State"], "Outcome"]
"""What reduces a kind of node: `reduction(node, stack, state)`."""
Resumption = Callable[[Any, Any, Stack, "State"], "Outcome"]
"""What goes on in a kind of frame when what stood above it is reduced: `resumption(frame, result, stack, state)`."""
Unwinding = Callable[[Any, Abrupt, Stack, "State"], "Outcome"]
"""What a kind of frame does when what stood above it was left: `unwinding(frame, abrupt, stack, state)`."""


class Config(NamedTuple):
    """A configuration: a node to reduce, or what it was reduced to; the context around it; the state."""

    control: Node | Value | Abrupt
    stack: Stack
    state: State


def value(rule: str, result: object, stack: Stack, state: State, node: Node | None = None, change: Change | None = None) -> Next:
    """The conclusion `... → result` of a rule without probability."""
    return Next(rule, Config(Value(result), stack, state), node, change)


def reduce(node: Node, frame: object, stack: Stack, state: State) -> Next:
    """Go on with a premise: reduce `node`, then come back to `frame`."""
    return Next("", Config(node, (frame, stack), state))
