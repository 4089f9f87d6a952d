"""step : Config -> Outcome. One step of the machine: the table from what stands in control to the rule that reduces it.

Pure: it never samples, reads or writes anything outside the configuration, and gives the same outcome however often a configuration is stepped.
A `Draw` asks for a value, and whoever runs the machine answers.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from shapely.errors import ShapelyError

from .dynamics import actions, choices, declarations, frames, guards, initial, interrupts, invocations, overrides, policy, processes, scenarios
from .kernel import conditions, draws, premises, queries, simulation
from .kernel.callers import OF_LIBRARY, caller_in, frames_of, of_program
from .kernel.config import Abrupt, Config, Reduction, Resumption, Stack, State, Unwinding, Value
from .kernel.errors import (
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
from .kernel.host import DoorStuck, HostException, entered
from .kernel.memory import is_out_of_memory, short_of_memory
from .kernel.nesting import too_deep
from .kernel.outcome import Draw, Fault, Next, Outcome, Stuck, dated
from .kernel.scenic_classes import DefaultIn, ScenicClass
from .kernel.unmet import unmet
from .kernel.values import Random
from .kernel.waiting import Waiting
from .python import (
    assignment,
    calls,
    comprehensions,
    control,
    definitions,
    elementwise,
    expression_statements,
    expressions,
    functions,
    generators,
    imports,
    intervals,
    members,
)
from .python.texts import in_this_run, too_many_digits
from .scenes import comparisons, object_definitions, operations, statements, termination
from .space.absence import Absent
from .space.distributions import BadParameters
from .space.fields import BadField, OutsideField
from .space.regions import BadRegion, EmptyRegion, UnboundedRegion
from .syntax import dynamics as d
from .syntax import expressions as e
from .syntax import python_expressions as p
from .syntax import statements as s
from .syntax.nodes import NOWHERE, Node, Span

REDUCE: Mapping[type, Reduction] = {
    # expressions inherited from Python
    p.Constant: expressions.axiom_rule,
    p.Name: expressions.axiom_rule,
    p.FString: expressions.formatted,
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
    e.RelativeHeading: operations.operator,
    e.ApparentHeading: operations.operator,
    e.Distance: operations.operator,
    e.DistancePast: operations.operator,
    e.Angle: operations.operator,
    e.CanSee: operations.operator,
    e.Degrees: operations.operator,
    e.FieldAt: operations.operator,
    e.RelativeTo: operations.operator,
    e.VectorOf: operations.operator,
    e.OffsetBy: operations.operator,
    e.OffsetAlong: operations.operator,
    e.Visible: operations.operator,
    e.VisibleFrom: operations.operator,
    e.Follow: operations.operator,
    e.RelativePosition: operations.operator,
    e.NotVisible: operations.operator,
    e.Intersects: members.intersects,
    e.SideOf: operations.side_of,
    e.Seconds: expressions.seconds,
    e.IntervalOrPair: intervals.interval_or_pair,
    e.InInitialScenario: queries.in_initial_scenario,
    Waiting: operations.waited,
    DefaultIn: object_definitions.default_in,
    # object definitions
    e.ObjectDefinition: object_definitions.object_definition,
    e.ObjectOrValue: object_definitions.object_definition,
    e.ObjectOrOperator: object_definitions.object_definition,
    # statements inherited from Python
    s.ExpressionStatement: expression_statements.expression_statement,
    s.Assignment: assignment.assignment,
    s.AugmentedAssignment: assignment.augmented,
    s.If: control.if_statement,
    s.While: control.while_statement,
    s.For: control.for_statement,
    s.FunctionDefinition: control.function_definition,
    s.Return: control.return_statement,
    s.Break: control.leave_block,
    s.Continue: control.leave_block,
    s.Pass: control.pass_statement,
    s.Global: control.pass_statement,
    s.Nonlocal: control.pass_statement,
    s.Delete: assignment.delete,
    s.Assert: control.assert_statement,
    s.Raise: control.raise_statement,
    s.Try: interrupts.try_rule,
    s.Import: imports.import_statement,
    s.ImportFrom: imports.import_from,
    s.ClassDefinition: definitions.class_definition,
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
    d.DoChoose: choices.pick,
    d.DoShuffle: choices.pick,
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
    elementwise.Selecting: elementwise.resume_selecting,
    elementwise.SelectingInCases: elementwise.resume_selecting_in_cases,
    object_definitions.ClassOf: object_definitions.resume_class,
    object_definitions.Construction: object_definitions.construct,
    operations.Settling: operations.resume_settling,
    object_definitions.Defaulting: object_definitions.resume_defaulting,
    object_definitions.Placing: object_definitions.resume_placing,
    control.Rest: control.resume_rest,
    expression_statements.Discard: expression_statements.resume_discard,
    control.Branching: control.resume_branching,
    control.Looping: control.resume_looping,
    control.Testing: control.resume_testing,
    control.Iterating: control.resume_iterating,
    control.Turning: control.resume_turning,
    elementwise.Asking: elementwise.resume_asking,
    generators.Expanding: generators.resume_expanding,
    elementwise.Pairing: elementwise.resume_pairing,
    elementwise.Quantifying: elementwise.resume_quantifying,
    elementwise.Slicing: elementwise.resume_slicing,
    control.Handling: control.resume_handling,
    control.Choosing: control.resume_choosing,
    control.Handled: control.resume_handled,
    control.Finally: control.resume_finally,
    control.Afterwards: control.resume_afterwards,
    statements.Requiring: statements.resume_requiring,
    statements.Deciding: statements.resume_deciding,
    draws.Apart: draws.resume_apart,
    definitions.ClassBody: definitions.resume_class_body,
    imports.ModuleBody: imports.resume_module_body,
    termination.Mutating: termination.resume_mutating,
    termination.Late: termination.resume_late,
    termination.Checking: termination.resume_checking,
    guards.Guarding: guards.resume_guarding,
    initial.Finishing: initial.resume_finishing,
    initial.OpeningGuards: initial.resume_opening_guards,
    frames.Abortable: interrupts.resume_abortable,
    interrupts.Entering: interrupts.resume_entering,
    interrupts.Interrupting: interrupts.resume_interrupting,
    frames.Interruptible: interrupts.resume_interruptible,
    invocations.Beginning: invocations.resume_beginning,
    frames.Invoked: invocations.resume_invoked,
    frames.Together: invocations.resume_together,
    choices.Enabling: choices.resume_enabling,
    choices.Starting: choices.resume_starting,
    frames.Returning: guards.resume_returning,
    frames.Shuffling: choices.resume_shuffling,
    processes.Coroutine: processes.resume_coroutine,
    simulation.Setting: scenarios.resume_setting,
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
    control.Looping: control.unwind_looping,
    generators.Giving: generators.unwind_giving,
    control.Handling: control.unwind_handling,
    control.Handled: control.unwind_handled,
    control.Finally: control.unwind_finally,
    statements.Deciding: statements.unwind_deciding,
    draws.Apart: draws.unwind_apart,
    definitions.ClassBody: definitions.unwind_class_body,
    imports.ModuleBody: imports.unwind_module_body,
    guards.Guarding: guards.unwind_guarding,
    frames.Abortable: interrupts.unwind_abortable,
    interrupts.Interrupting: interrupts.unwind_interrupting,
    frames.Interruptible: interrupts.unwind_interruptible,
    frames.Invoked: invocations.unwind_invoked,
    frames.Together: invocations.unwind_together,
    choices.Enabling: choices.unwind_enabling,
    simulation.Setting: scenarios.unwind_setting,
    processes.Coroutine: processes.unwind_coroutine,
    frames.Scenarios: scenarios.unwind_scenarios,
    scenarios.Ending: scenarios.unwind_ending,
    scenarios.RequirementsFirst: scenarios.unwind_requirements_first,
    policy.Step: policy.unwind_step,
}


def step(config: Config) -> Outcome:
    """What the machine says next about `config`: always the same, whatever was stepped before (`versions`)."""
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
                result = carried(result, frame)
            outcome = RESUME[type(frame)](frame, result, rest, state)
        elif kind is Abrupt:
            outcome = unwind(control_, stack, state)  # type: ignore[arg-type]
        else:
            outcome = REDUCE[kind](control_, stack, state)
    except NeedsElements as needed:
        version.versions.go_to(version)
        outcome = generators.expand(needed, config)
    except NeedsPosition as problem:
        outcome = object_definitions.wait_whole(config) or stopped(problem, config)
    except Exception as problem:
        outcome = stopped(problem, config)
    return told(outcome, state)


def told(outcome: Outcome, before: State) -> Outcome:
    """What a rule says, applied in the state `before` that stands in memory: in the version of what stands there now, a draw with what is given."""
    version = before.version
    if not version.undo and type(outcome) is Next and outcome.config.state.version is version:
        return outcome
    if type(outcome) is Draw and outcome.address in before.settings.given.draws:
        outcome = outcome._replace(distribution=before.settings.given.draws[outcome.address].of(outcome.distribution))
    return dated(outcome, version.versions.settled())


def stopped(problem: Exception, config: Config) -> Outcome:
    """What the machine says where a rule cannot go on. Raises what is no matter of the program."""
    match problem:
        case HostException(exception=ShapelyError() as found) | (ShapelyError() as found) if is_out_of_memory(found):
            return Fault(short_of_memory(place(config)))
        case HostException():
            return control.raised(problem, problem.span or place(config, problem.exception), config.stack, config.state)
        case NotBegun():
            return control.raised(HostException(problem), place(config), config.stack, config.state)
        case OutsideField():
            return Stuck("O-At", unmet(problem, place(config)))
        case DoorStuck():
            return problem.outcome._replace(beyond=None)
        case BadField() | BadRegion() | BadParameters() | UnboundedRegion():
            return Fault(RunError(str(problem), place(config), rule="E-Call-Host"))
        case EmptyRegion() | Absent():
            return Stuck("E-Call-Host", unmet(problem, place(config)))
        case RecursionError():
            return Fault(too_deep(place(config)))
        case OverflowError():
            return Fault(RunError("a number is too large", place(config)))
        case ValueError() if too_many_digits(problem):  # the one thing that fails whatever writes a value, here or in a message
            return Fault(RunError("a whole number has too many digits to be written", place(config)))
        case RunError(rule="E-Variable") if caught(config.stack):
            return control.raised(HostException(NameError(problem.message)), place(config), config.stack, config.state)
        case ScenicError():
            if problem.span == NOWHERE or problem.span.line == 0:
                problem.span = place(config)
            problem.span, where = of_program(problem.span, caller_in(frames_of(config.stack)))
            problem.hint = "; ".join(filter(None, (problem.hint, where)))
            return Fault(problem)
        case _ if entered(config.state.settings.door, config.state.version):
            return control.raised(HostException(problem), place(config, problem), config.stack, config.state)
        case _:
            raise problem


def caught(stack: Stack) -> bool:
    """Whether a `try` with handlers is around: an unknown name is then an exception of the program; else it is its error, with a hint."""
    while stack:
        frame, stack = stack
        if isinstance(frame, control.Handling) and frame.node.handlers:
            return True
    return False


def carried(result: object, frame: object) -> object:
    """What a frame gets where control flow may depend on what is drawn: a plain value, unless it only passes it on (`premises.CARRIERS`)."""
    if type(result) is not Random:
        return result
    match frame:
        case premises.Premises(node=node) if type(node) in premises.CARRIERS:
            return result
        case functions.Called() | functions.InScope() | operations.Settling():
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
    text = f"{type(exception).__name__}: {said(exception)}".rstrip(": ")
    span, where = of_program(abrupt.span, abrupt.caller)
    return Fault(UncaughtException(text, span, exception=exception, hint="; ".join([*notes(exception), *filter(None, [where])])))


MOST_SAID = 1000
"""So many characters of an exception's text are told."""


