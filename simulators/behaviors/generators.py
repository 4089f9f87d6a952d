"""The course of behaviors: what translated statements call where time passes; the rules are those of `semantics.dynamics`, as generators.

A generator is resumed from the outermost statement inwards, so that conditions of outer interrupts are looked at first, and invariants where the
innermost behavior goes on, as in `interrupts.check_interrupts`.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from operator import is_
from typing import Any

from ...semantics.dynamics.actions import actions_of
from ...semantics.dynamics.frames import BODY
from ...semantics.dynamics.guards import scope_of
from ...semantics.dynamics.invocations import with_arguments
from ...semantics.dynamics.scenarios import deadline_of
from ...semantics.machine.config import PASS, Abrupt, Config
from ...semantics.machine.outcome import Draw, Next, Requirement
from ...semantics.machine.simulation_state import flag_end, has_passed, simulation_of, span_line_text
from ...semantics.machine.values import Dynamic, Instance, unwrap, value_in_run
from ...semantics.python.string_methods import stable_repr
from ...semantics.space.distributions import Discrete
from ...semantics.space.vectors import Unchanging, Vector
from ...semantics.store.scopes import Scope
from ...semantics.syntax import dynamics as d
from ...semantics.syntax import statements as s
from ...semantics.syntax.nodes import Node
from .compiled_library import Code, CompiledGuard
from .fallback import LeftToMachine
from .operations import ACTION_TYPES, MOST_DEPTH, Calls, Raised, RunRejected
from .translate_statements import ExceptClause

Actions = tuple[Any, ...]
Course = Generator[Actions, None, Any]
"""What a coroutine still has to do: it yields the actions of each time step."""
Clause = tuple[Callable[[], bool], Node, Callable[[], Course]]
"""The condition of an interrupt, where it stands, and its handler."""


class Aborted(Exception):
    """`abort`: ends the innermost statement with interrupts."""


class Terminated(Exception):
    """`terminate`: ends the coroutine, and the scenario."""


class Invocation:
    """A behavior that runs for an agent, or a monitor (without agent): `path` are it and those around it, the outermost first.

    `lines` are the texts that tell what the agent does at a statement, where these stay the same as long as the `lists` among the arguments do.
    """

    __slots__ = ("agent", "depth", "fixed", "invariants", "lines", "lists", "path", "scope")

    def __init__(
        self, agent: Instance | None, path: tuple[Dynamic, ...], depth: int, scope: Scope | None = None, invariants: Sequence[CompiledGuard] = ()
    ) -> None:
        self.agent = agent
        self.path = path
        self.depth = depth
        self.scope = scope
        self.invariants = invariants
        self.lines: dict[int, str] = {}
        given = [value for one in path for value in given_to(one)]
        self.lists: list[tuple[list[Any], list[Any]]] = [(value, list(value)) for value in given if type(value) is list]
        self.fixed = all(is_fixed(value) or (type(value) is list and all(map(is_fixed, value))) for value in given)

    def doing(self, node: Node | None) -> str:
        """Which behaviors the agent is in, and on which line the innermost waits."""
        if self.lists and self.fixed and not all(len(now) == len(then) and all(map(is_, now, then)) for now, then in self.lists):
            self.fixed = False
            self.lines.clear()
        text = self.lines.get(id(node))
        if text is None:
            assert self.agent is not None
            place = "" if node is None else span_line_text(node.span, self.agent.span.file)
            text = ", ".join([" > ".join(map(stable_repr, self.path)), *([place] if place else [])])
            if self.fixed:
                self.lines[id(node)] = text
        return text


FIXED = frozenset({float, int, bool, str, type(None), Vector, Instance})


def is_fixed(value: object) -> bool:
    """Whether an argument is always told in the same words."""
    value = value_in_run(value)
    return type(value) in FIXED or isinstance(value, Unchanging)


def given_to(behavior: Dynamic) -> Iterator[Any]:
    """The arguments of a behavior that runs."""
    assert behavior.arguments is not None
    positional, named = behavior.arguments
    yield from positional
    yield from named.values()


class Courses(Calls):
    """The coroutines of a simulation. `leaf` and `node` are the invocation and the statement in which the one that ran last waits."""

    leaf: Invocation
    node: Node | None

    def begin(self, agent: Instance, behavior: Dynamic) -> Course:
        """The course of an agent's behavior; its guards are checked in its first time step."""
        return self.run_behavior(Invocation(agent, (), 0), behavior, limited=False)

    # Small statements

    def taken(self, node: d.Take, actions: Actions) -> Actions:
        """The actions of `take`, those in lists and tuples one by one. Raises `RunError` for what is none."""
        if len(actions) == 1 and type(actions[0]) is tuple and self.who.kind == "behavior" and ACTION_TYPES.issuperset(map(type, actions[0])):
            return actions[0]
        return actions_of(node, actions) if self.who.kind == "behavior" else ()

    def tell(self, rule: str, node: Node) -> None:
        """A rule fires that is an event of the time step."""
        self.witness(Next(rule, Config(PASS, (), self.state), node), None)

    def terminate(self, node: d.Terminate) -> None:
        """`terminate`."""
        if node.simulation:
            self.state = flag_end("`terminate simulation` was executed", self.state)
        self.tell("D-Terminate", node)
        raise Terminated

    def abort(self, node: Node) -> None:
        """`abort`."""
        self.tell("D-Abort", node)
        raise Aborted

    def deadline(self, node: Node, amount: Any) -> Callable[[], bool]:
        """Whether the limit of `for T` has passed, of a statement that begins in this time step."""
        deadline = deadline_of(node.limit, amount, node, "D-Do", self.state)  # type: ignore[attr-defined]
        first_step = simulation_of(self.state).step
        return lambda: has_passed(deadline, first_step, simulation_of(self.state))

    # Guards

    def check(self, guards: Sequence[CompiledGuard], scope: Scope) -> None:
        """Preconditions or invariants. Raises `Raised` for one that does not hold."""
        for guard in guards:
            if not guard.holds(self, scope):
                raise Raised(Abrupt("raise", guard.violation(guard.text), guard.node.span))

    def check_invariants(self, of: Invocation) -> None:
        """The invariants of a behavior that goes on."""
        assert of.scope is not None
        self.check(of.invariants, of.scope)

    # do

    def invocations(self, node: Node, values: Sequence[Any]) -> list[Dynamic]:
        """Return the invocations of a `do`, which are behaviors. Raises `LeftToMachine` for anything else."""
        found = [with_arguments(value, node, self.state) for value in values]
        if self.who.kind != "behavior" or not all(isinstance(one.definition, d.BehaviorDefinition) for one in found):
            raise LeftToMachine("`do` with something that is no behavior")
        return found

    def invoke(self, caller: Invocation, behaviors: Sequence[Dynamic], limited: bool) -> Course:
        """`do B1, ..., Bn`; where the statement has a limit, its end is not yet the return of the statement.

        A limit is looked at before the guards are; else these are checked at once, and nothing stands between the caller and the body.
        """
        if len(behaviors) == 1:
            if not (limited or caller.invariants):
                return self.entered(caller, behaviors[0])
            return self.run_behavior(caller, behaviors[0], limited=limited)
        return self.together(caller, behaviors, limited)

    def run_behavior(self, caller: Invocation, behavior: Dynamic, *, limited: bool, enabled: bool = False) -> Course:
        """`invocations.run_behavior`: the guards, the body; when it has ended, the invariants of the caller."""
        yield from self.entered(caller, behavior, enabled=enabled)
        if caller.invariants and not limited:
            self.check_invariants(caller)

    def entered(self, caller: Invocation, behavior: Dynamic, *, enabled: bool = False) -> Course:
        """The body of a behavior, whose guards hold."""
        self.turn()
        if caller.depth >= MOST_DEPTH:
            raise LeftToMachine("behaviors deep inside each other")
        code: Code = self.library.code_of(behavior)
        scope = scope_of(behavior, self.state, self=caller.agent)
        if code.preconditions and not enabled:
            self.check(code.preconditions, scope)
        if code.invariants:
            self.check(code.invariants, scope)
        return code.run(self, scope, Invocation(caller.agent, (*caller.path, behavior), caller.depth + 1, scope, code.invariants))

    def together(self, caller: Invocation, behaviors: Sequence[Dynamic], limited: bool) -> Course:
        """`invocations.run_together`: several behaviors at the same time, each with draws of its own; all have to end."""
        alone = Invocation(caller.agent, (), caller.depth)
        running: list[tuple[int, Course]] = [(k, self.run_behavior(alone, b, limited=False)) for k, b in enumerate(behaviors)]
        here = Invocation(caller.agent, caller.path, caller.depth)
        while True:
            base = (*self.prefix, self.draws)
            outer = self.prefix, self.draws + 1, self.handling
            actions: list[Any] = []
            left: list[tuple[int, Course]] = []
            terminates = False
            for place, course in running:
                self.prefix, self.draws, self.handling = (*base, place), 0, ()
                try:
                    actions.extend(next(course))
                    left.append((place, course))
                except (StopIteration, Aborted):
                    pass
                except Terminated:
                    terminates = True
                except Raised:
                    self.prefix, self.draws, self.handling = outer
                    if terminates:
                        self.state = flag_end(f"the behavior of {caller.agent!r} executed `terminate`", self.state)
                    raise
            self.prefix, self.draws, self.handling = outer
            if terminates:
                raise Terminated
            if not left:
                break
            running = left
            self.leaf, self.node = here, None
            yield tuple(actions)
        if caller.invariants and not limited:
            self.check_invariants(caller)

    # do choose, do shuffle

    def options(self, node: Node, values: Sequence[Any], weights: Sequence[Any]) -> list[tuple[Dynamic, Any]]:
        """Return the invocations to choose from, with their weights."""
        return list(zip(self.invocations(node, values), weights, strict=True))

    def pick(self, caller: Invocation, node: d.DoChoose | d.DoShuffle, options: list[tuple[Dynamic, Any]], limited: bool) -> Course:
        """`choices.choose`: among those whose preconditions hold; `do shuffle` goes on with the others."""
        while True:
            enabled = [k for k, (behavior, _) in enumerate(options) if self.is_enabled(caller, behavior)]
            if not enabled:
                word = "choose" if isinstance(node, d.DoChoose) else "shuffle"
                text = f"one of those to {word} from on line {node.span.line} is enabled"
                raise RunRejected("D-Choose", Requirement("precondition", node.span, text))
            chosen = self.drawn("D-Choose", Discrete(tuple((k, options[k][1]) for k in enabled)), node)
            behavior, _ = options[chosen]
            options = [one for k, one in enumerate(options) if k != chosen] if isinstance(node, d.DoShuffle) else []
            yield from self.run_behavior(caller, behavior, limited=limited or bool(options), enabled=True)
            if not options:
                return

    def is_enabled(self, caller: Invocation, behavior: Dynamic) -> bool:
        """Whether the preconditions of a behavior hold."""
        return all(guard.holds(self, scope_of(behavior, self.state, self=caller.agent)) for guard in self.library.code_of(behavior).preconditions)

    def drawn(self, rule: str, distribution: Discrete, node: Node) -> Any:
        """The value of a draw of the coroutine that runs."""
        address = (*self.prefix, self.draws)
        given = self.state.settings.given.draws
        known = given[address].of(distribution) if address in given else distribution
        self.draws += 1
        return value_in_run(self.choose(Draw(rule, address, known, node, no_configuration)))

    # Exceptions

    def attempt(self, scope: Scope, body: Course, handlers: Sequence[ExceptClause], otherwise: Callable[[], Course] | None) -> Course:
        """`try` with `except` and `else` (`control.unwind_handling`): how it was left, None at its end."""
        try:
            left = yield from body
        except Raised as problem:
            exception = problem.abrupt.value
            handler = next((h for h in handlers if h.type is None or self.catches(h.type(), exception)), None)
            if handler is None:
                raise
        else:
            return left if left is not None or otherwise is None else (yield from otherwise())
        assert isinstance(exception, BaseException)
        if handler.name is not None:
            scope.home(handler.name).bindings[handler.name] = exception
        left = yield from self.handled(handler.body(), exception)
        if handler.name is not None:
            scope.home(handler.name).bindings.pop(handler.name, None)
        if isinstance(left, Exception):
            raise left
        return left

    def handled(self, course: Iterator[Actions], exception: BaseException) -> Course:
        """The block of a handler, while the exception is handled: how it was left, if need be with an exception of its own."""
        while True:
            outer = self.handling
            self.handling = (*outer, exception)
            try:
                actions = next(course)
            except StopIteration as end:
                return end.value
            except (Raised, Aborted, Terminated) as left:
                return left
            finally:
                self.handling = outer
            yield actions

    def catches(self, classes: Any, exception: object) -> bool:
        """Whether an `except` of these classes catches an exception."""
        candidates = unwrap(classes)[0]
        every: Any = candidates if isinstance(candidates, tuple) else (candidates,)
        if not all(isinstance(c, type) and issubclass(c, BaseException) for c in every):
            raise LeftToMachine("`except` with something that is no exception class")
        return isinstance(exception, every)

    def at_last(self, course: Course, final: Callable[[], Course]) -> Course:
        """`finally`: however what stands before it was left, the block runs, and then that goes on."""
        problem: Exception | None = None
        left = None
        try:
            left = yield from course
        except (Raised, Aborted, Terminated) as found:
            problem = found
        after = yield from final()
        if after is not None:
            return after
        if problem is not None:
            raise problem
        return left

    # Interrupts

    def abortable(self, course: Course) -> Course:
        """An entire statement with interrupts, which `abort` ends."""
        try:
            return (yield from course)
        except Aborted:
            return None

    def interruptible(self, here: Invocation, node: Node, clauses: Sequence[Clause], body: Course) -> Course:
        """`interrupts.interruptible` and what follows it: how the statement was left, None at its end.

        Each of `waiting` is what was interrupted: its clause, since when that ran, its course, whether this has begun, and the behavior in which it
        waits. A clause's own condition is not looked at while it runs, those after it are.
        """
        current, since, course, begun, leaf = BODY, -1, body, False, here
        waiting: list[tuple[int, int, Course, bool, Invocation]] = []
        last = after = len(clauses) - 1
        if isinstance(node, LATER) and self.state.reading("interrupt-first-step") == "later-steps":
            after = BODY
        while True:
            while after > current:
                condition, place, handler = clauses[after]
                if condition():
                    if begun and leaf is here and here.invariants:
                        self.check_invariants(here)
                    self.turn()
                    self.tell("D-Interrupt", place)
                    waiting.append((current, since, course, begun, leaf))
                    current, since, course, begun, leaf = after, simulation_of(self.state).step, handler(), False, here
                    break
                after -= 1
            try:
                actions = next(course)
            except StopIteration as end:
                if end.value is not None or not waiting:
                    return end.value
                after = current if since < simulation_of(self.state).step else current - 1
                current, since, course, begun, leaf = waiting.pop()
                continue
            begun, leaf = True, self.leaf
            yield actions
            after = last


LATER = (s.Try, d.WaitFor)
"""Statements whose conditions may be looked at from the second time step on (reading `interrupt-first-step`)."""


def no_configuration(drawn: object) -> Config:
    """Nothing resumes a draw of compiled code."""
    raise AssertionError
