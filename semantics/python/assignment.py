"""Assignments: σ[x / v], and what Python assigns to besides variables (rule "Variable/Parameter Assignments")."""

from __future__ import annotations

import operator as python
from collections import deque
from collections.abc import Callable, Iterable, Mapping

from ..machine.built_in_properties import checked_property
from ..machine.config import PASS, Config, Stack, State
from ..machine.host_calls import HostException, host, raw
from ..machine.implicit_positions import wait
from ..machine.operand_kinds import is_object, is_sequence, kind_name
from ..machine.outcome import Change, Next, Outcome
from ..machine.premises import SHARED, axiom, describe_origin, premises
from ..machine.sandbox_table import OVERRIDES, as_member, is_hidden, is_user_made, may_override
from ..machine.values import Function, Instance, Method, Module, Random, unwrap, value_in_run
from ..space.regions import Region
from ..space.vectors import Vector
from ..store.budget import as_whole_number, container_length, refuse_too_long
from ..store.built_in_classes import canonical
from ..store.errors import RunError
from ..store.postponed_values import Waiting, needs_position
from ..store.scenic_classes import ScenicClass
from ..store.scopes import MISSING
from ..store.undo_log import CHANGEABLE, note_attribute, note_container, note_item
from ..syntax import python_expressions as p
from ..syntax import statements as s
from ..syntax.nodes import Node
from .arithmetic import BINARY
from .call_costs import check_key
from .expressions import as_vectors, conclude_binary, get_attribute, get_item
from .iteration import elements


def finish_statement(rule: str, node: Node, stack: Stack, state: State, change: Change | None = None) -> Next:
    """The statement is reduced to `pass`."""
    return Next(rule, Config(PASS, stack, state), node, change)


def assignment(node: s.Assignment, stack: Stack, state: State) -> Outcome:
    """The value of `x = E` comes first."""
    return premises(node, [node.value], conclude_assignment, stack, state)


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
    """Bind every target, from left to right; the expressions inside each are reduced when the ones before it are bound."""
    return bind_targets(node, [(target, values[0]) for target in node.targets], values[0], stack, state)


def bind_targets(node: s.Assignment, pending: list[tuple[Node, object]], assigned: object, stack: Stack, state: State) -> Outcome:
    """Bind the pending targets to their values."""
    while pending:
        (target, part), *pending = pending
        if state.may_branch and not (isinstance(target, p.Name) and target.name not in SHARED):
            part = value_in_run(part)  # only variables keep what a value was drawn from
        if isinstance(target, p.Name):
            state = assign_name(target.name, part, target, state)
        elif isinstance(target, (p.TupleDisplay, p.ListDisplay)):
            items = [item.value if isinstance(item, p.Starred) else item for item in target.items]
            pending = [*zip(items, unpack(target.items, part, target, state), strict=True), *pending]
        else:
            rest = ((target, part), pending, assigned)
            return premises(node, [None, *target_premises(target)], conclude_target, stack, state, [rest])
    return assigned_to(node.targets[0], assigned, node, stack, state)


def assigned_to(target: Node, result: object, node: Node, stack: Stack, state: State) -> Outcome:
    """If ⟨E, σ, π, O⟩ → ⟨v, σ, π, O'⟩ then ⟨x = E, σ, π, O⟩ → ⟨pass, σ[x/v], π, O'⟩: the state is that with v bound to its targets."""
    name = assigned_variables(target)
    return finish_statement("S-Assignment", node, stack, state, Change("σ", name, result) if name else None)


def assigned_variables(target: Node) -> str:
    """The variables that a target binds, as they are written; empty if there is something else in it."""
    if isinstance(target, (p.TupleDisplay, p.ListDisplay)):
        names = [assigned_variables(item) for item in target.items]
        return f"({', '.join(names)})" if all(names) else ""
    return target.name if isinstance(target, p.Name) else ""


def conclude_target(node: s.Assignment, values: list[object], stack: Stack, state: State) -> Outcome:
    """The object of `a.b` or the container and index of `a[i]` are reduced."""
    rest, *parts = [values[0], *map(value_in_run, values[1:])] if state.may_branch else values
    (target, part), pending, assigned = rest  # type: ignore[misc]
    return bind_targets(node, pending, assigned, stack, assign(target, part, parts, state))


def assign(target: Node, assigned: object, parts: list[object], state: State) -> State:
    """The state after binding a target that is no display; `parts` are the values of its inner expressions, in order."""
    match target:
        case p.Name(name=name):
            return assign_name(name, assigned, target, state)
        case p.Attribute(name=name):
            return set_attribute(parts[0], name, assigned, target, state)
        case p.Subscript():
            set_item(parts[0], assignment_index(target, parts[1:]), assigned, target, state)
            return state
        case _:
            raise AssertionError(type(target))


def assignment_index(target: p.Subscript, parts: list[object]) -> object:
    """The index or slice of an assignment: it may not be random."""
    places, origin = unwrap(parts)
    if origin is not None:
        raise RunError("the index of an assignment may not be random", target.span, rule="S-Assignment")
    index = slice(*places) if isinstance(target.index, p.Slice) else places[0]  # type: ignore[misc, index]
    check_key(index)
    return index


