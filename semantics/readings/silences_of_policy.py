"""Readings where the formal rules are silent about behaviors, monitors, scenarios and simulations."""

from __future__ import annotations

from .reading import Probe, Reading

PROCEDURE = 'Section "Semantics of Scenic", "Dynamic Constructs" (the procedure of the policy)'
DYNAMIC = 'Section "Dynamic Scenarios"'
COMPOSITIONAL = 'Section "Compositional Scenarios"'
SECTION_4_4 = 'Section "Statements"'

SILENCES_OF_POLICY: tuple[Reading, ...] = (
    Reading(
        id="choose-weights",
        kind="silence",
        about="policy",
        question="What are the weights of `do choose` and `do shuffle` when some scenarios are disabled?",
        places=(COMPOSITIONAL + ', "Random Selection of Scenarios"',),
        alternatives={
            "renormalised": "renormalised among the enabled ones, whose preconditions are not checked again; none enabled rejects the simulation, "
            "and is no exception; weights that are all 0 are an error; `do shuffle` draws again among the enabled rest",
        },
        consequence="Concerns scenarios.",
        code=("semantics.dynamics.choices.choose",),
        probe=Probe(
            "scenario A():\n    compose: wait\nscenario B():\n    precondition: False\n"
            "scenario C():\n    compose:\n        wait\n        wait\n"
            "scenario Main():\n    setup: ego = Object at (0, 0)\n    compose:\n        do choose {A: 2, B: 5, C: 1}",
            {"renormalised": "A with probability 2/3, C with probability 1/3"},
        ),
    ),
    Reading(
        id="eventually-window",
        kind="silence",
        about="policy",
        question="Which time steps count for `require always`, `require eventually` and monitors?",
        places=(PROCEDURE, SECTION_4_4 + ', "Requirements"'),
        alternatives={
            "whole": "every step in which the scenario that declares them is running, its first and its last included; one that never runs misses "
            "nothing",
        },
        consequence="Concerns requirements on simulations: the last step is that in which the scenario ends, by step 1 or a monitor.",
        code=("semantics.dynamics.policy.always_conditions",),
        probe=Probe(
            "ego = Object at (0, 0)\nrequire eventually ego.position.x == 0\nterminate when True",
            {"whole": "accepted: the first step, which is also the last, counts"},
        ),
    ),
    Reading(
        id="behaviors-after-terminate",
        kind="silence",
        about="policy",
        question="Do the other agents still act in the step in which one executes `terminate`?",
        places=(PROCEDURE + ", steps 5 and 6: all behaviors run, then the flag is checked",),
        alternatives={"all": "all agents run, then the flag is looked at", "stop": "the agents after the one that terminates do not run"},
        profiles={"scenic-2.1": "stop"},
        consequence="Concerns behaviors: a `require` in a later agent's behavior may still reject the simulation under `all` only.",
        code=("semantics.dynamics.policy.behaviors",),
        probe=Probe(
            "behavior End():\n    terminate\nbehavior Fail():\n    require False\n    wait\n"
            "ego = Object at (0, 0), with behavior End\nother = Object at (5, 0), with behavior Fail",
            {"all": "rejected always", "stop": "accepted, with one time step"},
        ),
    ),
    Reading(
        id="interrupt-recheck",
        kind="silence",
        about="policy",
        question="Are interrupt conditions checked again when a handler completes within a time step?",
        places=(DYNAMIC + ', "Interrupts"', SECTION_4_4 + ', "Interrupts"'),
        alternatives={
            "next-step": "none is checked twice in a time step: the handler's own if it has taken time, those of clauses before it and of inner "
            "statements; if none is true, the interrupted block goes on in the same step",
        },
        consequence="Concerns behaviors: a handler that takes no action cannot loop within one step.",
        code=("semantics.dynamics.interrupts.resume_interruptible",),
        probe=Probe(
            "behavior Drive():\n    try:\n        while True:\n            take 1\n    interrupt when True:\n        pass\n"
            "ego = Object at (0, 0), with behavior Drive",
            {"next-step": "action 1 in every time step"},
        ),
    ),
    Reading(
        id="do-until-zero",
        kind="silence",
        about="policy",
        question="Does `do B for 0 steps` or `do B until True` run anything?",
        places=(SECTION_4_4 + ', "Invoking Other Behaviors and Scenarios"', DYNAMIC + ': `until` is a shorthand for an interrupt that aborts'),
        alternatives={
            "nothing": "no: the condition is checked before the first step; a scenario is set up before, so that the condition may be about it",
        },
        consequence="Concerns behaviors and scenarios.",
        code=("semantics.dynamics.invocations.limited",),
        probe=Probe(
            "behavior Inner():\n    take 1\nbehavior Outer():\n    do Inner() until True\n    take 2\n"
            "ego = Object at (0, 0), with behavior Outer",
            {"nothing": "action 2 in the first time step"},
        ),
    ),
    Reading(
        id="invariant-while-interrupted",
        kind="silence",
        about="policy",
        question="Is an invariant checked while its behavior is suspended by an interrupt?",
        places=(DYNAMIC + ', "Preconditions and Invariants"', SECTION_4_4 + ', "Interrupts": "checked as usual" when the handler completes'),
        alternatives={"on-resume": "no; it is checked when the behavior resumes"},
        consequence="Concerns behaviors: collision avoidance may leave the lane that lane following insists on.",
        code=("semantics.dynamics.interrupts.go_on",),
        probe=Probe(
            "behavior Inner():\n    invariant: self.x != 1\n    while True:\n        wait\nbehavior Outer():\n    try:\n        do Inner()\n"
            "    interrupt when self.x == 0:\n        self.x = 1\n        wait\n        self.x = 2\n"
            "ego = Object at (0, 0), with x 0, with behavior Outer",
            {"on-resume": "no violation"},
        ),
    ),
    Reading(
        id="rejected-simulation",
        kind="silence",
        about="policy",
        question="When a simulation is discarded, is the same scene tried again?",
        places=(
            PROCEDURE + ': "discard the simulation"',
            'Section "Semantics of a Scenic Program": traces that do not terminate are discarded, the others renormalised',
            DYNAMIC + ': "reject that simulation and sample a new one"',
        ),
        alternatives={
            "discard": "no: the run is discarded whole, scene and policy, and the distribution renormalised",
            "retry": "yes, up to a limit: simulations are repeated on one scene, which gives scenes the wrong weights",
        },
        profiles={"scenic-2.1": "retry", "scenic-3": "retry"},
        consequence="Concerns simulations: under `retry` a scene is as frequent as if no dynamic requirement existed.",
        code=("inference.simulation.sample_simulation",),
        probe=Probe(
            "behavior Toss():\n    require Range(0, 1) < self.p\n    wait\n"
            "p = Uniform(0.25, 0.75)\nego = Object at (0, 0), with p p, with behavior Toss",
            {"discard": "P(p = 0.75) = 3/4", "retry": "P(p = 0.75) = 1/2"},
        ),
    ),
    Reading(
        id="dynamic-objects",
        kind="silence",
        about="policy",
        question="Do objects that a sub-scenario creates during a simulation obey the default requirements and mutation?",
        places=(COMPOSITIONAL + ', "Modular Scenarios": "as usual"', 'Figure "Semantics of statements", rules "Termination"'),
        alternatives={"setup-end": "yes, when its `setup` block ends"},
        consequence="Concerns scenarios: a parked car that would stand in another one rejects the simulation.",
        code=("semantics.dynamics.scenarios.resume_setting",),
        probe=Probe(
            "scenario Sub():\n    setup:\n        Object at (0, 0)\nscenario Main():\n    setup:\n        ego = Object at (0, 0)\n    compose:\n"
            "        do Sub()",
            {"setup-end": "rejected always: the two objects intersect"},
        ),
    ),
    Reading(
        id="time-limit",
        kind="silence",
        about="policy",
        question="What is looked at when a simulation ends because its time limit is reached?",
        places=(DYNAMIC + ', "Terminating the Scenario": "unless a time limit is specified"', PROCEDURE + ", steps 4 and 6"),
        alternatives={
            "required": "after N time steps the state is looked at as in the last step of a scenario that terminates: compose blocks, `require "
            "always`, monitors and termination conditions, then `require eventually`; it ends by the limit if by nothing else",
        },
        consequence="Concerns simulations with a time limit: every recorded state meets the requirements.",
        code=("semantics.dynamics.policy.check_flag",),
        probe=Probe(
            "ego = Object at (0, 0)\nrequire eventually simulation.currentTime > 1000",
            {"required": "rejected always, with a limit of 1000 seconds or less"},
        ),
    ),
    Reading(
        id="override-stack",
        kind="silence",
        about="policy",
        question="What do two overrides of one property in one scenario revert to?",
        places=(SECTION_4_4 + ', "Overrides"',),
        alternatives={"reverse": "both are reverted when that scenario ends, in reverse order: to the value before the first"},
        consequence="Concerns scenarios.",
        code=("semantics.dynamics.scenarios.end_scenario",),
        probe=Probe(
            "scenario Sub():\n    setup:\n        override ego with x 1\n        override ego with x 2\nscenario Main():\n    setup:\n"
            "        ego = Object at (0, 0), with x 0\n    compose:\n        do Sub() for 1 steps\n        require ego.x == 0\n        wait",
            {"reverse": "accepted always"},
        ),
    ),
    Reading(
        id="terminate-when-start",
        kind="silence",
        about="policy",
        question="Are termination conditions checked before the first step?",
        places=(PROCEDURE + ", step 1",),
        alternatives={
            "first": "yes: the procedure begins with step 1 on the initial scene; a compose block runs before them, and may end its scenario first",
        },
        consequence="Concerns simulations: a condition that holds at once ends the simulation before any action.",
        code=("semantics.dynamics.scenarios.check_termination",),
        probe=Probe(
            "behavior Go():\n    while True:\n        take 1\nego = Object at (0, 0), with behavior Go\nterminate when True",
            {"first": "a simulation without actions"},
        ),
    ),
    Reading(
        id="bare-behavior",
        kind="silence",
        about="policy",
        question="What is `with behavior B`, or `do choose A, B`, without parentheses?",
        places=(
            DYNAMIC + ": `Car with behavior FollowLaneBehavior`, and `WaitUntilClose` next to `WaitUntilClose(20)`",
            COMPOSITIONAL + ", \"Random Selection of Scenarios\": `do choose RedLightRunner, Jaywalker, ParkedCar`",
        ),
        alternatives={"no-arguments": "B(): an instance of its own for every object, or every `do`, with the default arguments"},
        consequence="Concerns behaviors and scenarios: two agents given the same name do not share its state.",
        code=("semantics.dynamics.invocations.with_arguments",),
        probe=Probe(
            "behavior Go(speed=3):\n    take speed\nego = Object at (0, 0), with behavior Go\nother = Object at (5, 0), with behavior Go(4)",
            {"no-arguments": "actions 3 and 4 in the first time step"},
        ),
    ),
    Reading(
        id="objects-while-running",
        kind="silence",
        about="policy",
        question="Where may objects be made, and `mutate` stand, while a scenario runs?",
        places=(
            COMPOSITIONAL + ', "Modular Scenarios": the `setup` block "can define classes, create objects, declare requirements"',
            'Figure "Semantics of statements", rules "Termination": default requirements are checked, and noise added, when a program ends',
        ),
        alternatives={
            "setup": "in `setup` blocks only, whose end checks the default requirements; elsewhere, and to mutate objects of others, it is an error",
        },
        consequence="Concerns behaviors, monitors and compose blocks: a program that makes objects there is refused where it does.",
        code=("semantics.dynamics.scenarios.check_setup",),
        probe=Probe(
            "scenario Main():\n    setup:\n        ego = Object at (0, 0)\n    compose:\n        wait\n        Object at (5, 0)",
            {"setup": "RunError in the second time step"},
        ),
    ),
    Reading(
        id="ego-of-scenarios",
        kind="silence",
        about="policy",
        question="What does `ego = ...` in a sub-scenario mean?",
        places=(
            COMPOSITIONAL + ', "Interrupts, Overriding, and Initial Scenarios": "use existing ego car" where it is not the initial scenario',
            'Figure "Semantics of statements", rule "Variable Assignments": ego is one variable',
        ),
        alternatives={"shared": "there is one ego, which is the new object from then on, also after the sub-scenario has ended"},
        consequence="Concerns scenarios: a sub-scenario that is also to run alone asks `in initial scenario` before it assigns ego.",
        code=("semantics.assignment.assign_name",),
        probe=Probe(
            "scenario Sub():\n    setup:\n        ego = Object at (5, 0)\nscenario Main():\n    setup:\n        ego = Object at (0, 0)\n"
            "    compose:\n        do Sub() for 1 steps\n        require ego.position.x == 5\n        wait",
            {"shared": "accepted always"},
        ),
    ),
    Reading(
        id="finally-of-coroutines",
        kind="silence",
        about="policy",
        question="When does `finally` run in a behavior or compose block that is left from outside?",
        places=(
            'Figure "Simplified Scenic grammar": `try` has no `finally`, which is inherited from Python; ' + SECTION_4_4 + ', "Interrupts"',
            SECTION_4_4 + ', "Termination Conditions": `terminate` ends the scenario "immediately"',
        ),
        alternatives={
            "own-way-out": "when control leaves its own block, also by `abort` or `terminate` (which take effect when it is done); not where the "
            "block is suspended by an interrupt and never goes on",
        },
        consequence="Concerns behaviors and scenarios: what must be undone in any case belongs into `override`.",
        code=("semantics.control.unwind_finally", "semantics.dynamics.interrupts.unwind_interruptible"),
        probe=Probe(
            "behavior Go():\n    try:\n        try:\n            take 1\n            take 2\n        finally:\n            take 3\n"
            "    interrupt when simulation.currentTime == 1:\n        abort\n    take 4\nego = Object at (0, 0), with behavior Go",
            {"own-way-out": "actions 1 and 4, not 3"},
        ),
    ),
    Reading(
        id="interrupts-in-except",
        kind="silence",
        about="policy",
        question="Are interrupt conditions checked while an `except` block of their statement runs?",
        places=(
            SECTION_4_4 + ', "Interrupts": "while none of them are true, the `try` block executes"; exceptions are caught "as in the Python `try` '
            'statement"',
        ),
        alternatives={"never": "no: the `try` block and its handlers were left by the exception; `abort` ends the statement there as well"},
        consequence="Concerns behaviors and compose blocks.",
        code=("semantics.dynamics.interrupts.try_interrupt",),
        probe=Probe(
            "behavior B():\n    try:\n        raise ValueError('x')\n    interrupt when simulation.currentTime == 1:\n        take 1\n"
            "    except ValueError:\n        take 2\n        take 3\nego = Object at (0, 0), with behavior B",
            {"never": "actions 2 and 3"},
        ),
    ),
    Reading(
        id="parallel-order",
        kind="silence",
        about="policy",
        question="In which order do the scenarios or behaviors of one `do` run in a time step?",
        places=(
            SECTION_4_4 + ', "Invoking Other Behaviors and Scenarios"',
            COMPOSITIONAL + ', "Parallel and Sequential Composition": "at the same time"',
        ),
        alternatives={
            "written": "as they are written: actions come in that order, and an exception in one keeps those after it from running in that step",
        },
        consequence="Concerns behaviors and scenarios that run in parallel.",
        code=("semantics.dynamics.invocations.run_together", "semantics.dynamics.scenarios.run_scenarios"),
        probe=Probe(
            "behavior Say(word):\n    take word\nbehavior B():\n    do Say(2), Say(1)\nego = Object at (0, 0), with behavior B",
            {"written": "actions 2 and 1, in this order"},
        ),
    ),
    Reading(
        id="override-what",
        kind="silence",
        about="policy",
        question="What may `override` change, and with which specifiers?",
        places=(
            SECTION_4_4 + ', "Overrides": "the same structure as an object definition", "to set the `aggression` property"',
            COMPOSITIONAL + ', "Interrupts, Overriding, and Initial Scenarios": "for the duration of the scenario"',
        ),
        alternatives={
            "existing": "properties that the object has and the simulator does not update, by `with` alone; all values are evaluated first; in a "
            "scenario that `do` invoked or a compose block, not in the setup of the initial scenario, which makes the objects",
        },
        consequence="Concerns scenarios: anything else is an error.",
        code=("semantics.dynamics.overrides.conclude_override",),
        probe=Probe(
            "scenario Sub():\n    setup:\n        override ego with nosuch 3\nscenario Main():\n    setup:\n        ego = Object at (0, 0)\n"
            "    compose:\n        wait\n        do Sub()",
            {"existing": "RunError in the second time step: ego has no such property"},
        ),
    ),
    Reading(
        id="suspended-scenario",
        kind="silence",
        about="policy",
        question="What of a scenario that an interrupt has suspended, and of the objects of one that has ended?",
        places=(SECTION_4_4 + ', "Interrupts": "suspending any behaviors/scenarios"', PROCEDURE + ": currently-running scenarios"),
        alternatives={
            "kept": "its overrides stay in force, its conditions and monitors wait, and time limits of `do ... for` run on; objects stay in the "
            "world when their scenario has ended, and their behaviors go on",
        },
        consequence="Concerns scenarios.",
        code=("semantics.dynamics.policy.conditions", "semantics.dynamics.interrupts.has_passed"),
        probe=Probe(
            "behavior Lane():\n    while True:\n        take 1\nbehavior B():\n    try:\n        do Lane() for 2 steps\n"
            "    interrupt when simulation.currentTime == 1:\n        take 2\n        take 3\nego = Object at (0, 0), with behavior B",
            {"kept": "actions 1, 2 and 3: the two steps have passed when the handler is done"},
        ),
    ),
    Reading(
        id="do-in-monitor",
        kind="conflict",
        about="policy",
        question="May a monitor `do` behaviors, or a behavior declare conditions over time?",
        places=(
            'Table "Statements", second group: legal inside behaviors, monitors, and compose blocks',
            SECTION_4_4 + ', "Invoking Other Behaviors and Scenarios": behaviors "if in a behavior", scenarios "if in a compose block"',
        ),
        alternatives={
            "refused": "no: a monitor has no agent whose behavior it could be; `require always`, `require eventually` and `terminate when` stand in "
            "setup and compose blocks",
        },
        consequence="Concerns monitors and behaviors.",
        code=("semantics.dynamics.invocations.invoke", "interpreter.checks.HOMES"),
        probe=Probe(
            "behavior Say():\n    take 1\nego = Object at (0, 0)\nmonitor Watch:\n    wait\n    do Say()",
            {"refused": "RunError in the second time step"},
        ),
    ),
)
