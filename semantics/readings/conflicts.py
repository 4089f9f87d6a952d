"""Readings where the paper contradicts itself about requirements, coordinates, properties and mutation."""

from __future__ import annotations

from .reading import Probe, Reading

STEP_1 = 'Figure "Semantics of statements", rule "Termination, Step 1: Apply Mutations"'
DATA_TYPES = 'Section "Data Types"'
SECTION_5_1 = 'Section "Semantics of Scenic"'
POSITION_FIGURE = 'Figure "Semantics of position specifiers"'
DRAWN_FIGURE = 'Figure "Various Scenic operators and specifiers applied to the ego object and an OrientedPoint P" (drawn)'
OPERATORS = 'Figure "Operators by result type"'

CONFLICTS: tuple[Reading, ...] = (
    Reading(
        id="soft",
        kind="conflict",
        question="When is the coin of `require[p] B` thrown?",
        places=(
            'Figure "Semantics of statements", rule "Soft Requirements", and Section "Semantics of a Scenic Program": the rule throws it inside the '
            "run, and runs that get stuck are discarded and the rest renormalised",
            SECTION_5_1 + ', "Soft Requirements", and Section "Semantics of Statements": B then holds with probability at least p',
        ),
        alternatives={
            "run": "a coin in every run, as in the rule; with q = P(B) this gives P(B | accepted) = q / (1 - p + p q), below p for small q",
            "scene": "one coin for every emitted scene, thrown before the rejection loop: P(B) = p + (1 - p) q, at least p",
        },
        profiles={"prose": "scene", "scenic-2.1": "scene", "scenic-3": "scene"},
        consequence="Under the rule the paper's own claim is false: `require[0.9] B` with P(B) = 0.1 holds in 53% of the scenes, not in 90%.",
        code=("semantics.statements.conclude_soft", "interpreter.choosers.from_stream"),
        probe=Probe(
            "x = Range(0, 1)\nego = Object at (0, 0), with v x\nrequire[0.5] x < 0.1",
            {"run": "P(x < 0.1) = 0.1 / 0.55 = 0.1818...", "scene": "P(x < 0.1) = 0.55"},
        ),
    ),
    Reading(
        id="require-time",
        kind="conflict",
        question="When is `require B` evaluated?",
        places=(
            'Figure "Semantics of statements", rule "Hard Requirements": when the statement is reached, hence before mutation',
            SECTION_5_1 + ', "Mutation": noise is added "before requirements are checked"; Section "Basic Scenarios", "Mutations": noise is added '
            '"while still enforcing all built-in and custom requirements"',
        ),
        alternatives={
            "statement": "at the statement, on the values that things have there, without noise",
            "end": "after mutation, with what variables and properties held at the statement (reading `requirement-capture`) and the noise",
        },
        profiles={"prose": "end", "scenic-2.1": "end", "scenic-3": "end"},
        consequence="Under the rule a mutated object may violate a requirement that the program states; the default requirements are checked after "
        "mutation in either case.",
        code=("semantics.statements.hard_requirement", "semantics.termination.resume_late"),
        probe=Probe(
            "ego = Object at (0, 0)\nmutate ego\nrequire ego.position.x < 1",
            {
                "statement": "accepted always; P(x < 0) = 1/2, and x > 1 occurs",
                "end": "x is a standard normal truncated to x < 1: P(x < 0) = (1/2) / Φ(1) = 0.5943...",
            },
        ),
    ),
    Reading(
        id="offset-by",
        kind="conflict",
        question="Along which axes does the specifier `offset by V` go?",
        places=(
            POSITION_FIGURE + ": V relative to ego.position, hence along East and North",
            DRAWN_FIGURE + ': `Point offset by (1, 2)` is `(1, 2) relative to ego`; Section "Basic Scenarios": "20-40 m ahead of the camera"; '
            'gallery, "An Oncoming Car"',
        ),
        alternatives={
            "local": "along ego's axes: V relative to ego",
            "global": "along East and North: V relative to ego.position",
        },
        profiles={"formal": "global"},
        consequence="With an ego that does not face North, every object placed by `offset by` stands elsewhere.",
        code=("semantics.specifiers.forms_of", "semantics.specifiers.offset_by_local", "semantics.specifiers.offset_by_global"),
        probe=Probe(
            "ego = Object at (0, 0), facing 90 deg\nother = Object offset by (0, 5)\nparam position = other.position",
            {"local": "(-5, 0)", "global": "(0, 5)"},
        ),
    ),
    Reading(
        id="oriented-offset",
        kind="conflict",
        question="What is the operator `OP offset by V` for an OrientedPoint OP?",
        places=(
            DATA_TYPES + ": `taxi offset by (1, 2)` may be written instead of `taxi.position offset by (1, 2)`, hence along East and North",
            'Figure "OrientedPoint operators": OP offset by V = V relative to OP; ' + DRAWN_FIGURE + ": `P offset by (0, -2)`; " + OPERATORS,
        ),
        alternatives={
            "local": "V relative to OP: an OrientedPoint along OP's axes",
            "global": "OP.position offset by V: a vector, along East and North",
        },
        profiles={"prose": "global"},
        consequence="The gallery's `carAheadOfCar` writes `(front of car) offset by (offsetX @ gap)`: only along the car's axes is the result ahead.",
        code=("semantics.operations.select",),
        probe=Probe(
            "ego = Object at (0, 0), facing 90 deg\np = ego offset by (0, 5)\nparam gap = distance from p to (0, 5)",
            {"local": "p is (-5, 0): the gap is sqrt(50)", "global": "p is (0, 5): the gap is 0"},
        ),
    ),
    Reading(
        id="height",
        kind="conflict",
        question="Which property is the extent of a bounding box along the y axis?",
        places=(
            POSITION_FIGURE + " and Figure \"OrientedPoint operators\": self.height, O.height; gallery: `height` of `Car` and of the pipes",
            'Table "Properties of the built-in classes" and Table "Specifiers for position": length',
        ),
        alternatives={"length": "`length`; `height` is another spelling of the same property, and giving both to one object is an error"},
        consequence="To the letter of the appendix `front of O` would need a property that no built-in class has.",
        code=("semantics.classes.canonical", "semantics.specifiers.behind_vector", "semantics.operators.front_of"),
        probe=Probe(
            "ego = Object behind (0, 0), with length 4\nother = Object behind (9, 0), with height 4\n"
            "param position = ego.position, other = other.position, height = ego.height",
            {"length": "(0, -2), (9, -2) and 4"},
        ),
    ),
    Reading(
        id="view-distance",
        kind="conflict",
        question="Which property says how far a Point sees?",
        places=(
            'Table "Properties of the built-in classes" and Figure "Notation used to define the semantics": viewDistance',
            'gallery: `visibleDistance` of `Car`, "A Platoon, in Daytime", "Bumper-to-Bumper Traffic"',
        ),
        alternatives={"viewDistance": "`viewDistance`; `visibleDistance` is another spelling of the same property, and giving both is an error"},
        consequence="Otherwise the gallery's `visibleDistance: 30` would have no effect at all.",
        code=("semantics.classes.canonical", "semantics.resolution.resolve_specifiers", "semantics.definitions.make_scenic_class"),
        probe=Probe(
            "class Near:\n    visibleDistance: 5\nego = Near at (0, 0)\nfar = Object at (30, 0), with visibleDistance 60, with requireVisible False\n"
            "param ego = ego.viewDistance, far = far.viewDistance, sees = far can see ego",
            {"viewDistance": "5, 60 and True; `with viewDistance 4, with visibleDistance 4` is a SpecifiedTwice error"},
        ),
    ),
    Reading(
        id="mutate-color",
        kind="conflict",
        question="Does `mutate` change the color of an object?",
        places=(
            STEP_1 + ": position and heading only; Section \"Statements\", \"Mutation\": likewise",
            'Section "Debugging Failures": the mutation feature adds noise to "the car\'s position, heading, and color"; gallery, "Adding Noise to a '
            'Scene"',
        ),
        alternatives={
            "no": "position and heading only",
            "yes": "where `color` is a tuple of reals, each component gets Normal(0, S · colorStdDev) as well and is kept within [0, 1]; "
            "colorStdDev is "
            "the property of that name, 0.05 where there is none",
        },
        profiles={"prose": "yes", "scenic-2.1": "yes"},
        consequence="The released world model adds its color noise in hue, saturation and lightness, with deviation 0.05 whatever the scale.",
        code=("semantics.termination.color_of", "semantics.termination.apply_noise"),
        probe=Probe(
            "ego = Object at (0, 0), with color (0.5, 0.5, 1), with colorStdDev 0.5\nmutate ego",
            {"no": "the color stays (0.5, 0.5, 1)", "yes": "P(first component = 0) = Φ(-1) = 0.1587..., and P(third = 1) = 1/2"},
        ),
    ),
    Reading(
        id="mutate-scale",
        kind="conflict",
        question="Is the number after `mutate X by` a standard deviation or a factor?",
        places=(
            'Section "Statements", "Mutation": noise "with the given standard deviation (default 1) to the position and heading"',
            STEP_1 + f", and {SECTION_5_1}, \"Mutation\": it is mutationScale, by which positionStdDev and headingStdDev (5 degrees) are multiplied",
        ),
        alternatives={"factor": "a factor: the deviation of the heading is 5 degrees times it, unless headingStdDev says otherwise"},
        consequence="As a deviation, `mutate` would turn every object by a radian or so, that is, completely.",
        code=("semantics.statements.conclude_mutate", "semantics.termination.mutate_objects"),
        probe=Probe(
            "ego = Object at (0, 0)\nmutate ego by 2",
            {"factor": "P(|heading| > 10 deg) = 2 Φ(-1) = 0.3173...; were it a deviation, 2 Φ(-0.0873) = 0.9305"},
        ),
    ),
    Reading(
        id="point-size",
        kind="conflict",
        question="Where is `OrientedPoint left of X by D`, which depends on a width that OrientedPoint does not have?",
        places=(
            'Algorithm 1 (resolveSpecifiers): "missing property D required by S"; Table "Properties of the built-in classes": width belongs to '
            'Object',
            'Section "Robot Motion Planning with a Bottleneck": `OrientedPoint left of bottleneck by halfGapWidth`; Figure "Helper function for '
            'creating a platoon starting from a given car": `OrientedPoint right of center by shift`',
        ),
        alternatives={"zero": "a width or length that a Point lacks counts as 0", "error": "a MissingProperty error, as in Algorithm 1"},
        profiles={"formal": "error"},
        consequence="Under `error` two scenarios of the paper's own gallery are ill-formed.",
        code=("semantics.object_definitions.conclude_arguments", "semantics.resolution.resolve_specifiers", "semantics.kinds.Reader.size"),
        probe=Probe(
            "ego = Object at (0, 0)\np = OrientedPoint left of (3, 0) by 1\nparam position = p.position",
            {"zero": "(2, 0)", "error": "MissingProperty, rule R-MissingProperty"},
        ),
    ),
)
