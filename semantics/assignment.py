"""Assignments: σ[x / v], and what Python assigns to besides variables (rule "Variable/Parameter Assignments")."""

from __future__ import annotations

from collections.abc import Iterable

from .classes import canonical
from .config import PASS, Config, Stack, State
from .errors import RunError
from .expressions import BINARY, as_vectors, elements
from .host import HostException, check_private, host
from .kinds import is_object
from .outcome import Change, Next, Outcome
from .premises import premises
from .properties import checked_property
from .scopes import MISSING
from .syntax import python_expressions as p
from .syntax import statements as s
from .syntax.nodes import Node
from .values import Function, Instance, Method, Module, Random, ScenicClass, plain


def done(rule: str, node: Node, stack: Stack, state: State, change: Change | None = None) -> Next:
    """The statement is reduced to `pass`."""
    return Next(rule, Config(PASS, stack, state), node, change)


def assignment(node: s.Assignment, stack: Stack, state: State) -> Outcome:
    """If ⟨E, σ, π, O⟩ → ⟨v, σ, π, O'⟩ then ⟨x = E, σ, π, O⟩ → ⟨pass, σ[x/v], π, O'⟩."""
    parts = [part for target in node.targets for part in target_premises(target)]
    return premises(node, [node.value, *parts], conclude_assignment, stack, state)


def target_premises(target: Node) -> Iterable[Node]:
    """The expressions inside a target: the object of `a.b`, the container and index of `a[i]`."""
    match target:
        case p.Attribute(value=inner):
            yield inner
        case p.Subscript(value=inner, index=p.Slice(lower=lower, upper=upper, step=step)):
            yield inner
            yield from (part if part is not None else p.Constant(value=None) for part in (lower, upper, step))
        case p.Subscript(value=inner, index=index):
            yield inner
            yield index
        case p.TupleDisplay(items=items) | p.ListDisplay(items=items):
            for item in items:
                yield from target_premises(item)
        case p.Starred(value=inner):
            yield from target_premises(inner)
        case _:
            return


def conclude_assignment(node: s.Assignment, values: list[object], stack: Stack, state: State) -> Outcome:
    """Bind every target, from left to right."""
    assigned, *parts = values
    rest = iter(parts)
    for target in node.targets:
        state = assign(target, assigned, rest, state)
    first = node.targets[0]
    name = first.name if isinstance(first, p.Name) else type(first).__name__.lower()
    return done("S-Assignment", node, stack, state, Change("σ", name, assigned))


def assign(target: Node, assigned: object, parts: Iterable[object], state: State) -> State:
    """The state after binding `target`; `parts` are the values of its inner expressions, in order."""
    rest = iter(parts)
    match target:
        case p.Name(name=name):
            return assign_name(name, assigned, target, state)
        case p.Attribute(name=name):
            return set_attribute(next(rest), name, assigned, target, state)
        case p.Subscript(index=p.Slice()):
            container, lower, upper, step = (next(rest) for _ in range(4))
            return set_item(container, slice(plain(lower), plain(upper), plain(step)), assigned, target, state)
        case p.Subscript():
            container, index = next(rest), next(rest)
            return set_item(container, index, assigned, target, state)
        case p.TupleDisplay(items=items) | p.ListDisplay(items=items):
            for item, element in zip(items, unpack(items, assigned, target, state), strict=True):
                state = assign(item.value if isinstance(item, p.Starred) else item, element, rest, state)
            return state
        case _:
            raise AssertionError(type(target))


def unpack(items: tuple[Node, ...], assigned: object, node: Node, state: State) -> list[object]:
    """The values for the items of a target list, a starred one taking the rest as a list."""
    if type(assigned) is Random and isinstance(assigned.value, (tuple, list)):
        origin = assigned.origin._replace(distribution=None)
        found: list[object] = [v if type(v) is Random else Random(v, origin) for v in assigned.value]
    else:
        found = elements(assigned, node, state)
    star = next((i for i, item in enumerate(items) if isinstance(item, p.Starred)), None)
    if star is None:
        if len(found) != len(items):
            raise HostException(ValueError(f"{len(items)} values are needed to unpack into these names, not {len(found)}"))
        return found
    after = len(items) - star - 1
    if len(found) < star + after:
        raise HostException(ValueError(f"at least {star + after} values are needed to unpack into these names, not {len(found)}"))
    return [*found[:star], found[star : len(found) - after], *found[len(found) - after :]]


