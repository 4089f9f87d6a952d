"""Classes and modules: class definitions, `import`, `model`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from .allowed import MARK, OVERRIDES, is_base, is_hidden, may_override
from .assignment import done
from .classes import OBJECT_CLASS, canonical
from .config import Abrupt, Config, Stack, State
from .control import block
from .errors import CheckError, ImportRefused, RunError
from .host import HostException
from .kinds import kind_name
from .library import bound
from .outcome import Change, Next, Outcome
from .premises import premises
from .scopes import MISSING, NO_NAMES, Scope
from .syntax import Program
from .syntax import statements as s
from .syntax.nodes import Node
from .values import Module, ScenicClass, plain

# Classes


class ClassBody(NamedTuple):
    """Frame of the Python part of a class body: methods and class attributes."""

    node: s.ClassDefinition
    outer: Scope
    superclass: ScenicClass | tuple[type, ...]


def class_definition(node: s.ClassDefinition, stack: Stack, state: State) -> Outcome:
    """`class C(superclass): property: E ...`: Object is the default superclass (paper, Section "Data Types")."""
    return premises(node, node.superclasses, conclude_superclasses, stack, state)


def conclude_superclasses(node: s.ClassDefinition, values: list[object], stack: Stack, state: State) -> Outcome:
    """A Scenic class has one Scenic superclass; below Python classes it is a Python class."""
    superclasses = [plain(v) for v in values] or [OBJECT_CLASS]
    scope = Scope("class", state.sigma, NO_NAMES)
    inner = state._replace(sigma=scope)
    if isinstance(superclasses[0], ScenicClass):
        if len(superclasses) > 1:
            raise RunError(f"the Scenic class {node.name} has more than one superclass", node.span, rule="S-Class")
        return block(node.body, (ClassBody(node, state.sigma, superclasses[0]), stack), inner)
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
    """σ[C / the class]."""
    node = frame.node
    members = state.sigma.bindings
    outer = state._replace(sigma=frame.outer)
    made = make_scenic_class(node, frame.superclass, members, frame.outer) if isinstance(frame.superclass, ScenicClass) else make_python_class(
        node, frame.superclass, members
    )
    frame.outer.bind(node.name, made)
    return done("S-Class", node, stack, outer, Change("σ", node.name, made))


def unwind_class_body(frame: ClassBody, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception in the body: restore σ."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))


def make_scenic_class(node: s.ClassDefinition, superclass: ScenicClass, members: Mapping[str, object], scope: Scope) -> ScenicClass:
    """The class with its own default value expressions; they are evaluated for each object."""
    defaults: dict[str, Node] = {}
    for default in node.properties:
        name = canonical(default.name)
        if name in defaults:
            raise CheckError(f"the property {name} has two defaults in class {node.name}", default.span)
        defaults[name] = default.value
    for name in members:
        if canonical(name) in superclass.defaults:
            raise RunError(
                f"{name} is a property of {superclass.name}, and `=` does not give it a default", node.span, rule="S-Class", hint=f"write {name}: ..."
            )
    if "__init__" in members:
        raise RunError(
            f"the Scenic class {node.name} has no __init__: its objects are made from specifiers", node.span, rule="S-Class",
            hint=f"for a Python class write class {node.name}(object):",
        )
    return ScenicClass(node.name, superclass, defaults, scope, dict(members), node.span)


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
            namespace[name] = member
        namespace["__module__"] = "scenic"
        namespace[MARK] = True  # before the class is made: an enumeration runs functions of the program when it is
        made = kind(node.name, superclasses, namespace)  # type: ignore[arg-type]
    except Exception as exception:
        raise HostException(exception) from exception
    return made


# Modules


class ModuleBody(NamedTuple):
    """Frame of an imported module's statements; `then` is the import that goes on afterwards."""

    name: str
    outer: Scope
    then: Node


def import_statement(node: s.Import, stack: Stack, state: State) -> Outcome:
    """`import a.b as c`."""
    for imported in node.names:
        if imported.name not in state.modules:
            return load(imported.name, node, stack, state)
    for imported in node.names:
        module = state.modules[imported.name]
        if imported.alias is not None:
            state.sigma.bind(imported.alias, module)
        else:
            bind_dotted(imported.name, module, state)
    return done("S-Import", node, stack, state)


