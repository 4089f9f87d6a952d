"""The paper's types of operands: which values count as a scalar, vector, heading, field, region, point, object.

`Point` and `OrientedPoint` are automatically interpreted as vectors or headings in contexts expecting these (paper,
Section "Data Types"). A `Reader` makes these interpretations and remembers whether anything it read was random.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from numbers import Real
from typing import Any, NamedTuple

from ..space.fields import VectorField
from ..space.numeric_functions import is_finite_number, to_floats
from ..space.regions import PlaneShape, Region
from ..space.symbol_seam import NotLifted, Spread, Symbol
from ..space.vectors import Vector
from ..store.budget import PLAIN
from ..store.built_in_classes import view_distance
from ..store.errors import RunError
from ..store.postponed_values import Waiting
from ..store.scenic_classes import ScenicClass
from ..store.scopes import descendants
from ..store.suggestions import did_you_mean
from ..syntax.nodes import NOWHERE, Node, Span
from ..syntax.python_expressions import Call, Name
from ..syntax.statements import Return
from .config import State
from .values import Dynamic, Function, Instance, Origin, Random, each, unwrap, value_in_run, wrap

SCALAR, VECTOR, HEADING, FIELD, REGION = "scalar", "vector", "heading", "vector field", "region"
POINT, ORIENTED_POINT, OBJECT = "Point", "OrientedPoint", "Object"


class OrientedPointAt(NamedTuple):
    """The value OrientedPoint(position, heading) of the paper's equations; heading None stands for ⊥."""

    position: Vector
    heading: float | None


class View:
    """The properties of an instance as an equation reads them: `view.position`, `view.heading`, ... with no randomness left."""

    __slots__ = ("instance", "reader")

    def __init__(self, instance: Instance, reader: Reader) -> None:
        self.instance = instance
        self.reader = reader

    @property
    def position(self) -> Vector:
        """The position, in metres."""
        return self.reader.property(self.instance, "position")  # type: ignore[return-value]

    @property
    def heading(self) -> float:
        """Radians anticlockwise from North."""
        return self.reader.property(self.instance, "heading")  # type: ignore[return-value]

    @property
    def width(self) -> float:
        """Metres, along the local x axis; 0 for a Point, which has none (reading `point-size`)."""
        return self.reader.size(self.instance, "width")

    @property
    def length(self) -> float:
        """Metres, along the local y axis (`height` in the appendix: reading `height`); 0 for a Point."""
        return self.reader.size(self.instance, "length")

    @property
    def view_distance(self) -> float:
        """Metres (reading `view-distance`)."""
        return self.reader.property(self.instance, view_distance(self.reader.state.settings.readings))  # type: ignore[return-value]

    @property
    def view_angle(self) -> float:
        """The view angle, in radians."""
        return self.reader.property(self.instance, "viewAngle")  # type: ignore[return-value]

    @property
    def is_oriented(self) -> bool:
        """Whether the instance is an OrientedPoint, not only a Point."""
        return is_oriented(self.instance)


class Reader:
    """Interprets values as the kinds that an equation expects; `origin` is that of the first random thing it met."""

    __slots__ = ("origin", "state")

    def __init__(self, state: State) -> None:
        self.state = state
        self.origin: Origin | None = None

    def plain(self, value: object) -> object:
        """The value with no randomness inside."""
        result, origin = unwrap(value)
        self.origin = self.origin or origin
        return result

    def property(self, instance: Instance, name: str) -> object:
        """Return O(instance.name) without randomness."""

        def of_one(instance: Instance) -> object:
            return self.plain(self.state.objects[instance.number][name])

        return each(of_one, instance)

    def size(self, instance: Instance, name: str) -> float:
        """O(instance.width) or O(instance.length), 0 where the instance has none."""

        def of_one(instance: Instance) -> object:
            return self.plain(self.state.objects[instance.number].get(name, 0.0))

        return each(of_one, instance)

    def wrap(self, value: object) -> object:
        """`value` marked random if anything read was."""
        return wrap(value, self.origin)

    def read(self, value: object, kind: str) -> object:
        """The plain value as the given kind; the caller knows that it is one (`has_kind`)."""
        match kind:
            case "vector":
                return each(self.vector, value)
            case "heading":
                return to_floats(value if is_scalar(value) else each(self.heading, value))
            case "Point" | "OrientedPoint" | "Object":
                return View(value, self)  # type: ignore[arg-type]
            case "scalar":
                return value
            case _:
                return value

    def heading(self, value: Instance) -> object:
        """Return the heading of an OrientedPoint."""
        return self.property(value, "heading")

    def vector(self, value: object) -> Vector:
        """A vector, a pair of scalars or a Point as a vector."""
        if isinstance(value, Vector):
            return value
        if isinstance(value, Instance):
            return self.property(value, "position")  # type: ignore[return-value]
        x, y = value  # type: ignore[misc]
        return Vector(to_floats(x), to_floats(y))


