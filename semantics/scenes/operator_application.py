"""How the machine applies an operator: rewrite it, or reduce its operands and apply the equation for their kinds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ..machine.config import Config, Stack, State, Value, value
from ..machine.host_calls import DoorStuck, HostException
from ..machine.implicit_positions import expression_of, specified_object, specifier_scope, wait
from ..machine.operand_kinds import OrientedPointAt, Reader, has_kind, in_the_plane, is_oriented, unfit
from ..machine.outcome import Next, Outcome, Requirement, Stuck
from ..machine.premises import premises
from ..machine.values import Instance
from ..python.functions import InScope
from ..space.fields import BadField, OutsideField
from ..space.geometry import normalise_heading
from ..space.vectors import Vector
from ..store.built_in_classes import ORIENTED_POINT_CLASS, built_in_defaults, view_distance
from ..store.errors import RunError, ScenicError
from ..store.postponed_values import Waiting
from ..store.scenic_classes import ScenicClass
from ..syntax import expressions as e
from ..syntax.nodes import Node
from . import operators as o
from . import released_forms


def operator(node: Node, stack: Stack, state: State) -> Outcome:
    """Rewrite the operator if its equation is a rewriting, else reduce its operands."""
    rewriting = released_forms.REWRITINGS.get(type(node))
    if rewriting is not None and rewriting.applies(node):
        return Next(rewriting.rule, Config(rewriting.rewrite(node), stack, state), node)
    names, _ = released_forms.EQUATIONS[type(node)]
    return premises(node, [getattr(node, name) for name in names], apply_operator, stack, state)


def side_of(node: e.SideOf, stack: Stack, state: State) -> Outcome:
    """`front of O` and its seven siblings."""
    return premises(node, [node.object], apply_side, stack, state)


def apply_side(node: e.SideOf, values: list[object], stack: Stack, state: State) -> Outcome:
    """Apply the equation of the side."""
    return apply_equation(node, (o.SIDES[node.side],), values, stack, state)


LIKE_SPECIFIERS = (e.FieldAt, e.OffsetBy, e.OffsetAlong)
"""Operators that are written as specifiers are: behind a class, with `new` forgotten, they seem to be one."""


def apply_operator(node: Node, values: list[object], stack: Stack, state: State) -> Outcome:
    """The operands are reduced: choose the equation by their kinds and conclude."""
    return apply_equation(node, released_forms.equations_of(node, state.reading("oriented-offset"), state.reading("angle")), values, stack, state)


def apply_equation(node: Node, equations: Sequence[o.Equation], values: list[object], stack: Stack, state: State) -> Outcome:
    """Conclude with the first equation whose kinds fit; what is random in the operands makes the result random."""
    reader = Reader(state)
    operands = [in_the_plane(reader.plain(v), state) for v in values]
    if state.settings.dialect == "scenic-3" and isinstance(node, LIKE_SPECIFIERS) and isinstance(operands[0], ScenicClass):
        raise RunError("dialect scenic-3 makes objects with `new`", node.span, rule="E-ObjectDefinition", hint="write `new` before the class")
    equation = select(node, equations, operands, state)
    arguments = [reader.read(operand, kind) for operand, kind in zip(operands, equation.kinds, strict=True)]
    if equation.needs_self:
        instance = specified_object(state)
        if instance is None:
            return value("", wait(node, values, apply_operator, state), stack, state, node)
        arguments.append(reader.property(instance, "position"))
    try:
        result = compute(equation.function, arguments, reader)
    except OutsideField as outside:
        requirement = Requirement("field", node.span, outside.premise)
        return Stuck(equation.rule, requirement, Config(Value(reader.wrap(_any_result(node, arguments))), stack, state))
    if isinstance(result, OrientedPointAt):
        point, state = new_oriented_point(result, reader, state)
        return value(equation.rule, point, stack, state, node)
    return value(equation.rule, reader.wrap(result), stack, state, node)


def compute(equation: Callable[..., object], arguments: Sequence[object], reader: Reader) -> object:
    """The right-hand side of an equation; a vector field of the program is called through the door, and what it reads counts."""
    door = reader.state.settings.door
    door.state, door.called, door.origin, door.in_turn, door.operands = reader.state, False, None, False, (equation, *arguments)
    door.budget.versions.given = None if reader.state.may_branch else reader.origin
    try:
        result = equation(*arguments)
    except (OutsideField, ScenicError, HostException, DoorStuck):
        raise
    except BadField as problem:
        raise RunError(str(problem), rule="O-Follow") from None
    except Exception as exception:
        if door.called:
            raise HostException(exception) from exception
        raise
    finally:
        door.budget.versions.given = None
    reader.origin = reader.origin or door.origin
    return result


def _any_result(node: Node, arguments: list[object]) -> object:
    """Some value of the right type for a run that is stuck anyway (see `Stuck.beyond`)."""
    return next((a for a in arguments if isinstance(a, Vector)), Vector(0.0, 0.0)) if isinstance(node, e.OffsetAlong) else 0.0


def select(node: Node, equations: Sequence[o.Equation], operands: list[object], state: State) -> o.Equation:
    """The equation for operands of these kinds; an error names what the operator expects."""
    if isinstance(node, e.RelativeTo) and all(isinstance(v, Instance) and is_oriented(v) for v in operands):
        raise RunError(
            "both sides of `relative to` are oriented points, so it could mean their positions or their headings",
            node.span, rule="O-RelativeTo-Headings", hint="write .position or .heading behind one of them",
        )
    for equation in equations:
        if all(has_kind(v, kind) for v, kind in zip(operands, equation.kinds, strict=True)):
            return equation
    nodes = [node.object] if isinstance(node, e.SideOf) else [getattr(node, name) for name in released_forms.EQUATIONS.get(type(node), ((),))[0]]
    raise unfit(operator_name(node), node, nodes, operands, [q.kinds for q in equations], equations[0].rule, state)


def operator_name(node: Node) -> str:
    """The operator as the user wrote it, for messages."""
    names = {
        e.RelativeHeading: "relative heading of", e.ApparentHeading: "apparent heading of", e.Distance: "distance from ... to",
        e.DistancePast: "distance of ... past", e.Angle: "angle from ... to", e.CanSee: "can see", e.Degrees: "deg", e.FieldAt: "at",
        e.RelativeTo: "relative to", e.VectorOf: "@", e.OffsetBy: "offset by", e.OffsetAlong: "offset along ... by",
        e.VisibleFrom: "visible from",
        e.RelativePosition: "relative position of ... from", e.NotVisible: "not visible", e.Follow: "follow ... from ... for",
    }
    if isinstance(node, e.SideOf):
        return f"`{node.side} of`"
    return f"`{names.get(type(node), type(node).__name__)}`"


class Settling(NamedTuple):
    """Frame: what waited is being reduced for an object (at a time step); `draws` were made before."""

    key: tuple[Waiting, int, int | None]
    draws: int


def reduce_waiting(node: Waiting, stack: Stack, state: State) -> Outcome:
    """Reduce what waited for a position, with the variables of the place where it stands, and the object
    whose position is meant here.
    """
    instance = specified_object(state)
    assert instance is not None
    key = (node, instance.number, None if state.simulation is None else state.simulation.step)
    if key in state.settled:
        return Next("", Config(Value(state.settled[key]), stack, state))
    inner = state._replace(sigma=specifier_scope(instance, node.scope))
    below = (Settling(key, state.draws), (InScope(state.sigma), stack))
    return premises(node.node, list(map(expression_of, node.values)), node.conclude, below, inner)


def resume_settling(frame: Settling, result: object, stack: Stack, state: State) -> Outcome:
    """Keep what was drawn for the object wherever the object mentions it again: an expression is evaluated
    once (paper, Section "Expressions").
    """
    if state.draws != frame.draws:
        now = frame.key[2]
        state = state._replace(settled={**{key: v for key, v in state.settled.items() if key[2] == now}, frame.key: result})
    return Next("", Config(Value(result), stack, state))


def new_oriented_point(at: OrientedPointAt, reader: Reader, state: State) -> tuple[Instance, State]:
    """OrientedPoint(position, heading) as an instance with the class's other default values; it is no part of the scene."""
    number = state.made
    point = Instance(number, ORIENTED_POINT_CLASS)
    properties = dict(built_in_defaults(ORIENTED_POINT_CLASS, view_distance(state.settings.readings)))
    properties["position"] = reader.wrap(at.position)
    if at.heading is not None:
        properties["heading"] = reader.wrap(heading_property(at.heading, reader))
    return point, state._replace(objects={**state.objects, number: properties}, made=number + 1)


def heading_property(heading: object, reader: Reader) -> object:
    """Return the property heading: the number, or the angle in (-π, π] (reading `heading-property`)."""
    return compute(normalise_heading, [heading], reader) if reader.state.reading("heading-property") == "wrapped" else heading


def membership(node: Node, left: object, right: object, stack: Stack, state: State) -> Outcome:
    """`V in R` and `O in R`."""
    return apply_equation(node, o.IN_EQUATIONS, [left, right], stack, state)
