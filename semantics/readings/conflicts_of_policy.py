"""Readings where the paper contradicts itself about behaviors, monitors, scenarios and their blocks, and about pruning."""

from __future__ import annotations

from .reading import Probe, Reading

STATEMENTS = 'Table "Statements"'
DYNAMIC = 'Section "Dynamic Scenarios"'
COMPOSITIONAL = 'Section "Compositional Scenarios"'
SECTION_4_4 = 'Section "Statements"'

CONFLICTS_OF_POLICY: tuple[Reading, ...] = (
    Reading(
        id="compose-only",
        kind="conflict",
        about="policy",
        question="May a scenario that is begun with leave it to those that it runs to make ego?",
        places=(
            SECTION_4_4 + ': of the `setup` and `compose` blocks "either of which can be omitted"',
            'Section "Basic Scenarios": "it is a syntax error to leave ego undefined"; the rules "Termination" of Figure "Semantics of statements"',
        ),
        alternatives={
            "when-needed": "yes, if it has a `compose` block: ego may be made by any scenario that runs when it is first needed; that objects are "
            "visible from it is required when the `setup` block that makes it ends; a simulation that ends of itself before is an error",
            "scene": "no: a scene without ego is an error",
        },
        profiles={"formal": "scene"},
        consequence="Concerns simulations: a scene alone has an ego in any case.",
        code=("semantics.termination.may_come_later", "semantics.termination.premises_of_step_two"),
        probe=Probe(
            "scenario Sub():\n    setup: ego = Object at (3, 0)\n    compose: wait\nscenario Main():\n    compose:\n        sub = Sub()\n"
            "        do sub until sub.ego.position.x == 4",
            {"when-needed": "one time step passes, with one object", "scene": "RunError, rule T-Mutate"},
        ),
    ),
    Reading(
        id="setup-block",
        kind="conflict",
        about="policy",
        question="Is the block that runs once when a scenario begins called `setup` or `start`?",
        places=('Figure "Simplified Scenic grammar" and ' + SECTION_4_4 + ', "Modular Scenarios": `setup`', SECTION_4_4 + ", footnote there: "
            "`start` block"),
        alternatives={"setup": "`setup` only"},
        consequence="Concerns the syntax of scenarios: `start:` is a syntax error.",
        code=("interpreter.parser.parse",),
        probe=Probe(
            "ego = Object at (0, 0)\nscenario Sub():\n    setup:\n        Object at (5, 0)",
            {"setup": "accepted; with `start:` in its place a ParseError"},
        ),
    ),
    Reading(
        id="setup-time",
        kind="conflict",
        about="policy",
        question="When does the `setup` block of a sub-scenario run?",
        places=(
            COMPOSITIONAL + ', "Modular Scenarios": "when the scenario is instantiated", as in `subScenario = ParkedCar(gap=0.25)`',
            SECTION_4_4 + ', "Modular Scenarios": "once when the scenario begins to execute", as in `do subScenario`',
        ),
        alternatives={"execution": "when it begins to execute; its variables cannot be read before"},
        consequence="Concerns scenarios while they run: making an instance that `do` never runs creates no objects, as `do choose` needs.",
        code=("semantics.dynamics.scenarios.enter_setup",),
        probe=Probe(
            "scenario Sub():\n    setup:\n        car = Object at (5, 0)\nscenario Main():\n    setup:\n        ego = Object at (0, 0)\n"
            "    compose:\n"
            "        sub = Sub()\n        wait\n        do sub for 1 steps",
            {"execution": "one object in the first time step, two in the second"},
        ),
    ),
    Reading(
        id="override-place",
        kind="conflict",
        about="policy",
        question="Where may `override` stand?",
        places=(
            STATEMENTS + ', second group: "only legal inside behaviors, monitors, and compose blocks"',
            SECTION_4_4 + ', "Overrides": "inside a scenario definition"; ' + COMPOSITIONAL + ", \"Interrupts, Overriding, and Initial "
                "Scenarios\": in a "
            "`setup` block",
        ),
        alternatives={"scenario": "in the setup and compose blocks of a scenario, whose end reverts it"},
        consequence="Concerns the syntax of scenarios: in a behavior or monitor it would not be clear when it is reverted.",
        code=("interpreter.checks.HOMES",),
        probe=Probe(
            "ego = Object at (0, 0)\nscenario Sub():\n    setup:\n        override ego with aggression 3",
            {"scenario": "accepted; in a behavior or a monitor a CheckError"},
        ),
    ),
    Reading(
        id="take-in-monitor",
        kind="conflict",
        about="policy",
        question="May a monitor `take` actions?",
        places=(
            SECTION_4_4 + ', "Actions": "inside behaviors"; grammar: monitors have no agent',
            STATEMENTS + ', second group: legal in monitors; ' + DYNAMIC + ', "Requirements and Monitors": "any actions they take are ignored"',
        ),
        alternatives={"ignored": "yes, and the actions are ignored: `take` is `wait` there"},
        consequence="Concerns monitors; the library functions that a monitor shares with behaviors keep working.",
        code=("interpreter.checks.HOMES",),
        probe=Probe("ego = Object at (0, 0)\nmonitor Watch:\n    take 1", {"ignored": "accepted"}),
    ),
    Reading(
        id="monitor-structure",
        kind="conflict",
        about="policy",
        question="Does a monitor have a parameter list and guards?",
        places=(
            SECTION_4_4 + ', "Behaviors and Monitors": "the same structure as a behavior statement", whose name has `(params)`',
            DYNAMIC + ": `monitor CarCEntersLast:`, without",
        ),
        alternatives={"optional": "the parameter list may be left out, guards are not accepted, and a monitor runs from its definition on"},
        consequence="Concerns monitors: nothing in the paper instantiates one, so its parameters could only have default values.",
        code=("semantics.dynamics.declarations.dynamic_definition",),
        probe=Probe("ego = Object at (0, 0)\nmonitor First:\n    wait\nmonitor Second(limit=3):\n    wait", {"optional": "accepted"}),
    ),
    Reading(
        id="interrupt-first-step",
        kind="conflict",
        about="policy",
        question="Are interrupt conditions checked before the body of `try` has begun?",
        places=(
            DYNAMIC + ', "Interrupts": "at the start of every time step during its execution"; ' + SECTION_4_4 + ', "Interrupts": "at each time '
                'step"',
            COMPOSITIONAL + ", \"Interrupts, Overriding, and Initial Scenarios\": the condition `distance to following.leadCar < 10` uses the "
                "variable that "
            "the first statement of the body assigns",
        ),
        alternatives={
            "every-step": "yes, from the first step on; that listing works only under `later-steps`",
            "later-steps": "no, from the second step on",
        },
        consequence="Concerns behaviors and compose blocks: `do B until C` with C true at once runs nothing under the first (reading "
            "`do-until-zero`).",
        code=("semantics.dynamics.interrupts.interruptible",),
        probe=Probe(
            "behavior Twice():\n    try:\n        take 1\n    interrupt when True:\n        abort\nego = Object at (0, 0), with behavior Twice",
            {"every-step": "no action in the first time step", "later-steps": "action 1 in the first time step"},
        ),
    ),
    Reading(
        id="invariant-of-caller",
        kind="conflict",
        about="policy",
        question="When is an invariant of a caller checked while `do Sub()` runs?",
        places=(
            DYNAMIC + ', "Preconditions and Invariants": "at every time step during the execution of a behavior"',
            SECTION_4_4 + ', "Invoking Other Behaviors and Scenarios": "when the do statement returns"',
        ),
        alternatives={"on-return": "when the `do` statement returns, not in between", "every-step": "in every time step"},
        consequence="Concerns behaviors and scenarios; the released implementations do one for `do` and the other for `do ... for`.",
        code=("semantics.dynamics.invocations.guards_on_resumption",),
        probe=Probe(
            "behavior Inner():\n    self.x = 1\n    wait\n    self.x = 0\n    wait\n"
            "behavior Outer():\n    invariant: self.x == 0\n    do Inner()\nego = Object at (0, 0), with x 0, with behavior Outer",
            {"on-return": "no violation", "every-step": "InvariantViolation in the second time step: the simulation is rejected"},
        ),
    ),
    Reading(
        id="prune-heading",
        kind="conflict",
        about="pruning",
        question="What does `relHead(P, Q) ± 2δ ∈ A` of Algorithm 2 test?",
        places=(
            "Algorithm 2 (pruneByHeading): an interval is said to be an element of a set of headings",
            'Section "Domain-Specific Sampling Techniques", "Pruning Based on Orientation": polygons satisfy the constraints "up to a '
            'perturbation", and '
            "the pruning is sound",
        ),
        alternatives={"meets": "whether [relHead - 2δ, relHead + 2δ] meets A, modulo 2π"},
        consequence="Concerns pruning: read as containment it removes scenes that satisfy all requirements.",
        code=(),
        probe=Probe(
            "south = PolygonalRegion([(-1, 0), (1, 0), (1, 9), (-1, 9)])\nego = Object in south, facing Range(-5, 5) deg\n"
            "other = Object in south, facing Range(-5, 5) deg\nrequire (relative heading of other) > 6 deg",
            {"meets": "with δ = 5 deg and A = (6 deg, 10 deg) the cell survives, although relHead = 0 lies outside A"},
        ),
    ),
    Reading(
        id="prune-mutated",
        kind="conflict",
        about="pruning",
        question="May the position of an object that will be mutated be pruned?",
        places=(
            'Section "Domain-Specific Sampling Techniques", "Pruning Based on Containment": "sound, since if X is centered anywhere not in the '
            'restriction, then some point of its bounding box must lie outside"',
            'Figure "Semantics of statements", rules "Termination": noise is added first, containment is checked on the sum',
        ),
        alternatives={"never": "no: pruning applies only to objects whose mutationScale is 0"},
        consequence="Concerns pruning: noise moves objects back into the workspace, and a sampler that prunes them gives scenes the wrong weights.",
        code=(),
        probe=Probe(
            "workspace = Workspace(RectangularRegion((0, 0), 0, 4, 4))\ny = Range(-2, 2)\nego = Object at (0, y), with y y, with headingStdDev 0\n"
            "mutate",
            {
                "never": "P(|y| > 1.5) = 2 (G(0) - G(-0.5) - G(-3) + G(-3.5)) / (G(3.5) - G(-0.5) - G(0.5) + G(-3.5)) = 0.1542..., "
                "with G(u) = u Φ(u) + φ(u); 0 if y were pruned to (-1.5, 1.5)",
            },
        ),
    ),
)
