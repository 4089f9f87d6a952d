"""`proofs/kernel/Machine.v` as an implementation: `python -m tests.proofs.theory` serves it by the harness protocol.

Coq extracts the machine to OCaml; that finds all runs of a program with their probabilities, and scenes are drawn among them.
What the static core has not is skipped, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import radians
from random import Random
from typing import Any

import scenic_ref
from scenic_ref.conformance.implementations.harness_server import serve
from scenic_ref.conformance.implementations.protocol import (
    Enumerated,
    NeverAccepted,
    Refused,
    SceneRecord,
    Task,
    Unsupported,
)
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.store.errors import ProgramError

from .core_programs import fraction
from .extracted import answers
from .translation import CLASS, Translation

STEPS = 3000
FIVE_DEGREES = fraction(Fraction(radians(5)))
TOLD = f"""fun '(at_the_end, program) =>
    let q x := let r := Qred x in [Qnum r; Zpos (Qden r)] in
    let int n := Z.of_nat n in
    let told v := match v with
      | Number x => int 0 :: q x | Truth b => [int 1; int (if b then 1 else 0)] | Vector x y => int 2 :: q x ++ q y
      | Instance n => [int 3; int n] end in
    let all := flat_map (fun xv => int (fst xv) :: told (snd xv)) in
    let problem e := match e with
      | Not_defined _ => 0 | No_self => 1 | No_attribute => 2 | Type_error => 3 | Division_by_zero => 4 | No_scalars => 5 | Bad_parameters => 6
      | No_vector => 7 | Ill_formed (Resolution.SpecifiedTwice _ _ _) => 8 | Ill_formed (Resolution.MissingProperty _ _) => 9
      | Ill_formed (Resolution.CyclicDependencies _) => 10 | Ill_formed _ => 11 | Bad_property _ => 12 | Ego_is_no_object => 13
      | No_boolean _ => 14 | Bad_probability _ => 15 | Bad_scale => 16 | Not_mutable => 17 | No_ego => 18 | Beyond_the_core => 19 end in
    let ended e w := match e with
      | Accepted s => (int 0 :: int 0 :: w) :: all (its_params s) :: match its_ego s with Some v => told v | None => [] end :: map all (its_content s)
      | Rejected (Condition line) => [int 1 :: int line :: w]
      | Rejected (Collision _ _) => [int 2 :: int 0 :: w]
      | Rejected (Visibility _) => [int 3 :: int 0 :: w]
      | Failed e => [int 4 :: int (problem e) :: w] end in
    match runs {FIVE_DEGREES} no_noise upright_boxes_intersect sees_upright_box at_the_end {STEPS} (begin program) with
    | Some found => map (fun r => ended (snd r) (q (weight (fst r)))) found
    | None => [] end"""
"""What the machine is asked about a program: how each of its runs ends, and its probability, as lists of numbers."""
ERRORS = [
    ("RunError", "E-Variable"), ("RunError", "E-Variable"), ("AttributeError", ""), ("TypeError", ""), ("ZeroDivisionError", ""),
    ("RunError", "O-VectorOf"), ("RunError", "E-Distributions"), ("RunError", "P-At"), ("SpecifiedTwice", "R-SpecifiedTwice"),
    ("MissingProperty", "R-MissingProperty"), ("CyclicDependencies", "R-Cyclic"), ("SpecifiedTwiceOptionally", "R-SpecifiedTwiceOptionally"),
    ("RunError", "E-ObjectDefinition"), ("RunError", "S-Assignment"), ("RunError", "S-Require"), ("RunError", "S-SoftReq-Check"),
    ("RunError", "S-Mutate"), ("RunError", "S-Mutate"), ("RunError", "T-Mutate"), ("beyond the core", ""),
]  # fmt: skip
"""The errors of the theory as those of the Python: the class (of the exception, if the program raised one) and the rule."""


Key = tuple[Any, ...]
KINDS = {1: "require", 2: "collision", 3: "visibility"}
"""How runs are rejected, by what the machine is told to answer."""


def bindings(told: Sequence[int]) -> Iterator[tuple[int, Key]]:
    """Variables, parameters or properties, by their numbers, with their values."""
    rest = iter(told)
    for name in rest:
        yield name, value(rest)


def value(rest: Iterator[int]) -> Key:
    """The value that comes next: its kind, and its numbers."""
    kind = next(rest)
    if kind in (1, 3):
        return kind, Fraction(next(rest))
    return kind, *(Fraction(next(rest), next(rest)) for _ in range(2 if kind == 2 else 1))


class Theory:
    """The machine of the proofs."""

    name = "machine of the proofs 1"
    dialects = ("paper",)

    def follows(self, reading: str, alternative: str) -> bool:
        """Both of `require-time`; of the others, the `paper` profile's."""
        return reading == "require-time" or alternative == READINGS[reading].default

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        """Rejection sampling among the runs. Raises `Unsupported` beyond the core, `Refused` where a run is an error, `NeverAccepted`."""
        runs, translation = found_runs(task)
        random, weights = Random(seed), [float(weight(run)) for run in runs]
        for index in range(count):
            stuck: set[str] = set()
            for attempt in range(1, attempts + 1):
                [[[kind, detail, *_], *content]] = random.choices(runs, weights)
                if kind == 0:
                    yield record(content, translation, index, attempt)
                    break
                if kind == 4:
                    raise refused(detail)
                stuck.add(KINDS[kind])
            else:
                raise NeverAccepted(frozenset(stuck))

    def enumerated(self, task: Task) -> Enumerated | None:
        """The law of the scenes. Raises as `scenes` does."""
        runs, translation = found_runs(task)
        for (kind, detail, *_), *_ in runs:
            if kind == 4:
                raise refused(detail)
        accepted = [run for run in runs if run[0][0] == 0]
        mass = sum(map(weight, accepted))
        if not mass:
            raise NeverAccepted(frozenset(KINDS[run[0][0]] for run in runs))
        scenes = ((weight(run) / mass, record(run[1:], translation, 0, 1)) for run in accepted)
        return Enumerated(tuple(scenes), Fraction(mass))


