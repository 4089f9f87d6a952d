"""What translated expressions call: the equations of `semantics` on plain values, and the machine for what has no shorter way.

Numbers, properties and comparisons of numbers need no rule between their operands and their value. All else is concluded by the rule of its
node, driven by the machine from the values of its premises, or reduced by the machine as a whole: draws keep their addresses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...semantics.dynamics.processes import Coroutine
from ...semantics.kernel.conditions import holding, truth
from ...semantics.kernel.config import Abrupt, Config, Stack, State, Value
from ...semantics.kernel.driving import Arrived, Chooser, Machine, Unfinished, Witness, drive_machine, taken_over
from ...semantics.kernel.errors import NeedsElements, OutOfTime
from ...semantics.kernel.kinds import Reader, is_object
from ...semantics.kernel.outcome import Draw, Fault, Next, Outcome, Requirement, Stuck
from ...semantics.kernel.premises import SHARED, Conclusion, Premises, variable
from ...semantics.kernel.scopes import MISSING, Scope
from ...semantics.kernel.simulation import Who
from ...semantics.kernel.values import Instance, plain
from ...semantics.python.expressions import conclude_binary, conclude_unary
from ...semantics.python.functions import InScope
from ...semantics.scenes.comparisons import conclude_comparison
from ...semantics.scenes.operations import apply_operator, apply_side, compute, new_oriented_point
from ...semantics.scenes.operators import IN_EQUATIONS, SIDES, Equation, OrientedPointAt, distance
from ...semantics.scenes.released import equations_of
from ...semantics.space.regions import EmptyRegion, Region, UnboundedRegion
from ...semantics.space.vectors import Vector
from ...semantics.step import step, stopped, told
from ...semantics.syntax import python_expressions as p
from ...semantics.syntax.expressions import Distance, SideOf
from ...semantics.syntax.nodes import Expression, Node
from ...simulators.actions import ACTIONS
from .leaving import LeftToMachine
from .natives import NUMBERS, SMALL, equation

PLAIN = frozenset({float, int, bool, type(None)})
"""Types of values that actions are given and that are compared as they are: the machine takes nothing off the run's budget for them."""
ACTION_TYPES = frozenset(ACTIONS.values())
MOST_DEPTH = 50
"""So many behaviors may be inside each other here; each costs some of Python's stack."""
STEPS = 20
"""A node of the syntax tree that is evaluated here, in turns of loops, functions, behaviors and handlers, counts for so many steps of the fuel.

Whether a time step has an end is for the machine to say: all this takes less than half of its fuel.
"""
OF_BEHAVIOR = 50
"""As many nodes does the beginning of a behavior or handler count for."""
VERY_LONG = "a time step of very many turns"


class RunRejected(Exception):
    """A requirement of the run does not hold."""

    def __init__(self, rule: str, requirement: Requirement) -> None:
        super().__init__(requirement.text)
        self.stuck = Stuck(rule, requirement)


class Raised(Exception):
    """An exception of the program, which it may catch."""

    def __init__(self, abrupt: Abrupt) -> None:
        super().__init__(str(abrupt.value))
        self.abrupt = abrupt


