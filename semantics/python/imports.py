"""Modules: `import`, `from ... import ...`, `model` (inherited from Python; Section "Statements").

A module that stands beside the program has a key that begins with one dot, and one more for each folder above the program's: ".sub.b" is the file
sub/b.scenic. All other modules have their names as keys.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from ..machine.config import Abrupt, Config, Stack, State
from ..machine.host_calls import HostException
from ..machine.operand_kinds import REGION, has_kind, is_object, kind_name, missing_member_error
from ..machine.outcome import Next, Outcome
from ..machine.values import Instance, Module, value_in_run
from ..store.errors import ImportRefused, RunError
from ..store.scopes import MISSING, Scope
from ..syntax import Program
from ..syntax import statements as s
from ..syntax.nodes import NOWHERE, Node, Span
from ..syntax.statements import Block
from .assignment import assign_name
from .control_flow import block
from .library import bound

# Keys


def sibling_module_key(name: str, level: int, package: str) -> str:
    """The key of a name with `level` dots before it, in a module of the package: that package, or one above it for each further dot."""
    rest = package.lstrip(".")
    dots, parts = len(package) - len(rest), rest.split(".") if rest else []
    for _ in range(level - 1):
        if parts:
            parts.pop()
        else:
            dots += 1
    return "." * dots + ".".join([*parts, *([name] if name else [])])


def package_of(key: str) -> str:
    """The package that the module belongs to: its folder; "." is that of the program."""
    rest = key.lstrip(".")
    return (key[: len(key) - len(rest)] or ".") + (rest.rpartition(".")[0] if key.startswith(".") else "")


def member_key(package: str, member: str) -> str:
    """The key of a module in a package."""
    return package + member if package.endswith(".") else f"{package}.{member}"


def dunders(file: str, name: str = "__main__", path: str = "") -> dict[str, object]:
    """The variables that a module of this file begins with: `__name__`, and unless its text comes from no file `__file__`.

    The file is told as it is seen from the folder of the program, `path`, or its own name alone, so that scenes are the same wherever that folder is.
    """
    return {"__name__": name} if file.startswith("<") else {"__name__": name, "__file__": path or re.split(r"[/\\]", file)[-1]}


def path_of(key: str) -> str:
    """The path of a module as it is seen from the folder of the program."""
    rest = key.lstrip(".")
    return "../" * (len(key) - len(rest) - 1) + rest.replace(".", "/") + ".scenic"


def key_of(name: str, level: int, package: str, library: Mapping[str, object]) -> str:
    """The key of a module as it is written in a module of the package: without dots before it, one beside the program comes first."""
    if level:
        return sibling_module_key(name, level, package)
    return name if name in library else sibling_module_key(name, 1, ".")


# Statements


class ModuleBody(NamedTuple):
    """Frame of an imported module's statements; `then` is the import that goes on afterwards, and `ego` what it was before."""

    key: str
    outer: Scope
    then: Node
    ego: object


def import_statement(node: s.Import, stack: Stack, state: State) -> Outcome:
    """`import a.b as c`."""
    keys = [key_here(one.name, 0, state) for one in node.names]
    for one, key in zip(node.names, keys, strict=True):
        if key not in state.modules:
            return load_imported_module(key, one.name, node, stack, state)
    for one, key in zip(node.names, keys, strict=True):
        module = state.modules[key]
        if one.alias is not None:
            check_workspace(one.alias, module, one.span)
            state = assign_name(one.alias, module, node, state)
        else:
            bind_dotted(one.name, module, state)
    return enter_import(node, stack, state)


def enter_import(node: Node, stack: Stack, state: State, statements: Block = ()) -> Outcome:
    """⟨import m, σ⟩ → ⟨pass, σ[m / the module]⟩ and ⟨from m import x, σ⟩ → ⟨pass, σ[x / m.x]⟩; the first time, m's statements come before."""
    return block(statements, stack, state, "S-Import", node)


