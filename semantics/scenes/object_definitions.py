"""The rule "Object Definitions" (Figure "Semantics of expressions"): resolve the specifiers, evaluate them in order, newInstance.

`resolve` is the first premise; `construct` is the rule, as a loop over the others: ⟨s_i, ...⟩ → v_i by `evaluate`, then σ_i[self.p_i / v_i(p_i)] by
`assign`, which goes on with s_{i+1}. The properties of `self` stand in O from the start.

The arguments of specifiers are evaluated first, from left to right, since which properties a specifier specifies depends
on their kinds (reading `specifier-arguments`). A vector field relative to something waits for the object's position: what is
left of such an argument is evaluated in the loop (reading `field-dependency`), after the specifier that determines the position.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from ..machine.built_in_properties import checked_property
from ..machine.config import Abrupt, Config, Stack, State, Value, reduce, value
from ..machine.implicit_positions import expression_of, specified_object, specifier_scope, wait, waits
from ..machine.operand_kinds import REGION, OrientedPointAt, Reader, has_kind, is_object, kind_name
from ..machine.outcome import Change, Draw, Next, Outcome, Requirement, Stuck
from ..machine.premises import NOT_AN_AXIOM, Premises, axiom, premises
from ..machine.simulation_state import check_setup
from ..machine.values import Instance, Origin, Random
from ..python.functions import LARGEST_DEPTH, InScope
from ..space.distributions import BadParameters, PointIn
from ..space.fields import OutsideField
from ..space.regions import Region
from ..space.vectors import Vector
from ..store.built_in_classes import defaults_of
from ..store.errors import RunError
from ..store.postponed_values import Waiting
from ..store.scenic_classes import DefaultIn, ScenicClass
from ..store.scopes import Scope
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax import specifiers as q
from ..syntax.nodes import Node
from . import released_forms
from . import specifiers as sp
from .operator_application import compute, heading_property
from .operators import EGO, EGO_POSITION
from .resolution import Ordered, Specification, postpone_specifier, resolve_specifiers
from .specifier_arguments import arguments_of, choose_form, default_specification, describe, ego_of, forms_under


class ClassOf(NamedTuple):
    """Frame: the class name of an object definition, or the head of what may be one, is being reduced."""

    node: Node


class Construction(NamedTuple):
    """Frame of an object definition: s_i of `order` is evaluated for `instance`, or has been; around it, σ is `outer` and the depth `depth`."""

    node: e.ObjectDefinition
    instance: Instance
    order: Ordered
    i: int
    outer: Scope
    depth: int

    @property
    def specification(self) -> Specification:
        """The current specification s_i in `order`."""
        return self.order[self.i][0]


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
        f"specifiers must follow the name of a Scenic class, not {kind_name(head)}", node.span, rule="E-ObjectDefinition"
    )


# Arguments of the specifiers


def evaluate_arguments(node: e.ObjectDefinition, class_: ScenicClass, stack: Stack, state: State) -> Outcome:
    """Rewrite the specifiers one by one, then reduce their arguments."""
    for index, specifier in enumerate(node.specifiers):
        rewriting = released_forms.REWRITINGS.get(type(specifier))
        if rewriting is not None and rewriting.applies(specifier):
            written = rewriting.rewrite(specifier)
            if any(argument is EGO or argument is EGO_POSITION for argument in arguments_of(written)):
                ego_of(specifier, state)
            specifiers = (*node.specifiers[:index], written, *node.specifiers[index + 1 :])
            rewritten = ClassOf(replace(node, specifiers=specifiers))  # type: ignore[arg-type]
            return Next(rewriting.rule, Config(Value(class_), (rewritten, stack), state), specifier)
    expressions = [a for s in node.specifiers for a in arguments_of(s)]
    return premises(node, expressions, partial(resolve, class_), stack, state)


def resolve(class_: ScenicClass, node: e.ObjectDefinition, values: list[object], stack: Stack, state: State) -> Outcome:
    """resolveSpecifiers(class, specifiers) = ((s_1, p_1), ..., (s_n, p_n)); then σ[self / ⊥]."""
    rest = iter(values)
    specifications = [describe(s, [next(rest) for _ in arguments_of(s)], state) for s in node.specifiers]
    for one in specifications:
        final = class_.finals.intersection(one.specifies)
        if final:
            text = f"the property {min(final)} of {class_.name} is final: no specifier may specify it"
            raise RunError(text, one.node.span, rule="E-ObjectDefinition")
    readable = defaults_of(class_, state.settings.readings)
    defaults = {name: default_specification(name, expression, owner, state) for name, (expression, owner) in readable.items()}
    known = frozenset(defaults) if state.reading("optional-unknown") == "ignore" else None
    absent = frozenset({"width", "length"}) if state.reading("point-size") == "zero" else frozenset()
    order = resolve_specifiers(node.span, specifications, defaults, known, absent)
    instance = Instance(state.made, class_, node.span)
    begun = state._replace(objects={**state.objects, instance.number: {}}, made=state.made + 1)
    frame = Construction(node, instance, order, 0, state.sigma, state.depth)
    return Next("R-ResolveSpecifiers", Config(Value(None), (frame, stack), begun), node, Change("", "order", order))


# The loop


def construct(frame: Construction, result: object, stack: Stack, state: State) -> Outcome:
    """If resolveSpecifiers(class, specifiers) = ((s_1, p_1), ..., (s_n, p_n)),
        ⟨s_1, σ[self / ⊥], π, O⟩ →^{r_1} ⟨v_1, σ_1, π, O_1⟩,
        ⟨s_2, σ_1[self.p_1 / v_1(p_1)], π, O_1⟩ →^{r_2} ⟨v_2, σ_2, π, O_2⟩,
        ...
        ⟨s_n, σ_{n-1}[self.p_{n-1} / v_{n-1}(p_{n-1})], π, O_{n-1}⟩ →^{r_n} ⟨v_n, σ_n, π, O_n⟩ and
        inst = newInstance(class, σ_n[self.p_n / v_n(p_n)](self)),
    then ⟨class specifiers, σ, π, O⟩ →^{r_1 ... r_n} ⟨inst, σ, π, O_n ∪ {inst}⟩.

    One turn of the loop: the next s_i; after the last, the conclusion. Only an Object is part of O.
    """
    if frame.i < len(frame.order):
        return evaluate((frame, stack), state)
    inst = frame.instance
    after = state._replace(sigma=frame.outer)
    if not is_object(inst):
        return value("E-ObjectDefinition", inst, stack, after, frame.node)
    if state.simulation is not None:
        check_setup("objects are made", frame.node, stack)
    return value("E-ObjectDefinition", inst, stack, after._replace(scene=(*state.scene, inst)), frame.node, Change("O", repr(inst), inst))


def assign(rule: str, v: Mapping[str, object], stack: Stack, state: State) -> Next:
    """σ_i[self.p_i / v_i(p_i)] for the properties p_i that Algorithm 1 gave to s_i, by whose rule ⟨s_i, ...⟩ → v_i; then the next s_i."""
    frame, rest = stack
    specification, names = frame.order[frame.i]
    node = specification.node
    place = frame.node.span if specification.is_default else node.value.span if isinstance(node, q.WithSpecifier) else node.span
    chosen = {n: checked_property(n, v[n], place, specification.name, state) for n in names if n in v}
    if "heading" in chosen and state.reading("heading-property") == "wrapped":
        reader = Reader(state)
        chosen["heading"] = reader.wrap(heading_property(reader.plain(chosen["heading"]), reader))
    following = Construction(frame.node, frame.instance, frame.order, frame.i + 1, frame.outer, frame.depth)
    after = state.with_properties(frame.instance, chosen)
    return Next(rule, Config(Value(None), (following, rest), after), specification.node, Change("O", "", None, frame.instance))


def outside(frame: Construction, state: State) -> State:
    """The state with the σ and the depth that the object definition has around it."""
    return state._replace(sigma=frame.outer, depth=frame.depth)


def unwind_construction(frame: Construction, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception leaves the object unfinished; σ is restored."""
    return Next("", Config(abrupt, stack, outside(frame, state)))


