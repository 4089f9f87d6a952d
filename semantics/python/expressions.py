"""Expressions inherited from Python: displays, attributes, subscripts, arithmetic, comparisons, boolean operators.

Their rules are standard, and "we essentially use without change" what Python does. What differs from Python: an operation on a random value gives a
random value, and nothing may branch on one outside behaviors (reading `random-branch`).
"""

from __future__ import annotations

import operator as python
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import BuiltinFunctionType
from typing import Any

from ..machine.conditions import is_counted
from ..machine.config import Stack, State, value
from ..machine.draws import draw
from ..machine.host_calls import HostException, decided_by, host, raw
from ..machine.implicit_positions import wait
from ..machine.operand_kinds import Reader, has_kind, is_a, is_pair, kind_name, missing_member_error, no_attribute
from ..machine.outcome import Outcome
from ..machine.premises import premises, raw_axiom
from ..machine.sandbox_table import is_given, is_record, is_user_made, may_ask, names_in
from ..machine.values import (
    Bound,
    Constructor,
    Dynamic,
    Function,
    Instance,
    Method,
    Module,
    Native,
    Random,
    Special,
    each,
    unwrap,
    value_in_run,
    with_random_keys,
    wrap,
)
from ..machine.world_queries import Clock, Closest, Parameters, attribute_of_clock
from ..space.distributions.families import Range
from ..space.fields import VectorField
from ..space.regions import PlaneShape, PolylineRegion
from ..space.vectors import Vector
from ..store.built_in_classes import canonical
from ..store.errors import NotBegun, RunError
from ..store.postponed_values import Waiting, needs_position
from ..store.scenic_classes import Above, ScenicClass
from ..store.scopes import BEGUN, MISSING, Scope, function_names
from ..store.sets import Set
from ..store.suggestions import did_you_mean, note_keys
from ..store.undo_log import note_call, note_item
from ..syntax import expressions as e
from ..syntax import python_expressions as p
from ..syntax.nodes import Node
from .arithmetic import BINARY, UNARY, puts_together
from .call_costs import check_key, check_keys
from .iteration import elements
from .library import ascii_of, attribute_of, bound, method_of
from .released_members import Member, member, own_name, rewritten
from .string_methods import addressless_format as format_value
from .string_methods import addressless_repr, addressless_str, stable_repr


def member_of(found: object, subject: object | None, class_: object, state: State) -> object:
    """A member of a class, of one of its instances or (`subject` is None) of the class itself: methods know of what they are."""
    match found:
        case staticmethod(__func__=function):
            return function
        case classmethod(__func__=Function() as function):
            return Method(function, class_, function.door)
        case property() if subject is not None:
            return raw(state.settings.door, state, found.__get__, subject, Instance)
        case Function() if subject is not None:
            return Method(found, subject, found.door)
    return found


NOTHING_TO_DO = Native("__init__", lambda *arguments, **keywords: None)
"""The `__init__` of a Scenic class: what there is to do is done when the instance is made."""


def attribute_above(above: Above, name: str, state: State) -> object:
    """`super().name`: that of the first class behind the one of the method that has it."""
    subject = above.subject
    is_class = isinstance(subject, (type, ScenicClass))
    for class_ in above.classes:
        if isinstance(class_, type) and is_user_made(class_) and not is_given(class_, name):
            continue
        if isinstance(class_, type) and is_record(class_) and not is_class:
            return raw(state.settings.door, state, of_subject, vars(class_)[name], subject)
        members = class_.methods if isinstance(class_, ScenicClass) else vars(class_) if is_user_made(class_) else {}
        if name in members:
            inner = value_in_run(subject)
            own = inner.class_ if isinstance(inner, Instance) else inner if is_class else type(inner)
            return member_of(members[name], None if is_class else subject, own, state)
        if isinstance(class_, type) and is_user_made(subject) and not is_class and not is_user_made(class_) and may_ask(class_, name):
            return method_of_python(class_, name, subject, state)
    if name == "__init__":
        return NOTHING_TO_DO
    raise HostException(AttributeError(f"super() has no attribute {name}"))


