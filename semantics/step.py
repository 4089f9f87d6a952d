"""step : Config -> Outcome. One step of the machine: the table from what stands in control to the rule that reduces it.

Pure: it never samples, reads or writes anything outside the configuration, and gives the same outcome however often a configuration is stepped.
A `Draw` asks for a value, and whoever runs the machine answers.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from shapely.errors import ShapelyError

from .dynamics import (
    actions,
    choose_and_shuffle,
    coroutines,
    declarations,
    frames,
    guards,
    initial_scenario,
    interrupts,
    invocations,
    overrides,
    policy,
    scenarios,
)
from .machine import conditions, draws, premises, simulation_state, world_queries
from .machine.config import Abrupt, Config, Reduction, Resumption, Stack, State, Unwinding, Value
from .machine.error_places import OF_LIBRARY, caller_in, frames_of, of_program
from .machine.host_calls import DoorStuck, HostException, has_entered_program
from .machine.outcome import Draw, Fault, Next, Outcome, Stuck, date_outcome
from .machine.stuck_runs import unmet_requirement
from .machine.value_nesting import too_deep
from .machine.values import Random
from .python import (
    assignment,
    calls,
    class_definitions,
    comprehensions,
    control_flow,
    elementwise_builtins,
    expression_statements,
    expressions,
    functions,
    generators,
    imports,
    released_members,
)
from .python.string_methods import in_this_run, too_many_digits
from .scenes import comparisons, object_definitions, operator_application, statements, termination
from .space.absence import Absent
from .space.distributions import BadParameters
from .space.fields import BadField, OutsideField
from .space.regions import BadRegion, EmptyRegion, UnboundedRegion
from .store.errors import (
    FuelExhausted,
    GuardViolation,
    NeedsElements,
    NeedsPosition,
    NotBegun,
    RunError,
    ScenicError,
    UncaughtException,
    without_addresses,
)
from .store.memory_errors import is_out_of_memory, short_of_memory
from .store.postponed_values import Waiting
from .store.scenic_classes import DefaultIn, ScenicClass
from .syntax import dynamics as d
from .syntax import expressions as e
from .syntax import python_expressions as p
from .syntax import statements as s
from .syntax.nodes import NOWHERE, Node, Span

REDUCE: Mapping[type, Reduction] = {
    # expressions inherited from Python
    p.Constant: expressions.axiom_rule,
    p.Name: expressions.axiom_rule,
    p.FString: expressions.f_string_rule,
    p.TupleDisplay: expressions.display,
    p.ListDisplay: expressions.display,
    p.SetDisplay: expressions.display,
    p.DictDisplay: expressions.dict_display,
    p.Attribute: expressions.attribute,
    p.Subscript: expressions.subscript,
    p.Call: calls.call,
    p.UnaryOperation: expressions.unary,
    p.BinaryOperation: expressions.binary,
    p.BooleanOperation: conditions.boolean,
    p.Comparison: comparisons.comparison,
    p.Conditional: conditions.conditional,
    p.Lambda: functions.lambda_rule,
    p.Comprehension: comprehensions.comprehension,
    # operators of the appendix
    e.RelativeHeading: operator_application.operator,
    e.ApparentHeading: operator_application.operator,
    e.Distance: operator_application.operator,
    e.DistancePast: operator_application.operator,
    e.Angle: operator_application.operator,
    e.CanSee: operator_application.operator,
    e.Degrees: operator_application.operator,
    e.FieldAt: operator_application.operator,
    e.RelativeTo: operator_application.operator,
    e.VectorOf: operator_application.operator,
    e.OffsetBy: operator_application.operator,
    e.OffsetAlong: operator_application.operator,
    e.Visible: operator_application.operator,
    e.VisibleFrom: operator_application.operator,
    e.Follow: operator_application.operator,
    e.RelativePosition: operator_application.operator,
    e.NotVisible: operator_application.operator,
    e.Intersects: released_members.intersects,
    e.SideOf: operator_application.side_of,
    e.Seconds: expressions.seconds,
    e.IntervalOrPair: expressions.interval_or_pair,
    e.InInitialScenario: world_queries.in_initial_scenario,
    Waiting: operator_application.reduce_waiting,
    DefaultIn: object_definitions.default_in,
    # object definitions
    e.ObjectDefinition: object_definitions.object_definition,
    e.ObjectOrValue: object_definitions.object_definition,
    e.ObjectOrOperator: object_definitions.object_definition,
    # statements inherited from Python
    s.ExpressionStatement: expression_statements.expression_statement,
    s.Assignment: assignment.assignment,
    s.AugmentedAssignment: assignment.augmented_assignment,
    s.If: control_flow.if_statement,
    s.While: control_flow.while_statement,
    s.For: control_flow.for_statement,
    s.FunctionDefinition: control_flow.function_definition,
    s.Return: control_flow.return_statement,
    s.Break: control_flow.leave_block,
    s.Continue: control_flow.leave_block,
    s.Pass: control_flow.pass_statement,
    s.Global: control_flow.pass_statement,
    s.Nonlocal: control_flow.pass_statement,
    s.Delete: assignment.delete,
    s.Assert: control_flow.assert_statement,
    s.Raise: control_flow.raise_statement,
    s.Try: interrupts.try_rule,
    s.Import: imports.import_statement,
    s.ImportFrom: imports.import_from,
    s.ClassDefinition: class_definitions.class_definition,
    # Scenic's static statements
    s.Model: imports.model,
    s.Param: statements.param,
    s.Require: statements.hard_requirement,
    s.SoftRequire: statements.soft_requirement,
    s.Mutate: statements.mutate,
    # dynamic definitions and requirements, kept for the policy
    d.BehaviorDefinition: declarations.dynamic_definition,
    d.MonitorDefinition: declarations.dynamic_definition,
    d.ScenarioDefinition: declarations.dynamic_definition,
    d.RequireAlways: declarations.dynamic_requirement,
    d.RequireEventually: declarations.dynamic_requirement,
    d.RequireMonitor: declarations.require_monitor,
    d.TerminateWhen: declarations.dynamic_requirement,
    d.TerminateAfter: declarations.terminate_after,
    d.Record: declarations.dynamic_requirement,
    s.ChooseSimulator: declarations.simulator,
    # dynamic statements
    d.Take: actions.take,
    d.Wait: actions.wait,
    d.WaitFor: actions.wait_for,
    d.Terminate: actions.terminate,
    d.Do: invocations.do,
    d.DoChoose: choose_and_shuffle.pick,
    d.DoShuffle: choose_and_shuffle.pick,
    d.Abort: interrupts.abort,
    d.Override: overrides.override,
}

RESUME: Mapping[type, Resumption] = {
    premises.Premises: premises.resume_premises,
    conditions.Boolean: conditions.resume_boolean,
    conditions.Test: conditions.resume_test,
    functions.Called: functions.resume_called,
    functions.InScope: functions.resume_in_scope,
    comprehensions.Comprehending: comprehensions.resume_comprehension,
    elementwise_builtins.Selecting: elementwise_builtins.resume_selecting,
    elementwise_builtins.SelectingInCases: elementwise_builtins.resume_selecting_in_cases,
    object_definitions.ClassOf: object_definitions.resume_class,
    object_definitions.Construction: object_definitions.construct,
    operator_application.Settling: operator_application.resume_settling,
    object_definitions.Defaulting: object_definitions.resume_defaulting,
    object_definitions.Placing: object_definitions.resume_placing,
    control_flow.Rest: control_flow.resume_rest,
    expression_statements.Discard: expression_statements.resume_discard,
    control_flow.Branching: control_flow.resume_branching,
    control_flow.Looping: control_flow.resume_looping,
    control_flow.Testing: control_flow.resume_testing,
    control_flow.Iterating: control_flow.resume_iterating,
    control_flow.Turning: control_flow.resume_turning,
    elementwise_builtins.Asking: elementwise_builtins.resume_asking,
    generators.Expanding: generators.resume_expanding,
    elementwise_builtins.Pairing: elementwise_builtins.resume_pairing,
    elementwise_builtins.Quantifying: elementwise_builtins.resume_quantifying,
    elementwise_builtins.Slicing: elementwise_builtins.resume_slicing,
    control_flow.Handling: control_flow.resume_handling,
    control_flow.Choosing: control_flow.resume_choosing,
    control_flow.Handled: control_flow.resume_handled,
    control_flow.Finally: control_flow.resume_finally,
    control_flow.Afterwards: control_flow.resume_afterwards,
    statements.Requiring: statements.resume_requiring,
    statements.Deciding: statements.resume_deciding,
    draws.Apart: draws.resume_apart,
    class_definitions.ClassBody: class_definitions.resume_class_body,
    imports.ModuleBody: imports.resume_module_body,
    termination.Mutating: termination.resume_mutating,
    termination.Late: termination.resume_late,
    termination.Checking: termination.resume_checking,
    guards.Guarding: guards.resume_guarding,
    initial_scenario.Finishing: initial_scenario.resume_finishing,
    initial_scenario.OpeningGuards: initial_scenario.resume_opening_guards,
    frames.Abortable: interrupts.resume_abortable,
    interrupts.Entering: interrupts.resume_entering,
    interrupts.Interrupting: interrupts.resume_interrupting,
    frames.Interruptible: interrupts.resume_interruptible,
    invocations.Beginning: invocations.resume_beginning,
    frames.Invoked: invocations.resume_invoked,
    frames.Together: invocations.resume_together,
    choose_and_shuffle.Enabling: choose_and_shuffle.resume_enabling,
    choose_and_shuffle.Starting: choose_and_shuffle.resume_starting,
    frames.Returning: guards.resume_returning,
    frames.Shuffling: choose_and_shuffle.resume_shuffling,
    coroutines.Coroutine: coroutines.resume_coroutine,
    simulation_state.Setting: scenarios.resume_setting,
    frames.Scenarios: scenarios.resume_scenarios,
    scenarios.Stepping: scenarios.resume_stepping,
    scenarios.Ending: scenarios.resume_ending,
    scenarios.RequirementsFirst: scenarios.resume_requirements_first,
    policy.Step: policy.resume_step,
}

UNWIND: Mapping[type, Unwinding] = {
    functions.Called: functions.unwind_called,
    functions.InScope: functions.unwind_in_scope,
    object_definitions.Construction: object_definitions.unwind_construction,
    control_flow.Looping: control_flow.unwind_looping,
    generators.Giving: generators.unwind_giving,
    control_flow.Handling: control_flow.unwind_handling,
    control_flow.Handled: control_flow.unwind_handled,
    control_flow.Finally: control_flow.unwind_finally,
    statements.Deciding: statements.unwind_deciding,
    draws.Apart: draws.unwind_apart,
    class_definitions.ClassBody: class_definitions.unwind_class_body,
    imports.ModuleBody: imports.unwind_module_body,
    guards.Guarding: guards.unwind_guarding,
    frames.Abortable: interrupts.unwind_abortable,
    interrupts.Interrupting: interrupts.unwind_interrupting,
    frames.Interruptible: interrupts.unwind_interruptible,
    frames.Invoked: invocations.unwind_invoked,
    frames.Together: invocations.unwind_together,
    choose_and_shuffle.Enabling: choose_and_shuffle.unwind_enabling,
    simulation_state.Setting: scenarios.unwind_setting,
    coroutines.Coroutine: coroutines.unwind_coroutine,
    frames.Scenarios: scenarios.unwind_scenarios,
    scenarios.Ending: scenarios.unwind_ending,
    scenarios.RequirementsFirst: scenarios.unwind_requirements_first,
    policy.Step: policy.unwind_step,
}


def step(config: Config) -> Outcome:
    """Return the machine's next outcome for `config`: always the same, whatever was stepped before
    (`versions`).
    """
    control_, stack, state = config
    version = state.version
    if version.undo:
        version.versions.go_to(version)
    kind = type(control_)
    try:
        if kind is Value:
            frame, rest = stack
            result = control_.value  # type: ignore[union-attr]
            if (state.deciding or state.simulation is not None) and state.may_branch:
                result = frame_value(result, frame)
            outcome = RESUME[type(frame)](frame, result, rest, state)
        elif kind is Abrupt:
            outcome = unwind(control_, stack, state)  # type: ignore[arg-type]
        else:
            outcome = REDUCE[kind](control_, stack, state)
    except NeedsElements as needed:
        version.versions.go_to(version)
        outcome = generators.expand(needed, config)
    except NeedsPosition as problem:
        outcome = object_definitions.wait_whole(config) or outcome_of_problem(problem, config)
    except Exception as problem:
        outcome = outcome_of_problem(problem, config)
    return apply_given_draws(outcome, state)


def apply_given_draws(outcome: Outcome, before: State) -> Outcome:
    """Return the outcome of a rule that was applied in the state `before`, which stands in memory: in the
    version of what stands there now, a draw with what is given.
    """
    version = before.version
    if not version.undo and type(outcome) is Next and outcome.config.state.version is version:
        return outcome
    if type(outcome) is Draw and outcome.address in before.settings.given.draws:
        outcome = outcome._replace(distribution=before.settings.given.draws[outcome.address].of(outcome.distribution))
    return date_outcome(outcome, version.versions.settled())


def outcome_of_problem(problem: Exception, config: Config) -> Outcome:
    """Return the machine's outcome where a rule cannot go on. Raises what is no matter of the program."""
    match problem:
        case HostException(exception=ShapelyError() as found) | (ShapelyError() as found) if is_out_of_memory(found):
            return Fault(short_of_memory(place(config)))
        case HostException():
            return control_flow.raise_host_exception(problem, problem.span or place(config, problem.exception), config.stack, config.state)
        case NotBegun():
            return control_flow.raise_host_exception(HostException(problem), place(config), config.stack, config.state)
        case OutsideField():
            return Stuck("O-At", unmet_requirement(problem, place(config)))
        case DoorStuck():
            return problem.outcome._replace(beyond=None)
        case BadField() | BadRegion() | BadParameters() | UnboundedRegion():
            return Fault(RunError(str(problem), place(config), rule="E-Call-Host"))
        case EmptyRegion() | Absent():
            return Stuck("E-Call-Host", unmet_requirement(problem, place(config)))
        case RecursionError():
            return Fault(too_deep(place(config)))
        case OverflowError():
            return Fault(RunError("a number is too large", place(config)))
        case ValueError() if too_many_digits(problem):  # the one thing that fails whatever writes a value, here or in a message
            return Fault(RunError("a whole number has too many digits to be written", place(config)))
        case RunError(rule="E-Variable") if has_handler(config.stack):
            return control_flow.raise_host_exception(HostException(NameError(problem.message)), place(config), config.stack, config.state)
        case ScenicError():
            if problem.span == NOWHERE or problem.span.line == 0:
                problem.span = place(config)
            problem.span, where = of_program(problem.span, caller_in(frames_of(config.stack)))
            problem.hint = "; ".join(filter(None, (problem.hint, where)))
            return Fault(problem)
        case _ if has_entered_program(config.state.settings.door, config.state.version):
            return control_flow.raise_host_exception(HostException(problem), place(config, problem), config.stack, config.state)
        case _:
            raise problem


