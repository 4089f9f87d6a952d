"""Values of Scenic expressions in finished scenes: an expression is evaluated after the run has ended, so it
changes nothing about the scene.

A parameter that is added to the program would be evaluated before objects are mutated, and could draw. Here
nothing is drawn: an expression that asks for a draw is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from ..data.scene import Scene, scene_of
from ..inference.enumeration import DEFAULT_RUNS, Enumeration, enumerate_runs
from ..interpreter.language.parser import parse
from ..interpreter.runtime.process_sandbox import guard_run
from ..interpreter.runtime.program_run import endless
from ..semantics.machine.config import Config, State, Value
from ..semantics.machine.host_calls import HostException
from ..semantics.machine.outcome import Draw, Fault
from ..semantics.machine.run_loop import Arrived, Unfinished, drive_machine, taken_over
from ..semantics.step import step
from ..semantics.store.errors import RunError, UsageError
from ..semantics.syntax import Expression
from ..semantics.syntax.statements import ExpressionStatement

if TYPE_CHECKING:
    from .scenario import Scenario

FILE = "<expression>"
"""The file that places in an expression name."""
NAME = "(the expression)"
"""The parameter of a scene that holds the value of the expression."""
FUEL = 100_000
"""The most steps that an expression may take."""


def expression_of(text: str, dialect: str | None = None) -> Expression:
    """The expression that a text is. Raises `ParseError`, and `UsageError` if it is something else."""
    statements = parse(text.strip(), FILE, dialect).statements
    if len(statements) != 1 or not isinstance(statements[0], ExpressionStatement):
        raise UsageError("this is no expression", hint="distance from ego to other, say, or ego can see other")
    return statements[0].value


def value_in_final_state(expression: Expression, state: State) -> object:
    """The value of an expression in the state in which a run has ended. Raises the error of the expression."""
    state.settings.door.budget.renew()
    return evaluate_config(Config(expression, (), state._replace(deciding=True)))


@guard_run
def evaluate_config(config: Config) -> object:
    """The value that the control is reduced to. Raises its error."""
    span = getattr(config.control, "span")  # noqa: B009 (of an expression)
    try:
        end, _ = drive_machine(step, taken_over(config), refuse_draw, FUEL, until=is_value)
    except HostException as problem:
        raise RunError(f"{type(problem.exception).__name__}: {problem.exception}", problem.span or span) from None
    if isinstance(end, Fault):
        raise end.error
    if isinstance(end, Unfinished):
        raise endless(end.config, FUEL)
    if not isinstance(end, Arrived) or not isinstance(end.config.control, Value):
        raise RunError("this has no value in a scene", span)
    return end.config.control.value


def is_value(config: Config) -> bool:
    """Whether the whole was reduced to a value."""
    return isinstance(config.control, Value) and not config.stack


def refuse_draw(draw: Draw) -> object:
    """Answers no draw. Raises `RunError`."""
    raise RunError("what is asked of a scene cannot draw", draw.node.span, hint="the scene is there already: name what it holds")


def read_with(expression: Expression) -> Callable[[State], Scene]:
    """A function to the scene of a run that has ended, which has the value of the expression among its parameters."""

    def read(state: State) -> Scene:
        scene = scene_of(state, 0, 0, 1)
        return replace(scene, params={NAME: value_in_final_state(expression, state)})

    return read


def law_of(scenario: Scenario, expression: Expression, *, max_runs: int = DEFAULT_RUNS) -> Enumeration:
    """The exact distribution of the scenes, each with the value of the expression. Raises what `Scenario.enumerate` does, and its error."""
    scenario.rehearse()
    return enumerate_runs(scenario.start, max_runs=max_runs, fuel=scenario.fuel, read=read_with(expression))