# ⟨s_i, ...⟩ → v_i, with the frame `Construction` on top of the stack


def evaluate(stack: Stack, state: State) -> Outcome:
    """Reduce what s_i still needs, then apply its equation: most specifiers need nothing, since their arguments are known."""
    frame: Construction = stack[0]
    specification = frame.specification
    if specification.arguments is None:
        return evaluate_default(frame, stack, state)
    if specification.waits:
        inner = state._replace(sigma=specifier_scope(frame.instance, frame.outer))
        return premises(specification.node, [expression_of(a) for a in specification.arguments], conclude_late, stack, inner)
    return specify(specification.form, specification.arguments, stack, state)


def conclude_late(node: Node, values: list[object], stack: Stack, state: State) -> Outcome:
    """The arguments that waited for the position are reduced; what they evaluate to may hold something that waits as well."""
    if any(map(waits, values)):
        return premises(node, list(map(expression_of, values)), conclude_late, stack, state)
    frame: Construction = stack[0]
    around = outside(frame, state)
    if frame.specification.is_default:
        return assign("P-Default", sp.default_value(frame.specification.specifies[0], values[0]), stack, around)
    if isinstance(node, q.WithSpecifier):
        return specify(None, tuple(values), stack, around)
    return specify(*choose_form(node, forms_under(node, state), values, state), stack, around)