def has_handler(stack: Stack) -> bool:
    """Whether a `try` with handlers is around: an unknown name is then an exception of the program; else it is its error, with a hint."""
    while stack:
        frame, stack = stack
        if isinstance(frame, control_flow.Handling) and frame.node.handlers:
            return True
    return False


def frame_value(result: object, frame: object) -> object:
    """Return the value for a frame where control flow may depend on what is drawn: a plain value, unless the
    frame only passes it on (`premises.CARRIERS`).
    """
    if type(result) is not Random:
        return result
    match frame:
        case premises.Premises(node=node) if type(node) in premises.CARRIERS:
            return result
        case functions.Called() | functions.InScope() | operator_application.Settling():
            return result
        case object_definitions.ClassOf() if not isinstance(result.value, ScenicClass):
            return result
        case _:
            return result.value


def unwind(abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """Leave frames until one stops what left its block; an exception that none stops is the program's error."""
    if abrupt.span.file.startswith(OF_LIBRARY) and abrupt.caller == NOWHERE:
        abrupt = abrupt._replace(caller=caller_in(frames_of(stack)))
    while stack:
        frame, stack = stack
        rule = UNWIND.get(type(frame))
        if rule is not None:
            return rule(frame, abrupt, stack, state)
    exception = abrupt.value
    if isinstance(exception, GuardViolation):
        return guards.at_top_level(abrupt)
    assert isinstance(exception, BaseException)
    text = f"{type(exception).__name__}: {exception_text(exception)}".rstrip(": ")
    span, where = of_program(abrupt.span, abrupt.caller)
    return Fault(UncaughtException(text, span, exception=exception, hint="; ".join([*notes(exception), *filter(None, [where])])))


MOST_SAID = 1000
"""So many characters of an exception's text are told."""


def exception_text(exception: BaseException) -> str:
    """The text of an exception; "" where a method of the program that should give it does not."""
    try:
        text = without_addresses(str(in_this_run(exception)))
    except FuelExhausted:
        raise
    except Exception:
        return ""
    return text if len(text) <= MOST_SAID else f"{text[:MOST_SAID]}..."


def notes(exception: BaseException) -> Sequence[str]:
    """Return the repairs noted on an exception that nothing caught, or known from its text."""
    noted = getattr(exception, "__notes__", ())
    if not noted and type(exception) is TypeError and TEXT_AND_NUMBER.match(str(exception)):
        return ["write str(x) for a number x as a text, or f'...{x}...'"]
    return noted


TEXT_AND_NUMBER = re.compile(
    r"can only concatenate str \(not \"(?:int|float)\"\) to str|unsupported operand type\(s\) for \+: '(?:int|float)' and 'str'"
)


def place(config: Config, exception: Exception | None = None) -> Span:
    """Return the place of the control in the source: its node, or the innermost frame that has one; the name
    of an attribute that is not there.
    """
    node, stack, _ = config
    while not (isinstance(node, Node) and node.span.line) and stack:
        frame, stack = stack
        node = getattr(frame, "node", None)
    span = getattr(node, "span", NOWHERE)
    if isinstance(node, p.Attribute) and isinstance(exception, AttributeError):
        return span._replace(line=span.end_line, column=span.end_column - len(node.name))
    return span
