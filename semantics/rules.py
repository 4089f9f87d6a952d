"""The catalogue of rules: every inference rule, equation and algorithm of the paper, with its own name and its function.

Ids are `<judgement>-<name>`: E expression, O operator, P specifier, R resolution, S statement, T termination, D dynamics. The
catalogue lists what the paper defines and, marked `inherited`, the rules of Python that it takes to be standard.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .dynamics import (
    actions,
    choose_and_shuffle,
    declarations,
    guards,
    initial_scenario,
    interrupts,
    invocations,
    overrides,
    policy,
    scenarios,
    temporal_requirements,
)
from .machine import conditions, draws, world_queries
from .python import (
    assignment,
    builtin_rules,
    calls,
    class_definitions,
    comprehensions,
    control_flow,
    elementwise_builtins,
    expressions,
    functions,
    imports,
    released_members,
)
from .scenes import (
    comparisons,
    default_requirements,
    mutation,
    object_definitions,
    operators,
    released_forms,
    resolution,
    specifiers,
    statements,
)
from .syntax import expressions as e
from .syntax import specifiers as q

EXPRESSIONS = 'Figure "Semantics of expressions"'
STATEMENTS = 'Figure "Semantics of statements"'
SCALAR, BOOLEAN, HEADING = 'Figure "Scalar operators"', 'Figure "Boolean operators"', 'Figure "Heading operators"'
VECTOR, REGION, ORIENTED = 'Figure "Vector operators"', 'Figure "Region operators"', 'Figure "OrientedPoint operators"'
POSITION = 'Figure "Semantics of position specifiers"'
POSITION_HEADING = 'Figure "Semantics of position specifiers that optionally specify heading"'
HEADINGS = 'Figure "Semantics of heading specifiers"'
ALGORITHM = "Algorithm 1 (resolveSpecifiers)"
PYTHON = 'Section "Syntax of Scenic": standard imperative constructs'
INITIAL = 'Section "Compositional Scenarios", "Interrupts, Overriding, and Initial Scenarios"'
SILENT = "silent in the paper; see the readings"
RELEASED = "not in the paper: dialects scenic-2.1 and scenic-3"


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule: its id, the paper's name or left-hand side for it, where it stands, and the function that is its code."""

    id: str
    name: str
    place: str
    function: Callable[..., object]
    inherited: bool = False

    @property
    def code(self) -> str:
        """The module and name of the function."""
        return f"{self.function.__module__.removeprefix('scenic_ref.')}.{self.function.__name__}"

    @property
    def statement(self) -> str:
        """The rule in words or symbols: the first paragraph of the function's docstring."""
        return " ".join((self.function.__doc__ or "").partition("\n\n")[0].split())


def _left_hand_side(function: Callable[..., object]) -> str:
    text = (function.__doc__ or "").strip()
    return text[1 : text.index("⟧")] if text.startswith("⟦") else text.partition("\n")[0]


def _equation(rule: str, function: Callable[..., object], place: str) -> Rule:
    return Rule(rule, _left_hand_side(function), place, function)


_OPERATOR_PLACES: Mapping[type, str] = {
    e.RelativeHeading: SCALAR, e.ApparentHeading: SCALAR, e.Distance: SCALAR, e.DistancePast: SILENT, e.Angle: SCALAR, e.CanSee: BOOLEAN,
    e.Degrees: 'Figure "Operators by result type"', e.FieldAt: HEADING, e.RelativeTo: HEADING, e.VectorOf: 'Section "Data Types", footnote',
    e.OffsetBy: VECTOR, e.OffsetAlong: VECTOR, e.Visible: REGION, e.VisibleFrom: REGION, e.Follow: ORIENTED,
}
_OTHER_PLACES: Mapping[str, str] = {
    "O-CanSee-Vector": SILENT, "O-RelativeTo-VectorOrientedPoint": ORIENTED, "O-RelativeTo-Vectors": SILENT,
    "O-OffsetBy-OrientedPoint": ORIENTED, "O-Distance-Region": SILENT, "P-Facing-Field": f"{EXPRESSIONS} (example); {HEADINGS}",
}
_SPECIFIER_PLACES: Mapping[type, str] = {
    q.InSpecifier: POSITION_HEADING, q.FollowingSpecifier: POSITION_HEADING, q.FacingSpecifier: HEADINGS, q.FacingTowardSpecifier: HEADINGS,
    q.FacingAwayFromSpecifier: HEADINGS, q.ApparentlyFacingSpecifier: HEADINGS,
}


