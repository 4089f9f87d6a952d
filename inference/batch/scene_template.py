"""Scenes from columns: what the program left at its end, (π, O) with symbols in it, filled in for each row."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...data.scene import OWN_FIELDS, Scene, SceneObject
from ...pictures.map_layers import SiteMap, site_of
from ...semantics.machine.config import State
from ...semantics.machine.values import unwrap
from ...semantics.programs import ego_of
from ...semantics.scenes.default_requirements import workspace_of
from ...semantics.space.geometry import normalise_heading
from ...semantics.space.regions import Region
from ...semantics.space.symbol_seam import NotLifted
from ...semantics.space.vectors import Vector
from .graph import GraphNode
from .row_calls import Columns
from .symbolic import Choice, Opaque, Traced, nodes_in, row_maker, symbols_in


class ObjectTemplate(NamedTuple):
    """An object whose properties may hold symbols; they are plain otherwise."""

    name: str | None
    class_name: str
    properties: dict[str, object]
    made: int


class Template(NamedTuple):
    """A scene with symbols in it."""

    objects: tuple[ObjectTemplate, ...]
    ego_id: int | None
    params: dict[str, object]
    workspace: Region
    pruned: bool = False
    site: SiteMap | None = None

    @property
    def outputs(self) -> list[GraphNode]:
        """The nodes that a scene is made from."""
        return nodes_in([self.params, *(o.properties for o in self.objects)])


def template_of(state: State, *, pruned: bool = False) -> Template:
    """The template of the state at the end of a traced run. Raises `NotLifted` where scenes have no common form."""
    numbers = {instance.number: i for i, instance in enumerate(state.scene)}
    try:
        ego = ego_of(state)
    except AssertionError:
        raise NotLifted("which object is ego is random") from None
    workspace = workspace_of(state)
    if symbols_in(workspace):
        raise NotLifted("the workspace is random")
    objects = tuple(
        ObjectTemplate(state.names.get(i.number), i.class_.name, {n: unwrap(v)[0] for n, v in state.objects[i.number].items()}, i.number)
        for i in state.scene
    )
    params = {n: unwrap(v)[0] for n, v in state.params.items()}
    return Template(objects, None if ego is None else numbers[ego.number], params, workspace, pruned, site_of(state))


def scenes_of(template: Template, columns: Columns, seed: int, indices: np.ndarray, attempts: np.ndarray) -> Iterator[Scene]:
    """The scenes of the rows; `attempts` counts from 0."""
    count = len(indices)
    params = [(name, row_values(value, columns, count)) for name, value in template.params.items()]
    objects = []
    for o in template.objects:
        values = {name: row_values(value, columns, count) for name, value in o.properties.items()}
        position, heading, width, length = (values.pop(name) for name in OWN_FIELDS)
        turned = normalise_heading(np.array(heading, dtype=float)).tolist()  # type: ignore[arg-type, attr-defined]
        objects.append((o, position, turned, width, length, list(values.items())))
    for row in range(count):
        made = tuple(
            SceneObject(
                i, o.name, o.class_name, position[row], heading[row], float(width[row]), float(length[row]), {n: v[row] for n, v in rest}, o.made,  # type: ignore[arg-type]
            )
            for i, (o, position, heading, width, length, rest) in enumerate(objects)
        )
        yield Scene(
            made, template.ego_id, {n: v[row] for n, v in params}, seed, int(indices[row]), int(attempts[row]) + 1, 1.0, template.workspace,
            template.pruned, template.site,
        )


def row_values(value: object, columns: Columns, count: int) -> list[object]:
    """Return the value in each row."""
    match value:
        case Choice() if not symbols_in(value.values):
            return [value.values[k] for k in columns[value.node.number].tolist()]
        case Opaque():
            return list(columns[value.node.number])
        case Traced() if not isinstance(value, Choice):
            return columns[value.node.number].tolist()
        case Vector():
            return [Vector(x, y) for x, y in zip(row_values(value.x, columns, count), row_values(value.y, columns, count), strict=True)]  # type: ignore[arg-type]
        case _ if not symbols_in(value):
            return [value] * count
    needed = {node.number: columns[node.number].tolist() for node in nodes_in(value)}
    made = row_maker(value)
    return [made(lambda node, row=row: needed[node.number][row]) for row in range(count)]
