"""The start of a run: the configuration ⟨program, ∅, ∅, ∅⟩, and what a finished run says, the scene (π, O)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from .dynamics.initial_scenario import Finishing, unassigned_ego
from .machine.config import Config, Settings, State
from .machine.host_calls import Door
from .machine.operand_kinds import is_object
from .machine.outcome import GivenValues
from .machine.values import Instance, value_in_run
from .python.builtins import builtin_scope
from .python.functions import enter
from .python.generators import expand
from .python.imports import dunders
from .step import step
from .store.errors import NoEgo
from .store.scopes import Scope, target_names
from .syntax import Program, Span
from .syntax.dynamics import BehaviorDefinition, MonitorDefinition, ScenarioDefinition
from .syntax.python_expressions import Constant
from .syntax.statements import Assignment, Block, ClassDefinition, FunctionDefinition, If, Model

NOTHING_GIVEN = GivenValues()
OF_RELEASES = ("scenic-2.1", "scenic-3")
"""The dialects of the released implementations."""


def make_settings(
    readings: dict[str, str], library: dict[str, object], params: dict[str, object], model: str | None, scenario: str | None = None,
    *, trusted: bool = False, given: GivenValues = NOTHING_GIVEN, elsewhere: Mapping[str, tuple[str, ...]] | None = None,
    defined: Mapping[str, Span] | None = None, dialect: str = "paper",
) -> Settings:  # fmt: skip
    """Return the constants of every run of a program; its door is of no run (see `initial`)."""
    return Settings(
        readings=readings, library=library, machine=step, door=Door(enter, expand), params=params, model=model, scenario=scenario, trusted=trusted,  # type: ignore[arg-type]
        given=given, elsewhere=elsewhere or {}, defined=defined or {}, dialect=dialect,
    )  # fmt: skip


def definitions(program: Program) -> dict[str, Span]:
    """Return the places at which a program first binds each name at its top level."""
    found: dict[str, Span] = {}
    for statement in program.statements:
        match statement:
            case FunctionDefinition(name=name) | ClassDefinition(name=name) | BehaviorDefinition(name=name):
                names: Iterable[str] = (name,)
            case MonitorDefinition(name=name) | ScenarioDefinition(name=name):
                names = (name,)
            case Assignment(targets=targets):
                names = (name for target in targets for name in target_names(target))
            case _:
                names = ()
        for name in names:
            found.setdefault(name, statement.span)
    return found


def initial(program: Program, settings: Settings) -> Config:
    """⟨program, ∅, ∅, ∅⟩; a world model named from outside replaces the program's (paper, "Selecting a World Model"), or comes first.

    Each run has a door of its own, so that runs of one program side by side never meet.
    """
    settings = settings._replace(door=Door(enter, expand))  # type: ignore[arg-type]
    budget = settings.door.budget
    scope = Scope("module", builtin_scope(budget, released=settings.dialect in OF_RELEASES), bindings=dunders(program.file))
    statements: Block = program.statements
    if settings.model is not None:
        chosen = settings.model
        statements = tuple(replace(s, name=chosen) if isinstance(s, Model) else s for s in statements)
        if not any(isinstance(s, Model) for s in statements):
            statements = (Model(name=chosen), *statements)
    whole = If(test=Constant(value=True), then=statements)
    empty = None if statements else Span(program.file, 1, 1, 1, 1)
    finishing = Finishing(empty, unassigned_ego(program.statements))
    return Config(whole, (finishing, ()), State(scope, settings, budget.versions.current, params=dict(settings.params)))


def ego_of(state: State, *, simulated: bool = False) -> Instance | None:
    """The ego object of a finished run, if there is one (reading `no-ego`; in a simulation a scenario may make it later, reading `compose-only`).

    Raises `NoEgo` where there must be one.
    """
    ego = value_in_run(state.ego)
    if ego is None and (simulated or state.reading("no-ego") == "allowed"):
        return None
    if ego is None:
        raise NoEgo("the scene has no ego: only a scenario that the compose block runs would make it", hint="run a simulation of the program")
    assert isinstance(ego, Instance) and is_object(ego)
    return ego