class Defaulting(NamedTuple):
    """Frame above `Construction`: a default value expression is being reduced, with `self` bound to the object so far; `begun` is the state then."""

    expression: Node
    begun: State


def evaluate_default(frame: Construction, stack: Stack, state: State) -> Outcome:
    """Reduce a default value expression in the scope of its class."""
    node, name = frame.specification.node, frame.specification.specifies[0]
    found = axiom(node, state) if type(node) is p.Constant else NOT_AN_AXIOM
    if found is not NOT_AN_AXIOM:
        return assign("P-Default", sp.default_value(name, found), stack, state)
    owner = defaults_of(frame.instance.class_, state.settings.readings)[name][1]
    if state.depth >= LARGEST_DEPTH:
        text = f"the class {owner.name} creates objects of its own kind in its default of {name}, without end"
        raise RunError(text, node.span, rule="E-ObjectDefinition")
    scope = Scope("specifier", owner.scope, bindings={"self": frame.instance})
    inner = state._replace(sigma=scope, depth=state.depth + 1)
    return reduce(node, Defaulting(node, inner), stack, inner)


def default_in(node: DefaultIn, stack: Stack, state: State) -> Outcome:
    """Reduce the default value expression of another class, of which an additive one is made, in the scope of that class."""
    scope = Scope("specifier", node.owner.scope, bindings={"self": state.sigma.lookup("self")})
    return Next("", Config(node.expression, (InScope(state.sigma), stack), state._replace(sigma=scope)))


def resume_defaulting(frame: Defaulting, result: object, stack: Stack, state: State) -> Outcome:
    """The default value was reduced to `result`; where that waits for the position, it comes after the specifier that determines it."""
    construction, rest = stack
    if waits(result):
        specification: Specification = construction.specification
        needed = tuple(dict.fromkeys((*specification.dependencies, "position")))
        changed = replace(specification, dependencies=needed, arguments=(result,), waits=True)
        order = (*construction.order[: construction.i], *postpone_specifier(construction.order[construction.i :], changed, construction.node.span))
        frame_ = construction._replace(order=order)
        return Next("", Config(Value(None), (frame_, rest), outside(construction, state)), construction.node, Change("", "order", order))
    return assign("P-Default", sp.default_value(construction.specification.specifies[0], result), stack, outside(construction, state))


