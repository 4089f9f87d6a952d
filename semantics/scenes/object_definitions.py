"""The rule "Object Definitions" (Figure "Semantics of expressions"): resolve the specifiers, evaluate them in order, newInstance.

    resolveSpecifiers(class, specifiers) = ((s_1, p_1), ..., (s_n, p_n))
    ⟨s_1, σ[self / ⊥], π, O⟩ →^{r_1} ⟨v_1, σ_1, π, O_1⟩
    ⟨s_2, σ_1[self.p_1 / v_1(p_1)], π, O_1⟩ →^{r_2} ⟨v_2, σ_2, π, O_2⟩
    ...
    ⟨s_n, σ_{n-1}[self.p_{n-1} / v_{n-1}(p_{n-1})], π, O_{n-1}⟩ →^{r_n} ⟨v_n, σ_n, π, O_n⟩
    inst = newInstance(class, σ_n[self.p_n / v_n(p_n)](self))
    ----------------------------------------------------------------------------------------
    ⟨class specifiers, σ, π, O⟩ →^{r_1 ... r_n} ⟨inst, σ, π, O_n ∪ {inst}⟩

`resume_class` finds the class, `conclude_arguments` is the first premise, `construct` goes through the others one by one
(`assign_property` is σ[self.p / v(p)]), `new_instance` is the conclusion. The properties of `self` stand in O from the start.

The arguments of specifiers are evaluated first, from left to right, since which properties a specifier specifies depends
on their kinds (reading `specifier-arguments`); except those that mention a vector field relative to something, which wait
for the object's position (reading `field-dependency`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from ..kernel.config import Abrupt, Config, Stack, State, Value, reduce, value
from ..kernel.errors import RunError
from ..kernel.kinds import OrientedPointAt, Reader, is_object, kind_name
from ..kernel.outcome import Change, Draw, Next, Outcome, Requirement, Stuck
from ..kernel.premises import NOT_AN_AXIOM, axiom, premises
from ..kernel.properties import checked_property
from ..kernel.scopes import Scope
from ..kernel.simulation import check_setup
from ..kernel.values import Instance, Origin, Random, ScenicClass
from ..python.functions import LARGEST_DEPTH
from ..space.distributions import BadParameters, PointIn
from ..space.fields import OutsideField
from ..space.regions import Region
from ..space.vectors import Vector
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax import specifiers as q
from ..syntax.nodes import Node
from . import specifiers as sp
from .operations import SPECIFIED, compute
from .resolution import Ordered, Specification, resolve_specifiers
from .specifier_arguments import arguments_of, choose_form, default_specification, describe, waits_for_position


class ClassOf(NamedTuple):
    """Frame: the class name of an object definition, or the head of what may be one, is being reduced."""

    node: Node


class Construction(NamedTuple):
    """Frame of an object definition whose specifier number `index` is being evaluated for `instance`."""

    node: e.ObjectDefinition
    instance: Instance
    order: Ordered
    index: int
    outer: Scope


def object_definition(node: e.ObjectDefinition | e.ObjectOrValue | e.ObjectOrOperator, stack: Stack, state: State) -> Outcome:
    """Reduce the class, or the head that decides whether this is an object definition at all."""
    head = {e.ObjectDefinition: "class_", e.ObjectOrValue: "value", e.ObjectOrOperator: "head"}[type(node)]
    return reduce(getattr(node, head), ClassOf(node), stack, state)


def resume_class(frame: ClassOf, head: object, stack: Stack, state: State) -> Outcome:
    """`E at X` is an object definition if E is a Scenic class, otherwise an operator (reading `bare-class`)."""
    node = frame.node
    if isinstance(head, ScenicClass):
        definition = node if isinstance(node, e.ObjectDefinition) else node.as_object if isinstance(node, e.ObjectOrOperator) else None
        if definition is None:
            definition = e.ObjectDefinition(class_=node.value, span=node.span)  # type: ignore[attr-defined]
        return evaluate_arguments(definition, head, stack, state)
    if isinstance(node, e.ObjectOrValue):
        return value("", head, stack, state)
    if isinstance(node, e.ObjectOrOperator):
        return Next("", Config(node.as_operator, stack, state))
    raise RunError(
        f"specifiers must follow the name of a Scenic class, and this is {kind_name(head)}", node.span, rule="E-ObjectDefinition"
    )


# Arguments of the specifiers


def evaluate_arguments(node: e.ObjectDefinition, class_: ScenicClass, stack: Stack, state: State) -> Outcome:
    """Rewrite the specifiers one by one, then reduce the arguments that need not wait."""
    for index, specifier in enumerate(node.specifiers):
        rewriting = sp.REWRITINGS.get(type(specifier))
        if rewriting is not None and rewriting.applies(specifier):
            specifiers = (*node.specifiers[:index], rewriting.rewrite(specifier), *node.specifiers[index + 1 :])
            rewritten = ClassOf(replace(node, specifiers=specifiers))  # type: ignore[arg-type]
            return Next(rewriting.rule, Config(Value(class_), (rewritten, stack), state), specifier)
    deferred = tuple(waits_for_position(s, state) for s in node.specifiers)
    expressions = [a for s, late in zip(node.specifiers, deferred, strict=True) if not late for a in arguments_of(s)]
    return premises(node, expressions, partial(conclude_arguments, class_, deferred), stack, state)


def conclude_arguments(
    class_: ScenicClass, deferred: tuple[bool, ...], node: e.ObjectDefinition, values: list[object], stack: Stack, state: State
) -> Outcome:
    """resolveSpecifiers(class, specifiers) = ((s1, p1), ..., (sn, pn)); then σ[self / ⊥]."""
    rest = iter(values)
    specifications = [
        describe(s, None if late else [next(rest) for _ in arguments_of(s)], state) for s, late in zip(node.specifiers, deferred, strict=True)
    ]
    defaults = {name: default_specification(name, expression, owner, state) for name, (expression, owner) in class_.defaults.items()}
    known = frozenset(defaults) if state.reading("optional-unknown") == "ignore" else None
    absent = frozenset({"width", "length"}) if state.reading("point-size") == "zero" else frozenset()
    order = resolve_specifiers(node.span, specifications, defaults, known, absent)
    instance = Instance(state.made, class_, node.span)
    begun = state._replace(objects={**state.objects, instance.number: {}}, made=state.made + 1)
    frame = Construction(node, instance, order, 0, state.sigma)
    return Next("R-ResolveSpecifiers", Config(Value(None), (frame, stack), begun), node, Change("", "order", order))


# Evaluation in order


def construct(frame: Construction, stack: Stack, state: State) -> Outcome:
    """⟨s_i, σ[self.p_{i-1} / v_{i-1}]⟩ → v_i for the next specifier; after the last, newInstance."""
    if frame.index == len(frame.order):
        return new_instance(frame, stack, state)
    specification, _ = frame.order[frame.index]
    if specification.is_default or specification.arguments is None:
        return evaluate_late(frame, specification, stack, state)
    if specification.form is None:
        return assign_with(frame, specification.arguments[0], stack, state)
    return apply_form(frame, specification.form, specification.arguments, stack, state)


def evaluate_late(frame: Construction, specification: Specification, stack: Stack, state: State) -> Outcome:
    """Reduce a default value, or an argument that waited for the position, where `self` is the object so far."""
    node = specification.node
    if specification.is_default:
        found = axiom(node, state) if type(node) is p.Constant else NOT_AN_AXIOM
        if found is not NOT_AN_AXIOM:
            return assign_default(frame, found, stack, state)
        owner = frame.instance.class_.defaults[specification.specifies[0]][1]
        bindings: Mapping[str, object] = {"self": frame.instance, SPECIFIED: frame.instance}
        scope = Scope("specifier", owner.scope, bindings=dict(bindings))
        if state.depth >= LARGEST_DEPTH:
            raise RunError(
                f"the class {owner.name} creates objects of its own kind in its default of {specification.specifies[0]}, without end", node.span,
                rule="E-ObjectDefinition",
            )
        return reduce(node, Defaulting(frame), stack, state._replace(sigma=scope, depth=state.depth + 1))
    scope = Scope("specifier", frame.outer, bindings={SPECIFIED: frame.instance})
    arguments = arguments_of(node)
    return premises(node, arguments, partial(conclude_late, frame), (frame, stack), state._replace(sigma=scope))


def conclude_late(frame: Construction, node: Node, values: list[object], stack: Stack, state: State) -> Outcome:
    """The arguments that waited are reduced: apply the specifier."""
    outer = state._replace(sigma=frame.outer)
    if isinstance(node, q.WithSpecifier):
        return assign_with(frame, values[0], stack[1], outer)
    form, complete = choose_form(node, sp.forms_of(node, state.reading("offset-by")), values, state)
    return apply_form(frame, form, complete, stack[1], outer)


def resume_construction(frame: Construction, result: object, stack: Stack, state: State) -> Outcome:
    """A specifier's properties are assigned: go on with the next one."""
    return construct(frame, stack, state)