def weight(run: Sequence[Sequence[int]]) -> Fraction:
    """The probability of a run."""
    return Fraction(*run[0][2:])


def found_runs(task: Task) -> tuple[Sequence[Any], Translation]:
    """All runs of a program. Raises `Unsupported`; what cannot be read at all is not in the core."""
    reading = task.readings.get("require-time", READINGS["require-time"].default)
    return runs_of(task.program, reading == "end")


@lru_cache(maxsize=64)
def runs_of(text: str, at_the_end: bool) -> tuple[Sequence[Any], Translation]:
    """The same, of a text, which the machine runs once."""
    translation = Translation()
    try:
        term = translation.program(scenic_ref.loads(text).program)
    except ProgramError as error:
        raise Unsupported(f"the core has no such program: {error.message}") from error
    [told] = answers(TOLD, [f"({str(at_the_end).lower()}, {term})"])
    if not told:
        raise Unsupported("the machine ran out of steps")
    for (kind, detail, *_), *content in told:
        if kind == 4 and ERRORS[detail] == ERRORS[-1]:
            raise Unsupported("a run that leaves the core")
        if kind in KINDS and translation.noise:
            raise Unsupported("the core has no place for noise")
        for o in map(dict, map(bindings, content[2:])):
            scale, *deviations = (o.get(p, (0, 0))[1] for p in (5, 6, 7))
            if scale and any(deviations):
                raise Unsupported("the core has no place for noise")
    return told, translation


def refused(detail: int) -> Refused:
    """An error of a run."""
    name, rule = ERRORS[detail]
    return Refused("resolve" if rule.startswith("R-") else "run", name, class_name=name, rule=rule or None)


def record(content: Sequence[Sequence[int]], translation: Translation, index: int, attempts: int) -> SceneRecord:
    """A scene in the format of `docs/formats.md`."""
    told, ego, *objects = content
    names = {number: name for name, number in translation.params.items()}
    found = {names[x]: shown(v) for x, v in bindings(told)}
    params = {name: translation.read(name, found) for name in dict.fromkeys((*found, *translation.lists)) if "." not in name}
    [_, own] = value(iter(ego))
    return {
        "schema": "scenic-ref/scene/1", "seed": 0, "scene": index, "attempts": attempts, "weight": 1.0,
        "params": params, "ego": int(own),
        "objects": [object_record(i, dict(bindings(o)), translation, i == own) for i, o in enumerate(objects)],
    }  # fmt: skip


def object_record(number: int, of: Mapping[int, Key], translation: Translation, ego: bool) -> Mapping[str, object]:
    """An object."""
    names = {p: name for name, p in translation.properties.items()}
    found = {names[p]: shown(v) for p, v in of.items() if p != CLASS}
    outer = {name: found.pop(name) for name in ("position", "heading", "width", "length")}
    return {"id": number, "name": "ego" if ego else None, "class": translation.classes[int(of[CLASS][1])][0], **outer, "properties": found}


def shown(found: Key) -> object:
    """A value as JSON has it; an object by its number."""
    kind, *numbers = found
    if kind == 1:
        return bool(numbers[0])
    if kind == 2:
        return [float(n) for n in numbers]
    return {"object": int(numbers[0])} if kind == 3 else float(numbers[0])


if __name__ == "__main__":
    serve(Theory())