def bind_dotted(name: str, module: object, state: State) -> None:
    """`import a.b.c` binds a, through which a.b.c is reached."""
    first, *rest = name.split(".")
    if not rest:
        state.sigma.bind(first, module)
        return
    found = state.sigma.bindings.get(first)
    package = found if isinstance(found, Module) else Module(first, Scope("module", None))
    state.sigma.bind(first, package)
    for part in rest[:-1]:
        inner = package.scope.bindings.setdefault(part, Module(part, Scope("module", None)))
        assert isinstance(inner, Module)
        package = inner
    package.scope.bindings[rest[-1]] = module


def import_from(node: s.ImportFrom, stack: Stack, state: State) -> Outcome:
    """`from m import a, b` and `from m import *`."""
    name = "." * node.level + node.module
    if name not in state.modules:
        return load(name, node, stack, state)
    module = state.modules[name]
    names = {n.name: n.alias or n.name for n in node.names} or {n: n for n in public_names(module)}
    for member, alias in names.items():
        submodule = f"{name}.{member}"
        found = member_of(module, member)
        if found is MISSING and submodule in state.settings.library:
            if submodule not in state.modules:
                return load(submodule, node, stack, state)
            found = state.modules[submodule]
        if found is MISSING and member == "ego" and state.ego is not None:
            continue  # all modules share it
        if found is MISSING:
            raise RunError(f"the module {name} has no {member}", node.span, rule="S-Import")
        state.sigma.bind(alias, found)
    return done("S-Import", node, stack, state)


def model(node: s.Model, stack: Stack, state: State) -> Outcome:
    """⟨model m⟩ → ⟨from m import *⟩; the command line may name another m for the program (`programs.initial`)."""
    return Next("S-Model", Config(s.ImportFrom(module=node.name, names=(), span=node.span), stack, state), node)


def public_names(module: object) -> list[str]:
    """What `*` imports."""
    names = list(module.scope.bindings) if isinstance(module, Module) else dir(module)
    return [n for n in names if not n.startswith("_")]


def member_of(module: object, name: str) -> object:
    """A member of a module, or MISSING."""
    if isinstance(module, Module):
        return module.scope.bindings.get(name, MISSING)
    return MISSING if name.startswith("_") else getattr(module, name, MISSING)


def load(name: str, node: Node, stack: Stack, state: State) -> Outcome:
    """Run a Scenic module, once per run, or take a Python one; then try the import again."""
    found = state.settings.library.get(name, MISSING)
    if isinstance(found, Program):
        builtins = state.sigma.module.parent
        scope = Scope("module", builtins)
        module = Module(name, scope)
        begun = state._replace(sigma=scope, modules={**state.modules, name: module})
        return block(found.statements, (ModuleBody(name, state.sigma, node), stack), begun, "S-Import", node)
    if isinstance(found, Exception):
        raise ImportRefused(str(found), node.span, rule="S-Import", hint=getattr(found, "hint", ""))
    if found is MISSING:
        raise RunError(f"there is no module {name}", node.span, rule="S-Import")
    budget = state.settings.door.budget
    own = {member: bound(own_copy(value), budget) for member, value in found.items()} if isinstance(found, Mapping) else {}
    module = Module(name, Scope("module", None, bindings=own)) if isinstance(found, Mapping) else found
    return Next("", Config(node, stack, state._replace(modules={**state.modules, name: module})))


def own_copy(value: object) -> object:
    """A value of a Python module as a run gets it: what the program changes in it, no other run sees."""
    if type(value) is dict:
        return {key: own_copy(item) for key, item in value.items()}
    return [own_copy(item) for item in value] if type(value) is list else value


def resume_module_body(frame: ModuleBody, result: object, stack: Stack, state: State) -> Outcome:
    """The module has run: go on with the import."""
    return Next("", Config(frame.then, stack, state._replace(sigma=frame.outer)))


def unwind_module_body(frame: ModuleBody, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception in the module."""
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer)))