def key_here(name: str, level: int, state: State) -> str:
    """The key of a module as it is written in the module whose statements run."""
    return key_of(name, level, state.sigma.module.package, state.settings.library)


def bind_dotted(name: str, module: object, state: State) -> None:
    """`import a.b.c` binds a, through which a.b.c is reached."""
    first, *rest = name.split(".")
    if not rest:
        state.sigma.bind(first, module)
        return
    found = state.sigma.bindings.get(first)
    versions = state.version.versions
    package = found if isinstance(found, Module) else Module(first, Scope("module", versions))
    state.sigma.bind(first, package)
    for part in rest[:-1]:
        inner = package.scope.bindings.get(part)
        if not isinstance(inner, Module):
            package.scope.put(part, inner := Module(part, Scope("module", versions)))
        package = inner
    package.scope.put(rest[-1], module)


def import_from(node: s.ImportFrom, stack: Stack, state: State) -> Outcome:
    """`from m import a, b` and `from m import *`."""
    name = "." * node.level + node.module
    key = key_here(node.module, node.level, state)
    if key not in state.modules:
        return load_imported_module(key, name, node, stack, state)
    module = state.modules[key]
    names = {n.name: n.alias or n.name for n in node.names} or {n: n for n in public_names(module, node)}
    for member, alias in names.items():
        submodule = member_key(key, member)
        found = module.scope.bindings.get(member, MISSING)
        if found is MISSING and submodule in state.settings.library:
            if submodule not in state.modules:
                return load_imported_module(submodule, submodule, node, stack, state)
            found = state.modules[submodule]
        if member == alias == "ego" and not node.names:
            continue  # `*` replaces no ego
        if found is MISSING and member == "ego" and state.ego is not None:
            continue  # the module has none of its own: all share the scene's
        if found is MISSING:
            raise unknown_import_error(member, name, module, next((n.span for n in node.names if n.name == member), None))
        check_workspace(alias, found, next((n.span for n in node.names if n.name == member), node.span))
        if alias == "ego" and not is_the_scenes(found) and (state.sigma.kind != "module" or in_module(stack)):
            state.sigma.bind(alias, found)  # a variable of the function, or of the module
        else:
            state = assign_name(alias, found, node, state)
    return enter_import(node, stack, state)


def check_workspace(name: str, found: object, span: Span) -> None:
    """Refuse to import as the workspace what is no region. Raises `RunError`."""
    if name == "workspace" and not has_kind(value_in_run(found), REGION):
        hint = "give it another name, and write workspace = Workspace(region)"
        raise RunError(f"workspace must be a region, not {kind_name(found)}", span, rule="S-Import", hint=hint)


def is_the_scenes(found: object) -> bool:
    """Return whether a value is an Object, which can be the ego."""
    inner = value_in_run(found)
    return isinstance(inner, Instance) and is_object(inner)


def in_module(stack: Stack) -> bool:
    """Return whether an imported module is being run."""
    while stack:
        frame, stack = stack
        if isinstance(frame, ModuleBody):
            return True
    return False


def model(node: s.Model, stack: Stack, state: State) -> Outcome:
    """⟨model m⟩ → ⟨from m import *⟩; the command line may name another m for the program (`programs.initial`)."""
    return Next("S-Model", Config(s.ImportFrom(module=node.name, names=(), as_model=True, span=node.span), stack, state), node)


def public_names(module: Module, node: Node) -> list[str]:
    """Return the names that `*` imports: those in `__all__`, or if there is none all that do not begin with
    an underscore. Raises `RunError`.
    """
    listed = module.scope.bindings.get("__all__", MISSING)
    if listed is MISSING:
        return members(module)
    if not isinstance(listed, (list, tuple)) or not all(isinstance(name, str) for name in listed):
        raise RunError(f"`__all__` of {module!r} is not a list of names", node.span, rule="S-Import")
    return list(listed)


def members(module: Module) -> list[str]:
    """The names in a module that do not begin with an underscore."""
    return [n for n in module.scope.bindings if not n.startswith("_")]


