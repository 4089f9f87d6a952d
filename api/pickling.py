"""Scenarios for `pickle`: by the text of the program and what was set, never by what was computed from them, which is computed again."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..interpreter.language.parser import parse
from ..semantics.store.errors import UsageError
from ..semantics.syntax import Program

if TYPE_CHECKING:
    from ..data.scene import Scene
    from .scenario import Scenario


class Condition(NamedTuple):
    """The arguments that were given to `condition_on`."""

    scene: Scene | None
    objects: tuple[int, ...] | None
    params: Mapping[str, object]


class ScenarioText(NamedTuple):
    """A scenario as it was loaded: the text of its program, its settings, and a digest of the text of every Scenic module that it can import."""

    text: str
    file: str
    dialect: str
    readings: Mapping[str, str]
    params: Mapping[str, object]
    model: str | None
    trust: bool
    directory: str | None
    fuel: int
    scenario: str | None
    modules: Mapping[str, str]


def reduce_scenario(scenario: Scenario) -> tuple[Callable[..., Scenario], tuple[object, ...]]:
    """Return the function that makes the scenario again, and its arguments."""
    source = scenario.conditioned_from
    if source is None:
        return made_again, (type(scenario), text_of_scenario(scenario), None, None, scenario.factorised, scenario.device)
    condition = scenario.condition
    assert condition is not None
    check_portable("the given parameter", condition.params)
    return made_again, (type(scenario), None, source, condition, scenario.factorised, scenario.device)


def text_of_scenario(scenario: Scenario) -> ScenarioText:
    """A scenario of which nothing is given. Raises `UsageError`."""
    program = scenario.program
    if program.statements and not program.text:
        raise UsageError("a scenario can be pickled only with the text of its program, and this one has none", hint="make it by loads or load")
    check_portable("the parameter", scenario.params)
    directory = None if scenario.directory is None else str(scenario.directory.resolve())
    return ScenarioText(
        program.text, program.file, program.dialect, scenario.readings, scenario.params, scenario.model, scenario.trust, directory, scenario.fuel,
        scenario.scenario, digests(scenario),
    )  # fmt: skip


def check_portable(what: str, values: Mapping[str, object]) -> None:
    """Raise `UsageError` for a value that cannot be pickled, with its name."""
    for name, value in values.items():
        try:
            pickle.dumps(value)
        except Exception as problem:  # whatever a foreign value does when it is pickled
            raise UsageError(f"{what} {name} cannot be pickled: {problem}") from None


def digests(scenario: Scenario) -> dict[str, str]:
    """Return a SHA-256 digest of the text of every Scenic module that the program can import, by the module's
    key.
    """
    modules = {key: module for key, module in scenario.settings.library.items() if isinstance(module, Program)}
    return {key: hashlib.sha256(module.text.encode("utf-8", "surrogatepass")).hexdigest() for key, module in modules.items()}


def made_again(
    kind: type[Scenario], written: ScenarioText | None, source: Scenario | None, condition: Condition | None, factorised: bool, device: str | None
) -> Scenario:  # fmt: skip
    """The scenario that was pickled. Raises `UsageError` where its modules are not those that they were, and what loading it raises."""
    if condition is not None:
        assert source is not None
        found = source.condition_on(condition.scene, objects=condition.objects, params=condition.params)
    else:
        assert written is not None
        found = loaded_again(kind, written)
    if device != found.device and device is not None:
        found = found.on_device(device)
    return found.pruned() if factorised else found


def loaded_again(kind: type[Scenario], written: ScenarioText) -> Scenario:
    """The scenario of a text with its settings. Raises `UsageError` where a module has changed, or is no longer there."""
    text, file, dialect, readings, params, model, trust, directory, fuel, scenario, modules = written
    where = None if directory is None else Path(directory)
    found = kind(
        parse(text, file, dialect), readings=readings, params=params, model=model, trust=trust, directory=where, fuel=fuel, scenario=scenario,
    )
    now = digests(found)
    changed = next((key for key in {**modules, **now} if modules.get(key) != now.get(key)), None)
    if changed is not None:
        what = "has changed" if changed in modules and changed in now else "is not there any more" if changed in modules else "was not there"
        raise UsageError(f"the module {changed.lstrip('.')} {what} since this scenario was pickled", hint=f"load {file} again")
    return found