class Defaulting(NamedTuple):
    """Frame: a default value expression is being reduced, with `self` bound to the object so far."""

    construction: Construction


def resume_defaulting(frame: Defaulting, result: object, stack: Stack, state: State) -> Outcome:
    """The default value was reduced to `result`."""
    construction = frame.construction
    return assign_default(construction, result, stack, state._replace(sigma=construction.outer, depth=state.depth - 1))


def unwind_construction(frame: Construction | Defaulting, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception leaves the object unfinished; σ is restored."""
    if isinstance(frame, Defaulting):
        return Next("", Config(abrupt, stack, state._replace(sigma=frame.construction.outer, depth=state.depth - 1)))
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def apply_form(frame: Construction, form: sp.Form, arguments: tuple[object, ...], stack: Stack, state: State) -> Outcome:
    """Apply the equation of a specifier; `in R` and `visible` first draw the point."""
    reader = Reader(state)
    node = frame.order[frame.index][0].node
    operands = [reader.read(reader.plain(a), kind) for a, kind in zip(arguments, form.kinds, strict=True)]
    if form.needs_self:
        operands.append(reader.read(frame.instance, "Point"))
    if form.needs_euler_steps:
        operands.append(state.settings.euler_steps)
    if form.passes_on:  # ⟦at V⟧ = ⟦V⟧: the value itself, which `resample` may draw again
        return assign_property(frame, form.rule, {form.specifies[0]: form.function(arguments[0])}, stack, state)
    try:
        result = compute(form.function, operands, reader)
    except OutsideField as outside:
        return outside_field(frame, form.rule, outside, {"position": Vector(0.0, 0.0), "heading": 0.0}, reader.origin, stack, state)
    if isinstance(result, Region):
        return draw_point(frame, form, operands, result, node, stack, state)
    return assign_property(frame, form.rule, properties_of(result, form, reader.origin), stack, state)


def properties_of(result: object, form: sp.Form, origin: Origin | None) -> dict[str, object]:
    """{position ↦ v}, {heading ↦ v} or {position ↦ o.position, heading ↦ o.heading}."""
    reader_wrap = (lambda v: Random(v, origin._replace(distribution=None))) if origin is not None else (lambda v: v)
    match result:
        case OrientedPointAt(position=position, heading=None):
            return {"position": reader_wrap(position)}
        case OrientedPointAt(position=position, heading=heading):
            return {"position": reader_wrap(position), "heading": reader_wrap(heading)}
        case _:
            return {form.specifies[0]: reader_wrap(result)}


def draw_point(
    frame: Construction, form: sp.Form, operands: list[object], region: Region, node: Node, stack: Stack, state: State
) -> Outcome:
    """x = uniformPointIn(R)."""
    try:
        distribution = PointIn(region)
    except BadParameters as bad:
        raise RunError(str(bad), node.span, rule=form.rule) from None
    origin = Origin(node.span, "a uniformly random point", None)
    after = state._replace(draws=state.draws + 1)
    resume = partial(place_point, frame, form, operands, origin, stack, after)
    return Draw(form.rule, state.address, distribution, node, resume)


class Placed(NamedTuple):
    """Control result: the point that `in R` or `visible` drew, on its way to the object, with the equation and its operands."""

    point: Vector
    form: sp.Form
    operands: list[object]
    origin: Origin


def place_point(
    frame: Construction, form: sp.Form, operands: list[object], origin: Origin, stack: Stack, state: State, point: object
) -> Config:
    """The configuration after the draw: the specifier's frame receives the point."""
    assert isinstance(point, Vector)
    return Config(Value(Placed(point, form, operands, origin)), (Placing(frame), stack), state)


class Placing(NamedTuple):
    """Frame: a specifier's point was drawn, its orientation is next."""

    construction: Construction


def resume_placing(frame: Placing, placed: Placed, stack: Stack, state: State) -> Outcome:
    """The equation once its point x is drawn."""
    try:
        at = compute(placed.form.function, (*placed.operands, placed.point), Reader(state))
    except OutsideField as outside:
        properties: dict[str, object] = {"position": placed.point, "heading": 0.0}
        return outside_field(frame.construction, placed.form.rule, outside, properties, placed.origin, stack, state)
    return assign_property(frame.construction, placed.form.rule, properties_of(at, placed.form, placed.origin), stack, state)


def outside_field(
    frame: Construction, rule: str, outside: OutsideField, properties: dict[str, object], origin: Origin | None, stack: Stack, state: State
) -> Outcome:
    """Reading `field-outside`: the run is stuck."""
    node = frame.order[frame.index][0].node
    names = frame.order[frame.index][1]
    anything = {n: (Random(v, origin) if origin else v) for n, v in properties.items() if n in names}
    beyond = assign_property(frame, rule, anything, stack, state)
    return Stuck(rule, Requirement("field", node.span, outside.premise), beyond.config if isinstance(beyond, Next) else None)


def assign_with(frame: Construction, given: object, stack: Stack, state: State) -> Outcome:
    """⟦with P E⟧ = {P ↦ ⟦E⟧}."""
    return assign_property(frame, "P-With", dict.fromkeys(frame.order[frame.index][1], given), stack, state)


def assign_default(frame: Construction, given: object, stack: Stack, state: State) -> Outcome:
    """{P ↦ ⟦E⟧} for the property P that no specifier gives, where E is its default value expression in the most derived class, about `self`."""
    return assign_property(frame, "P-Default", dict.fromkeys(frame.order[frame.index][1], given), stack, state)


def assign_property(frame: Construction, rule: str, properties: Mapping[str, object], stack: Stack, state: State) -> Outcome:
    """σ[self.p / v(p)] for the properties p that Algorithm 1 gave to this specifier; then the next specifier."""
    specification, names = frame.order[frame.index]
    place = frame.node.span if specification.is_default else specification.node.span
    chosen = {n: checked_property(n, properties[n], place, specification.name, state) for n in names if n in properties}
    after = state.with_properties(frame.instance, chosen)
    change = Change("O", "", None, frame.instance)
    following = Construction(frame.node, frame.instance, frame.order, frame.index + 1, frame.outer)
    return Next(rule, Config(Value(None), (following, stack), after), specification.node, change)


def new_instance(frame: Construction, stack: Stack, state: State) -> Outcome:
    """inst = newInstance(class, σ_n(self)), and O_n ∪ {inst}."""
    instance = frame.instance
    if state.simulation is not None and is_object(instance):

        check_setup("objects are made", frame.node, stack)
    scene = (*state.scene, instance) if is_object(instance) else state.scene
    after = state._replace(sigma=frame.outer, scene=scene)
    change = Change("O", repr(instance), instance) if is_object(instance) else None
    return value("E-ObjectDefinition", instance, stack, after, frame.node, change)