def unknown_import_error(member: str, name: str, module: Module, span: Span | None) -> HostException:
    """The exception of a name that a module has not, with the nearest one that it has."""
    error = missing_member_error(name, member, ImportError(f"the module {name} has no {member} in this reference"), members(module))
    return HostException(error, span=span)


# Loading


def load_imported_module(key: str, name: str, node: Node, stack: Stack, state: State) -> Outcome:
    """Run a Scenic module, once per run, or take a Python one; then try the import again.

    One that does not exist is an `ImportError`, as in Python. One that this machine refuses ends the program: that is not the program's to catch.
    """
    found = state.settings.library.get(key, MISSING)
    if isinstance(found, Program):
        builtins = state.sigma.module.parent
        assert builtins is not None
        own = dunders(found.file, key.lstrip("."), path_of(key))
        scope = Scope("module", builtins, bindings=own, package=package_of(key))
        module = Module(name.lstrip("."), scope)
        begun = state._replace(sigma=scope, modules={**state.modules, key: module})
        return enter_import(node, (ModuleBody(key, state.sigma, node, state.ego), stack), begun, found.statements)
    if found is MISSING or isinstance(found, ModuleNotFoundError):
        raise absent(name, found)
    if isinstance(found, Exception):
        if isinstance(found, ImportRefused) and found.span != NOWHERE:  # the program says elsewhere what is refused
            raise ImportRefused(found.message, found.span, rule="S-Import", hint=found.hint)
        raise ImportRefused(str(found), node.span, rule="S-Import", hint=getattr(found, "hint", ""))
    assert isinstance(found, Mapping)
    budget = state.settings.door.budget
    own = {member: bound(own_copy(value), budget) for member, value in found.items()}
    module = Module(name, Scope("module", budget.versions, bindings=own))
    return Next("", Config(node, stack, state._replace(modules={**state.modules, key: module})))


def absent(name: str, found: object) -> HostException:
    """The exception of a module that does not exist, with what the library says of it."""
    error = ModuleNotFoundError(str(found) if isinstance(found, ModuleNotFoundError) else f"there is no module {name}")
    for note in getattr(found, "__notes__", ()):
        error.add_note(note)
    return HostException(error)


def own_copy(value: object) -> object:
    """A value of a Python module as a run gets it: what the program changes in it, no other run sees."""
    if type(value) is dict:
        return {key: own_copy(item) for key, item in value.items()}
    return [own_copy(item) for item in value] if type(value) is list else value


def in_model(stack: Stack) -> bool:
    """Whether the module that a `model` statement names, or one that it imports, is being run."""
    while stack:
        frame, stack = stack
        if isinstance(frame, ModuleBody) and isinstance(frame.then, s.ImportFrom) and frame.then.as_model:
            return True
    return False


def resume_module_body(frame: ModuleBody, result: object, stack: Stack, state: State) -> Outcome:
    """The module has run: go on with the import.

    What it assigned to `ego` is a variable of its own, and the ego of who imports it only where there was none (reading `ego-of-modules`).
    """
    after = state._replace(sigma=frame.outer)
    if state.ego is not frame.ego:
        state.modules[frame.key].scope.put("ego", state.ego)
        after = after if frame.ego is None else with_ego(frame.ego, state.ego, after)
    return Next("", Config(frame.then, stack, after))


def with_ego(ego: object, other: object, state: State) -> State:
    """The state with this ego again; the other one's name in the scene is not `ego` any more."""
    names = {number: name for number, name in state.names.items() if number != value_in_run(other).number}  # type: ignore[attr-defined]
    return state._replace(ego=ego, names=names)


def unwind_module_body(frame: ModuleBody, abrupt: Abrupt, stack: Stack, state: State) -> Outcome:
    """An exception in the module: it is not imported."""
    left = {key: module for key, module in state.modules.items() if key != frame.key}
    return Next("", Config(abrupt, stack, state._replace(sigma=frame.outer, modules=left, ego=frame.ego)))
