"""Specifiers as Algorithm 1 sees them: what each specifies and needs, from the kinds of its arguments.

The arguments are evaluated before the algorithm runs (reading `specifier-arguments`); of those that are a vector field relative to something, what
is left waits for the object's position (reading `field-dependency`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from ..machine.config import State
from ..machine.implicit_positions import waits
from ..machine.operand_kinds import FLAT, OBJECT, SCALAR, has_kind, in_the_plane, unfit
from ..machine.premises import axiom
from ..machine.values import unwrap
from ..store.built_in_classes import canonical
from ..store.errors import RunError
from ..store.scenic_classes import ScenicClass
from ..store.scopes import ByIdentity, descendants
from ..syntax import python_expressions as p
from ..syntax import specifiers as q
from ..syntax.nodes import NOWHERE, Node
from . import released_forms
from . import specifiers as sp
from .operators import EGO
from .resolution import Specification


def arguments_of(node: Node) -> list[Node]:
    """The argument expressions of a specifier, in the order of its form's kinds."""
    if isinstance(node, q.WithSpecifier):
        return [node.value]
    return [getattr(node, name) for name in released_forms.FORMS[type(node)][0]]


def describe(node: Node, arguments: Sequence[object], state: State) -> Specification:
    """Return the specification of a specifier: the properties it specifies, optionally or not, and its
    dependencies, from the kinds of its arguments; one that waits needs the position.
    """
    name, late = sp.specifier_name(node), any(map(waits, arguments))
    waiting = ("position",) if late else ()
    if isinstance(node, q.WithSpecifier):
        return Specification(node, name, (canonical(node.property, state.settings.readings),), (), waiting, None, tuple(arguments), waits=late)
    forms = forms_under(node, state)
    if late:
        form = forms[0]
        return Specification(node, name, form.specifies, (), tuple(dict.fromkeys((*form.dependencies, *waiting))), None, tuple(arguments), waits=True)
    form, complete = choose_form(node, forms, arguments, state)
    optional = form.optional
    if form.heading_of_region and unwrap(arguments[0])[0].orientation is not None:  # type: ignore[attr-defined]
        optional = sp.HEADING_ONLY
    return Specification(node, name, form.specifies, optional, form.dependencies, form, complete)


def forms_under(node: Node, state: State) -> tuple[sp.Form, ...]:
    """The forms of a specifier under the readings of the run."""
    offset_by, amounts, heading = map(state.reading, ("offset-by", "offset-amounts", "offset-heading"))
    return released_forms.forms_of(node, offset_by, amounts, heading, state.settings.dialect)


def choose_form(node: Node, forms: tuple[sp.Form, ...], arguments: Sequence[object], state: State) -> tuple[sp.Form, tuple[object, ...]]:
    """The form whose kinds fit, and its arguments (ego joins those that speak of it)."""
    if forms[0].needs_ego:
        arguments = [*arguments, ego_of(node, state)]
    arguments = [in_the_plane(a, state) for a in arguments]
    operands = [unwrap(a)[0] for a in arguments]
    for form in forms:
        if all(has_kind(v, kind) for v, kind in zip(operands, form.kinds, strict=True)):
            if form is released_forms.ON_VECTOR and has_kind(operands[0], OBJECT):
                hint = "write `at O`, or `ahead of O` and its kin"
                raise RunError(f"`on` an Object is on its surface, which {FLAT}", arguments_of(node)[0].span, rule=form.rule, hint=hint)
            return form, tuple(arguments)
    nodes = arguments_of(node)
    toward = isinstance(node, q.FacingTowardSpecifier) and has_kind(operands[0], SCALAR)
    hint = "for an angle write `facing A`, without `toward`" if toward else ""
    raise unfit(f"`{sp.specifier_name(node)}`", node, nodes, operands, [form.kinds for form in forms], forms[0].rule, state, hint)


def ego_of(node: Node, state: State) -> object:
    """The value of ego for a specifier that leaves it out. Raises `RunError` at the specifier."""
    try:
        return axiom(EGO, state)
    except RunError as problem:
        problem.span = node.span if problem.span == NOWHERE else problem.span
        raise


def default_specification(name: str, expression: Node, owner: ScenicClass, state: State) -> Specification:
    """A default value expression as a specifier: its dependencies are the properties it mentions as `self.property`."""
    readings = state.settings.readings
    return _default_specification(name, ByIdentity(expression), owner.name, readings["height"], readings["view-distance"])


@lru_cache(maxsize=65536)
def _default_specification(name: str, key: ByIdentity, owner: str, height: str, distance: str) -> Specification:
    readings = {"height": height, "view-distance": distance}
    attributes = (n for n in descendants(key.node) if isinstance(n, p.Attribute))
    mentioned = dict.fromkeys(canonical(n.name, readings) for n in attributes if isinstance(n.value, p.Name) and n.value.name == "self")
    return Specification(key.node, f"default {name} of {owner}", (name,), (), tuple(mentioned), None, None, is_default=True)