def method_of_python(class_: type, name: str, subject: object, state: State) -> object:
    """`super().name` where it is of a Python class below which the class of the program stands."""
    ours = method_of(class_, name, state.settings.door.budget)
    if isinstance(ours, Bound):  # which takes the subject first
        return replace(ours, subject=(subject,))
    found: Any = next((vars(c)[name] for c in class_.__mro__ if name in vars(c)), MISSING)
    if found is MISSING:
        raise HostException(AttributeError(f"super() has no attribute {name}"))
    return raw(state.settings.door, state, of_subject, found, subject)


def of_subject(found: Any, subject: object) -> object:
    """Return a member of a class as its instance sees it."""
    return found.__get__(subject, type(subject)) if hasattr(found, "__get__") else found


def interval_or_pair(node: e.IntervalOrPair, stack: Stack, state: State) -> Outcome:
    """`(low, high)` of dialect `pldi19` (reading `intervals`)."""
    return premises(node, [node.low, node.high], conclude_interval, stack, state)


def conclude_interval(node: e.IntervalOrPair, values: list[object], stack: Stack, state: State) -> Outcome:
    """Uniform on the interval if both ends are scalars, otherwise a pair."""
    if all(has_kind(value_in_run(v), "scalar") for v in values):
        return draw(node, RANGE, tuple(values), {}, stack, state)
    return display_items(tuple, values, node, stack, state)


RANGE = Constructor("Range", Range, keeps_values=False, takes="low, high")


def axiom_rule(node: Node, stack: Stack, state: State) -> Outcome:
    """⟨c⟩ → c and ⟨x⟩ → σ(x)."""
    return value("E-Variable" if isinstance(node, p.Name) else "E-Constant", raw_axiom(node, state), stack, state, node)


# Displays


def display(node: p.TupleDisplay | p.ListDisplay | p.SetDisplay, stack: Stack, state: State) -> Outcome:
    """`(a, *b)`, `[a, *b]`, `{a, *b}`: the elements keep their randomness, the container has none of its own."""
    return premises(node, [i.value if isinstance(i, p.Starred) else i for i in node.items], conclude_display, stack, state)


def conclude_display(node: p.TupleDisplay | p.ListDisplay | p.SetDisplay, values: list[object], stack: Stack, state: State) -> Outcome:
    """Put the elements together."""
    items: list[object] = []
    for expression, item in zip(node.items, values, strict=True):
        if isinstance(expression, p.Starred):
            items.extend(elements(item, expression, state))
        else:
            items.append(item)
    kind = {p.TupleDisplay: tuple, p.ListDisplay: list, p.SetDisplay: Set}[type(node)]
    return display_items(kind, items, node, stack, state)


def display_items(kind: Callable[[list], object], items: list, node: Node, stack: Stack, state: State) -> Outcome:
    """If ⟨E_i⟩ → v_i then ⟨(E_1, ..., E_n)⟩ → (v_1, ..., v_n), and likewise for lists, sets and dictionaries."""
    return value("E-Display", container(kind, items, state), stack, state, node)


def container(kind: Callable[[list], object], items: list, state: State) -> object:
    """A container of the items. What a class of the program raises where its instances are hashed is the program's to catch."""
    if kind is not Set and kind is not dict:
        return kind(items)
    with decided_by(unwrap(items if kind is Set else [key for key, _ in items])[1], state):
        return raw(state.settings.door, state, hashed_container, kind, items)


def hashed_container(kind: Callable[[list], object], items: list) -> object:
    """A set or a dictionary of the items, random as a whole if members or keys are. Raises `TypeError` for unhashable ones."""
    plain_keys, origin = unwrap(items if kind is Set else [key for key, _ in items])
    check_keys(plain_keys)  # type: ignore[arg-type]
    if origin is None:
        return kind(items)
    plain_items = unwrap(items)[0]
    return wrap((with_random_keys if kind is dict else kind)(plain_items), origin)  # type: ignore[arg-type]


def dict_display(node: p.DictDisplay, stack: Stack, state: State) -> Outcome:
    """`{k: v, **m}`."""
    expressions = [part for key, item in node.items for part in (key, item)]
    return premises(node, expressions, conclude_dict, stack, state)