def is_scalar(value: object) -> bool:
    """Whether the value is a number (truth values are not)."""
    if isinstance(value, bool):
        return False
    return isinstance(value, Real) or (isinstance(value, Symbol) and value.always(is_scalar))


def is_pair(value: object) -> bool:
    """Whether the value is a tuple of two scalars."""
    inner = value_in_run(value)
    if type(inner) in PLAIN:
        return False
    if isinstance(inner, Symbol):
        return inner.always(is_pair)
    return type(inner) is tuple and len(inner) == 2 and all(is_scalar(value_in_run(part)) for part in inner)  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]


def is_a(value: object, kind: type) -> bool:
    """Whether a value that is not wrapped is of a class; one that differs from run to run, in every run."""
    if not isinstance(value, Symbol):
        return isinstance(value, kind)
    try:
        return value.always(lambda one: is_a(one, kind))
    except NotLifted:
        return False


def always(predicate: Callable[[Any], bool], value: object) -> bool:
    """Whether the predicate, about its type and the like, holds of a value that is not wrapped, in every run. Raises `NotLifted` if that differs."""
    return value.always(predicate) if isinstance(value, Symbol) else predicate(value)


def symbolic_items(container: object) -> list[object] | None:
    """Return a stand-in for the items of a container that differs from run to run, among which a distribution
    chooses; None for any other container.
    """
    return [Spread(container)] if isinstance(container, Symbol) else None


def cases(value: object) -> Sequence[tuple[object, object]] | None:
    """The values of something that differs from run to run, each with its condition; None for any other. Raises `NotLifted` for too many."""
    return value.cases() if isinstance(value, Symbol) else None


def of_cases(value: Any, results: Sequence[object], *, drawn: bool) -> object:
    """Combine the results of the `cases` of a value. Raises `NotLifted` if there were draws, whose numbers
    depend on the case.
    """
    if drawn:
        raise NotLifted("a function with draws, or with `and` or `or` of something random, filters a container that differs from run to run")
    return value.of_cases(results)


def may_be_none(value: object) -> bool:
    """Whether a value that is not wrapped is None, or may be in some run."""
    return value is None or isinstance(value, Symbol)


def is_vector(value: object) -> bool:
    """Whether the value is a vector, not a pair or a point."""
    return value.always(is_vector) if isinstance(value, Symbol) else isinstance(value, Vector)


def is_sequence(value: object) -> bool:
    """Whether the value is a tuple or list."""
    return value.always(is_sequence) if isinstance(value, Symbol) else isinstance(value, (tuple, list))


def is_oriented(instance: Instance) -> bool:
    """Whether the instance's class is OrientedPoint or below it."""
    return instance.always(is_oriented) if isinstance(instance, Symbol) else instance.class_.built_in_name != "Point"


def is_object(instance: Instance) -> bool:
    """Whether the instance's class is Object or below it, so that it is part of the scene."""
    return instance.class_.built_in_name == "Object"


def has_kind(value: object, kind: str) -> bool:
    """Whether a plain value can be interpreted as the kind."""
    if isinstance(value, Symbol):
        return value.always(lambda one: has_kind(one, kind))
    match kind:
        case "scalar":
            return is_scalar(value)
        case "vector":
            return isinstance(value, (Vector, Instance)) or (
                isinstance(value, (tuple, list)) and len(value) == 2 and is_scalar(value[0]) and is_scalar(value[1])
            )
        case "heading":
            return is_scalar(value) or (isinstance(value, Instance) and is_oriented(value))
        case "vector field":
            return isinstance(value, VectorField)
        case "region":
            return isinstance(value, Region)
        case "Point":
            return isinstance(value, Instance)
        case "OrientedPoint":
            return isinstance(value, Instance) and is_oriented(value)
        case "Object":
            return isinstance(value, Instance) and is_object(value)
        case _:
            raise AssertionError(kind)


def misfit(values: Sequence[object], kinds: Sequence[Sequence[str]]) -> int | None:
    """Which of the values no row of kinds accepts in its place; None if there is not exactly one."""
    wrong = [place for place, value in enumerate(values) if not any(has_kind(value, row[place]) for row in kinds)]
    return wrong[0] if len(wrong) == 1 else None


