"""Readings where the formal rules are silent about geometry, specifiers, requirements and mutation."""

from __future__ import annotations

from .reading import Probe, Reading

NOTATION = 'Figure "Notation used to define the semantics"'
SCALAR_OPERATORS = 'Figure "Scalar operators"'
OPERATORS = 'Figure "Operators by result type"'
STEP_1 = 'Figure "Semantics of statements", rule "Termination, Step 1: Apply Mutations"'
STEP_2 = 'Figure "Semantics of statements", rule "Termination, Step 2: Check Default Requirements"'

SILENCES: tuple[Reading, ...] = (
    Reading(
        id="angle",
        kind="silence",
        question="What is the arctan of a vector, and are differences of headings wrapped?",
        places=('Figure "Semantics of position specifiers" and ' + SCALAR_OPERATORS, 'Section "Data Types", "Headings"'),
        alternatives={
            "heading": "the heading of the vector, anticlockwise from North: atan2(-x, y), in (-π, π], and 0 for the zero vector; operators do "
            "not wrap "
            "differences, only the output is normalised to (-π, π]",
        },
        consequence="rotate((0, 1), arctan(v)) is parallel to v; `abs((angle to a) - (angle to b))` jumps by 2π due South of ego.",
        code=("semantics.geometry.angle_of", "semantics.geometry.normalise_heading", "semantics.operators.relative_heading"),
        probe=Probe(
            "ego = Object at (0, 0)\nparam west = angle to (-1, 0), south = angle to (0, -1), east = angle to (1, 0), none = angle to (0, 0), "
            "wide = relative heading of 190 deg from -190 deg",
            {"heading": "π/2, π, -π/2, 0 and 19π/9"},
        ),
    ),
    Reading(
        id="resample",
        kind="silence",
        question="A variable holds a sampled value: from which distribution does `resample(x)` sample?",
        places=('Section "Expressions" and its footnote on parameters', 'Figure "Semantics of expressions", rule "Distributions": no rule for '
            'resample'),
        alternatives={
            "remembered": "σ keeps, for each value that the rule Distributions produced, the distribution and its evaluated parameters θ; "
            "anything else, "
            "such as x + 1, is an error",
        },
        consequence="Aliases, elements of lists and arguments of functions can be resampled; sums and products cannot.",
        code=("semantics.specials.resample", "semantics.draws.ask"),
        probe=Probe(
            "low = Range(0, 1)\nx = Range(low, low + 1)\ny = resample(x)\nego = Object at (0, 0), with above y - low, with gap y - x",
            {"remembered": "y - low lies in [0, 1] always, and P(y < x) = 1/2; `resample(x + 1)` is a RunError, rule E-Resample"},
        ),
    ),
    Reading(
        id="resample-constant",
        kind="silence",
        question="What is `resample(x)` for a value that is not random?",
        places=(
            'Section "Expressions": D is "one of the distributions in Tab."',
            'Figure "Helper function for creating a platoon starting from a given car": `resample(wiggle)` with the default wiggle=0',
        ),
        alternatives={"point-mass": "the value itself, as if drawn from a point mass", "error": "a RunError, as for anything that is no "
            "distribution"},
        consequence="Under `error` the paper's own helper functions fail with their default arguments.",
        code=("semantics.specials.resample",),
        probe=Probe("ego = Object at (0, 0)\nparam x = resample(3)", {"point-mass": "3", "error": "RunError, rule E-Resample"}),
    ),
    Reading(
        id="distance-past",
        kind="silence",
        question="What is `distance of OP past V`?",
        places=(OPERATORS + " (the appendix has no equation)", 'Section "Compositional Scenarios": `until distance past subScenario.parkedCar > 10`'),
        alternatives={"local-y": "the y coordinate of OP.position - V in OP's local coordinates; OP is ego by default"},
        consequence="Positive once OP has passed V, negative before.",
        code=("semantics.operators.distance_past",),
        probe=Probe(
            "ego = Object at (0, 5)\np = OrientedPoint at (0, 0), facing 90 deg\nparam a = distance past (0, 0), b = distance past (3, 7), "
            "c = distance of p past (3, 0)",
            {"local-y": "5, -2 and 3"},
        ),
    ),
    Reading(
        id="can-see-vector",
        kind="silence",
        question="What does it mean to see a vector?",
        places=('Figure "Boolean operators": defined for an Object only', OPERATORS + ": `can see` takes a vector or an Object"),
        alternatives={"in-region": "the point lies in the viewer's visible region, a closed set"},
        consequence="A point at exactly the view distance is seen.",
        code=("semantics.operators.can_see_vector",),
        probe=Probe(
            "ego = Object at (0, 0), with viewDistance 10, with viewAngle 90 deg\n"
            "param a = ego can see (0, 10), b = ego can see (0, 10.001), c = ego can see (-1, 2), d = ego can see (-2, 1)",
            {"in-region": "True, False, True, False"},
        ),
    ),
    Reading(
        id="vector-relative",
        kind="silence",
        question="What is `V1 relative to V2` for vectors?",
        places=('Figure "Vector operators" (no equation)', 'Section "Expressions": `(-3, 0) relative to Y` is 3 m West of Y if Y is a vector'),
        alternatives={"sum": "the sum"},
        consequence="A Point, which has no heading, counts as a vector here.",
        code=("semantics.operators.vectors_relative",),
        probe=Probe(
            "ego = Object at (0, 0)\np = Point at (3, 4)\nparam a = (-3, 0) relative to (5, 6), b = (1, 2) relative to p",
            {"sum": "(2, 6) and (4, 6)"},
        ),
    ),
    Reading(
        id="field-outside",
        kind="silence",
        question="What is a polygonal vector field outside all its cells?",
        places=('Section "Data Types", "Vector Fields": "an orientation to each point in space"', 'Section "Domain-Specific Sampling Techniques"'),
        alternatives={"stuck": "nothing: no rule applies, the run is stuck and discarded, and the report counts it as such"},
        consequence="A car that noise or an offset moves off the map takes its run with it.",
        code=("semantics.fields.PolygonalVectorField", "semantics.operations.apply_equation", "semantics.object_definitions.outside_field"),
        probe=Probe(
            "from scenic.simulators.gta.map import roadDirection\nx = Uniform(0, 9999999)\nego = Object at (0, 0)\n"
            "param heading = roadDirection at (x, 9999999)",
            {"stuck": "AttemptsExhausted, all attempts counted under one requirement of kind `field`"},
        ),
    ),
    Reading(
        id="requirement-capture",
        kind="silence",
        question="Which values does a condition see that is evaluated later than its statement?",
        places=('Figure "Semantics of statements", rule "Hard Requirements"', 'Section "Semantics of Scenic", "Mutation"'),
        alternatives={
            "values": "under `require-time=statement` nothing is captured; under `end` the variables, the elements of their lists, dictionaries and "
            "sets, and the properties count as they were at the statement, plus the noise of mutation",
        },
        consequence="Assignments after a `require` never change its meaning; variables that a called function reads count as they are at the end.",
        code=("semantics.scopes.Scope.snapshot", "semantics.termination.as_captured"),
        probe=Probe(
            "x, l = 1, [1]\nego = Object at (0, 0), with x 1\nrequire x == 1 and l[0] == 1 and ego.x == 1 and (distance to (0, 0)) == 0\n"
            "x, l[0], ego.x = 2, 2, 2\nego = Object at (5, 0)",
            {"values": "accepted always, under both alternatives of `require-time`"},
        ),
    ),
    Reading(
        id="beside-object-by",
        kind="silence",
        question="What is `left of O by S` for an Object O?",
        places=(
            'Figure "Semantics of position specifiers that optionally specify heading": `left of O` only',
            'Table "Specifiers for position": `left of Object by scalar`',
        ),
        alternatives={"from-side": "left of (left of O) by S; likewise for right of, ahead of and behind"},
        consequence="S is the gap between the two boxes.",
        code=("semantics.specifiers.left_of_object",),
        probe=Probe(
            "ego = Object at (0, 0)\na = Object left of ego by 2\nb = Object ahead of ego by 2, with length 3\nparam a = a.position, b = b.position",
            {"from-side": "(-3, 0) and (0, 4)"},
        ),
    ),
    Reading(
        id="optional-unknown",
        kind="silence",
        question="Does `Point on road` have a heading, which `on road` specifies optionally and Point does not define?",
        places=('Section "Semantics of Expressions": "together with any properties specified by any of the specifiers"', 'Algorithm 1, line '
            '"filter"'),
        alternatives={"extend": "yes: P holds every property that any specifier specifies", "ignore": "no: optional specifications of unknown "
            "properties lapse"},
        profiles={"scenic-2.1": "ignore"},
        consequence="It remains a Point: it cannot be used as a heading, and its visible region is a disc.",
        code=("semantics.object_definitions.conclude_arguments", "semantics.resolution.resolve_specifiers"),
        probe=Probe(
            "F = VectorField('F', lambda p: 1.5)\nR = PolygonalRegion([(-3, -3), (3, -3), (3, 3), (-3, 3)], orientation=F)\n"
            "ego = Object at (0, 0)\np = Point in R\nparam heading = p.heading",
            {"extend": "1.5", "ignore": "UncaughtException, an AttributeError"},
        ),
    ),
    Reading(
        id="field-dependency",
        kind="silence",
        question="On what does `facing H relative to F` depend?",
        places=(
            'Figure "Heading operators": uses self.position',
            'Section "Basic Scenarios": "automatically uses the position of the Car being defined"; Table "Specifiers for heading": `facing '
            'heading` has no '
            "dependencies",
        ),
        alternatives={
            "position": "an expression that mentions a vector field relative to a heading or field depends on the position of the object being "
            "specified; "
            "outside a specifier or default value it is an error",
        },
        consequence="`Car left of (0, 0), facing 10 deg relative to roadDirection` is cyclic.",
        code=("semantics.object_definitions.waits_for_position", "semantics.operations.specified_object"),
        probe=Probe(
            "F = VectorField('F', lambda p: p.x)\nego = Object at (0, 0)\nother = Object facing 0.25 relative to F, at (1, 5)\n"
            "param heading = other.heading",
            {"position": "1.25; with `left of (1, 5)` CyclicDependencies, rule R-Cyclic; `x = 0.25 relative to F` a RunError, rule "
                "O-RelativeTo-HeadingField"},
        ),
    ),
    Reading(
        id="follow",
        kind="silence",
        question="Is there an operator `follow F from V for S`?",
        places=(
            OPERATORS + " (absent)",
            'Figure "OrientedPoint operators" (defined); Figure "Helper function for creating a platoon starting from a given car" (used)',
        ),
        alternatives={"appendix": "yes, as the appendix defines it, with N = 4 Euler steps"},
        consequence="N is a setting of the machine; each step has length S / N along the field at its start.",
        code=("semantics.operators.follow", "semantics.geometry.forward_euler"),
        probe=Probe(
            "F = VectorField('F', lambda p: 90 deg if p.y >= 1 else 0)\nego = Object at (0, 0)\np = follow F for 4\n"
            "param position = p.position, heading = p.heading",
            {"appendix": "(-3, 1) and π/2"},
        ),
    ),
    Reading(
        id="region-sampling",
        kind="silence",
        question="What is a uniformly random point in a polyline, in a set of points, in an empty region?",
        places=(NOTATION + ": uniformPointIn(R)",),
        alternatives={"measure": "uniform by length; uniform by count; there is none: the run is stuck, with the reason kept for the report"},
        consequence="An intersection that happens to be empty discards the run instead of ending the program.",
        code=("semantics.regions.PolylineRegion", "semantics.regions.PointSetRegion", "semantics.distributions.PointIn"),
        probe=Probe(
            "p = Point in PolylineRegion([(0, 0), (1, 0), (1, 3)])\nego = Object at p",
            {"measure": "P(y = 0) = 1/4; `Point in nowhere` is stuck with a requirement of kind `region`"},
        ),
    ),
    Reading(
        id="visible-clip",
        kind="silence",
        question="Is the point of `visible` restricted to the workspace?",
        places=('Figure "Semantics of position specifiers": visible from P = uniformPointIn(visibleRegion(P))', STEP_2),
        alternatives={"no": "no: it is uniform in the visible region; containment is a later requirement, and only for Objects"},
        consequence="Points made with `visible` may lie outside the workspace.",
        code=("semantics.specifiers.visible_from",),
        probe=Probe(
            "workspace = Workspace(RectangularRegion((0, 0), 0, 2, 2))\nego = Object at (0, 0), with viewDistance 2\np = Point visible\n"
            "param inside = p in workspace",
            {"no": "P(inside) = 1 / π = 0.3183..., not 1"},
        ),
    ),
    Reading(
        id="region-contained",
        kind="silence",
        question="What does the property `regionContainedIn` do?",
        places=('Table "Properties of the built-in classes": "region object must be contained in"', STEP_2 + ": speaks of the workspace only"),
        alternatives={"both": "containment is checked in the workspace, and also in that region where the property is not None"},
        consequence="It tightens the default requirement and never replaces it.",
        code=("semantics.termination.premises_of_step_two", "semantics.termination.contained_in"),
        probe=Probe(
            "x = Range(0, 4)\nego = Object at (0, 0)\nother = Object at (x, 9), with x x, with regionContainedIn RectangularRegion((0, 9), 0, 5, 5)\n"
            "workspace = Workspace(RectangularRegion((2, 2), 0, 30, 30))",
            {"both": "x <= 2 always: P(x < 1) = 1/2, not 1/4"},
        ),
    ),
    Reading(
        id="touching",
        kind="silence",
        question="Do bounding boxes that touch intersect?",
        places=(STEP_2 + ": boundingBox(o_i) ∩ boundingBox(o_j) = ∅", NOTATION + ': boundingBox(O) is the "set of points in the bounding box"'),
        alternatives={"collide": "yes: boxes are closed sets", "allow": "no: two boxes collide where one reaches into the inside of the other"},
        consequence="Under `collide` the paper's `left of Object` without `by` never gives a scene, since it puts the boxes side by side.",
        code=("semantics.termination.check_default_requirements", "semantics.geometry.boxes_intersect"),
        probe=Probe(
            "ego = Object at (0, 0)\nObject left of ego",
            {"collide": "stuck always, at a requirement of kind `collision`", "allow": "accepted always"},
        ),
    ),
    Reading(
        id="mutate-all",
        kind="silence",
        question="Which objects does `mutate` without a list mutate?",
        places=('Section "Statements", "Mutation": "every Object, if no list is given"', 'Figure "Semantics of statements", rule "Mutations"'),
        alternatives={"existing": "every Object that exists when the statement runs"},
        consequence="Objects created after it are not mutated.",
        code=("semantics.statements.conclude_mutate",),
        probe=Probe("ego = Object at (0, 0)\nmutate by 2\nObject at (20, 0)", {"existing": "mutation scales 2 and 0"}),
    ),
    Reading(
        id="mutate-copies",
        kind="silence",
        question="Do points and properties computed from an object before mutation move with it?",
        places=(STEP_1,),
        alternatives={"no": "no: the rule updates only position and heading of the members of O"},
        consequence="An object placed `ahead of` a mutated one keeps its place; velocity keeps its direction.",
        code=("semantics.termination.apply_noise",),
        probe=Probe("ego = Object at (0, 0)\np = front of ego\nmutate ego\nparam front = p.position", {"no": "(0, 0.5), whatever the noise"}),
    ),
    Reading(
        id="zero-stddev",
        kind="silence",
        question="What is Normal(0, 0), which Step 1 draws for every object that is not mutated?",
        places=(STEP_1, 'Section "Semantics of Scenic", "Mutation": "objects with nonzero mutationScale"'),
        alternatives={"point-mass": "a point mass at 0: no draw, probability 1"},
        consequence="Traces of programs without `mutate` hold no draws of noise.",
        code=("semantics.termination.mutate_objects",),
        probe=Probe(
            "ego = Object at (1, 2), facing 3 deg, with positionStdDev 0, with headingStdDev 0\nother = Object at (9, 9)\nmutate ego",
            {"point-mass": "ego stays at (1, 2), facing 3 deg, other at (9, 9)"},
        ),
    ),
)
