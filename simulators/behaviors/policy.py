"""The seven steps of the policy with compiled coroutines: the same answers as `semantics.dynamics.policy`, step by step.

The state of the simulation stands in `state`, as with the machine; what it keeps of agents and monitors are compiled courses, which the machine
passes on without looking at them. Compose blocks, and coroutines that are not compiled, are run by the machine.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from ...interpreter.runtime.process_sandbox import guard_run
from ...interpreter.runtime.program_run import DEFAULT_FUEL, Chooser, Witness
from ...semantics.dynamics import policy as rules
from ...semantics.dynamics.coroutines import DYNAMIC, Ended, Yielded, address_of
from ...semantics.dynamics.guards import at_top_level, opening_guards
from ...semantics.dynamics.interrupts import run_for_one_step
from ...semantics.dynamics.invocations import describe_behaviors, with_arguments
from ...semantics.dynamics.temporal_requirements import CONDITIONS, over_time
from ...semantics.machine.config import Config, Stack, State, Value
from ...semantics.machine.outcome import Act, Finish, Outcome, Requirement, Stuck
from ...semantics.machine.run_loop import Arrived, Unfinished, drive_machine, taken_over
from ...semantics.machine.simulation_state import (
    TOP,
    Agent,
    Declared,
    Running,
    Suspended,
    Who,
    flag_end,
    has_passed,
    simulation_of,
    with_scenario,
    with_simulation,
)  # fmt: skip
from ...semantics.machine.values import Dynamic, Instance, value_in_run
from ...semantics.step import step as machine_step
from ...semantics.store.errors import FuelExhausted, GuardViolation
from ...semantics.store.scopes import ByIdentity
from ...semantics.syntax import dynamics as d
from ...semantics.syntax.nodes import Node, Span
from ...semantics.syntax.statements import Block
from .compiled_library import Library
from .fallback import LeftToMachine, Untranslated
from .generators import Aborted, Course, Courses, Invocation, Terminated
from .operations import VERY_LONG, Raised, RunRejected

ENDED, TERMINATED = "ended", "terminated"
"""How a coroutine ends in a time step."""


class CompiledCourse:
    """The process of an agent or monitor, in place of a `Suspended`: where it waits is known of the last time step in which it ran.

    `key` is what is left to the machine where something in it is not compiled.
    """

    __slots__ = ("course", "key", "leaf", "node", "who")

    def __init__(self, course: Course, key: ByIdentity, who: Who) -> None:
        self.course = course
        self.key = key
        self.who = who
        self.leaf: Invocation | None = None
        self.node: Node | None = None


class CompiledPolicy(Courses):
    """The policy of one simulation; `home` is its own part of the state, beside those of the coroutines.

    Raises `LeftToMachine` where only the machine knows what is next: the simulation begins anew then.
    """

    def __init__(self, state: State, choose: Chooser, library: Library, witness: Witness, fuel: int = DEFAULT_FUEL) -> None:
        super().__init__(state, choose, fuel, witness)
        self.library = library
        self.home = {name: getattr(state, name) for name in ("sigma", "prefix", "draws", "handling", "depth")}
        top = simulation_of(state).scenarios[TOP]
        self.simple = top.compose is None and not (top.dynamic is not None and top.dynamic.definition.invariants)  # type: ignore[attr-defined]
        self.calm = self.simple and not (top.always or top.eventually or top.terminations or top.monitors or top.records)
        self.before = state.reading("requirements-order") == "before"
        self.in_steps = state.reading("time-unit") == "steps"
        self.stops = state.reading("behaviors-after-terminate") == "stop"

    @guard_run
    def __call__(self, state: State, limit: str) -> Act | Finish | Stuck:
        """Run a time step, as `policy.policy` does, in a state whose objects the simulator has updated.

        What compiled code changes in place is noted in one version until the machine goes on with it.
        """
        outcome = self.time_step(state, limit)
        if isinstance(outcome, Stuck) or not outcome.state.version.undo:
            return outcome
        return outcome._replace(state=outcome.state.in_version(outcome.state.version.versions.settled()))

    def time_step(self, state: State, limit: str) -> Act | Finish | Stuck:
        """Run a time step in the version in which it began."""
        if simulation_of(state).step == 0:
            state = state.in_version(state.version.begun_anew())  # nothing stands in memory that an attempt before has changed
        active = (TOP,) if self.simple else ()
        simulation = simulation_of(state)
        same = not simulation.flag and simulation.limit == limit and simulation.active == active
        self.state = state if same else with_simulation(state, flag="", limit=limit, active=active)
        self.nodes = self.spent = 0
        self.now = simulation.step if self.in_steps else simulation.step * simulation.timestep
        state.settings.door.budget.renew()
        try:
            return self.steps(simulation.step)
        except RunRejected as rejected:
            return rejected.stuck
        except Raised as raised:
            if isinstance(raised.abrupt.value, GuardViolation):
                return at_top_level(raised.abrupt)
            raise LeftToMachine("an exception that the program does not catch") from raised
        except (LeftToMachine, FuelExhausted):
            raise
        except Exception as problem:  # an error of the program, which the machine finds again, and tells
            text = f"{problem.args[0]} is read before it is bound" if type(problem) is KeyError else f"{type(problem).__name__}: {problem}"
            raise LeftToMachine(text) from problem

    def steps(self, step: int) -> Act | Finish | Stuck:
        """The seven steps; the first three have nothing to do where the program declares nothing for them."""
        if not (self.calm and step):
            self.compose_blocks()
            stuck = self.requirements()
            if stuck is not None:
                return stuck
            self.monitors()
        ended = self.ended("D-Policy-4")
        if ended is not None:
            return ended
        actions = self.behaviors(step)
        ended = self.ended("D-Policy-6")
        return ended if ended is not None else Act("D-Policy-7", actions, self.state)

    # Steps 1, 2 and 3

    def compose_blocks(self) -> None:
        """Step 1: where no scenario has a compose block, there is the top level alone, and its conditions."""
        simulation = simulation_of(self.state)
        top = simulation.scenarios[TOP]
        if not self.simple or (simulation.step == 0 and opening_guards(self.state)):
            self.by_machine(Value(None), rules.Step(1), 2)  # which looks anew at which scenarios are active
            return
        if top.over:
            self.state = flag_end("a monitor executed `terminate`", self.state)
            return
        if not top.ran:
            self.state = with_scenario(self.state, top._replace(ran=True))
        if self.before:
            for place, declared in over_time(top):
                self.requirement(TOP, place, declared)
        reason = self.termination(top) if top.terminations else ""
        if reason:
            self.state = flag_end(reason, self.state)

    def own(self) -> State:
        """The state in which the policy goes on, where coroutines have left theirs."""
        return self.state._replace(**self.home, version=self.state.version.versions.settled())

    def by_machine(self, control: Any, number: rules.Step, until: int) -> None:
        """A step of the policy, by the machine; it ends where the one numbered `until` begins."""
        config = taken_over(Config(control, (number, ()), self.own()))
        end, steps = drive_machine(machine_step, config, self.choose, self.fuel // 2 - self.spent, witness=self.witness, until=partial(begins, until))
        self.spent += steps
        if isinstance(end, Stuck):
            raise RunRejected(end.rule, end.requirement)
        if not isinstance(end, Arrived):
            raise LeftToMachine(VERY_LONG if isinstance(end, Unfinished) else "an error of the program")
        self.state = end.config.state

    def termination(self, top: Running) -> str:
        """Why the top level ends in this time step, "" if it does not."""
        for index, declared in enumerate(top.terminations):
            if declared.deadline is not None:
                if has_passed(declared.deadline, top.first_step, simulation_of(self.state)):
                    return f"the time limit on line {declared.node.span.line} is reached"
                continue
            node = declared.node
            assert isinstance(node, d.TerminateWhen)
            if not self.evaluated(Who("condition", TOP, index), node.condition, declared, decides=True):
                continue
            self.tell("D-TerminateWhen", node)
            reason = f"the termination condition on line {node.span.line} is true"
            if not node.simulation:
                return reason
            self.state = flag_end(reason, self.state)
        return ""

    def evaluated(self, who: Who, node: Node, declared: Declared, *, decides: bool) -> Any:
        """The value of a condition, in the scope in which it was declared; its draws are numbered apart."""
        self.who, self.prefix, self.draws, self.handling = who, address_of(who, self.state), 0, ()
        return self.library.condition(node, declared.scope, decides=decides)(self, declared.scope)

    def requirements(self) -> Stuck | None:
        """Step 2: check the requirements over time, and record values."""
        simulation = simulation_of(self.state)
        for number in dict.fromkeys(simulation.active):
            running = simulation.scenarios[number]
            if not self.before and (running.always or running.eventually):
                for place, declared in over_time(running):
                    self.requirement(number, place, declared)
            for place, declared in enumerate(running.records):
                if rules.is_due(declared, running, simulation):
                    self.record(number, place, declared)
        for running in simulation_of(self.state).scenarios.values():
            if running.over and (missed := rules.never_held(running)) is not None:
                return rules.never_satisfied(missed)
        return None

    def requirement(self, number: int, place: int, declared: Declared) -> None:
        """`require always`, `require eventually`. Raises `RunRejected`."""
        node = declared.node
        eventually = isinstance(node, d.RequireEventually)
        who = Who("condition", number, CONDITIONS + 2 * place + eventually)
        holds = self.evaluated(who, node.condition, declared, decides=True)  # type: ignore[attr-defined]
        if not eventually and not holds:
            raise RunRejected("D-Always", Requirement("always", node.span, f"`require always` on line {node.span.line}"))
        if eventually and holds:
            running = simulation_of(self.state).scenarios[number]
            if place not in running.satisfied:
                self.state = with_scenario(self.state, running._replace(satisfied=running.satisfied | {place}))

    def record(self, number: int, place: int, declared: Declared) -> None:
        """`record E`."""
        node = declared.node
        assert isinstance(node, d.Record)
        value = self.evaluated(Who("condition", number, 2 * CONDITIONS + 2 * place), node.value, declared, decides=False)
        self.state = rules.conclude_record(node, value, (), self.state).config.state  # type: ignore[union-attr]

    def monitors(self) -> None:
        """Step 3: run the monitors, and forget scenarios that are over."""
        simulation = simulation_of(self.state)
        for number in dict.fromkeys(simulation.active):
            for place in range(len(simulation.scenarios[number].monitors)):
                self.monitor(number, place)
        there = simulation_of(self.state).scenarios
        for running in there.values():
            if running.over:
                left = {n: r for n, r in there.items() if not r.over or rules.has_unreported_eventually(r)}
                self.state = with_simulation(self.state, scenarios=left)
                return

    def monitor(self, number: int, place: int) -> None:
        """One monitor, for one time step."""
        running = simulation_of(self.state).scenarios[number]
        process: Any = running.monitors[place]
        if process is None:
            return
        who = Who("monitor", number, place)
        rest, how = self.one_step(self.compiled_monitor(process, who), who)
        running = simulation_of(self.state).scenarios[number]
        kept: Any = (*running.monitors[:place], rest, *running.monitors[place + 1 :])
        self.state = with_scenario(self.state, running._replace(monitors=kept))
        if how is TERMINATED:
            self.state = rules.ended_by_monitor(number, self.state)

    def compiled_monitor(self, process: Any, who: Who) -> CompiledCourse | Suspended:
        """A monitor before its first time step, compiled where that can be; its body is what the one statement says that it has to do."""
        if not isinstance(process, Suspended) or process.begun:
            return process
        body: Block = process.control.then  # type: ignore[union-attr]
        key = ByIdentity(body[0])
        if key not in self.library.left:
            try:
                code = self.library.monitor(body, process.sigma)
                return CompiledCourse(code.run(self, process.sigma, Invocation(None, (), 0, process.sigma)), key, who)
            except Untranslated as problem:
                self.library.left[key] = problem.reason
        return process

    # Steps 4, 5, 6

    def ended(self, rule: str) -> Finish | Stuck | None:
        """Steps 4 and 6: the end, if there is a reason for it."""
        simulation = simulation_of(self.state)
        if not (simulation.flag or simulation.limit):
            return None
        outcome = rules.end_or_advance(rules.Step(4), rule, (), self.state)
        assert isinstance(outcome, (Finish, Stuck))
        return outcome

    def behaviors(self, step: int) -> Mapping[int, tuple[Any, ...]]:
        """Step 5: the actions of each agent, in the time step of that number."""
        agents = dict(simulation_of(self.state).agents)
        actions: dict[int, tuple[Any, ...]] = {}
        changed = False
        for instance in self.state.scene:
            number = instance.number
            behavior = value_in_run(self.state.objects[number].get("behavior"))
            if behavior is None:
                continue
            agent = agents.get(number)
            process: Any = None if agent is None else agent.process
            if process is None:
                if agent is not None and agent.ended:
                    continue
                changed, process = True, self.first_step(behavior, instance)
                agent = agents[number] = Agent(instance, process)
            if type(process) is CompiledCourse:
                self.who, self.prefix, self.draws = process.who, (DYNAMIC, step, 0, number, 0), 0
                taken: Any = self.advanced(process)
            else:
                changed = True
                self.state = with_simulation(self.state, agents=agents)
                process, taken = self.one_step(process, Who("behavior", number))
                agents[number] = Agent(instance, process)
            if taken is ENDED or taken is TERMINATED:
                changed = True
                agents[number] = Agent(instance, None, ended=True)
                if taken is TERMINATED:
                    self.state = flag_end(f"the behavior of {instance!r} executed `terminate`", self.state)
            elif taken:
                actions[number] = taken
            if self.stops and simulation_of(self.state).flag:
                break
        if changed:
            self.state = with_simulation(self.state, agents=agents)
        return actions

    def first_step(self, behavior: Any, instance: Instance) -> CompiledCourse | Suspended:
        """The course of an agent's behavior before its first time step, compiled where that can be."""
        if not isinstance(behavior, Dynamic) or not isinstance(behavior.definition, d.BehaviorDefinition):
            raise LeftToMachine("a behavior that is none")
        key = ByIdentity(behavior.definition)
        if key not in self.library.left:
            try:
                self.library.code_of(behavior)
                node = Node(span=instance.span)
                return CompiledCourse(self.begin(instance, with_arguments(behavior, node, self.state)), key, Who("behavior", instance.number))
            except Untranslated as problem:
                self.library.left[key] = problem.reason
        return rules.first_step(behavior, instance.span, self.own())

    def advanced(self, process: CompiledCourse) -> Any:
        """Run a compiled coroutine in this time step; return its actions, ENDED or TERMINATED."""
        self.handling = ()
        try:
            actions = next(process.course)
        except (StopIteration, Aborted):
            return ENDED
        except Terminated:
            return TERMINATED
        except Untranslated as problem:
            self.library.left[process.key] = problem.reason
            raise LeftToMachine(problem.reason, again=True) from None
        process.leaf, process.node = self.leaf, self.node
        return actions

    def one_step(self, process: Any, who: Who) -> tuple[Any, Any]:
        """A coroutine for one time step: what it still has to do, and its actions, ENDED or TERMINATED."""
        if type(process) is CompiledCourse:
            self.who, self.prefix, self.draws = who, address_of(who, self.state), 0
            taken = self.advanced(process)
            return (None if taken is ENDED or taken is TERMINATED else process), taken
        base: Stack = (rules.Step(0), ())
        state = self.own()
        first: list[Outcome] = [run_for_one_step(process, who, base, state)]
        result = self.settled(lambda config: first.pop() if first else machine_step(config), Config(Value(None), (), state), base)
        if isinstance(result, Yielded):
            return result.rest, result.actions
        assert isinstance(result, Ended)
        return None, TERMINATED if result.terminates else ENDED

    # What is told of agents

    def doing(self, state: State) -> dict[int, str]:
        """Which behaviors each agent is in, and where."""
        found: dict[int, str] = {}
        for number, agent in simulation_of(state).agents.items():
            process: Any = agent.process
            if type(process) is CompiledCourse:
                leaf, node = process.leaf, process.node
                found[number] = leaf.doing(node)  # type: ignore[union-attr]
            elif text := describe_behaviors(agent):
                found[number] = text
        if state.version.undo:  # arguments may have changed something when they were written out
            state.version.versions.go_to(state.version)
        return found

    def place(self, instance: Instance, state: State) -> tuple[Span, str]:
        """Raise `LeftToMachine`: the machine finds the same error, and reports it with its place."""
        raise LeftToMachine("an action that its agent cannot take")


def begins(number: int, config: Config) -> bool:
    """Whether a step of the policy begins."""
    stack = config.stack
    return type(config.control) is Value and bool(stack) and type(stack[0]) is rules.Step and stack[0].number == number and not stack[1]