def assign_name(name: str, assigned: object, node: Node, state: State) -> State:
    """σ[x/v]; `ego` and `workspace` are shared by all modules; an Object keeps the name it is first assigned to."""
    inner = plain(assigned)
    if name == "ego":
        if not (isinstance(inner, Instance) and is_object(inner)):
            raise RunError("ego must be an Object", node.span, rule="S-Assignment", hint="write ego = Object ..., or a class below Object")
        return state._replace(ego=assigned, names={**state.names, inner.number: "ego"})
    if name == "workspace":
        state.sigma.bind(name, assigned)
        return state._replace(workspace=assigned)
    state.sigma.bind(name, assigned)
    if isinstance(assigned, Instance) and is_object(assigned) and state.sigma.kind == "module" and assigned.number not in state.names:
        return state._replace(names={**state.names, assigned.number: name})
    return state


def bind_target(target: Node, assigned: object, state: State) -> None:
    """Bind loop variables (names and nested tuples of names)."""
    if isinstance(target, p.Name):
        state.sigma.bind(target.name, assigned)
        return
    if isinstance(target, (p.TupleDisplay, p.ListDisplay)):
        for item, element in zip(target.items, unpack(target.items, assigned, target, state), strict=True):
            bind_target(item.value if isinstance(item, p.Starred) else item, element, state)
        return
    raise RunError("a loop variable must be a name or a tuple of names", target.span, rule="S-For")


def set_attribute(subject: object, name: str, assigned: object, node: Node, state: State) -> State:
    """O[instance.p / v], or Python's attribute assignment on an instance of a Python class of the program."""
    inner = plain(subject)
    match inner:
        case Instance():
            checked = checked_property(canonical(name), assigned, node.span, f".{name} =", state)
            return state.with_properties(inner, {canonical(name): checked})
        case Module():
            inner.scope.bindings[name] = assigned
            return state
        case ScenicClass() | Function() | Method():
            raise RunError(f"attributes of {inner!r} cannot be assigned", node.span, rule="S-Assignment")
        case _ if "__scenic_user_class__" in (inner if isinstance(inner, type) else type(inner)).__dict__:
            check_private(name, inner, node)
            state.settings.door.state = state
            try:
                setattr(inner, name, assigned)
            except Exception as exception:
                raise HostException(exception) from exception
            return state
        case _:
            raise HostException(AttributeError(f"attribute {name} of a {type(inner).__name__} cannot be assigned"))


def set_item(container: object, index: object, assigned: object, node: Node, state: State) -> State:
    """`container[index] = v`; the element keeps its randomness."""
    state.settings.door.state = state
    if type(index) is Random:
        raise RunError("the index of an assignment may not be random", node.span, rule="S-Assignment")
    try:
        plain(container)[index] = assigned  # type: ignore[index]
    except Exception as exception:
        raise HostException(exception) from exception
    return state


def augmented(node: s.AugmentedAssignment, stack: Stack, state: State) -> Outcome:
    """`x += E`: in place for lists, sets and dicts, as in Python."""
    return premises(node, [node.target, *target_premises(node.target), node.value], conclude_augmented, stack, state)


def conclude_augmented(node: s.AugmentedAssignment, values: list[object], stack: Stack, state: State) -> Outcome:
    """Compute and bind."""
    current, *parts, operand = values
    if node.operator == "+" and type(plain(current)) is list:
        plain(current).extend(elements(operand, node, state))  # type: ignore[attr-defined]
        result = current
    else:
        result = host(state.settings.door, state, BINARY[node.operator], *as_vectors([current, operand], state))
    state = assign(node.target, result, iter(parts), state)
    return done("S-Assignment", node, stack, state, Change("σ", getattr(node.target, "name", ""), result))


def delete(node: s.Delete, stack: Stack, state: State) -> Outcome:
    """`del x, a[i], b.c`."""
    return premises(node, [part for t in node.targets for part in target_premises(t)], conclude_delete, stack, state)


def conclude_delete(node: s.Delete, values: list[object], stack: Stack, state: State) -> Outcome:
    """Remove every target."""
    rest = iter(values)
    for target in node.targets:
        match target:
            case p.Name(name=name):
                if state.sigma.home(name).bindings.pop(name, MISSING) is MISSING:
                    raise RunError(f"{name} is not defined", target.span, rule="S-Delete")
            case p.Attribute(name=name):
                check_private(name, plain(next(rest)), target)
                raise RunError("attributes cannot be deleted", target.span, rule="S-Delete")
            case p.Subscript(index=p.Slice()):
                container, lower, upper, step = (plain(next(rest)) for _ in range(4))
                _delete_item(container, slice(lower, upper, step))
            case _:
                container, index = plain(next(rest)), plain(next(rest))
                _delete_item(container, index)
    return done("S-Delete", node, stack, state)


def _delete_item(container: object, index: object) -> None:
    try:
        del container[index]  # type: ignore[attr-defined]
    except Exception as exception:
        raise HostException(exception) from exception