def unfit(
    name: str, node: Node, nodes: Sequence[Node], operands: Sequence[object], kinds: Sequence[Sequence[str]], rule: str, state: State, hint: str = ""
) -> RunError:  # fmt: skip
    """The error where operands have none of the rows of kinds; it speaks of those that the program wrote at `nodes`, not of what was added."""
    wrong = misfit(operands, kinds)
    written = [i for i in range(len(operands)) if i < len(nodes) and nodes[i].span != NOWHERE] or list(range(len(operands)))
    place = nodes[wrong].span if wrong is not None and wrong in written and wrong < len(nodes) else node.span
    refuse_third_dimension(name, operands, place, rule)
    if wrong is None or wrong not in written:
        expected = " or ".join(dict.fromkeys("(" + ", ".join(row[i] for i in written) + ")" for row in kinds))
        found = ", ".join(kind_name(operands[i]) for i in written)
        hint = hint or ("" if wrong is None else repair(operands[wrong], {row[wrong] for row in kinds}))
        return RunError(f"{name} expects {expected}, not ({found})", place, rule=rule, hint=hint)
    fitting = [row for row in kinds if all(i == wrong or has_kind(operands[i], row[i]) for i in range(len(operands)))] or kinds
    wanted = list(dict.fromkeys(row[wrong] for row in fitting))
    value = operands[wrong]
    if wrong < len(nodes):
        hint = hint or instead_of_point(name, value, wanted) or (function_without_return(nodes[wrong], state) if value is None else "")
    pair = is_pair_of_numbers(value) and VECTOR not in wanted and REGION in wanted
    called, side = named_at(name, wrong, len(written))
    message = f"{called} expects {one_of(wanted)}{side}, not {'a point' if pair else kind_name(value)}"
    return RunError(message, place, rule=rule, hint=hint or repair(value, wanted))


BEHIND: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("`left of`", "`right of`", "`ahead of`", "`behind`", "`offset along`"), ("by",)),
    "`beyond`": ("by", "from"), "`following`": ("for", "from"), "`apparently facing`": ("from",),
}
"""Words behind which the further arguments of specifiers stand."""
INFIX = frozenset({"`@`", "`at`", "`offset by`", "`relative to`", "`can see`"})


def named_at(name: str, number: int, count: int) -> tuple[str, str]:
    """How an operator or specifier is called where its operand of this number, from 0, is meant, and on which side that stands."""
    if count == 2 and name in INFIX:
        return name, " on its right" if number else " on its left"
    words = BEHIND.get(name, ())
    return (f"{name[:-1]} ... {words[number - 1]}`" if 0 < number <= len(words) else name), ""


def one_of(kinds: Sequence[str]) -> str:
    """The kinds with their articles: "a heading or a vector field"."""
    *most, last = [f"{'an' if kind[0] in 'aeiouAEIOU' else 'a'} {kind}" for kind in kinds]
    return f"{', '.join(most)} or {last}" if most else last


def instead_of_point(name: str, value: object, kinds: Collection[str]) -> str:
    """Return a repair for a point that is given as the region of `in` and `on`; "" if there is none."""
    if name not in ("`in`", "`on`") or VECTOR in kinds or not is_pair_of_numbers(value):
        return ""
    x, y = map(str, value) if all(type(c) in (int, float) and -MOST_TOLD < c < MOST_TOLD for c in value) else ("x", "y")  # type: ignore[attr-defined]
    return f"write `at ({x}, {y})`" if max(len(x), len(y)) <= LONGEST_TOLD else "write `at (x, y)`"


MOST_TOLD, LONGEST_TOLD = 1e6, 6
"""Numbers as programs write them are told again; what was computed or drawn is larger, or has more digits."""


def function_without_return(node: Node, state: State) -> str:
    """Return a repair for the function whose call gave None; "" if it is not one of the program that is
    called by its name.
    """
    function = value_in_run(state.sigma.lookup(node.function.name)) if isinstance(node, Call) and isinstance(node.function, Name) else None
    if not isinstance(function, Function) or not isinstance(function.body, tuple) or function.span.file != node.span.file:
        return ""
    name, line = function.name, function.span.line
    if any(isinstance(inner, Return) and inner.value is not None for statement in function.body for inner in descendants(statement)):
        return f"see why {name} (line {line}) gives None: a function that ends without `return` does"
    return f"write `return ...` at the end of {name} (line {line}), which has none"


def is_pair_of_numbers(value: object) -> bool:
    """Return whether the value is a tuple or list of two numbers."""
    return isinstance(value, tuple | list) and len(value) == 2 and all(map(is_scalar, value))


