"""A simulator of the user's own, by the name of its module and class: `package.module:Class`.

Whoever names it decides to run that Python code: a program cannot (docs/security.md).
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import ModuleType

from ..semantics.store.errors import ScenicError, UsageError
from .protocol import METHODS, Simulator, check_usable


def own_simulator(name: str, timestep: float | None) -> Simulator:
    """The simulator that `MODULE:CLASS` makes, with `timestep=` if that is given. Raises `UsageError`."""
    module_name, _, class_name = name.partition(":")
    if not all(part.isidentifier() for part in (*module_name.split("."), *class_name.split("."))):
        raise UsageError(f"{name} does not name a simulator", hint="write package.module:Class")
    with importable_from_here():
        make = maker(import_user_module(module_name), module_name, class_name)
        options = {} if timestep is None else {"timestep": timestep}
        call = f"{class_name}({', '.join(f'{key}={value!r}' for key, value in options.items())})"
        try:
            simulator = make(**options)
        except ScenicError:
            raise
        except Exception as problem:
            raise UsageError(f"the simulator {name} cannot be made: {call} failed: {type(problem).__name__}: {problem}") from problem
    try:
        check_usable(simulator)  # type: ignore[arg-type]
    except UsageError as problem:
        raise UsageError(f"{name} is not a simulator: {problem.message}", hint=problem.hint) from None
    return simulator  # type: ignore[return-value]


@contextmanager
def importable_from_here() -> Iterator[None]:
    """The modules of the current folder can be imported, and win over installed ones; not later, when programs run."""
    here = os.getcwd()
    sys.path.insert(0, here)
    try:
        yield
    finally:
        if here in sys.path:
            sys.path.remove(here)


def import_user_module(name: str) -> ModuleType:
    """A module of Python. Raises `UsageError`."""
    try:
        return importlib.import_module(name)
    except (Exception, SystemExit) as problem:
        if isinstance(problem, ModuleNotFoundError) and problem.name is not None and f"{name}.".startswith(f"{problem.name}."):
            hint = "modules are looked for in the current folder, and among the installed ones"
            raise UsageError(f"there is no module {problem.name}", hint=hint) from None
        raise UsageError(f"the module {name} cannot be imported: {type(problem).__name__}: {problem}") from problem


def maker(module: ModuleType, module_name: str, class_name: str) -> Callable[..., object]:
    """The class, or another callable, that makes a simulator. Raises `UsageError`."""
    found: object = module
    for part in class_name.split("."):
        if not hasattr(found, part):
            classes = [k for k, v in vars(module).items() if isinstance(v, type) and all(callable(getattr(v, m, None)) for m in METHODS)]
            hint = f"its simulators are {', '.join(classes)}" if classes else "no class there has the methods of a simulator"
            raise UsageError(f"the module {module_name} has no {class_name}", hint=hint)
        found = getattr(found, part)
    if not callable(found):
        raise UsageError(f"{module_name}:{class_name} makes no simulator: it is a {type(found).__name__}", hint="name its class")
    return found
