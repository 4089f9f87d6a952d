"""Readings where a rule, a table or the grammar contradicts what the paper's programs and explanations take for granted."""

from __future__ import annotations

from .reading import Probe, Reading

OBJECT_RULE = 'Figure "Semantics of expressions", rule "Object Definitions"'
PROPERTIES = 'Table "Properties of the built-in classes"'
OPERATORS = 'Figure "Operators by result type"'
ONCOMING = 'gallery, "An Oncoming Car"'

CONFLICTS_OF_EXAMPLES: tuple[Reading, ...] = (
    Reading(
        id="alg1-graph",
        kind="conflict",
        question="What are the vertices of the dependency graph of Algorithm 1?",
        places=(
            'Algorithm 1 (resolveSpecifiers): "specifiers S in dom specForProperty", whose domain holds properties, and edges between specifiers, in '
            '"an empty graph on dom specForProperty"',
            'Section "Semantics of Expressions": "a directed graph with vertices P", the properties; rule "Object Definitions": v_i(p_i), one '
            'property '
            "per specifier, where Algorithm 1 returns a set",
        ),
        alternatives={"specifiers": "specifiers, taken from the image of the map; a specifier is evaluated once, for all properties it determines"},
        consequence="The orders are the same: a property comes after another exactly if its specifier does.",
        code=("semantics.resolution.resolve_specifiers",),
        probe=Probe(
            "ego = Object with foo 1, left of (0, 0), with width 2, facing 90 deg\nparam position = ego.position",
            {"specifiers": "(0, -1), in whatever order the specifiers are written"},
        ),
    ),
    Reading(
        id="is-in",
        kind="conflict",
        question="How is membership in a region written?",
        places=(OPERATORS + ": `X in region`", 'Figure "Boolean operators": `X is in R`'),
        alternatives={"in": "`X in R`; `X is in R` is accepted and means the same"},
        consequence="Both spellings parse to the same tree.",
        code=("semantics.comparisons.conclude_comparison",),
        probe=Probe(
            "ego = Object at (0, 0)\nR = CircularRegion((0, 0), 1)\nparam a = ego in R, b = ego is in R, c = (0, 2) is in R, d = (0, 1) in R",
            {"in": "True, True, False, True"},
        ),
    ),
    Reading(
        id="in-whole",
        kind="conflict",
        question="Is an Object in a region when it enters it, or when it is inside as a whole?",
        places=(
            'Figure "Boolean operators": O is in R = boundingBox(O) ⊆ R',
            'Section "Dynamic Scenarios": `self in targetRegion` fires when "the car enters the targetRegion"; "carA and carB enter the '
            'intersection"',
        ),
        alternatives={"whole": "as a whole: the bounding box is a subset of the region"},
        consequence="A car straddling the edge of an intersection is neither in it nor does `not in` say that it is clear of it.",
        code=("semantics.operators.object_is_in",),
        probe=Probe(
            "ego = Object at (0, 0)\nR = RectangularRegion((0, 0), 0, 0.9, 5)\nparam a = ego in R, b = ego.position in R, c = ego not in R",
            {"whole": "False, True, True"},
        ),
    ),
    Reading(
        id="no-orientation",
        kind="conflict",
        question="Which heading does `in R` specify where R has no preferred orientation?",
        places=(
            'Figure "Semantics of position specifiers that optionally specify heading": OrientedPoint(x, ⊥), and the specifier "evaluates to the map '
            '{position, heading}"',
            'Section "Specifiers": `on region` optionally specifies heading "if the given region has a preferred orientation"',
        ),
        alternatives={"none": "none: the heading comes from another specifier or from the default value"},
        consequence="Read as a map with heading ⊥, every object placed in a plain region would have no heading, and mutation would be undefined.",
        code=("semantics.object_definitions.describe", "semantics.specifiers.oriented"),
        probe=Probe(
            "class Turned:\n    heading: 1.25\nego = Turned in CircularRegion((0, 0), 1)\nparam heading = ego.heading",
            {"none": "1.25"},
        ),
    ),
    Reading(
        id="scene-objects",
        kind="conflict",
        question="Do Points and OrientedPoints belong to the set O of a scene?",
        places=(
            OBJECT_RULE + ": every new instance joins O, whatever its class",
            'Section "Data Types": "physical objects in a scene are instances of Object"; Section "Semantics of Scenic": a scene assigns "all the '
            'properties of each Object"; rule "Termination, Step 2" uses width, length, allowCollisions and requireVisible of every member of O',
        ),
        alternatives={"objects": "no: only instances of Object and of classes below it"},
        consequence="To the letter, `Point on road`, the default position of every Car, would make the termination rules undefined.",
        code=("semantics.object_definitions.new_instance", "semantics.kinds.is_object"),
        probe=Probe(
            "spot = OrientedPoint at (900, 0)\nego = Object at (0, 0)\nplace = Point at (0, 0)\nmutate",
            {"objects": "one object; the points collide with nothing, need not be visible and are not mutated"},
        ),
    ),
    Reading(
        id="nested-objects",
        kind="conflict",
        question="Is an object that a specifier's expression creates part of the scene?",
        places=(
            "Figure \"Semantics of expressions\", rule \"'with' specifier\": the premise yields O', the conclusion drops it",
            OBJECT_RULE + ": O_1, ..., O_n are handed from specifier to specifier and end in the result",
        ),
        alternatives={"kept": "yes, and it comes before the object that is being specified"},
        consequence="`Car with trailer Trailer at (0, 9)` makes two objects.",
        code=("semantics.object_definitions.new_instance",),
        probe=Probe("ego = Object at (0, 0), with friend (Object at (5, 0))", {"kept": "two objects, at (5, 0) and (0, 0)"}),
    ),
    Reading(
        id="velocity",
        kind="conflict",
        question="What is the default value of `velocity`?",
        places=(PROPERTIES + ', column "Default": (0, 0)', PROPERTIES + ', column "Meaning": "default from speed, heading"'),
        alternatives={"derived": "(0, speed) along the heading; mutation, which changes the heading later, does not recompute it"},
        consequence="The two columns agree only for speed 0.",
        code=("semantics.classes.OBJECT_CLASS",),
        probe=Probe("ego = Object at (0, 0), facing 90 deg, with speed 2\nparam velocity = ego.velocity", {"derived": "(-2, 0)"}),
    ),
    Reading(
        id="sees-box",
        kind="conflict",
        question="Must the centre of an Object be seen, or some point of its bounding box?",
        places=(
            'Figure "Boolean operators": visibleRegion(P) ∩ boundingBox(O) ≠ ∅',
            ONCOMING + ': a view cone of 30 degrees "requires that this orientation is also within 15° of facing the camera"',
        ),
        alternatives={"box": "some point of the box: the orientation may deviate by a few degrees more than half the view angle"},
        consequence="The gallery's 15 degrees hold for the centre of the camera's car only, not for what the program requires.",
        code=("semantics.operators.can_see_object",),
        probe=Probe(
            "ego = Object at (0, 0)\nc = Object at (0, 10), facing 196 deg, with viewAngle 30 deg\n"
            "param box = c can see ego, centre = c can see (0, 0)",
            {"box": "True for the box, False for the centre"},
        ),
    ),
    Reading(
        id="oncoming-range",
        kind="conflict",
        question="Is `Car offset by (Range(-10, 10), Range(20, 40))` 20-40 m ahead?",
        places=(
            'Section "Basic Scenarios" and ' + ONCOMING + ': "a car 20-40 m ahead"',
            'gallery, "The scenic.simulators.gta.model Module": `visibleDistance: 30`; rule "Termination, Step 2": what ego cannot see is discarded',
        ),
        alternatives={"conditioned": "no: only the cars within ego's view distance remain, and their distances are distributed accordingly"},
        consequence="With a view distance of 30 m no scene has the car's nearest point further away than that.",
        code=("semantics.termination.check_default_requirements",),
        probe=Probe(
            "y = Range(20, 40)\nego = Object at (0, 0), with viewDistance 30, with y y\nObject offset by (0, y)",
            {"conditioned": "y is uniform on (20, 30.5): P(y < 25) = 5 / 10.5 = 0.4761..., not 1/4"},
        ),
    ),
    Reading(
        id="distance-words",
        kind="conflict",
        question="In which order do `from` and `to` follow `distance` and `angle`?",
        places=(
            OPERATORS + ": `distance to V from V`, `angle from V to V`",
            'Figure "Scalar operators": `distance from V1 to V2`; Section "Dynamic Scenarios": `distance from self to ego`',
        ),
        alternatives={"either": "in either; the one that is left out is ego.position"},
        consequence="`distance from X` alone, which only the prose uses, is the distance from X to ego.",
        code=("semantics.operators.distance_from_ego", "semantics.operators.angle_from_ego"),
        probe=Probe(
            "ego = Object at (0, 0)\nparam a = distance to (3, 4) from (0, 1), b = distance from (0, 1) to (3, 4), c = distance from (3, 4), "
            "d = angle to (0, 1) from (1, 1)",
            {"either": "3 sqrt(2), 3 sqrt(2), 5 and π/2"},
        ),
    ),
    Reading(
        id="distance-region",
        kind="conflict",
        question="May `distance from X to Y` speak of a region?",
        places=(
            OPERATORS + ' and Figure "Scalar operators": both are vectors',
            'Section "Dynamic Scenarios": `(distance from self to intersection) < 10`, where `ego in intersection` makes intersection a region',
        ),
        alternatives={"nearest": "yes: the distance to its nearest point, 0 inside"},
        consequence="Without it two programs of the paper would be ill-typed.",
        code=("semantics.operators.distance_to_region",),
        probe=Probe(
            "ego = Object at (0, 0)\nR = CircularRegion((10, 0), 2)\nparam out = distance to R, inside = distance from (9, 0) to R",
            {"nearest": "8 and 0"},
        ),
    ),
    Reading(
        id="heading-scalar",
        kind="conflict",
        question="Is `S deg` a heading or a scalar?",
        places=(
            OPERATORS + ": `scalar deg` is a headingOperator, and comparisons, products and abs take scalars",
            'gallery, "A Badly-Parked Car": `Uniform(1.0, -1.0) * (10, 20) deg`; "Robot Motion Planning with a Bottleneck": `... <= 10 deg`; '
            '"A Single Car": `(-10 deg, 10 deg)`',
        ),
        alternatives={"scalar": "a scalar, the angle in radians; a heading is a scalar, or an OrientedPoint read as its heading"},
        consequence="Headings take part in arithmetic, and nothing tells radians from metres.",
        code=("semantics.operators.degrees", "semantics.kinds.has_kind"),
        probe=Probe("ego = Object at (0, 0), facing 2 * 45 deg\n"
            "param heading = ego.heading, small = abs(-5 deg) <= 10 deg", {"scalar": "π/2 and True"}),
    ),
    Reading(
        id="import-names",
        kind="conflict",
        question="Does `import m` make the names of m available without m?",
        places=(
            'Table "Statements": `import` is Python\'s',
            'Figure "A Scenic representing rubble fields with a bottleneck": `import mars` and then `Rover at 0 @ -2`',
        ),
        alternatives={"dialect": "only in dialect pldi19, the gallery's, and only for Scenic modules; elsewhere write `from m import *` or `model "
            "m`"},
        consequence="In the default dialect the program of that figure stops at `Rover`.",
        code=("interpreter.modules.with_old_imports",),
        probe=Probe("# dialect: pldi19\nimport mars\nego = Rover at 0 @ -2", {"dialect": "a Rover at (0, -2); without the first line a RunError, "
            "rule E-Variable"}),
    ),
)
