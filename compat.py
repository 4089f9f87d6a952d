"""The names of the released implementations for the few calls that most scripts make.

    import scenic_ref.compat as scenic

    scenario = scenic.scenarioFromFile("crossing.scenic", params={"weather": "rain"})
    scene, iterations = scenario.generate(maxIterations=1000)
    print(scene.egoObject.position, scene.params["weather"])

Programs are read in dialect `scenic-3`, or in `scenic-2.1` if they make no object by `new` (the comment `# dialect: NAME` in the first
line decides), under the profile of the same name. Random numbers come from a seed that Python's `random` gives when the scenario is made,
so that `random.seed(S)` before it makes a script repeatable.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping
from pathlib import Path

from .api import Scenario as OurScenario
from .api import loads
from .data.scene import Scene as OurScene
from .data.scene import SceneObject
from .interpreter.language.dialects import MARK
from .interpreter.language.modules import read_text
from .interpreter.language.parser import parse
from .semantics.machine.values import Random
from .semantics.space import geometry
from .semantics.space.regions import Region
from .semantics.space.vectors import Vector
from .semantics.store.errors import AttemptsExhausted, ParseError, ScenicError, UsageError
from .semantics.store.scopes import descendants
from .semantics.syntax.expressions import ObjectDefinition, ObjectOrOperator


class Position(Vector):
    """A vector with the methods of the released implementations."""

    __slots__ = ()

    def distanceTo(self, other: Object | Vector | tuple[float, float]) -> float:
        """The distance to a position in metres, or to an object as that measures it."""
        return other.distanceTo(self) if isinstance(other, Object) else geometry.distance(self, position_of(other))

    def angleTo(self, other: Object | Vector | tuple[float, float]) -> float:
        """The heading from here to a position or to that of an object, in radians anticlockwise from North."""
        return geometry.angle_of(position_of(other) - self)

    def __eq__(self, other: object) -> bool:
        return Vector(self.x, self.y) == (Vector(other.x, other.y) if isinstance(other, Vector) else other)

    __hash__ = Vector.__hash__


def object_of(object_: SceneObject, to_box: bool) -> Object:
    """The object, of a class that has the name of its class in the program."""
    return type(object_.class_name, (Object,), {})(object_, to_box)


class Object:
    """An object of a scene: its properties are attributes."""

    def __init__(self, object_: SceneObject, to_box: bool) -> None:
        self._object = object_
        self._to_box = to_box

    def __reduce__(self) -> tuple[object, ...]:
        return object_of, (self._object, self._to_box)

    def __getattr__(self, name: str) -> object:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in ("x", "y") and name not in self._object.properties:
            return getattr(self._object.position, name)
        if name == "visibleDistance" and name not in self._object.properties:
            name = "viewDistance"
        try:
            value = self._object[name]
        except KeyError:
            raise AttributeError(f"{self!r} has no property {name}") from None
        return Position(value.x, value.y) if isinstance(value, Vector) else value

    @property
    def corners(self) -> tuple[Vector, ...]:
        """The four corners, from the front right one on, anticlockwise."""
        return geometry.corners(self._object.position, self._object.heading, self._object.width, self._object.length)

    def distanceTo(self, point: Object | Vector | tuple[float, float]) -> float:
        """The distance between the positions, in metres; by the reading `distance-method` from the box of this object."""
        o, to = self._object, position_of(point)
        return geometry.distance_to_box(o.position, o.heading, o.width, o.length, to) if self._to_box else geometry.distance(o.position, to)

    def containsPoint(self, point: Object | Vector | tuple[float, float]) -> bool:
        """Whether the point is in the box of the object."""
        o = self._object
        return bool(geometry.box_contains(o.position, o.heading, o.width, o.length, position_of(point)))

    def __repr__(self) -> str:
        return f"<{self._object.class_name} {self._object.name or self._object.id}>"


def position_of(point: Object | Vector | tuple[float, float]) -> Vector:
    """The position of an object, or what is one."""
    x, y = point._object.position if isinstance(point, Object) else point
    return Vector(x, y)


__all__ = [
    "InvalidScenarioError", "Object", "RejectionException", "Scenario", "Scene", "ScenicSyntaxError", "Vector",
    "scenarioFromFile", "scenarioFromString",
]  # fmt: skip

InvalidScenarioError = ScenicError
"""What is wrong with a program; see `scenic_ref.errors` for the kinds."""
ScenicSyntaxError = ParseError


class RejectionException(Exception):
    """No scene was found in `maxIterations` runs."""


class Scene:
    """A scene under the released names; `scene` is ours."""

    def __init__(self, scene: OurScene, readings: Mapping[str, str]) -> None:
        self.scene = scene
        self.objects = tuple(object_of(o, readings["distance-method"] == "box") for o in scene.objects)

    @property
    def egoObject(self) -> Object | None:
        """The object from whose point of view the scene is, if there is one."""
        return None if self.scene.ego_id is None else self.objects[self.scene.ego_id]

    @property
    def params(self) -> dict[str, object]:
        """The global parameters of the scene."""
        return dict(self.scene.params)

    @property
    def workspace(self) -> Region:
        """The region in which all objects lie."""
        return self.scene.workspace

    def show2D(self, zoom: object = None, block: bool = True) -> None:
        """Show the scene from above, by matplotlib."""
        import io

        data = self.scene._repr_png_()
        import matplotlib.pyplot as plt

        plt.imshow(plt.imread(io.BytesIO(data)))
        plt.axis("off")
        plt.show(block=block)

    show = show2D


class Scenario:
    """A scenario under the released names; `scenario` is ours."""

    def __init__(self, scenario: OurScenario) -> None:
        self.scenario = scenario
        self.seed = random.getrandbits(63)
        self.index = 0

    @property
    def params(self) -> dict[str, object]:
        """The global parameters at the end of a run, with the distributions of those that are drawn. Raises `AttemptsExhausted`."""
        found = self.scenario.last_state(lambda outcome, drawn: None).params
        return {name: value.origin.distribution or value if isinstance(value, Random) else value for name, value in found.items()}

    def generate(self, maxIterations: float = 2000, verbosity: int = 0, feedback: object = None) -> tuple[Scene, int]:
        """The next scene, and in how many runs it was found. Raises `RejectionException` if there is none among `maxIterations` runs."""
        scenes, attempts = self.generateBatch(1, maxIterations, 0, feedback)
        if verbosity >= 1:
            print(f"Generated scene in {attempts} iterations.")
        return scenes[0], attempts

    def generateBatch(
        self, numScenes: int, maxIterations: float = float("inf"), verbosity: int = 0, feedback: object = None
    ) -> tuple[list[Scene], int]:
        """So many scenes, and in how many runs they were found together; as `generate`."""
        if feedback is not None:
            raise UsageError("there is no sampler here that takes feedback")
        start, self.index = self.index, self.index + numScenes
        most = int(min(maxIterations, 2**62))
        try:
            scenes = list(self.scenario.sample_many(numScenes, self.seed, start=start, max_attempts=most))
        except AttemptsExhausted as problem:
            raise RejectionException(f"failed to generate scenario in {maxIterations} iterations: {problem.message}") from None
        return [Scene(scene, self.scenario.readings) for scene in scenes], sum(scene.attempts for scene in scenes)

    def conditionOn(self, scene: Scene | None = None, objects: Iterable[int] = (), params: Mapping[str, object] | None = None) -> None:
        """From now on, the given objects are as in the scene, and the parameters have these values: as `Scenario.condition_on` says."""
        wanted = list(objects)
        self.scenario = self.scenario.condition_on(scene.scene if scene and wanted else None, objects=wanted or None, params=params)


def scenarioFromString(
    string: str, params: Mapping[str, object] | None = None, model: str | None = None, scenario: str | None = None, *, filename: str = "<string>",
    mode2D: bool = True, trust: bool = False, directory: Path | None = None,
) -> Scenario:
    """The scenario of a program text. Raises `ScenicSyntaxError`, and `UsageError` for three dimensions."""
    if not mode2D:
        raise UsageError("this reference is two-dimensional", hint="leave out mode2D=False")
    dialect = dialect_of(string, filename)
    made = loads(
        string, file=filename, dialect=dialect, params=params, model=model, scenario=scenario, trust=trust, directory=directory,
    )
    return Scenario(made)


def scenarioFromFile(
    path: str | Path, params: Mapping[str, object] | None = None, model: str | None = None, scenario: str | None = None, *, mode2D: bool = True,
    trust: bool = False,
) -> Scenario:
    """The scenario of a program file; modules next to it can be imported. Raises as `scenarioFromString`."""
    text = read_text(Path(path))
    return scenarioFromString(text, params, model, scenario, filename=str(path), mode2D=mode2D, trust=trust, directory=Path(path).parent)


def dialect_of(text: str, filename: str) -> str:
    """The dialect that the program names; else `scenic-2.1` if it can be read in that one, and makes no object by `new`; else `scenic-3`."""
    mark = MARK.match(text)
    if mark is not None:
        return mark.group(1)
    try:
        newer = parse(text, filename, "scenic-3")
    except ParseError:
        pass
    else:
        nodes = [node for statement in newer.statements for node in descendants(statement)]
        perhaps = {id(node.as_object) for node in nodes if isinstance(node, ObjectOrOperator)}
        if any(isinstance(node, ObjectDefinition) and id(node) not in perhaps for node in nodes):
            return "scenic-3"
    try:
        parse(text, filename, "scenic-2.1")
    except ParseError:
        return "scenic-3"
    return "scenic-2.1"

