"""Objects of scenes under the names of the released implementations: for `compat`."""

from __future__ import annotations

from ..semantics.space import geometry
from ..semantics.space.vectors import Vector
from .scenes import SceneObject


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