class Equations:
    """The state of a simulation while compiled code runs, and the values of expressions in it.

    `state` has the scope, the numbering of draws and the handled exceptions of whichever coroutine ran last: each that goes on has its own (`here`).

    Compiled code changes variables without a note (`versions`), since no run goes back behind it; whatever the machine changes is noted in `state`.

    `prefix` and `draws` are the address of the next draw of the coroutine that runs, whose `who` it is; `handling` are the exceptions that it
    handles. `now` is the time, as `simulation.currentTime` says it. `spent` are the steps of the machine in this time step: half of its fuel is for
    what compiled code does without it: it has evaluated `nodes`, each of which counts for `price`.
    `calls` of compiled functions are open.
    """

    def __init__(self, state: State, choose: Chooser, fuel: int, witness: Witness) -> None:
        self.state = state
        self.choose = choose
        self.fuel = fuel
        self.witness = witness
        self.who = Who("condition", 0)
        self.prefix: tuple[int, ...] = ()
        self.draws = 0
        self.handling: tuple[BaseException, ...] = ()
        self.nodes, self.price = 0, 1
        self.calls = 0
        self.spent = 0
        self.now: float = 0

    # The machine

    def here(self, scope: Scope) -> State:
        """The state in which the coroutine that runs goes on; as many behaviors are inside each other there as may be here at most."""
        version = self.state.version.versions.settled()
        depth = MOST_DEPTH + self.calls
        return self.state._replace(sigma=scope, prefix=self.prefix, draws=self.draws, handling=self.handling, depth=depth, version=version)

    def driven(self, control: Node | Value, scope: Scope) -> Any:
        """What the machine reduces a node to. Raises `LeftToMachine`, `RunRejected`."""
        base = self.base(scope)
        return self.settled(step, taken_over(Config(control, base, self.here(scope))), base)

    def base(self, scope: Scope) -> Stack:
        """The context of what the coroutine that runs reduces; an exception stops above the frame of the coroutine, which numbers draws as before."""
        return (InScope(scope), (Coroutine(self.who, scope, self.handling, 0, self.prefix, self.draws), ()))

    def settled(self, machine: Machine, config: Config, base: Stack) -> Any:
        """The value with which the machine comes back to the context `base`. Raises `Raised`, `RunRejected`, and `LeftToMachine` for an error."""

        def is_back(config: Config) -> bool:
            kind = type(config.control)
            return (kind is Value and config.stack is base) or (kind is Abrupt and (config.stack is base or config.stack is base[1]))

        end, steps = drive_machine(machine, config, self.choose, self.fuel // 2 - self.spent, witness=self.witness, until=is_back)
        self.spent += steps
        if isinstance(end, Stuck):
            raise RunRejected(end.rule, end.requirement)
        if isinstance(end, Fault) and isinstance(end.error, OutOfTime):
            raise end.error  # the machine would take as long again
        if not isinstance(end, Arrived):
            raise LeftToMachine(VERY_LONG if isinstance(end, Unfinished) else "an error of the program")
        self.state, self.draws = end.config.state, end.config.state.draws
        control = end.config.control
        if isinstance(control, Abrupt):
            if control.kind != "raise":
                raise LeftToMachine("a statement that leaves its block")
            raise Raised(control)
        assert isinstance(control, Value)
        return control.value

    def reduced(self, scope: Scope, node: Node) -> Any:
        """⟨E, σ⟩ → v, by the machine, or a statement that takes no time; a value that was drawn keeps what it was drawn from."""
        return self.driven(node, scope)

    def concluded(self, scope: Scope, conclude: Conclusion, node: Node, values: list[object]) -> Any:
        """The conclusion of a rule from the values of its premises; where it is no value yet, what the machine makes of it."""
        base, state = self.base(scope), self.here(scope)
        *before, last = values
        frame = Premises(node, [None] * len(values), len(before), tuple(before), conclude)
        try:
            outcome = told(conclude(node, values, base, state), state)
        except NeedsElements:  # those of a generator, which the machine computes
            return self.settled(step, taken_over(Config(Value(last), (frame, base), state)), base)
        except Exception as problem:
            outcome = told(stopped(problem, Config(Value(last), (frame, base), state)), state)
        if type(outcome) is Draw:
            outcome = self.answered(outcome)
        if type(outcome) is Next and outcome.config.stack is base and type(outcome.config.control) is Value:
            self.state, self.draws = outcome.config.state, outcome.config.state.draws
            return outcome.config.control.value
        first: list[Outcome] = [outcome]
        return self.settled(lambda config: first.pop() if first else step(config), Config(Value(None), (), state), base)

    def answered(self, draw: Draw) -> Outcome:
        """What follows a draw; one that only the machine's loop knows how to answer, or to refuse, stays as it is."""
        try:
            drawn = self.choose(draw)
        except (EmptyRegion, UnboundedRegion):
            return draw
        return Next(draw.rule, draw.resume(drawn), draw.node)

    # Expressions

    def variable(self, scope: Scope, node: p.Name) -> Any:
        """⟨x⟩ → σ(x), with what it was drawn from."""
        if node.name not in SHARED and (found := scope.lookup(node.name)) is not MISSING:
            return found
        return variable(node, self.here(scope))

    def binary(self, scope: Scope, node: p.BinaryOperation, left: Any, right: Any) -> Any:
        """⟨E1 ⊕ E2⟩ → v1 ⊕ v2."""
        if type(left) in NUMBERS and type(right) in NUMBERS and -SMALL < left < SMALL and -SMALL < right < SMALL:
            if node.operator == "+":
                return left + right
            if node.operator == "-":
                return left - right
            if node.operator == "*":
                return left * right
            if node.operator == "/" and right:
                return left / right
            if node.operator == "**" and type(left) is float and (left > 0 or type(right) is int) and left:
                return self.power(scope, node, left, right)
        elif type(left) is Vector and type(right) is Vector:
            if node.operator == "+":
                return left + right
            if node.operator == "-":
                return left - right
        elif type(left) is Vector and type(right) is float and node.operator == "*":
            return left * right
        elif type(left) is list and type(right) is list and node.operator == "+" and len(left) + len(right) < SHORT:
            return left + right
        return plain(self.concluded(scope, conclude_binary, node, [left, right]))

    def power(self, scope: Scope, node: p.BinaryOperation, base: float, exponent: float) -> Any:
        """x ** y of a float, which is positive or has a whole number above it."""
        try:
            return base**exponent
        except OverflowError:
            return plain(self.concluded(scope, conclude_binary, node, [base, exponent]))

    def unary(self, scope: Scope, node: p.UnaryOperation, operand: Any) -> Any:
        """⟨⊖E⟩ → ⊖v."""
        if node.operator == "-" and type(operand) in NUMBERS:
            return -operand
        if node.operator == "not" and type(operand) is bool:
            return not operand
        return plain(self.concluded(scope, conclude_unary, node, [operand]))

    def comparison(self, scope: Scope, node: p.Comparison, left: Any, right: Any) -> Any:
        """⟨E1 < E2⟩ → v1 < v2."""
        if type(left) is str and type(right) is str and len(left) + len(right) < SHORT:
            if node.operators[0] == "==":
                return left == right
            if node.operators[0] == "!=":
                return left != right
        if isinstance(right, Region) and node.operators[0] in ("in", "not in"):
            found = self.lies_in(left, right) if type(left) is Instance else MISSING
            if found is MISSING:
                found = self.equated(node, IN_EQUATIONS, (left, right))
            if found is not MISSING:
                return found if node.operators[0] == "in" else not found
        return plain(self.concluded(scope, conclude_comparison, node, [(), left, right]))

    def lies_in(self, one: Instance, region: Region) -> Any:
        """Whether an object lies in a region, as `operators.object_is_in` says; MISSING where that is for the machine to say."""
        properties = self.state.objects[one.number]
        position = properties.get("position")
        box = properties.get("heading"), properties.get("width"), properties.get("length")
        if type(position) is not Vector or not NUMBERS.issuperset(map(type, box)) or not is_object(one):
            return MISSING
        try:
            return region.contains_box(position, *box)  # type: ignore[arg-type]
        except OutOfTime:
            raise
        except Exception:
            return MISSING

    def operator(self, scope: Scope, node: Node, *operands: Any) -> Any:
        """An operator of the paper, by the equation for the kinds of its operands."""
        if type(node) is Distance:
            one, other = map(self.position, operands)
            if type(one) is Vector and type(other) is Vector:
                return distance(one, other)
        found = self.equated(node, equations_of(node, self.state.reading("oriented-offset"), self.state.reading("angle")), operands)
        return plain(self.concluded(scope, apply_operator, node, list(operands))) if found is MISSING else found

    def side(self, scope: Scope, node: SideOf, subject: Any) -> Any:
        """`front of O` and its seven siblings."""
        found = self.equated(node, (SIDES[node.side],), (subject,))
        return plain(self.concluded(scope, apply_side, node, [subject])) if found is MISSING else found

    def equated(self, node: Node, equations: Sequence[Equation], operands: Sequence[Any]) -> Any:
        """The right-hand side of the equation for operands of these kinds; MISSING where that is for the machine to say."""
        found = equation(node, equations, operands, self.state)
        if found is None:
            return MISSING
        reader = Reader(self.state)
        try:
            result = compute(found.function, [reader.read(operand, kind) for operand, kind in zip(operands, found.kinds)], reader)
        except OutOfTime:
            raise
        except Exception:
            return MISSING
        if isinstance(result, OrientedPointAt):
            result, self.state = new_oriented_point(result, reader, self.state)
        return result

    def position(self, value: Any) -> Any:
        """The position of an instance; other values as they are."""
        return self.state.objects[value.number].get("position") if type(value) is Instance else value

    def action(self, known: dict[type, Any], kind: type, arguments: tuple[Any, ...]) -> Any:
        """An action of constants in a `take` statement, which is made once: it is nobody's but the simulator's."""
        made = known[kind] = kind(*arguments)
        return made

    # What decides

    def is_true(self, scope: Scope, result: Any, node: Expression) -> bool:
        """The truth of a condition that decides control flow."""
        return truth(plain(result), node, self.here(scope), "this condition")

    def holds(self, scope: Scope, result: Any, node: Expression) -> bool:
        """Whether a condition of a requirement, guard, interrupt or end holds."""
        inner = plain(result)
        if inner is True or inner is False:
            return inner
        return bool(holding(inner, node.span, self.here(scope), "a condition", ""))

    def turn(self, nodes: int = OF_BEHAVIOR) -> None:
        """A loop goes back, or a function, behavior or handler begins. Raises `LeftToMachine` where that may be without end."""
        self.nodes += nodes * self.price
        if self.nodes * STEPS > self.fuel:
            raise LeftToMachine(VERY_LONG)


SHORT = 200
"""Characters of two texts that are compared, and elements of two lists that are put together, without a word to the run's budget."""
