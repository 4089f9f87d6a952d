"""Specifiers as Algorithm 1 sees them: what each specifies and needs, from the kinds of its arguments.

The arguments are evaluated before the algorithm runs (reading `specifier-arguments`), except those that mention a vector
field relative to something, which wait for the object's position (reading `field-dependency`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from ..kernel.classes import canonical
from ..kernel.config import State
from ..kernel.errors import RunError
from ..kernel.kinds import has_kind, kind_name
from ..kernel.premises import axiom
from ..kernel.scopes import MISSING, ByIdentity, Scope, children, descendants
from ..kernel.values import Instance, ScenicClass, plain, unwrap
from ..space.fields import VectorField
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax import specifiers as q
from ..syntax.nodes import Node
from . import released
from . import specifiers as sp
from .resolution import Specification


def arguments_of(node: Node) -> list[Node]:
    """The argument expressions of a specifier, in the order of its form's kinds."""
    if isinstance(node, q.WithSpecifier):
        return [node.value]
    return [getattr(node, name) for name in released.FORMS[type(node)][0]]


def waits_for_position(specifier: Node, state: State) -> bool:
    """Whether an argument mentions a vector field relative to a heading or field (reading `field-dependency`)."""
    if not _has_relative_to(ByIdentity(specifier)):
        return False
    return any(
        isinstance(n, e.RelativeTo) and any(isinstance(peek(side, state), VectorField) for side in (n.left, n.right))
        for n in own_descendants(specifier, state)
    )


def own_descendants(node: Node, state: State) -> Iterator[Node]:
    """The nodes below a specifier that are evaluated for its object: not the specifiers of another object, nor a lambda's body."""
    pending = [node]
    while pending:
        current = pending.pop()
        yield current
        if isinstance(current, p.Lambda | e.ObjectDefinition):
            continue
        if isinstance(current, e.ObjectOrOperator):
            pending.extend([] if isinstance(peek(current.head, state), ScenicClass) else [current.as_operator])
        else:
            pending.extend(children(current))


@lru_cache(maxsize=65536)
def _has_relative_to(key: ByIdentity) -> bool:
    return any(isinstance(n, e.RelativeTo) for n in descendants(key.node))


def peek(node: Node, state: State) -> object:
    """The value of a path (names, attributes, constant subscripts) if it has one already, else None; nothing is reduced."""
    match node:
        case p.Name(name=name):
            found = state.sigma.lookup(name)
            if name == "ego" and found is MISSING:
                return plain(state.ego)
            return None if found is MISSING else plain(found)
        case p.Attribute(value=inner, name=name):
            owner = peek(inner, state)
            if isinstance(owner, Instance):
                return plain(state.objects[owner.number].get(canonical(name)))
            scope = getattr(owner, "scope", None)
            if isinstance(scope, Scope):
                return plain(scope.bindings.get(name))
            return None if name.startswith("_") else getattr(owner, name, None)
        case p.Subscript(value=inner, index=p.Constant(value=index)):
            owner = peek(inner, state)
            try:
                return plain(owner[index]) if isinstance(owner, (list, tuple, dict)) else None  # type: ignore[index]
            except (LookupError, TypeError):
                return None
        case _:
            return None


def describe(node: Node, arguments: list[object] | None, state: State) -> Specification:
    """What a specifier specifies, optionally or not, and its dependencies, from the kinds of its arguments."""
    name = sp.specifier_name(node)
    if isinstance(node, q.WithSpecifier):
        dependencies = ("position",) if arguments is None else ()
        return Specification(node, name, (canonical(node.property),), (), dependencies, None, None if arguments is None else tuple(arguments))
    forms = forms_under(node, state)
    if arguments is None:
        form = forms[0]
        return Specification(node, name, form.specifies, (), tuple(dict.fromkeys((*form.dependencies, "position"))), None, None)
    form, complete = choose_form(node, forms, arguments, state)
    optional = form.optional
    if form.heading_of_region and unwrap(arguments[0])[0].orientation is not None:  # type: ignore[attr-defined]
        optional = sp.HEADING_ONLY
    return Specification(node, name, form.specifies, optional, form.dependencies, form, complete)


def forms_under(node: Node, state: State) -> tuple[sp.Form, ...]:
    """The forms of a specifier under the readings of the run."""
    return released.forms_of(node, state.reading("offset-by"), state.reading("offset-amounts"))


def choose_form(node: Node, forms: tuple[sp.Form, ...], arguments: list[object], state: State) -> tuple[sp.Form, tuple[object, ...]]:
    """The form whose kinds fit, and its arguments (ego joins those that speak of it)."""
    if forms[0].needs_ego:
        arguments = [*arguments, axiom(p.Name(name="ego", span=node.span), state)]
    operands = [unwrap(a)[0] for a in arguments]
    for form in forms:
        if all(has_kind(v, kind) for v, kind in zip(operands, form.kinds, strict=True)):
            return form, tuple(arguments)
    expected = " or ".join(dict.fromkeys("(" + ", ".join(f.kinds) + ")" for f in forms))
    found = ", ".join(kind_name(v) for v in operands)
    raise RunError(f"`{sp.specifier_name(node)}` expects {expected}, not ({found})", node.span, rule=forms[0].rule)


def default_specification(name: str, expression: Node, owner: ScenicClass, state: State) -> Specification:
    """A default value expression as a specifier: its dependencies are the properties it mentions as `self.property`."""
    specification, has_relative_to = _default_specification(name, ByIdentity(expression), owner.name)
    if has_relative_to and waits_for_position(expression, state._replace(sigma=owner.scope)):
        return replace(specification, dependencies=tuple(dict.fromkeys((*specification.dependencies, "position"))))
    return specification


@lru_cache(maxsize=65536)
def _default_specification(name: str, key: ByIdentity, owner: str) -> tuple[Specification, bool]:
    mentioned = dict.fromkeys(
        canonical(n.name) for n in descendants(key.node) if isinstance(n, p.Attribute) and isinstance(n.value, p.Name) and n.value.name == "self"
    )
    specification = Specification(key.node, f"default {name} of {owner}", (name,), (), tuple(mentioned), None, None, is_default=True)
    return specification, _has_relative_to(key)