def said(exception: BaseException) -> str:
    """The text of an exception; "" where a method of the program that should give it does not."""
    try:
        text = without_addresses(str(in_this_run(exception)))
    except FuelExhausted:
        raise
    except Exception:
        return ""
    return text if len(text) <= MOST_SAID else f"{text[:MOST_SAID]}..."


def notes(exception: BaseException) -> Sequence[str]:
    """What was noted on an exception that nothing caught, or is known of its text: a suggested repair."""
    noted = getattr(exception, "__notes__", ())
    if not noted and type(exception) is TypeError and TEXT_AND_NUMBER.match(str(exception)):
        return ["write str(x) for a number x as a text, or f'...{x}...'"]
    return noted


TEXT_AND_NUMBER = re.compile(
    r"can only concatenate str \(not \"(?:int|float)\"\) to str|unsupported operand type\(s\) for \+: '(?:int|float)' and 'str'"
)


def place(config: Config, exception: Exception | None = None) -> Span:
    """Where in the source the control stands: its node, or the innermost frame that has one; the name of an attribute that is not there."""
    node, stack, _ = config
    while not (isinstance(node, Node) and node.span.line) and stack:
        frame, stack = stack
        node = getattr(frame, "node", None)
    span = getattr(node, "span", NOWHERE)
    if isinstance(node, p.Attribute) and isinstance(exception, AttributeError):
        return span._replace(line=span.end_line, column=span.end_column - len(node.name))
    return span
