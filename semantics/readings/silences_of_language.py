"""Readings where the formal rules are silent about the language around them: variables, branches, functions, classes, syntax."""

from __future__ import annotations

from .reading import Probe, Reading

OBJECT_RULE = 'Figure "Semantics of expressions", rule "Object Definitions"'
PLATOON = 'Figure "Helper function for creating a platoon starting from a given car"'
BRANCHING = 'Section "Syntax of Scenic": "conditional branching may not depend on random variables"'

SILENCES_OF_LANGUAGE: tuple[Reading, ...] = (
    Reading(
        id="ego-late",
        kind="silence",
        question="May an object that is created before `ego` is assigned use it?",
        places=('Section "Basic Scenarios": "it is a syntax error to leave ego undefined"', 'Figure "Semantics of position specifiers"'),
        alternatives={"error": "no: an error at the use; leaving ego undefined until the end is an error as well"},
        consequence="`Car offset by (0, 5)` before `ego = Car` is a mistake, `Car at (0, 5)` is not.",
        code=("semantics.premises.variable", "semantics.termination.resume_finishing"),
        probe=Probe(
            "Object offset by (0, 5)\nego = Object at (0, 0)",
            {"error": "RunError, rule E-Variable; a program without `ego = ...` is a RunError, rule T-Mutate"},
        ),
    ),
    Reading(
        id="ego-twice",
        kind="silence",
        question="What if `ego` is assigned twice?",
        places=('Figure "Semantics of statements", rules "Variable/Parameter Assignments" and "Termination, Step 2"',),
        alternatives={"last": "it is a variable like any other: each use reads its value at the time, the termination rule the last one"},
        consequence="What must be visible must be visible from the last ego.",
        code=("semantics.assignment.assign_name",),
        probe=Probe(
            "ego = Object at (0, 0)\na = Object offset by (0, 5)\nego = Object at (40, 0)\nb = Object offset by (45, 0)\n"
            "param a = a.position, b = b.position",
            {"last": "(0, 5) and (85, 0), which only the second ego sees"},
        ),
    ),
    Reading(
        id="random-branch",
        kind="silence",
        question="What happens when control flow outside behaviors depends on a random value?",
        places=(BRANCHING + "; no rule says what happens", 'Section "Domain-Specific Sampling Techniques": "lack of conditional control flow"'),
        alternatives={
            "error": "an error that names the branch and the random value's origin, whatever the value happens to be; it is found before any "
            "scene is made",
        },
        consequence="It holds for `if`, `while`, conditional expressions, comprehension conditions, the length of what is iterated over, and "
            "which function "
        "is called.",
        code=("semantics.conditions.random_branch", "interpreter.running.rehearse"),
        probe=Probe("ego = Object at (0, 0)\nx = Range(0, 1)\nif x < 2:\n    Object at (3, 3)", {"error": "RandomBranch, rule E-Branch"}),
    ),
    Reading(
        id="boolean-random",
        kind="silence",
        question="Are `and` and `or` branches when an operand is random?",
        places=(BRANCHING, 'Figure "Operators by result type": `and` and `or` are booleanOperators, whose semantics is "standard"'),
        alternatives={
            "short-circuit": "an operand behind one that decides is not reduced, random or not, as in the standard meaning: it can neither draw, nor "
            "get stuck, nor fail; draws in operands that a random one decides about are numbered apart",
            "operator": "as soon as an operand is random, all the operands after it are reduced as well",
        },
        consequence="`require x > 0 and 1 / x > 0` is no error where x is 0, and `require x > 3 or (F at (x, 0)) > 0` is not stuck where x > 3; "
        "`a < b < c` goes by the same reading. Under `operator` both are.",
        code=("semantics.conditions.resume_boolean", "semantics.comparisons.conclude_comparison"),
        probe=Probe(
            "log = []\ndef seen(v):\n    log.append(v)\n    return v\nego = Object at (0, 0)\nx = Range(0, 1)\ny = x < 2 or seen(True)\n"
            "z = True or seen(False)\nparam y = y, reduced = len(log)",
            {
                "short-circuit": "True, and no operand reduced: the one before it decides",
                "operator": "True, and 1 operand reduced: the one after a random operand",
            },
        ),
    ),
    Reading(
        id="is-none",
        kind="silence",
        question="Is `model is None` random where `model` is a random value?",
        places=(BRANCHING, PLATOON + ": `car.model if model is None else resample(model)`, called with a random model"),
        alternatives={"identity": "not if the value is a direct draw whose distribution cannot give None; otherwise it is, and a branch on it is "
            "an error"},
        consequence="The paper's helper functions work with random and with missing arguments.",
        code=("semantics.comparisons.never_none",),
        probe=Probe(
            "ego = Object at (0, 0)\nx = Uniform(1, 2)\nparam a = 1 if x is None else 2",
            {"identity": "2; with `Uniform(1, None)` RandomBranch, rule E-Branch"},
        ),
    ),
    Reading(
        id="default-arguments",
        kind="silence",
        question="When is a random default argument drawn?",
        places=(PLATOON + ": `dist=(2, 8), shift=(-0.5, 0.5)`", 'gallery, "A Platoon, in Daytime": functions are "inherited from Python"'),
        alternatives={"definition": "once, when `def` runs, as in Python: all calls share the draw, and `resample` at the use makes them "
            "independent"},
        consequence="All cars of a platoon have the same `shift`, and their own `resample(dist)`.",
        code=("semantics.control.function_definition", "semantics.functions.make_function"),
        probe=Probe(
            "def f(x=Range(0, 1)):\n    return x\ndef g(x=Range(0, 1)):\n    return resample(x)\nego = Object at (0, 0)\n"
            "param shared = f() - f(), independent = g() - g()",
            {"definition": "0 always, and not 0"},
        ),
    ),
    Reading(
        id="specifier-arguments",
        kind="silence",
        question="In which order, and with which `self`, are the arguments of specifiers evaluated?",
        places=(
            OBJECT_RULE + ": each specifier is reduced in the order of Algorithm 1",
            "Algorithm 1 (resolveSpecifiers): what a specifier specifies must be known before, and depends on the kinds of its arguments",
        ),
        alternatives={
            "left-to-right": "from left to right before resolveSpecifiers, so that `self` is not known; those that mention a vector field "
            "relative to "
            "something wait for the position (reading `field-dependency`); default values are evaluated in the order of Algorithm 1, with `self`",
        },
        consequence="The distribution does not depend on it, side effects and messages do; `with x self.width` is an error.",
        code=("semantics.object_definitions.evaluate_arguments",),
        probe=Probe(
            "log = []\ndef seen(v):\n    log.append(v)\n    return v\n"
            "ego = Object left of seen((5, 5)) by seen(1), facing seen(2), with width seen(3)\n"
            "param log = log",
            {"left-to-right": "[(5, 5), 1, 2, 3]; `Object with x self.width` is a RunError, rule E-Variable"},
        ),
    ),
    Reading(
        id="bare-class",
        kind="silence",
        question="Does the name of a class create an object or mean the class?",
        places=(
            'Figure "Simplified Scenic grammar": a class with a possibly empty list of specifiers is an object',
            'Section "Dynamic Scenarios": `self.distanceToClosest(Pedestrian)`; Figure "Operators by result type": `vectorField at vector`',
        ),
        alternatives={
            "by-place": "it creates an object as a whole statement, as the right-hand side of an assignment or of `return`, or as the head of a "
            "specifier; as an "
            "argument, in a list or compared it is the class; `E at X` is decided by what E is, a class or a field",
        },
        consequence="A list of new objects needs specifiers, or assignments before it.",
        code=("semantics.object_definitions.resume_class",),
        probe=Probe(
            "class C:\n    width: 2\nF = VectorField('F', lambda p: 1.5)\ndef make():\n    return C at (9, 9)\nego = C\nother = make()\n"
            "param made = isinstance(ego, C), same = [C][0] is C, field = F at (3, 3), returned = isinstance(other, C)",
            {"by-place": "True, True, 1.5, True, and two objects"},
        ),
    ),
    Reading(
        id="intervals",
        kind="silence",
        question="What is `(low, high)` in the programs of the gallery?",
        places=(
            'Section "Data Types": `(X, Y)` is a vector; `X @ Y` is legal as well (footnote)',
            "gallery: `(-10 deg, 10 deg)` is an interval, `(-10, 10) @ (20, 40)` a vector of intervals; Table \"Built-in distributions\": "
            "`Range(low, high)`",
        ),
        alternatives={
            "dialect": "in dialect pldi19, chosen by an option or a first line `# dialect: pldi19`, a pair of scalars outside vector positions is "
            "an interval; "
            "elsewhere it is a vector",
        },
        consequence="One text can mean two programs: the dialect is part of a program.",
        code=("interpreter.dialects.choose", "semantics.draws.interval_or_pair"),
        probe=Probe(
            "# dialect: pldi19\nx = (1, 2)\ny = resample(x)\nego = Object at (3, 4), with x x, with y y",
            {"dialect": "a scalar x in [1, 2] and ego at (3, 4); without the first line x is the vector (1, 2)"},
        ),
    ),
    Reading(
        id="time-unit",
        kind="silence",
        question="In which unit are `Range(15, 30) seconds` and `simulation.currentTime`, which Section 3 compares?",
        places=('Section "Dynamic Scenarios", "Stateful Behaviors"', 'Table "Statements": `for scalar seconds/steps`'),
        alternatives={
            "seconds": "`E seconds` is E, and `simulation.currentTime` is in seconds",
            "steps": "`E seconds` is E, and `simulation().currentTime` counts time steps",
        },
        profiles={"scenic-2.1": "steps", "scenic-3": "steps"},
        consequence="The two alternatives concern behaviors; under `steps` the paper's DriveWithRandomStops compares steps with seconds.",
        code=("semantics.expressions.conclude_seconds",),
        probe=Probe("ego = Object at (0, 0)\nparam delay = 15 seconds, more = (2 seconds) + 1", {"seconds": "15 and 3", "steps": "15 and 3 as well"}),
    ),
)
