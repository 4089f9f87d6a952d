"""Programs in the dialects of the released implementations: our verdicts and values are theirs, or the difference is of a kind that is named.

`programs.toml` are the programs; what the releases say of them stands beside, as `record.py` wrote it. Values are compared where the release gives
the same twice, with different seeds.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from scenic_ref.api import loads
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.interpreter.language.printer import to_source
from scenic_ref.semantics.space.vectors import Vector
from scenic_ref.semantics.store.errors import AttemptsExhausted, ParseError, ScenicError

HERE = Path(__file__).parent
DIALECTS = ("scenic-2.1", "scenic-3")
KINDS = {"wording", "release", "reading", "outside", "missing"}
"""Of differences: of words alone, a fault of the release, a reading of the paper, what is no matter of this reference, and what it lacks."""
PROGRAMS: list[dict[str, Any]] = tomllib.loads((HERE / "programs.toml").read_text())["program"]
CASES = [(p, d) for p in PROGRAMS for d in DIALECTS if p.get("only", d) == d]
Told = dict[str, Any]


def text_in(program: str, dialect: str) -> str:
    """The program in a dialect: in `scenic-2.1` objects are made without `new`."""
    return program if dialect == "scenic-3" else re.sub(r"\bnew (?=[A-Za-z])", "", program)


@cache
def released(dialect: str) -> dict[str, Told]:
    """What the release said of each program."""
    return json.loads((HERE / f"{dialect}.json").read_text())


def ours(program: Told, dialect: str) -> Told:
    """What we say of it, in the same form."""
    try:
        scenario = loads(text_in(program["program"], dialect), dialect=dialect, profile=dialect)
        if "steps" not in program:
            return {"verdict": "ok", **of_scene(scenario.sample(1, max_attempts=300))}
        run = scenario.simulate(steps=program["steps"], seed=1, max_attempts=60).simulation
    except AttemptsExhausted:
        return {"verdict": "rejected"}
    except ScenicError as error:
        return {"verdict": "error", "message": str(error)}
    taken = [[[str(agent), [plain(a) for a in actions]] for agent, actions in sorted(m.actions.items())] for m in run.moments[:-1]]
    return {"verdict": "ok", **of_scene(run.scene), "actions": taken}


def of_scene(scene: Any) -> Told:
    """The objects and global parameters of a scene."""
    objects = [[*o["position"], o["heading"], o["width"], o["length"]] for o in scene.to_json()["objects"]]
    return {"objects": objects, "params": {name: plain(value) for name, value in scene.params.items()}}


def plain(value: Any) -> Any:
    """A value in the form of the records."""
    match value:
        case Vector(x=x, y=y):
            return {"vector": [float(x), float(y)]}
        case bool() | int() | float() | str() | None:
            return value
        case list() | tuple():
            return [plain(v) for v in value]
        case dict():
            return {str(k): plain(v) for k, v in value.items()}
    return {"type": type(value).__name__}


def alike(theirs: Any, own: Any) -> bool:
    """Equality, numbers to a millionth; the releases do not say what a vector, a point or an object is by itself."""
    if isinstance(theirs, dict) and isinstance(own, dict):
        if {"type", "oriented", "point"} & (theirs.keys() | own.keys()):
            return True
        return theirs.keys() == own.keys() and all(alike(theirs[k], own[k]) for k in theirs)
    theirs, own = (v["vector"] if isinstance(v, dict) and "vector" in v else v for v in (theirs, own))
    if isinstance(theirs, list) and isinstance(own, list):
        return len(theirs) == len(own) and all(map(alike, theirs, own))
    if isinstance(theirs, (int, float)) and isinstance(own, (int, float)):
        return math.isclose(theirs, own, rel_tol=1e-6, abs_tol=1e-6)
    return theirs == own


def acting(actions: list[list[list[Any]]]) -> list[list[list[Any]]]:
    """The actions of each time step, without agents that do nothing."""
    return [[[agent, taken] for agent, taken in step if taken not in ([], [None], [[]])] for step in actions]


def same_values(theirs: Told, own: Told) -> bool:
    """Whether what the release recorded is what we found."""
    if "actions" in theirs and not alike(acting(theirs["actions"]), acting(own["actions"])):
        return False
    return all(alike(theirs[name], own[name]) for name in ("objects", "params") if name in theirs)


@pytest.mark.sampled(8)
@pytest.mark.parametrize(("program", "dialect"), CASES, ids=[f"{d}-{p['name']}" for p, d in CASES])
def test_the_verdict_and_the_values_are_those_of_the_release_or_differ_as_is_said(program: Told, dialect: str) -> None:
    theirs, own = released(dialect)[program["name"]], ours(program, dialect)
    differs: Told = program.get("differs", {}).get(dialect, {})
    assert own["verdict"] == differs.get("verdict", theirs["verdict"]), own
    if own["verdict"] == theirs["verdict"] == "ok":
        assert same_values(theirs, own) == (not differs), (theirs, own)
    assert differs.get("kind", "wording") in KINDS
    assert not differs or differs["why"]


def test_there_are_enough_programs_and_each_has_a_record() -> None:
    for dialect in DIALECTS:
        assert {p["name"] for p, d in CASES if d == dialect} == set(released(dialect))
        assert len(released(dialect)) >= 150
        same = [p for p, d in CASES if d == dialect and dialect not in p.get("differs", {})]
        assert len(same) > 0.7 * len(released(dialect))


@pytest.mark.parametrize(("program", "dialect"), CASES, ids=[f"{d}-{p['name']}" for p, d in CASES])
def test_what_is_read_is_printed_and_read_again(program: Told, dialect: str) -> None:
    try:
        tree = parse(text_in(program["program"], dialect), dialect=dialect)
    except ParseError:
        return
    assert parse(to_source(tree), dialect=dialect).statements == tree.statements