def _operator_rules() -> list[Rule]:
    """In the order of the figures; each rewriting before the equation that it leads to."""
    found: list[Rule] = []
    for kind, (_, equations) in operators.EQUATIONS.items():
        for rewritten in (kind, e.Visible) if kind is e.VisibleFrom else (kind,):
            if rewritten in operators.REWRITINGS:
                rewriting = operators.REWRITINGS[rewritten]
                found.append(_equation(rewriting.rule, rewriting.rewrite, _OPERATOR_PLACES[rewritten]))
        found += [_equation(q.rule, q.function, _OTHER_PLACES.get(q.rule, _OPERATOR_PLACES[kind])) for q in equations]
        if kind is e.CanSee:
            found += [_equation(q.rule, q.function, BOOLEAN) for q in operators.IN_EQUATIONS]
    return found + [_equation(q.rule, q.function, ORIENTED) for q in operators.SIDES.values()]


def _specifier_rules() -> list[Rule]:
    """In the order of the tables; each rewriting before the equations that it leads to."""
    found = [Rule("P-With", "`with' specifier", EXPRESSIONS, specifiers.with_property)]
    for kind, (_, forms) in specifiers.FORMS.items():
        place = _SPECIFIER_PLACES.get(kind, POSITION)
        if kind in specifiers.REWRITINGS:
            rewriting = specifiers.REWRITINGS[kind]
            found.append(_equation(rewriting.rule, rewriting.rewrite, f"{POSITION}; {POSITION_HEADING}" if kind is q.BesideSpecifier else place))
        if kind is q.OffsetBySpecifier:
            forms = tuple(f for alternatives in specifiers.OFFSET_BY.values() for f in alternatives)
        if kind is q.BesideSpecifier:
            forms = tuple(f for side in specifiers.BESIDE.values() for f in side)
        for form in forms:
            of_point = kind is q.BesideSpecifier and bool(form.optional)
            found.append(_equation(form.rule, form.function, _OTHER_PLACES.get(form.rule, POSITION_HEADING if of_point else place)))
    return [*found, Rule("P-Default", "default value specifier", 'Section "Data Types"; Algorithm 1', specifiers.default_value)]


def _released_rules() -> list[Rule]:
    """Operators and specifiers that are not in the paper."""
    rewritings = [
        _equation(r.rule, r.rewrite, RELEASED) for r in (*released_forms.OPERATOR_REWRITINGS.values(), *released_forms.SPECIFIER_REWRITINGS.values())
    ]
    tables = (*(equations for _, equations in released_forms.OPERATORS.values()), *released_forms.WRAPPED.values())
    equations = [_equation(q.rule, q.function, RELEASED) for equations in tables for q in equations]
    specifiers_ = (forms for _, forms in released_forms.SPECIFIERS.values())
    alone = (released_forms.BEYOND, released_forms.ON_VECTOR)
    forms = [f for forms in (*specifiers_, *released_forms.BESIDE.values(), alone, *released_forms.ORIENTED_OFFSETS.values()) for f in forms]
    return [*rewritings, *equations, *(_equation(f.rule, f.function, RELEASED) for f in forms)]