def wait_whole(config: Config) -> Outcome | None:
    """Something needs the value of what waits for a position, and cannot wait with it: a condition, a function of the program. Else None.

    Where a position is meant, what waits is reduced. Within the argument of a specifier or a default value, that as a whole waits for the position of
    the object, and the state is that before it (paper, Section "Expressions": a field is "interpreted ... at the position of the object being
    specified").
    """
    control, stack, state = config
    if isinstance(control, Value) and type(control.value) is Waiting and specified_object(state) is not None:
        return Next("", Config(control.value, stack, state))
    while stack:
        frame, below = stack
        begun = frame.begun if isinstance(frame, (Premises, Defaulting)) else None
        if begun is not None:
            begun.version.versions.go_to(begun.version)
            expression: Any = frame.expressions[frame.position] if isinstance(frame, Premises) else frame.expression
            return Next("", Config(Value(wait(expression, (), itself, begun)), stack, begun))
        if isinstance(frame, Construction):
            return None
        stack = below
    return None


def itself(node: Node, values: list[object], stack: Stack, state: State) -> Outcome:
    """An expression that was not begun."""
    return Next("", Config(node, stack, state))  # type: ignore[arg-type]


def specify(form: sp.Form | None, arguments: tuple[object, ...], stack: Stack, state: State) -> Outcome:
    """Apply the equation of a specifier (that of `with` has no `form`); `in R` and `visible` first draw the point."""
    frame: Construction = stack[0]
    if form is None:
        return assign("P-With", sp.with_property(frame.specification.specifies[0], arguments[0]), stack, state)
    reader = Reader(state)
    try:
        operands = [reader.read(reader.plain(a), kind) for a, kind in zip(arguments, form.kinds, strict=True)]
        if form.needs_self:
            operands.append(reader.read(frame.instance, "Point"))
        if form.passes_on:  # ⟦at V⟧ = ⟦V⟧: the value itself, which `resample` may draw again
            return assign(form.rule, {form.specifies[0]: form.function(arguments[0])}, stack, state)
        result = compute(form.function, operands, reader)
    except OverflowError:
        raise RunError("a number is too large", frame.specification.node.span, rule=form.rule) from None
    except OutsideField as problem:
        return outside_field(form.rule, problem, {"position": Vector(0.0, 0.0), "heading": 0.0}, reader.origin, stack, state)
    if has_kind(result, REGION):
        return draw_point(form, operands, result, stack, state)  # type: ignore[arg-type]
    return assign(form.rule, properties_of(result, form, reader.origin), stack, state)


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


class Placing(NamedTuple):
    """Frame above `Construction`: the point that `in R` or `visible` needs is being drawn; then comes the equation, with its operands."""

    form: sp.Form
    operands: list[object]
    origin: Origin


def draw_point(form: sp.Form, operands: list[object], region: Region, stack: Stack, state: State) -> Outcome:
    """x = uniformPointIn(R), drawn before the specifier's equation."""
    node = stack[0].specification.node
    try:
        distribution = PointIn(region)
    except BadParameters as bad:
        raise RunError(str(bad), node.span, rule=form.rule) from None
    placing = Placing(form, operands, Origin(node.span, "a uniformly random point", None))
    after = state._replace(draws=state.draws + 1)

    def resume(point: object) -> Config:
        return Config(Value(point), (placing, stack), after)

    return Draw(form.rule, state.address, distribution, node, resume)


def resume_placing(frame: Placing, point: Vector, stack: Stack, state: State) -> Outcome:
    """The equation once its point x is drawn."""
    form, operands, origin = frame
    reader = Reader(state)
    reader.origin = origin
    try:
        at = compute(form.function, (*operands, point), reader)
    except OutsideField as problem:
        return outside_field(form.rule, problem, {"position": point, "heading": 0.0}, origin, stack, state)
    properties = properties_of(at, form, origin)
    if "regionContainedIn" in form.specifies:
        properties["regionContainedIn"] = operands[0]
    return assign(form.rule, properties, stack, state)


def outside_field(
    rule: str, problem: OutsideField, properties: Mapping[str, object], origin: Origin | None, stack: Stack, state: State
) -> Outcome:
    """Reading `field-outside`: the run is stuck."""
    specification, names = stack[0].order[stack[0].i]
    anything = {n: (Random(v, origin) if origin else v) for n, v in properties.items() if n in names}
    return Stuck(rule, Requirement("field", specification.node.span, problem.premise), assign(rule, anything, stack, state).config)
