"""Wrong machines: one fault each, as edits of a copy of the package, with a program whose distribution it changes."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent.parent
PACKAGES = ("semantics", "interpreter", "inference", "api", "sampling", "simulators", "conformance", "testing", "cli")


class Edit(NamedTuple):
    """A piece of text that stands once in a file, and what replaces it."""

    file: str
    old: str
    new: str


class Fault(NamedTuple):
    """What is wrong, how the copy is edited, a program by whose scenes it shows, and vectors that catch it."""

    name: str
    edits: tuple[Edit, ...]
    program: str
    vectors: tuple[str, ...]


FAR = ", with requireVisible False"

FAULTS = (
    Fault(
        "coin per scene",
        (Edit("semantics/scenes/statements.py", 'per_scene = state.reading("soft") == "scene"', "per_scene = True"),),
        "x = Range(0, 1)\nrequire[0.5] x < 0.1\nego = Object with v x\n",
        ("soft-requirement-coin-per-run", "soft-requirements-have-their-own-coins"),
    ),
    Fault(
        "optional specifier beats a non-optional one",
        (Edit("semantics/scenes/resolution.py", "        if name in spec_for_property:\n            continue\n", ""),),
        f"ego = Object at (0, 5), facing Range(0, 1)\nObject left of ego by 2, facing Range(1, 2){FAR}\n",
        ("non-optional-wins-over-optional", "following-with-its-own-heading"),
    ),
    Fault(
        "height for width",
        (
            Edit("semantics/scenes/specifiers.py", "return v + geometry.rotate(Vector(-self.width / 2 - s, 0.0)", "return v + geometry.rotate(Vector(-self.length / 2 - s, 0.0)"),
            Edit("semantics/scenes/specifiers.py", "return _offset_local(op, Vector(-self.width / 2 - s, 0.0))", "return _offset_local(op, Vector(-self.length / 2 - s, 0.0))"),
        ),
        f"ego = Object at (0, 9)\nObject left of (0, 0) by Range(1, 2), with length 4{FAR}\n",
        ("left-of-vector", "left-of-oriented-point-by"),
    ),
    Fault(
        "angle without wrap",
        (
            Edit(
                "semantics/space/geometry.py", "def wedge_contains(heading: float, angle: float, v: Vector) -> bool:\n",
                "def wedge_contains(heading: float, angle: float, v: Vector) -> bool:\n"
                "    return v == Vector(0.0, 0.0) or abs(angle_of(v) - heading) <= angle / 2\n\n\n"
                "def wedge_contains_of_the_paper(heading: float, angle: float, v: Vector) -> bool:\n",
            ),
        ),
        "ego = Object at (0, 0), facing 170 deg, with viewAngle 60 deg, with viewDistance 9\nv = (Range(-5, 5), Range(-5, -1))\n"
        "require ego can see v\nego.v = v\n",
        ("can-see-across-south", "can-see-object-across-south"),
    ),
    Fault(
        "mutation at the statement instead of at the end",
        (
            Edit(
                "semantics/scenes/statements.py",
                '    return finish_statement("S-Mutate", node, stack, state, Change("O", ", ".join(f"{t!r}.mutationScale" for t in targets), scale))\n',
                "    from .termination import apply_termination_rules\n\n    return apply_termination_rules(stack, state)\n",
            ),
            Edit(
                "semantics/dynamics/initial_scenario.py", "    return apply_termination_rules(stack, order_scene_objects(state))\n",
                "    from ..machine.config import PASS, Config\n    from ..machine.outcome import Next\n    from ..scenes.termination import Late\n\n"
                '    return Next("T-Mutate", Config(PASS, (Late(0, 0), stack), state))\n',
            ),
            Edit(
                "semantics/scenes/termination.py", 'return Next("T-Mutate", Config(PASS, (Late(0, frame.since), stack), found._replace(draws=found.draws + 1)))',
                'return Next("T-Mutate", Config(PASS, stack, found._replace(draws=found.draws + 1)))',
            ),
        ),
        "ego = Object at (0, 0)\nmutate ego\nrequire ego.position.x >= 0\n",
        ("noise-comes-at-the-end", "requirement-before-mutation"),
    ),
    Fault(
        "resample draws the parameters again",
        (
            Edit(
                "semantics/machine/draws.py", '    return ask(node, distribution, "E-Distributions", stack, state, f"{constructor.name}(...)")\n',
                '    asked = ask(node, distribution, "E-Distributions", stack, state, f"{constructor.name}(...)")\n'
                "    origin = Origin(node.span, constructor.name, Again(constructor, arguments, distribution))\n"
                "    after = state._replace(draws=state.draws + 1)\n"
                "    return asked._replace(resume=lambda drawn: Config(Value(Random(unwrap(drawn)[0], origin)), stack, after))\n\n\n"
                "class Again:\n"
                "    name, parameters = 'Again', {}\n\n"
                "    def __init__(self, constructor, arguments, distribution):\n"
                "        self.constructor, self.arguments, self.distribution = constructor, arguments, distribution\n\n"
                "    def sample(self, uniform):\n"
                "        drawn = [\n"
                "            a.origin.distribution.sample(uniform) if type(a) is Random and a.origin.distribution is not None else unwrap(a)[0]\n"
                "            for a in self.arguments\n"
                "        ]\n"
                "        try:\n"
                "            return self.constructor.make(*drawn).sample(uniform)\n"
                "        except BadParameters:\n"
                "            return self.distribution.sample(uniform)\n\n"
                "    def log_density(self, value):\n"
                "        return self.distribution.log_density(value)\n\n"
                "    def support(self):\n"
                "        return None\n",
            ),
        ),
        "m = Range(0, 10)\nx = Range(0, m)\ny = resample(x)\nego = Object with v (m, y)\n",
        ("resample-keeps-the-parameters", "resample-keeps-finite-parameters"),
    ),
    Fault(
        "uniform in the bounding box instead of the polygon",
        (
            Edit(
                "semantics/space/regions/point_sampling.py",
                "        return self.point(pick(",
                "        if isinstance(self, TriangleSampler):\n"
                "            low, high = self.triangles.reshape(-1, 2).min(0), self.triangles.reshape(-1, 2).max(0)\n"
                "            return Vector(*(low + (high - low) * [uniform(), uniform()]).tolist())\n"
                "        return self.point(pick(",
            ),
        ),
        "ego = Object in PolygonalRegion([(0, 0), (4, 0), (0, 4)])\n",
        ("in-triangle-is-uniform-in-x", "in-triangle-stays-in-the-triangle"),
    ),
    Fault(
        "a requirement dropped",
        (Edit("semantics/scenes/default_requirements.py", "    return negation(every([*(to_floats(", "    return True or negation(every([*(to_floats("),),
        f"ego = Object at (0, 0)\nObject at (Range(-3, 3), 0){FAR}\n",
        ("collision", "collision-conditions-the-distribution"),
    ),
    Fault(
        "beyond from the wrong point",
        (Edit("semantics/scenes/specifiers.py", "return v1 + geometry.rotate(v2, geometry.angle_of(v1 - v3))", "return v3 + geometry.rotate(v2, geometry.angle_of(v1 - v3))"),),
        f"ego = Object at (0, 0)\nObject beyond (3, 4) by (0, Range(3, 5)) from (0, 1){FAR}\n",
        ("beyond-from", "beyond-ego"),
    ),
    Fault(
        "a degree taken for a radian",
        (Edit("semantics/scenes/operators.py", "    return s * DEGREE\n", "    return s\n"),),
        "ego = Object facing Range(0, 2) deg\n",
        ("range-in-degrees", "local-coordinates"),
    ),
    Fault(
        "a default evaluated once per class",
        (
            Edit(
                "semantics/scenes/object_definitions.py", "    owner = defaults_of(frame.instance.class_, state.settings.readings)[name][1]\n",
                "    owner = defaults_of(frame.instance.class_, state.settings.readings)[name][1]\n"
                "    once = ONCE.get((id(owner), name))\n"
                "    if once is not None:\n"
                '        return assign("P-Default", sp.default_value(name, once[1]), stack, state)\n',
            ),
            Edit(
                "semantics/scenes/object_definitions.py", "    construction, rest = stack\n",
                "    construction, rest = stack\n"
                "    name = construction.specification.specifies[0]\n"
                "    owner = defaults_of(construction.instance.class_, state.settings.readings)[name][1]\n"
                "    if not owner.built_in:\n"
                "        ONCE[id(owner), name] = (owner, result)\n",
            ),
            Edit("semantics/scenes/object_definitions.py", "class Defaulting(NamedTuple):", "ONCE: dict = {}\n\n\nclass Defaulting(NamedTuple):"),
        ),
        "class A:\n    w: Range(0, 1)\nego = A at (0, 0)\nb = A at (0, 5)\n",
        ("default-is-drawn-for-each-object", "default-range-is-drawn-for-each-object"),
    ),
    Fault(
        "a function's default argument drawn anew at every call",
        (
            Edit(
                "semantics/python/functions.py", "            bound[parameter.name] = defaults[parameter.name]\n",
                "            bound[parameter.name] = anew(defaults[parameter.name])\n",
            ),
            Edit(
                "semantics/python/functions.py", "LARGEST_DEPTH = 3_000\n",
                "LARGEST_DEPTH = 3_000\nSOURCE = __import__('random').Random(5)\n\n\n"
                "def anew(default):\n"
                "    distribution = getattr(getattr(default, 'origin', None), 'distribution', None)\n"
                "    return default if distribution is None else type(default)(distribution.sample(SOURCE.random), default.origin)\n",
            ),
        ),
        "def f(x=Range(0, 1)):\n    return x\nego = Object with v (f(), f())\n",
        ("default-argument-is-drawn-once", "reading-default-arguments"),
    ),
    Fault(
        "weights of Discrete normalised wrongly",
        (
            Edit(
                "semantics/space/distributions/families.py", "        return [float(part / sums[-1]) for part in sums]\n",
                "        return [*(min(1.0, float(part / len(sums))) for part in sums[:-1]), 1.0]\n",
            ),
            Edit(
                "semantics/space/distributions/families.py", "        total = sum(weights)\n",
                "        weights = [min(Fraction(1), weight / len(weights)) for weight in weights[:-1]]\n"
                "        weights.append(max(Fraction(0), 1 - sum(weights)))\n"
                "        total = sum(weights)\n",
            ),
        ),
        "ego = Object with v Discrete({1: 1, 2: 3})\n",
        ("discrete-with-weights", "discrete-weights-below-one"),
    ),
)


def wrong_machine(fault: Fault, folder: Path) -> Path:
    """A copy of the package with the fault in it; the folder to put on the path."""
    home = folder / "scenic_ref"
    for name in PACKAGES:
        shutil.copytree(ROOT / name, home / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("__init__.py", "__main__.py"):
        shutil.copy(ROOT / name, home / name)
    for file, old, new in fault.edits:
        text = (home / file).read_text()
        assert text.count(old) == 1, f"{fault.name}: the text to replace stands {text.count(old)} times in {file}"
        (home / file).write_text(text.replace(old, new))
    return folder