def random_write(subject: Random, node: Node) -> RunError:
    """The error where what is changed is itself a random choice."""
    return RunError(
        f"which {kind_name(subject).removeprefix('an ').removeprefix('a ')} this changes is random: it depends on {describe_origin(subject.origin)}",
        node.span, rule="S-Assignment", hint="change each of them before the choice is made",
    )


def unpack(items: tuple[Node, ...], assigned: object, node: Node, state: State) -> list[object]:
    """The values for the items of a target list, a starred one taking the rest as a list."""
    if type(assigned) is Random and assigned.origin.distribution is None and is_sequence(assigned.value):
        origin = assigned.origin._replace(distribution=None)
        found: list[object] = [v if type(v) is Random else Random(v, origin) for v in assigned.value]  # type: ignore[attr-defined]
    else:
        found = elements(assigned, node, state)
    star = next((i for i, item in enumerate(items) if isinstance(item, p.Starred)), None)
    least = len(items) if star is None else len(items) - 1
    if len(found) < least or (star is None and len(found) > least):
        which = ", those of a vector in the plane" if isinstance(value_in_run(assigned), Vector) else ""
        problem = ValueError(f"{least} values {'or more ' if star is not None else ''}are needed to unpack into these names, not {len(found)}{which}")
        raise HostException(problem, assigned.origin if type(assigned) is Random else None)
    if star is None:
        return found
    after = len(items) - star - 1
    return [*found[:star], found[star : len(found) - after], *found[len(found) - after :]]


EGO_HINTS = {False: "write ego = Object ..., or a class below Object", True: "a comma at the end makes a tuple: leave it out"}


def assign_name(name: str, assigned: object, node: Node, state: State) -> State:
    """σ[x/v]; `ego` and `workspace` are shared by all modules; an Object keeps the name it is first assigned to."""
    inner = value_in_run(assigned)
    if name == "ego":
        if not (isinstance(inner, Instance) and is_object(inner)):
            hint = EGO_HINTS[isinstance(inner, tuple)]
            if isinstance(inner, ScenicClass) and state.settings.dialect == "scenic-3":
                hint = "write `new` before the class"
            raise RunError("ego must be an Object", node.span, rule="S-Assignment", hint=hint)
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
    if type(subject) is Random:
        raise random_write(subject, node)
    inner = subject
    match inner:
        case Instance():
            refuse_controlled(inner, canonical(name, state.settings.readings), node, state)
            unwrap(assigned)  # it may not wait for a position
            checked = checked_property(canonical(name, state.settings.readings), assigned, node.span, f".{name} =", state)
            return state.with_properties(inner, {canonical(name, state.settings.readings): checked})
        case Module():
            inner.scope.put(name, assigned)
            return state
        case ScenicClass() | Function() | Method():
            raise RunError(f"attributes of {inner!r} cannot be assigned", node.span, rule="S-Assignment")
        case Region() if not is_user_made(inner):
            raise RunError(
                f"regions do not change: {name} of {kind_name(inner)} cannot be assigned", node.span, rule="S-Assignment",
                hint="give it where the region is made, as in PolygonalRegion(points, orientation=F), or write `facing F` at the objects in it",
            )
        case _ if is_user_made(inner):
            if is_hidden(name):
                raise RunError(f"{name} is private to Python objects", node.span, rule="S-Assignment")
            if isinstance(inner, type) and name in OVERRIDES and not may_override(name, assigned):
                raise RunError(f"{name} must be a function of the program", node.span, rule="S-Assignment")
            note_attribute(state.settings.door.budget, inner, name)
            raw(state.settings.door, state, setattr, inner, name, as_member(name, assigned) if isinstance(inner, type) else assigned)
            return state
        case _:
            raise HostException(AttributeError(f"attribute {name} of a {type(inner).__name__} cannot be assigned"))


def refuse_controlled(target: Instance, name: str, node: Node, state: State) -> None:
    """Properties that the simulator updates "are controlled using actions and not direct assignments" (Section "Statements", "Overrides").

    Objects of a setup block that is not over are not in the simulation yet. Raises `RunError`.
    """
    simulation = state.simulation
    if simulation is not None and name in simulation.fixed and target.number < simulation.known and is_object(target):
        raise RunError(
            f"{name} of {target!r} is updated by the simulator: it cannot be assigned", node.span, rule="S-Assignment",
            hint="take an action that changes it; before the simulation, and in the setup block that makes the object, it can be assigned",
        )


def set_item(container: object, index: object, assigned: object, node: Node, state: State) -> None:
    """`container[index] = v`; the element keeps its randomness."""
    if type(container) is Random:
        raise random_write(container, node)
    if type(container) is Waiting:
        raise needs_position(container)
    if isinstance(index, slice) and isinstance(container, list):
        assigned = elements(assigned, node, state)
    note_item(state.settings.door.budget, container, index)
    raw(state.settings.door, state, python.setitem, container, index, assigned)


