"""Behaviors and scenarios that invoke others, choices among them, objects and overrides: the rest of the dynamic statements."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import MutableMapping
from typing import Any

from .coroutines import Coroutines
from .programs import Carry, Creation, Declaration, Invitation, ModularScenario, Overriding, Procedure, Statement, Watchman
from .running import Discarded, GuardBroken, Left, RunningScenario, Steps, Whose, WorldObject, close


class Oracle(Coroutines):
    """Statements about behaviors, scenarios and objects."""

    def of_scenarios(self, statement: Statement, whose: Whose) -> Steps:
        """`do`, `override`, an object, or what a scenario declares."""
        match statement:
            case Carry():
                yield from self.carry(statement, whose)
            case Overriding() | Creation():
                self.change(statement, whose)
            case Declaration(kind, condition):
                self.course(whose).conditions[kind].append((condition, whose))
            case Watchman(_, body):
                course = self.course(whose)
                course.monitors.append(self.block(body, Whose("monitor", ChainMap({}, whose.names), course)))
            case _:
                raise AssertionError(statement)

    def course(self, whose: Whose) -> RunningScenario:
        """The scenario whose code this is."""
        assert whose.scenario is not None
        return whose.scenario

    # Invoking

    def carry(self, statement: Carry, whose: Whose) -> Steps:
        """Section "Statements", "Invoking Other Behaviors and Scenarios": "It does not return until the sub-behavior/sub-scenario terminates";
        "When the do statement returns, the invariants of the calling behavior/scenario are checked". Scenarios are set up before the limit is
        looked at (reading `do-until-zero`).
        """
        what = [(one, self.value(one.argument, whose)) for one in statement.what]
        if statement.way:
            self.happened[f"do {statement.way} in {whose.kind}"] += 1
            yield from self.limited(self.chosen(what, statement.way == "shuffle", whose), statement.limit, whose)
        elif whose.kind == "compose":
            courses = self.set_up(what)
            try:
                yield from self.limited(self.scenarios_together(courses), statement.limit, whose)
            finally:
                self.end_all(courses)
        else:
            steps = [self.behave(self.behaviors[one.name], n, whose.names["self"]) for one, n in what]
            yield from self.limited(self.behaviors_together(steps), statement.limit, whose)
        self.check_invariants(whose)

    def chosen(self, options: list[tuple[Invitation, Any]], shuffle: bool, whose: Whose) -> Steps:
        """Section "Compositional Scenarios", "Random Selection of Scenarios": "choose scenarios to run randomly amongst only those whose
        preconditions are satisfied"; "If none of the three scenarios are enabled, Scenic will reject the simulation" (reading `choose-weights`).
        """
        while options:
            enabled = [k for k, (one, n) in enumerate(options) if self.is_enabled(one, n, whose)]
            if not enabled:
                raise Discarded("precondition")
            self.happened["disabled"] += len(enabled) < len(options)
            k = self.draw([(k, options[k][0].weight) for k in enabled])
            one, n = options[k]
            if whose.kind == "compose":
                courses = self.set_up([(one, n)], enabled=True)
                try:
                    yield from self.scenarios_together(courses)
                finally:
                    self.end_all(courses)
            else:
                yield from self.behaviors_together([self.behave(self.behaviors[one.name], n, whose.names["self"], enabled=True)])
            options = [*options[:k], *options[k + 1 :]] if shuffle else []

    def is_enabled(self, one: Invitation, n: Any, whose: Whose) -> bool:
        """Whether its preconditions hold."""
        definition = self.scenarios[one.name] if whose.kind == "compose" else self.behaviors[one.name]
        inner = Whose(whose.kind, {"n": n, "self": whose.names.get("self")})
        return all(self.value(condition, inner) for condition in definition.preconditions)

    def behave(self, definition: Procedure, n: Any, thing: WorldObject, enabled: bool = False) -> Steps:
        """A behavior of an object: its preconditions, its invariants, its body."""
        whose = Whose("behavior", {"n": n, "self": thing}, invariants=definition.invariants)
        if not enabled:
            self.check("PreconditionViolation", definition.preconditions, whose)
        self.check_invariants(whose)
        try:
            yield from self.block(definition.body, whose)
        except Left as left:
            if left.args[0] != "return":
                raise

    def behaviors_together(self, children: list[Steps]) -> Steps:
        """Several behaviors of one agent, in the order in which they are written (reading `parallel-order`). `terminate` sets the flag (step 5 of the
        policy), whatever the others do in the same time step; those that have not run yet in it still do.
        """
        try:
            while children:
                taken, left, terminated = [], [], None
                for child in children:
                    try:
                        actions, _ = next(child)
                    except StopIteration:
                        continue
                    except Left as leaving:
                        terminated = leaving
                        self.terminated_beside_others()
                        continue
                    taken += actions
                    left.append(child)
                if terminated is not None:
                    raise terminated
                if left:
                    yield tuple(taken), None
                children = left
        finally:
            close(children)

    def terminated_beside_others(self) -> None:
        """Set the flag now: an exception of one of the others may be caught."""
        self.terminate()

    def terminate(self) -> None:
        """Set the flag."""
        self.flag = True

    # Scenarios

    def set_up(self, what: list[tuple[Invitation, Any]], enabled: bool = False) -> list[RunningScenario]:
        """Section "Statements", "Modular Scenarios": "The setup block contains code that runs once when the scenario begins to execute". If one
        cannot begin, none does, and there is nothing of them.
        """
        courses: list[RunningScenario] = []
        things = len(self.things)
        try:
            for one, n in what:
                courses.append(self.begun(self.scenarios[one.name], {"n": n}, enabled))
        except GuardBroken:
            self.happened["cannot begin"] += 1
            self.end_all(courses)
            self.courses = [course for course in self.courses if course not in courses]
            del self.things[things:]
            raise
        return courses

    def begun(self, definition: ModularScenario, names: MutableMapping[str, Any], enabled: bool = False, top: bool = False) -> RunningScenario:
        """The preconditions, the setup block, the default requirements (reading `dynamic-objects`); what runs then is the compose block."""
        course = RunningScenario(names, top, invariants=definition.invariants)
        if not enabled:
            self.check("PreconditionViolation", definition.preconditions, Whose("setup", names, course))
        for _ in self.block(definition.setup, Whose("setup", names, course)):
            raise AssertionError("a setup block takes no time")
        if len({thing.place for thing in self.things}) < len(self.things):
            raise Discarded("collision")
        if definition.compose is not None:
            course.compose = self.composing(definition, course)
        self.courses.append(course)
        return course

    def composing(self, definition: ModularScenario, course: RunningScenario) -> Steps:
        """A compose block, "executed in essentially the same way as a monitor" (Section "Compositional Scenarios", "Parallel and Sequential
        Composition"); invariants hold from the first time step after `setup` (reading `initial-guards`).
        """
        whose = Whose("compose", course.names, course, definition.invariants)
        self.check_invariants(whose)
        yield from self.block(definition.compose or (), whose)

    def step_of(self, course: RunningScenario) -> bool:
        """Step 1 of the policy for a scenario: its compose block for one time step, then its `terminate when` (`terminate-when-start`); "scenarios
        without compose blocks do nothing in a time step other than check" conditions. Whether it goes on; a monitor may have ended it.
        """
        if course.over:
            return False
        self.active.append(course)
        course.ran = True
        if course.compose is None:
            self.check_invariants(Whose("compose", course.names, course, course.invariants))
        else:
            try:
                next(course.compose)
            except (StopIteration, Left):  # the block is finished, or was left by `return` or `terminate`
                return False
        return not any(self.value(condition, whose) for condition, whose in course.conditions["terminate when"])

    def scenarios_together(self, courses: list[RunningScenario]) -> Steps:
        """Several scenarios, one after the other in each time step, until all have ended."""
        while courses:
            left = []
            for course in courses:
                if self.step_of(course):
                    left.append(course)
                else:
                    self.end(course)
            courses = left
            if courses:
                yield (), None

    def end_all(self, courses: list[RunningScenario]) -> None:
        """All these scenarios are over."""
        for course in courses:
            self.end(course)

    def end(self, course: RunningScenario) -> None:
        """A scenario is over, with all that it runs. Section "Statements", "Overrides": "Properties overridden by a scenario revert to their original
        values when the scenario terminates. When the behavior property is overridden, the original behavior is suspended, then resumed".
        """
        if course.over:
            return
        course.over = True
        if course.compose is not None:
            close([course.compose])
        for thing in self.things:
            for name, layers in thing.layers.items():
                thing.layers[name] = [layer for layer in layers if layer[0] is not course]
                self.happened[f"{name} reverted"] += len(thing.layers[name]) < len(layers)

    def change(self, statement: Overriding | Creation, whose: Whose) -> None:
        """An object is made, or a property of one is overridden until the scenario ends (readings `override-stack`, `objects-while-running`)."""
        x = self.value(statement.x, whose) if statement.x else None
        called = statement.behavior
        n = None if called is None else self.value(called.argument, whose)
        if isinstance(statement, Creation):
            thing = WorldObject(self.value(statement.place, whose), {"x": [(None, x)], "behavior": [(None, None)]})
            if called is not None:
                thing.layers["behavior"] = [(None, self.behave(self.behaviors[called.name], n, thing))]
            self.things.append(thing)
            self.happened["new object"] += self.time >= 0
            space = self.known if self.time < 0 else whose.names
            space[statement.name] = thing
            return
        thing = self.value(statement.thing, whose)
        if called is None:
            thing.layers["x"].append((self.course(whose), x))
        else:
            thing.layers["behavior"].append((self.course(whose), self.behave(self.behaviors[called.name], n, thing)))
