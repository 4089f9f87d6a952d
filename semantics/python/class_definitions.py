"""Definitions of Scenic and Python classes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..machine.config import Abrupt, Config, Stack, State
from ..machine.host_calls import HostException
from ..machine.operand_kinds import kind_name
from ..machine.outcome import Change, Next, Outcome
from ..machine.premises import premises
from ..machine.sandbox_table import MARK, OVERRIDES, as_member, is_base, is_hidden, may_override
from ..machine.values import value_in_run
from ..store.built_in_classes import OBJECT_CLASS, canonical, defaults_of
from ..store.errors import CheckError, RunError, ScenicError
from ..store.scenic_classes import ScenicClass
from ..store.scopes import NO_NAMES, Scope, target_names
from ..syntax import statements as s
from ..syntax.nodes import Node, Span
from .assignment import finish_statement
from .control_flow import block

# Classes


class ClassBody(NamedTuple):
    """Frame of the Python part of a class body: methods and class attributes."""

    node: s.ClassDefinition
    outer: Scope
    superclasses: tuple[ScenicClass, ...] | tuple[type, ...]


def class_definition(node: s.ClassDefinition, stack: Stack, state: State) -> Outcome:
    """Object is the default superclass (paper, Section "Data Types")."""
    return premises(node, node.superclasses, conclude_superclasses, stack, state)


def conclude_superclasses(node: s.ClassDefinition, values: list[object], stack: Stack, state: State) -> Outcome:
    """Below Scenic classes it is a Scenic class, below Python classes a Python class."""
    superclasses = [value_in_run(v) for v in values] or [OBJECT_CLASS]
    scope = Scope("class", state.sigma, NO_NAMES)
    inner = state._replace(sigma=scope)
    if isinstance(superclasses[0], ScenicClass):
        foreign = next((c for c in superclasses if not isinstance(c, ScenicClass)), None)
        if foreign is not None:
            what = f"the Python class {foreign.__name__}" if isinstance(foreign, type) else kind_name(foreign)
            raise RunError(f"the Scenic class {node.name} cannot be derived from {what} as well", node.span, rule="S-Class")
        return block(node.body, (ClassBody(node, state.sigma, tuple(superclasses)), stack), inner)  # type: ignore[arg-type]
    for superclass in superclasses:
        if not (isinstance(superclass, type) and (state.settings.trusted or is_base(superclass))):
            name = superclass.__name__ if isinstance(superclass, type) else kind_name(superclass)
            raise RunError(f"{node.name} cannot be a subclass of {name}", node.span, rule="S-Class")
    if node.properties:
        raise RunError(
            f"{node.name} is a Python class, so it has no properties", node.properties[0].span, rule="S-Class",
            hint="derive it from Object, or leave the superclass out",
        )
    return block(node.body, (ClassBody(node, state.sigma, tuple(superclasses)), stack), inner)  # type: ignore[arg-type]


def resume_class_body(frame: ClassBody, result: object, stack: Stack, state: State) -> Outcome:
    """⟨class C(superclass): property: E ..., σ⟩ → ⟨pass, σ[C / the class]⟩."""
    node = frame.node
    members = state.sigma.bindings
    outer = state._replace(sigma=frame.outer)
    state.settings.door.state = state  # an enumeration may run functions of the program when it is made
    above = frame.superclasses
    is_scenic = isinstance(above[0], ScenicClass)
    made = make_scenic_class(node, above, members, frame.outer, state.settings.readings) if is_scenic else make_python_class(node, above, members)  # type: ignore[arg-type]
    frame.outer.bind(node.name, made)
    return finish_statement("S-Class", node, stack, outer, Change("σ", node.name, made))


def unwind_class_body(frame: ClassBody, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception in the body: restore σ."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def place_of_member(name: str, node: s.ClassDefinition) -> Span:
    """The statement in the body of a class that binds a name; the class itself where none does directly."""
    for statement in node.body:
        targets = statement.targets if isinstance(statement, s.Assignment) else ()
        bound = {one for target in targets for one in target_names(target)}
        if name in bound or getattr(statement, "name", None) == name:
            return statement.span
    return node.span


def make_scenic_class(
    node: s.ClassDefinition, superclasses: tuple[ScenicClass, ...], members: Mapping[str, object], scope: Scope, readings: Mapping[str, str]
) -> ScenicClass:
    """The class with its own default value expressions; they are evaluated for each object."""
    try:
        inheriting = ScenicClass(node.name, superclasses, {}, scope)
        inherited = defaults_of(inheriting, readings)
    except TypeError as exception:
        raise HostException(exception) from None
    defaults: dict[str, Node] = {}
    check_finals(node, inheriting, readings)
    for default in node.properties:
        name = canonical(default.name, readings)
        if name in defaults:
            raise CheckError(f"the property {name} has two defaults in class {node.name}", default.span)
        defaults[name] = default.value
    for name in members:
        if canonical(name, readings) in inherited:
            owner = inherited[canonical(name, readings)][1]
            raise RunError(
                f"{name} is a property of {owner.name}, and `=` does not give it a default", place_of_member(name, node), rule="S-Class",
                hint=f"write {name}: ...",
            )
    if "__init__" in members:
        raise RunError(
            f"the Scenic class {node.name} has no __init__: its objects are made from specifiers", node.span, rule="S-Class",
            hint=f"for a Python class write class {node.name}(object):",
        )
    special = next((name for name in members if name in OVERRIDES and name != "__doc__"), None)
    if special is not None:
        text = f"a Scenic class cannot say what {special} is: its instances are shown, compared and combined as the language does it"
        raise RunError(text, node.span, rule="S-Class", hint=f"give the method another name, or write class {node.name}(object): for a Python class")
    finals, additives = (frozenset(canonical(d.name, readings) for d in node.properties if a in d.attributes) for a in ("final", "additive"))
    return ScenicClass(node.name, superclasses, defaults, scope, dict(members), node.span, own_finals=finals, own_additives=additives)


def check_finals(node: s.ClassDefinition, inheriting: ScenicClass, readings: Mapping[str, str]) -> None:
    """The released Scenic 3: no class before another one in the lineage gives a default to a final property of that one."""
    own = {canonical(default.name, readings): default.span for default in node.properties}
    lineage = inheriting.lineage
    for i, owner in enumerate(lineage):
        for name in sorted(owner.own_finals):
            overriding = node.name if name in own else next((c.name for c in lineage[:i] if name in c.own_defaults), None)
            if overriding is not None:
                raise RunError(
                    f"the property {name} of {owner.name} is final: {overriding} cannot give it another default", own.get(name, node.span),
                    rule="S-Class", hint=f"leave out [final] in {owner.name}, or the default",
                )


def make_python_class(node: s.ClassDefinition, superclasses: tuple[type, ...], members: Mapping[str, object]) -> type:
    """A Python class; its methods are functions of the program. An enumeration's members are made by the enumeration."""
    hidden = next(filter(is_hidden, members), None)
    if hidden is not None:
        raise RunError(f"a class cannot define {hidden}", node.span, rule="S-Class", hint="docs/security.md lists what it can")
    foreign = next((name for name, member in members.items() if name in OVERRIDES and not may_override(name, member)), None)
    if foreign is not None:
        raise RunError(f"{foreign} must be a function of the program", node.span, rule="S-Class", hint="write def")
    try:
        kind = type(superclasses[0])
        namespace = kind.__prepare__(node.name, superclasses)
        for name, member in members.items():
            namespace[name] = as_member(name, member)
        namespace["__module__"] = "scenic"
        namespace[MARK] = True  # before the class is made: an enumeration runs functions of the program when it is
        made = kind(node.name, superclasses, namespace)  # type: ignore[arg-type]
    except ScenicError:
        raise
    except Exception as exception:
        raise HostException(exception) from exception
    return made