_PAPER = [
    Rule("E-Distributions", "Distributions", EXPRESSIONS, draws.draw),
    Rule("E-Resample", "resample(D)", 'Section "Expressions"', builtin_rules.resample),
    Rule("E-Resample-Constant", "resample(v)", SILENT, builtin_rules.resample),
    Rule("E-Branch", "conditional branching may not depend on random variables", 'Section "Syntax of Scenic"', conditions.random_branch),
    Rule("E-ObjectDefinition", "Object Definitions", EXPRESSIONS, object_definitions.construct),
    Rule("E-Member", "methods and derived properties", RELEASED, released_members.rewritten),
    Rule("O-Intersects", "X intersects Y", RELEASED, released_members.meet),
    Rule("E-Seconds", "E seconds", 'Section "Stateful Behaviors"', expressions.conclude_seconds),
    Rule("E-InInitialScenario", "in initial scenario", INITIAL, world_queries.in_initial_scenario),
    Rule("R-ResolveSpecifiers", "resolveSpecifiers", ALGORITHM, resolution.resolve_specifiers),
    Rule("R-SpecifiedTwice", "property P specified twice", ALGORITHM + ", gather all specified properties", resolution.specified_twice),
    Rule(
        "R-SpecifiedTwiceOptionally", "property P specified twice", ALGORITHM + ", filter optional specifications",
        resolution.specified_twice_optionally,
    ),
    Rule("R-MissingProperty", "missing property D required by S", ALGORITHM + ", build dependency graph", resolution.missing_property),
    Rule("R-Cyclic", "specifiers have cyclic dependencies", ALGORITHM + ", build dependency graph", resolution.cyclic),
    Rule("S-Assignment", "Variable Assignments", STATEMENTS, assignment.assigned_to),
    Rule("S-Param", "Parameter Assignments", STATEMENTS, statements.conclude_param),
    Rule("S-Require", "Hard Requirements", STATEMENTS, statements.conclude_require),
    Rule("S-Require-Capture", "Hard Requirements, checked at the end", "reading require-time = end", statements.capture),
    Rule("S-SoftReq-Check", "Soft Requirements (with probability p)", STATEMENTS, statements.check_soft_requirement),
    Rule("S-SoftReq-Skip", "Soft Requirements (with probability 1-p)", STATEMENTS, statements.skip),
    Rule("S-Mutate", "Mutations", STATEMENTS, statements.conclude_mutate),
    Rule("S-Model", "Selecting a World Model", 'Section "Statements"', imports.model),
    Rule("S-Class", "class definitions", 'Section "Data Types"', class_definitions.resume_class_body),
    Rule("S-Dynamic", "dynamic requirements and termination conditions", 'Section "Statements", "Requirements"', declarations.dynamic_requirement),
    Rule("S-Definition", "behaviors, monitors and scenarios", 'Section "Statements"', declarations.dynamic_definition),
    Rule("T-Mutate", "Termination, Step 1: Apply Mutations", STATEMENTS, mutation.apply_mutations),
    Rule("T-Check", "Termination, Step 2: Check Default Requirements", STATEMENTS, default_requirements.check_default_requirements),
]

_INHERITED = [
    ("E-Constant", "literals", expressions.axiom_rule),
    ("E-Variable", "variables", expressions.axiom_rule),
    ("E-Display", "tuples, lists, sets and dicts", expressions.display_items),
    ("E-FString", "f-strings", expressions.conclude_formatted),
    ("E-Attribute", "object.property", expressions.attribute_is),
    ("E-Subscript", "subscripts and slices", expressions.conclude_subscript),
    ("E-Arithmetic", "arithmetic operators", expressions.arithmetic),
    ("E-Not", "not boolean", expressions.conclude_not),
    ("E-Compare", "comparisons", comparisons.conclude_comparison),
    ("E-Boolean", "boolean and/or boolean", conditions.resume_boolean),
    ("E-Conditional", "conditional expressions", conditions.resume_test),
    ("E-Lambda", "lambda", functions.lambda_rule),
    ("E-Call", "calls of functions of the program", calls.apply),
    ("E-Return", "the end of a call", functions.resume_called),
    ("E-Call-Host", "calls of library functions", functions.return_host_result),
    ("E-Call-Dynamic", "behaviors, monitors and scenarios with arguments", calls.invocation),
    ("E-Comprehension", "comprehensions", comprehensions.advance),
    ("E-Generator", "generators", comprehensions.generator),
    ("E-Next", "the next element of a generator", elementwise_builtins.resume_asking),
    ("E-Print", "print", builtin_rules.print_rule),
    ("E-Raise", "exceptions raised by operations", control_flow.raise_host_exception),
    ("S-If", "if", control_flow.resume_branching),
    ("S-While", "while", control_flow.resume_testing),
    ("S-For", "for", control_flow.turn),
    ("S-Break", "break", control_flow.unwind_looping),
    ("S-Def", "def", control_flow.conclude_function),
    ("S-Return", "return", control_flow.conclude_return),
    ("S-Assert", "assert", control_flow.conclude_assert),
    ("S-Raise", "raise", control_flow.conclude_raise),
    ("S-Except", "except", control_flow.handle),
    ("S-Finally", "finally", control_flow.final_block),
    ("S-Delete", "del", assignment.conclude_delete),
    ("S-Import", "import", imports.enter_import),
]

