"""Readings that were found when the language was looked at a second time."""

from __future__ import annotations

from .reading import Probe, Reading

PROCEDURE = 'Section "Semantics of Scenic", "Dynamic Constructs"'
DATA_TYPES = 'Section "Data Types"'

SECOND_LOOK: tuple[Reading, ...] = (
    Reading(
        id="terminate-who",
        kind="conflict",
        about="policy",
        question="Which scenario does `terminate` in a monitor end?",
        places=(
            PROCEDURE + ', step 3: run the monitors of all running scenarios; "set the terminate flag" if one terminates, that of step 1',
            'Section "Dynamic Scenarios", "Terminating the Scenario": "to end the scenario immediately", which in a scenario of its own is that one',
        ),
        alternatives={
            "scenario": "that which declares the monitor, at once; the top-level one by the flag",
            "simulation": "the whole simulation, whichever scenario declares the monitor: there is one flag",
        },
        profiles={"formal": "simulation", "scenic-3": "simulation"},
        consequence="Under both, `terminate` in the compose block of a sub-scenario ends that one, and in a behavior the top-level scenario.",
        code=("semantics.dynamics.policy.ended_by_monitor",),
        probe=Probe(
            "scenario Sub():\n    setup:\n        monitor End:\n            wait\n            terminate\n"
            "scenario Main():\n    setup:\n        ego = Object at (0, 0)\n    compose:\n        do Sub()\n        wait\n        wait",
            {"scenario": "Main goes on after Sub has ended, for two more time steps", "simulation": "it ends with Sub"},
        ),
    ),
    Reading(
        id="invalid-parameters",
        kind="silence",
        question="What becomes of a run in which a distribution gets parameters that it has not, such as a negative standard deviation?",
        places=('Figure "Semantics of expressions", rule "Distributions": its premise is v in dom baseDist(theta); for such a theta none fires',),
        alternatives={
            "error": "an error of the program, at the distribution, that says which parameter is wrong",
            "stuck": "no rule applies: the run is stuck and discarded, as if a requirement had failed there",
        },
        profiles={"formal": "stuck"},
        consequence="Under `stuck` random parameters are conditioned on being parameters: Normal(0, Range(-1, 1)) draws its deviation from [0, 1].",
        code=("semantics.draws.invalid", "semantics.termination.mutate_objects"),
        probe=Probe(
            "ego = Object at (0, 0)\nd = Uniform(-1, 1, 2)\nx = Normal(0, d)\nparam d = d",
            {"error": "RunError, rule E-Distributions", "stuck": "d is 1 or 2, with probability 1/2 each"},
        ),
    ),
    Reading(
        id="pairs",
        kind="silence",
        question="Is `(X, Y)` a vector where no specifier or operator of Scenic asks for one?",
        places=(DATA_TYPES + ', "Vectors": written (X, Y)', 'Section "Syntax of Scenic": Python is inherited, in which this is a tuple'),
        alternatives={
            "vector": "yes, if both are scalars and an operation of vectors is asked for: members `.x` and `.y`, sums and differences of two, "
            "products and quotients with a scalar, equality with a vector",
            "tuple": "no: it has no members `.x` and `.y`, and `+` puts tuples together",
        },
        profiles={"scenic-2.1": "tuple", "scenic-3": "tuple"},
        consequence="Displays of two scalars remain tuples in every other respect: they can be indexed, unpacked, hashed and iterated over.",
        code=("semantics.expressions.conclude_binary", "semantics.expressions.get_host_attribute"),
        probe=Probe(
            "ego = Object at (0, 0)\nparam s = [*((1, 2) + (3, 4))], t = [*((1, 2) * 2)]",
            {"vector": "[4, 6] and [2, 4]", "tuple": "[1, 2, 3, 4] and [1, 2, 1, 2]"},
        ),
    ),
    Reading(
        id="set-order",
        kind="silence",
        question="In which order is a set iterated over, and what are `hash(v)` and the text of an instance?",
        places=('Section "Syntax of Scenic": Python is inherited, in which all three depend on the process',),
        alternatives={
            "insertion": "in the order in which the elements came; a hash depends on the value alone, and what has no value of its own has none; "
            "texts name no address",
        },
        consequence="A scene is a function of the program, the seed and its number.",
        code=("semantics.sets.Set", "semantics.library.hash_of", "semantics.texts.represented"),
        probe=Probe(
            "ego = Object at (0, 0)\nparam fruit = list({'pear', 'apple', 'plum', 'apple'})", {"insertion": "pear, apple, plum, in every process"},
        ),
    ),
    Reading(
        id="workspace-value",
        kind="silence",
        question="What may `workspace` be, and when is it read?",
        places=('Figure "Semantics of statements", Termination, Step 2: boundingBox(o_i) in workspace', DATA_TYPES + ', "Regions"'),
        alternatives={
            "region": "any region, `Workspace(region)` being the same set of points; Step 2 reads what the variable holds when the program has "
            "ended, in whichever module it was assigned; without an assignment it is the plane",
        },
        consequence="An object that was made before `workspace` was assigned must lie in it as well.",
        code=("semantics.termination.workspace_of",),
        probe=Probe(
            "x = Uniform(0, 9)\nego = Object at (x, 0)\nworkspace = CircularRegion((0, 0), 3)\nparam x = x", {"region": "x is 0 in every scene"},
        ),
    ),
    Reading(
        id="combined-orientation",
        kind="silence",
        question="Which preferred orientation has an intersection of regions, such as `visible curb`?",
        places=('Figure "Notation": "preferred orientation of R if any"; Figure "Region operators": R intersected with visibleRegion(P)',),
        alternatives={"first": "that of the first region if it has one, else that of the second"},
        consequence="`on visible curb` gives a heading, as the paper's listings need.",
        code=("semantics.regions.combined.IntersectionRegion",),
        probe=Probe(
            "field = VectorField('f', lambda p: 0.5)\nroad = PolygonalRegion([(-9, 1), (9, 1), (9, 9), (-9, 9)], orientation=field)\n"
            "ego = Object at (0, 0), with viewDistance 9\nspot = OrientedPoint on visible road\nparam h = spot.heading",
            {"first": "0.5, the heading of the road"},
        ),
    ),
    Reading(
        id="point-set",
        kind="silence",
        question="Does a point that is listed twice in a set of points count twice?",
        places=('Figure "Notation": uniformPointIn(R) is uniform on R, a set', DATA_TYPES + ', "Regions"'),
        alternatives={"once": "once: it is a set"},
        consequence="Weights are given by `Discrete`, not by repetition.",
        code=("semantics.regions.curves.PointSetRegion",),
        probe=Probe(
            "p = PointSetRegion('p', [(0, 0), (0, 0), (0, 0), (4, 0)])\nego = Object in p", {"once": "P(x = 4) = 1/2"},
        ),
    ),
    Reading(
        id="boundaries",
        kind="silence",
        question="Where is the boundary of a closed set, when numbers are rounded?",
        places=(DATA_TYPES + ', "Regions": sets of points of the plane', 'Figure "Notation": Disc and Sector; Figure "Boolean operators"'),
        alternatives={"tolerance": "what comes within 1e-8 m of it is in it, or meets it; a sector that lacks 1e-8 rad of a full turn is a disc"},
        consequence="A point on an edge, as written, is in the set however it was computed. Comparisons of numbers remain exact.",
        code=("semantics.boundaries.widened", "semantics.geometry.wedge_contains", "semantics.geometry.boxes_intersect"),
        probe=Probe(
            "ego = Object at (0, 0), with viewAngle 90 deg\nparam on = ego can see (1, 1), beside = ego can see (1, 0.999)",
            {"tolerance": "True and False"},
        ),
    ),
)