def augmented_assignment(node: s.AugmentedAssignment, stack: Stack, state: State) -> Outcome:
    """`x += E`: in place for lists, sets and dicts, as in Python."""
    return premises(node, [*target_premises(node.target)], conclude_augmented_target, stack, state)


def conclude_augmented_target(node: s.AugmentedAssignment, parts: list[object], stack: Stack, state: State) -> Outcome:
    """Read the target's value, whose inner expressions have been reduced once; then reduce the operand."""
    match node.target:
        case p.Attribute() as target:
            if type(parts[0]) is Random:
                raise random_write(parts[0], node)
            current = get_attribute(parts[0], target, state)
        case p.Subscript() as target:
            current = get_item(target, parts, state)
        case target:
            current = axiom(target, state)
    read = [*parts, current]
    return premises(node, [*[None] * len(read), node.value], conclude_augmented, stack, state, read)


def conclude_augmented(node: s.AugmentedAssignment, values: list[object], stack: Stack, state: State) -> Outcome:
    """Compute the new value and bind it."""
    *parts, current, operand = values
    operation = IN_PLACE[node.operator]
    if any(type(v) is Waiting for v in (current, operand)) and not isinstance(current, CHANGEABLE):
        binary = p.BinaryOperation(operator=node.operator, left=p.Constant(value=None), right=node.value, span=node.span)
        result = wait(binary, (current, operand), conclude_binary, state)
    elif hasattr(type(value_in_run(current)), f"__{operation.__name__}__"):
        result = change_in_place(node, operation, current, operand, state)
    else:
        result = host(state.settings.door, state, BINARY[node.operator], *as_vectors([current, operand], state))
    state = assign(node.target, result, parts, state)
    return assigned_to(node.target, result, node, stack, state)


def change_in_place(node: s.AugmentedAssignment, operation: Callable[..., object], current: object, operand: object, state: State) -> object:
    """`x += E` on a value that can be changed: elements keep their randomness, but how many there are and which may not be random."""
    door = state.settings.door
    if type(current) is Random:
        raise random_write(current, node)
    note_container(state.settings.door.budget, current)
    if isinstance(current, list) and node.operator == "+" and not is_user_made(current):
        current.extend(elements(operand, node, state))
        return current
    if not is_user_made(current) and (type(operand) is Random or (not isinstance(current, dict) and unwrap(operand)[1] is not None)):
        raise RunError(
            f"`{node.operator}=` with a random operand would change {kind_name(current)} at random", node.span, rule="S-Assignment",
            hint=f"make a new one: x = x {node.operator} ...",
        )
    if isinstance(current, (list, deque)) and node.operator == "*" and hasattr(type(operand), "__index__"):
        refuse_too_long(container_length(current) * (times := as_whole_number(operand)))
        operand = operand if isinstance(operand, int) or hasattr(type(operand), "__rmul__") else times
    return raw(door, state, operation, current, operand)


IN_PLACE: Mapping[str, Callable[..., object]] = {
    "+": python.iadd, "-": python.isub, "*": python.imul, "/": python.itruediv, "//": python.ifloordiv, "%": python.imod, "**": python.ipow,
    "<<": python.ilshift, ">>": python.irshift, "&": python.iand, "|": python.ior, "^": python.ixor,
}


def delete(node: s.Delete, stack: Stack, state: State) -> Outcome:
    """The containers and indices in `del x, a[i]` come first."""
    return premises(node, [part for t in node.targets for part in target_premises(t)], conclude_delete, stack, state)


def assigned_for_all(name: str, state: State) -> bool:
    """Return whether `ego` or `workspace` has been assigned: all modules share it, and the scene needs it."""
    return (state.ego if name == "ego" else state.workspace) is not None


def conclude_delete(node: s.Delete, values: list[object], stack: Stack, state: State) -> Outcome:
    """⟨del x, σ⟩ → ⟨pass, σ without x⟩; `del a[i]` takes the element out of the container."""
    rest = iter(values)
    for target in node.targets:
        match target:
            case p.Name(name="ego" | "workspace" as name) if assigned_for_all(name, state):
                raise RunError(f"{name} cannot be deleted", target.span, rule="S-Delete", hint=f"assign it again instead: {name} = ...")
            case p.Name(name=name):
                if state.sigma.unbind(name) is MISSING:
                    raise RunError(f"{name} is not defined", target.span, rule="S-Delete")
            case p.Attribute():
                next(rest)
                raise RunError("attributes cannot be deleted", target.span, rule="S-Delete")
            case p.Subscript():
                container, *parts = (next(rest) for _ in target_premises(target))
                if type(container) is Random:
                    raise random_write(container, target)
                note_container(state.settings.door.budget, container)
                raw(state.settings.door, state, python.delitem, container, assignment_index(target, parts))
            case _:
                raise AssertionError(type(target))
    return finish_statement("S-Delete", node, stack, state)