PROCEDURE = 'Section "Semantics of Scenic", "Dynamic Constructs"'
ACTIONS = 'Section "Statements", "Actions"'
INVOKING = 'Section "Statements", "Invoking Other Behaviors and Scenarios"'
INTERRUPTS = 'Section "Statements", "Interrupts"'
GUARDS = 'Section "Dynamic Scenarios", "Preconditions and Invariants"'
TERMINATION = 'Section "Statements", "Termination Conditions"'
OVER_TIME = 'Section "Dynamic Scenarios", "Requirements and Monitors"'
MODULAR = 'Section "Statements", "Modular Scenarios"'

_DYNAMIC = [
    Rule("D-Policy-1", "run the compose blocks", PROCEDURE + ", step 1", policy.compose_blocks),
    Rule("D-Policy-2", "check all require always conditions", PROCEDURE + ", step 2", policy.requirements_over_time),
    Rule("D-Policy-3", "run all monitors", PROCEDURE + ", step 3", policy.monitors),
    Rule("D-Policy-4", "if the flag is set, terminate", PROCEDURE + ", step 4", policy.check_flag),
    Rule("D-Policy-5", "run all the behaviors", PROCEDURE + ", step 5", policy.behaviors),
    Rule("D-Policy-6", "repeat step 4", PROCEDURE + ", step 6", policy.check_flag_again),
    Rule("D-Policy-7", "return the choice of actions", PROCEDURE + ", step 7", policy.actions),
    Rule("D-Always", "require always B", OVER_TIME, temporal_requirements.always),
    Rule("D-Eventually", "require eventually B", OVER_TIME, policy.never_satisfied),
    Rule("D-Take", "take actions", ACTIONS, actions.conclude_take),
    Rule("D-Wait", "wait", ACTIONS, actions.wait),
    Rule("D-Terminate", "terminate", TERMINATION, actions.terminate),
    Rule("D-TerminateWhen", "terminate when B", TERMINATION, scenarios.resume_ending),
    Rule("D-TerminateAfter", "terminate after S", RELEASED, scenarios.time_is_over),
    Rule("D-WaitFor", "wait for T, wait until B", RELEASED, actions.conclude_wait_for),
    Rule("D-Record", "record E", RELEASED, policy.conclude_record),
    Rule("S-Simulator", "simulator E", RELEASED, declarations.simulator),
    Rule("D-Do", "do B", INVOKING, invocations.enter_behavior),
    Rule("D-Do-Return", "the end of an invocation", INVOKING, guards.do_returns),
    Rule("D-Choose", "do choose, do shuffle", 'Section "Compositional Scenarios", "Random Selection of Scenarios"', choose_and_shuffle.choose),
    Rule("D-Try", "try ... interrupt when B", INTERRUPTS, interrupts.interruptible),
    Rule("D-Interrupt", "an interrupt condition becomes true", INTERRUPTS, interrupts.begin_handler),
    Rule("D-Abort", "abort", INTERRUPTS, interrupts.abort),
    Rule("D-Precondition", "precondition: B", GUARDS, guards.precondition_violated),
    Rule("D-Initial", "like ordinary requirements, violating any precondition causes ... rejected", GUARDS, initial_scenario.precondition),
    Rule("D-Invariant", "invariant: B", GUARDS, guards.invariant_violated),
    Rule("D-Guard", "the simulation is only rejected if the exception propagates out to the top level", GUARDS, guards.at_top_level),
    Rule("D-Setup", "the setup block of a scenario", MODULAR, scenarios.setup),
    Rule("D-Scenario-End", "the end of a compose block", PROCEDURE + ", step 1", scenarios.resume_stepping),
    Rule("D-Override", "override object specifiers", 'Section "Statements", "Overrides"', overrides.conclude_override),
]

CATALOGUE: tuple[Rule, ...] = (
    *_PAPER, *_DYNAMIC, *_specifier_rules(), *_operator_rules(), *_released_rules(),
    *(Rule(i, name, PYTHON, function, inherited=True) for i, name, function in _INHERITED),
)
"""Every rule, those of the paper first."""

RULES: Mapping[str, Rule] = {rule.id: rule for rule in CATALOGUE}