def repair(value: object, kinds: Collection[str]) -> str:
    """Return a repair for a value that is none of the expected kinds; "" if nothing is likely."""
    match value:
        case type() if value in AS_IN_SCENIC:
            return f"did you mean {AS_IN_SCENIC[value]}?"
        case str() if HEADING in kinds:
            return "write an angle without quotation marks, as in `30 deg`"
        case str() if VECTOR in kinds:
            return "write a vector without quotation marks, as in `(1, 2)`"
        case str() if SCALAR in kinds:
            return "write a number without quotation marks"
        case list() | tuple() if REGION in kinds and value and all(isinstance(one, Region) for one in value):
            return "for one of them write `Uniform(*values)`"
        case (_, _) if VECTOR in kinds and (pair := next((one for one in value if is_pair_of_numbers(one)), None)) is not None:
            return f"a coordinate is one number: for a random one write `Range({pair[0]}, {pair[1]})`"
        case (low, high) if SCALAR in kinds and is_scalar(low) and is_scalar(high):
            return f"for a random number write `Range({low}, {high})`" if isinstance(value, tuple) else "for one of them write `Uniform(*values)`"
        case list() if SCALAR in kinds:
            return "for one of them write `Uniform(*values)`"
        case None:
            return OF_NONE
        case _ if VECTOR in kinds and is_scalar(value):
            return "a vector has two coordinates: write `(x, y)`"
        case Vector() | Instance() if REGION in kinds:
            return "a region is a set of points: write `at` for one point, or `CircularRegion(center, radius)`"
        case _ if REGION in kinds and isinstance(instead := getattr(type(value), "as_region", None), str):
            return instead
        case ScenicClass() if OBJECT in kinds or VECTOR in kinds:
            return f"that is the class; name an object of it: x = {value.name} ..."
        case _:
            return ""


OF_NONE = "a function without `return` gives None, and so does a method that changes a list, such as `append`"
AS_IN_SCENIC: Mapping[type, str] = {object: "Object"}
"""Types of Python that are written like a class of Scenic, but for the case."""
SPATIAL = frozenset({
    "BoxRegion", "SpheroidRegion", "MeshRegion", "MeshVolumeRegion", "MeshSurfaceRegion", "PathRegion", "PolygonalFootprintRegion", "VoxelRegion",
    "ViewRegion", "SurfaceCollisionTrimesh", "Shape", "BoxShape", "CylinderShape", "ConeShape", "SpheroidShape", "MeshShape", "Orientation",
})  # fmt: skip
"""Names of the released Scenic 3 for things in space."""
SPATIAL_PROPERTIES: Mapping[str, str] = {
    "yaw": "write `facing A`, or give a default to `heading`", "orientationStdDev": "write `headingStdDev` and the first of the angles",
    "contactTolerance": "write the gap: `left of X by S`", "baseOffset": "write the position itself",
    **dict.fromkeys(("pitch", "roll", "parentOrientation", "orientation"), "leave it out"),
}
"""The properties by which it turns and places things there: what to write for them."""
SPATIAL_ATTRIBUTES = frozenset({"z", *SPATIAL_PROPERTIES})
"""Names of what vectors and objects have there."""
FLAT = "is three-dimensional; this reference is two-dimensional"


INSTEAD_OF_ATTRIBUTES: Mapping[str, str] = {
    **dict.fromkeys(("leftlane", "lanetoleft", "laneleft"), "the lane to the left is that of a section: ego.laneSection.laneToLeft"),
    **dict.fromkeys(("rightlane", "lanetoright", "laneright"), "the lane to the right is that of a section: ego.laneSection.laneToRight"),
    **dict.fromkeys(("pose", "transform"), "an object has a position and a heading"),
    **dict.fromkeys(("location", "loc", "point", "coordinates"), "ask for its position"),
    **dict.fromkeys(("rotation", "angle", "theta", "direction"), "ask for its heading"),
    **dict.fromkeys(("size", "dimensions", "extent"), "an object has a width and a length"),
}
"""Attributes that people expect of objects and lanes, by their letters alone, and what to write for them."""