def conclude_dict(node: p.DictDisplay, values: list[object], stack: Stack, state: State) -> Outcome:
    """Put the entries together, later ones winning."""
    entries: list[tuple[object, object]] = []
    for index, (key_expression, _) in enumerate(node.items):
        key, item = values[2 * index], values[2 * index + 1]
        if key_expression is not None:
            entries.append((key, item))
            continue
        mapping = value_in_run(item)
        if not isinstance(mapping, Mapping):
            raise HostException(TypeError(f"{kind_name(item)} is not a mapping"))
        origin = item.origin if type(item) is Random else None
        entries += [(wrap(k, origin), wrap(v, origin)) for k, v in mapping.items()]
    return display_items(dict, entries, node, stack, state)


def f_string_rule(node: p.FString, stack: Stack, state: State) -> Outcome:
    """The values of an f-string come first."""
    expressions: list[Node | None] = []
    for part in node.parts:
        if isinstance(part, p.FormattedValue):
            expressions += [part.value, part.format]
    return premises(node, expressions, conclude_formatted, stack, state)


def conclude_formatted(node: p.FString, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E_i⟩ → v_i then ⟨f"...{E_i}..."⟩ → the text with each v_i formatted in its place."""
    conversions = {"": lambda v: v, "r": addressless_repr, "s": addressless_str, "a": ascii_of}

    def join(*parts: object) -> str:
        rest = iter(parts)
        return "".join(
            part if isinstance(part, str) else format_value(conversions[part.conversion](next(rest)), str(next(rest) or "")) for part in node.parts
        )

    texts = [instance_text(v, state) for v in values]
    return value("E-FString", host(state.settings.door, state, join, *texts), stack, state, node)


def instance_text(argument: object, state: State) -> object:
    """An instance as `print`, `str` and f-strings show it, with its class and position; other values as they are."""
    inner = value_in_run(argument)
    if not isinstance(inner, Instance):
        return argument
    position, origin = unwrap(state.objects[inner.number].get("position"))
    return wrap(f"{inner.class_.name} at {position}", argument.origin if type(argument) is Random else origin)


# Attributes and subscripts


def attribute(node: p.Attribute, stack: Stack, state: State) -> Outcome:
    """The object of `E.name` comes first."""
    return premises(node, [node.value], conclude_attribute, stack, state)


def conclude_attribute(node: p.Attribute, values: list[object], stack: Stack, state: State) -> Outcome:
    """The object is known: its attribute."""
    subject = values[0]
    found = member(subject, node.name, state)
    if found is not None:
        rewrite, is_method = found
        if is_method:
            return attribute_is(node, Member(subject, node.name, rewrite), stack, state)
        return rewritten(node, rewrite, (subject,), stack, state)
    if type(subject) is not Random:
        return attribute_is(node, get_attribute(subject, node, state), stack, state)
    shared = shared_method(subject, node.name, state)
    if shared is not None:
        return attribute_is(node, shared, stack, state)

    def of_one(one: object) -> object:
        return get_attribute(one, node, state)

    of_one.__qualname__ = f"there is {node.name}"
    with decided_by(subject.origin, state):
        inner, origin = unwrap(each(of_one, subject.value))
    return attribute_is(node, wrap(inner, subject.origin or origin), stack, state)


def attribute_is(node: Node, result: object, stack: Stack, state: State) -> Outcome:
    """If ⟨E⟩ → o then ⟨E.name⟩ → O(o.name) for an instance o, and the attribute of anything else; `getattr` and `hasattr` alike."""
    return value("E-Attribute", result, stack, state, node)


def shared_method(subject: Random, name: str, state: State) -> Method | None:
    """A method of the program that all instances have among which a draw chose: which one runs is then not random."""
    support = subject.origin.distribution.support() if subject.origin.distribution is not None else None
    if support is None or not isinstance(subject.value, Instance) or canonical(name, state.settings.readings) in state.objects[subject.value.number]:
        return None
    found = {value_in_run(v).class_.method(name) if isinstance(value_in_run(v), Instance) else None for v, _ in support}  # type: ignore[attr-defined]
    method = found.pop() if len(found) == 1 else None
    return Method(method, subject, method.door) if isinstance(method, Function) else None


def get_attribute(subject: object, node: p.Attribute, state: State) -> object:
    """The attribute of a value that is not wrapped."""
    name = node.name
    match subject:
        case Waiting(missing=NotBegun() as missing):
            return wait(node, (subject,), conclude_attribute, state, missing)
        case Waiting():
            raise needs_position(subject)
        case Clock():
            return attribute_of_clock(name, node, state)
        case Above():
            return attribute_above(subject, name, state)
        case Parameters():
            if name not in state.params and name in ("get", "keys", "values", "items"):
                return get_attribute(dict(state.params), node, state)
            if name not in state.params:
                error = AttributeError(f"there is no global parameter {name}")
                error.add_note(did_you_mean(name, state.params, f"set it first, param {name} = VALUE, or give it from outside, -p {name}=VALUE"))
                raise HostException(error)
            return state.params[name]
        case Instance():
            return instance_attribute(subject, name, state)
        case Module():
            result = subject.scope.bindings.get(name, MISSING)
            if result is MISSING:
                known = [n for n in subject.scope.bindings if not n.startswith("_")]
                raise HostException(
                    missing_member_error(subject.name, name, AttributeError(f"module {subject.name} has no {name} in this reference"), known)
                )
            return result
        case ScenicClass():
            found = subject.method(name)
            if found is None and name == "__name__":
                return subject.name
            if found is None:
                raise HostException(AttributeError(f"class {subject.name} has no attribute {name}; a property needs an instance"))
            return member_of(found, None, subject, state)
        case Dynamic(space=Scope() as space) if BEGUN not in space.bindings and (name == "ego" or name in function_names(subject.definition).local):
            missing = NotBegun(f"{subject!r} was asked for its {name} before it began: ask once `do` has set it up")
            if state.reading("names-not-begun") == "waits":
                return wait(node, (subject,), conclude_attribute, state, missing)
            raise HostException(missing)
        case Dynamic(space=Scope() as space) if name in space.bindings or (name == "ego" and state.ego is not None):
            return space.bindings.get(name, state.ego)  # all scenarios share ego (reading `ego-of-scenarios`)
        case _ if name == "__name__" and (own := own_name(subject)) is not None:
            return own
        case Function() | Method() | Dynamic():
            raise HostException(AttributeError(f"{subject!r} has no attribute {name}"))
        case Native(members=members) | Bound(members=members) if name in members:
            return bound(members[name], state.settings.door.budget)
        case _:
            return get_host_attribute(subject, name, node, state)


def resolve_waiting(value: object, state: State) -> object:
    """Resolve a value that waited for a scenario that has begun since, or keep it if that is still missing
    (reading `names-not-begun=waits`); other values as they are.
    """
    if type(value) is not Waiting or value.missing is None:
        return value
    return get_attribute(value_in_run(resolve_waiting(value.values[0], state)), value.node, state)  # type: ignore[arg-type]


def get_host_attribute(subject: object, name: str, node: p.Attribute, state: State) -> object:
    """An attribute of the table, or of a class of the program; a container's methods stay those of the container itself, random elements and all."""
    door, is_open = state.settings.door, may_ask(subject, name)
    if state.settings.trusted and not name.startswith("_"):
        return raw(door, state, getattr, subject, name)
    if name in ("x", "y") and is_pair(subject) and state.reading("pairs") == "vector":
        return subject["xy".index(name)]  # type: ignore[index]
    if is_open:
        return raw(door, state, attribute_of, subject, name, door.budget)
    fallback = getattr(type(subject), "__getattr__", None) if is_user_made(subject) and not isinstance(subject, type) else None
    if isinstance(fallback, Function):
        return raw(door, state, fallback, subject, name)
    if name.startswith("_") and subject is not None:
        raise RunError(f"names with a leading underscore, such as {name}, are private to Python objects", node.span, rule="E-Attribute")
    error = no_attribute(kind_name(subject), name, names_in(subject))
    if isinstance(subject, PlaneShape):
        error.add_note(f"of what shapely gives its shapes, these have {', '.join(sorted(names_in(subject)))}")
    raise HostException(error)


def instance_attribute(instance: Instance, name: str, state: State) -> object:
    """O(instance.name), or a method of its class."""
    properties = state.objects[instance.number]
    result = properties.get(canonical(name, state.settings.readings), MISSING)
    if result is not MISSING:
        return result
    found = instance.class_.method(name)
    if found is None and name == "distanceToClosest":
        return Closest(instance)
    if found is None:
        error = no_attribute(instance.class_.name, name, properties, "property")
        if name == "height":  # under `height=own`
            error.add_note("the third extent that Scenic 3 gives every object does not exist in the plane: give it one by `with height`")
        raise HostException(error)
    return member_of(found, instance, instance.class_, state)


def subscript(node: p.Subscript, stack: Stack, state: State) -> Outcome:
    """The container and the index of `E[I]`, or of `E[a:b:c]`, come first."""
    index = node.index
    parts = [index.lower, index.upper, index.step] if isinstance(index, p.Slice) else [index]
    return premises(node, [node.value, *parts], conclude_subscript, stack, state)


def conclude_subscript(node: p.Subscript, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E⟩ → c and ⟨I⟩ → i then ⟨E[I]⟩ → c[i]: the element keeps its own randomness; a random index or container makes it random."""
    if len(values) == 2 and is_a(value_in_run(values[0]), VectorField):
        return rewritten(node, lambda f, v: e.FieldAt(field=f, vector=v), (values[0], values[1]), stack, state)
    if len(values) == 2 and is_a(value_in_run(values[0]), PolylineRegion):
        points = p.Attribute(value=p.Constant(value=values[0]), name="points")
        return rewritten(node, lambda i: p.Subscript(value=points, index=i), (values[1],), stack, state)
    return value("E-Subscript", get_item(node, values, state), stack, state, node)


def get_item(node: p.Subscript, values: list[object], state: State) -> object:
    """The element of a container, whose value comes first, at an index, or from, to and step of a slice."""
    container, *parts = values
    if type(container) is Waiting:
        raise needs_position(container)
    places, origin = unwrap(parts)
    if type(container) is Random:
        container, origin = container.value, container.origin
    if type(container) is Parameters:
        container = dict(state.params)
    index = slice(*places) if isinstance(node.index, p.Slice) else places[0]  # type: ignore[misc, index]
    check_key(index)
    if isinstance(container, defaultdict):  # which makes what is missing
        note_item(state.settings.door.budget, container, index)
        note_call(state.settings.door.budget, container.default_factory, ())
    try:
        with decided_by(origin, state):
            result = raw(state.settings.door, state, python.getitem, container, index)
    except HostException as problem:
        note_keys(problem.exception, container, index)
        if isinstance(problem.exception, TypeError) and isinstance(container, CALLED):
            raise HostException(in_square_brackets(node), problem.origin, node.span) from None
        if isinstance(problem.exception, IndexError) and isinstance(container, SEQUENCES):
            problem.exception.add_note(describe_index_range(len(container)))
        raise
    return result if origin is None else wrap(unwrap(result)[0], origin)


CALLED = (type, Function, Method, Constructor, Special, Native, BuiltinFunctionType, Closest, Dynamic)
"""What is called with parameters, and has no elements."""


def in_square_brackets(node: p.Subscript) -> TypeError:
    """The exception for parameters in square brackets, with what to write."""
    name, items = as_written(node.value), node.index.items if isinstance(node.index, p.TupleDisplay) else (node.index,)
    given = [as_written(item) for item in items]
    error = TypeError(f"the parameters of {name or 'a function'} stand in round brackets")
    error.add_note(f"write `{name or 'f'}({'...' if '' in given else ', '.join(given)})`")
    return error


def as_written(node: Node) -> str:
    """The text of a constant or a name with dots; "" for other expressions."""
    match node:
        case p.Constant(value=int() | float() | str() as constant) if not isinstance(constant, str) or len(constant) <= LONGEST:
            return stable_repr(constant)
        case p.UnaryOperation(operator="-", operand=p.Constant() as operand):
            return f"-{as_written(operand)}"
        case p.Name(name=name):
            return name
        case p.Attribute(value=inner, name=name) if (before := as_written(inner)):
            return f"{before}.{name}"
        case _:
            return ""


LONGEST = 40
"""Longer texts are not told again."""
SEQUENCES = (list, tuple, str)


def describe_index_range(length: int) -> str:
    """Which elements a sequence of that length has."""
    if length < 2:
        return "its only element has the number 0" if length else "it is empty"
    return f"its {length:,} elements are numbered from 0 to {length - 1:,}"


# Arithmetic


def apply_host(rule: str, node: Node, function: Callable[..., object], values: list[object], stack: Stack, state: State) -> Outcome:
    """Conclude with a Python operation; the fast path is for two plain numbers."""
    if len(values) == 2:
        left, right = values
        if type(left) is float and type(right) is float:
            try:
                return value(rule, function(left, right), stack, state, node)
            except ArithmeticError as exception:
                raise HostException(exception) from exception
    return value(rule, host(state.settings.door, state, function, *values), stack, state, node)


def binary(node: p.BinaryOperation, stack: Stack, state: State) -> Outcome:
    """`E1 + E2` and the other arithmetic operators."""
    return premises(node, [node.left, node.right], conclude_binary, stack, state)


def conclude_binary(node: p.BinaryOperation, values: list[object], stack: Stack, state: State) -> Outcome:
    """Python's arithmetic; a Point operand is read as its position (Section "Data Types")."""
    operands = as_vectors(values, state)
    if node.operator in "+-*/" and state.reading("pairs") == "vector" and any(map(is_pair, operands)):
        operands = pairs_as_vectors(node.operator, operands, state)
    return arithmetic(node, BINARY[node.operator], operands, stack, state)


def arithmetic(node: Node, operation: Callable[..., object], operands: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E1⟩ → v1 and ⟨E2⟩ → v2 then ⟨E1 ⊕ E2⟩ → v1 ⊕ v2, and ⟨⊖E⟩ → ⊖v likewise, as in Python."""
    if isinstance(node, p.BinaryOperation) and puts_together(node.operator, operands):  # what it holds stays as random as it is
        result = raw(state.settings.door, state, operation, *operands)
        state.settings.door.budget.made(value_in_run(result))
        return value("E-Arithmetic", result, stack, state, node)
    return apply_host("E-Arithmetic", node, operation, operands, stack, state)


def pairs_as_vectors(operator: str, operands: list[object], state: State) -> list[object]:
    """Pairs of scalars as vectors where the operator is one of vectors: two of them, or one and a scalar (reading `pairs`)."""
    others = [unwrap(v)[0] for v in operands if not is_pair(v)]
    if operator in "+-":
        fits = all(isinstance(v, Vector) for v in others)
    else:
        fits = len(others) == 1 and has_kind(others[0], "scalar") and not (operator == "/" and is_pair(operands[1]))
    return [as_vector(v, state) for v in operands] if fits else operands


def as_vector(value: object, state: State) -> object:
    """A pair of scalars as a vector, random if one of them is; anything else as it is."""
    if not is_pair(value):
        return value
    reader = Reader(state)
    return reader.wrap(reader.read(reader.plain(value), "vector"))


def as_vectors(values: list[object], state: State) -> list[object]:
    """Instances replaced by their positions."""
    return [state.objects[v.number]["position"] if isinstance(v, Instance) else v for v in values]


def unary(node: p.UnaryOperation, stack: Stack, state: State) -> Outcome:
    """`-E`, `+E`, `~E`, `not E`."""
    return premises(node, [node.operand], conclude_unary, stack, state)


def conclude_unary(node: p.UnaryOperation, values: list[object], stack: Stack, state: State) -> Outcome:
    """Apply one of Python's unary operators."""
    operation = UNARY[node.operator]
    return conclude_not(node, operation, values, stack, state) if node.operator == "not" else arithmetic(node, operation, values, stack, state)


def conclude_not(node: Node, operation: Callable[..., object], operands: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨B⟩ → b then ⟨not B⟩ → ¬b."""
    if is_counted(operands[0]):
        return value("E-Not", not operands[0], stack, state, node)
    return apply_host("E-Not", node, operation, operands, stack, state)


def seconds(node: e.Seconds, stack: Stack, state: State) -> Outcome:
    """`E seconds` is E, in seconds (reading `time-unit`)."""
    return premises(node, [node.value], conclude_seconds, stack, state)


def conclude_seconds(node: e.Seconds, values: list[object], stack: Stack, state: State) -> Outcome:
    """If ⟨E⟩ → v then ⟨E seconds⟩ → v: a duration in seconds is a scalar."""
    if not has_kind(value_in_run(values[0]), "scalar"):
        raise RunError(f"`seconds` expects a scalar, not {kind_name(values[0])}", node.span, rule="E-Seconds")
    return value("E-Seconds", values[0], stack, state, node)

