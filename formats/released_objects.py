"""Objects of scenes under the names of the released implementations: for `compat`."""

from __future__ import annotations

from ..semantics.space import geometry
from ..semantics.space.vectors import Vector
from .scenes import SceneObject


class Object:
    """An object of a scene: its properties are attributes."""

    def __init__(self, object_: SceneObject, to_box: bool) -> None:
        self._object = object_
        self._to_box = to_box

    def __getattr__(self, name: str) -> object:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in ("x", "y") and name not in self._object.properties:
            return getattr(self._object.position, name)
        if name == "visibleDistance" and name not in self._object.properties:
            name = "viewDistance"
        try:
            return self._object[name]
        except KeyError:
            raise AttributeError(f"{self!r} has no property {name}") from None

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