def no_attribute(subject: str, name: str, known: Iterable[str], what: str = "attribute") -> AttributeError:
    """The exception where a value has no such attribute or property, with the nearest of those that it has."""
    error = AttributeError(f"{subject} has no {what} {name}" + (f", which {FLAT}" if name in SPATIAL_ATTRIBUTES else ""))
    hint = "" if name in SPATIAL_ATTRIBUTES else did_you_mean(name, sorted(known))
    if hint:
        error.add_note(hint)
    if not hint and (instead := INSTEAD_OF_ATTRIBUTES.get(name.lower().replace("_", ""))) is not None:
        error.add_note(instead)
    if subject == "None" and name not in SPATIAL_ATTRIBUTES:
        error.add_note(OF_NONE)
    if name == "yaw":
        error.add_note("ask for its heading")
    return error


INSTEAD_OF_RANDOM: Mapping[str, str] = {
    "uniform": "Range(low, high)", "random": "Range(0, 1)", "randint": "DiscreteRange(low, high)", "randrange": "DiscreteRange(0, n - 1)",
    "choice": "Uniform(*values)", "choices": "Discrete({value: weight, ...})", "gauss": "Normal(mean, stdDev)",
    "normalvariate": "Normal(mean, stdDev)",
}
"""What draws in Scenic as a function of Python's module `random` does."""


def missing_member_error(module: str, member: str, error: Exception, known: Iterable[str]) -> Exception:
    """The error that a module has no such member, with the nearest that it has, or what to write for those of `random`."""
    if module == "random":
        instead = f"write {INSTEAD_OF_RANDOM[member]}" if member in INSTEAD_OF_RANDOM else "draw with Range, Uniform or Normal"
        error.add_note(f"{instead}: what Python draws by itself does not follow from the seed; random.Random(1) does")
    elif hint := did_you_mean(member, known):
        error.add_note(hint)
    return error


def refuse_third_dimension(what: str, operands: Iterable[object], span: Span, rule: str) -> None:
    """Raises `RunError` if one of the operands has three coordinates or angles."""
    for operand in operands:
        if what == "`@`" and isinstance(operand, list):
            hint = "for one of its elements write `Uniform(*values)`"
            raise RunError(f"{what} stands between two numbers, not beside a list", span, rule=rule, hint=hint)
        if isinstance(operand, (tuple, list)) and len(operand) == 3 and all(map(is_scalar, operand)):
            raise RunError(f"{what} is given three numbers, which {FLAT}", span, rule=rule, hint=third_left_out(operand, what))


def in_the_plane(value: object, state: State) -> object:
    """Return three coordinates of which the third is exactly 0 as the first two, in dialect scenic-3; any other value as it is."""
    if state.settings.dialect != "scenic-3" or not isinstance(value, (tuple, list)) or len(value) != 3:
        return value
    third = value[2]
    flat = isinstance(third, (int, float)) and not isinstance(third, bool) and third == 0
    return type(value)(value[:2]) if flat and all(is_scalar(value_in_run(v)) for v in value[:2]) else value


def third_left_out(operand: object, what: str) -> str:
    """Return the repair for three numbers: coordinates, or the angles of an orientation."""
    if what == "`facing`":
        return "write only the first, the yaw"
    return "leave out the third" + ("; for one of the three write `Uniform(*values)`" if isinstance(operand, list) else "")


def kind_name(value: object) -> str:
    """Return the user's name for a value's type."""
    value = value.value if type(value) is Random else value
    if isinstance(value, bool) or value is None:
        return repr(value)
    if isinstance(value, PlaneShape):
        return "a shape"
    if any("scenic_names" in vars(class_) for class_ in type(value).__mro__):  # a part of a road network, say, though it is a region as well
        return f"{'an' if type(value).__name__[0] in 'AEIOU' else 'a'} {type(value).__name__}"
    for kind in (SCALAR, FIELD, REGION):
        if has_kind(value, kind):
            return f"a {kind}"
    if type(value) is Waiting:
        return "a value that waits for a position" if value.missing is None else "a value that waits for a scenario to begin"
    if isinstance(value, Vector):
        return "a vector"
    if isinstance(value, Instance):
        return f"an instance of {value.class_.name}"
    if isinstance(value, str):
        return "a string"
    if isinstance(value, ScenicClass):
        return f"the class {value.name}"
    if isinstance(value, Dynamic):
        return f"the {type(value.definition).__name__.removesuffix('Definition').lower()} {value!r}"
    if isinstance(value, (tuple, list)):
        return f"a {type(value).__name__} of {len(value)}"
    if isinstance(value, Symbol):
        return "a random value"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    return f"a {type(value).__name__}"


def is_finite(value: object) -> bool:
    """Whether a scalar or vector has no NaN or infinity in it."""
    if isinstance(value, Vector):
        return bool(is_finite_number(value.x) and is_finite_number(value.y))
    return bool(is_finite_number(value))
