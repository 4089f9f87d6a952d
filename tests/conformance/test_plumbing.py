"""The harness against implementations that are wrong on purpose: each matcher must fail, and for the right reason."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction

import pytest
from scenic_ref.conformance import ConformanceVector, Enumerated, NeverAccepted, Ourselves, Refused, Task, judge, load_vectors
from scenic_ref.conformance.implementations.protocol import SceneRecord
from scenic_ref.conformance.vector_files import read_file

VECTORS = {v.name: v for v in load_vectors() if v.name.startswith("plumbing-")}
Change = Callable[[object], object]


class Sampling:
    """Ourselves without enumeration and traces: the least that an implementation can do."""

    name = "sampling"
    dialects: tuple[str, ...] = ("paper",)

    def follows(self, reading: str, alternative: str) -> bool:
        return True

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        yield from Ourselves().scenes(task, count, seed=seed, attempts=attempts)


class Changed(Sampling):
    """Every number of every scene changed by a function."""

    def __init__(self, change: Change) -> None:
        self.change = change

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        for scene in super().scenes(task, count, seed=seed, attempts=attempts):
            changed = deep(scene, self.change)
            assert isinstance(changed, dict)
            yield {**changed, "ego": scene["ego"]}


def deep(value: object, change: Change) -> object:
    match value:
        case bool():
            return value
        case int() | float():
            return change(value)
        case list():
            return [deep(v, change) for v in value]
        case dict():
            return {k: deep(v, change) for k, v in value.items()}
        case _:
            return value


class Edited(Sampling):
    """Every scene edited by a function."""

    def __init__(self, edit: Callable[[dict], None]) -> None:
        self.edit = edit

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        for scene in super().scenes(task, count, seed=seed, attempts=attempts):
            self.edit(scene)  # pyright: ignore[reportArgumentType]
            yield scene


class Raises(Sampling):
    """Whatever it is asked, it raises the same."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        raise self.error
        yield {}


class AcceptsEverything(Sampling):
    """Gives a scene whatever the program is."""

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        yield from ({"params": {}, "ego": 0, "objects": []} for _ in range(count))


class MissesAScene(Sampling):
    """One scene too few."""

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        yield from super().scenes(task, count - 1, seed=seed, attempts=attempts)


class Repeats(Sampling):
    """The same scene again and again."""

    def scenes(self, task: Task, count: int, *, seed: int, attempts: int) -> Iterator[SceneRecord]:
        first = next(super().scenes(task, 1, seed=seed, attempts=attempts))
        yield from (first for _ in range(count))


class Traces(Sampling):
    """Tells the same rules for every program."""

    def __init__(self, *rules: str) -> None:
        self.rules = frozenset(rules)

    def fired(self, task: Task, wanted: frozenset[str], *, seed: int) -> frozenset[str]:
        return self.rules


class Enumerates(Ourselves):
    """Enumeration with its numbers changed."""

    def __init__(self, change: Callable[[Enumerated], Enumerated | None]) -> None:
        self.change = change

    def enumerated(self, task: Task) -> Enumerated | None:
        found = super().enumerated(task)
        return None if found is None else self.change(found)


class Rigid(Sampling):
    """Follows no reading."""

    def follows(self, reading: str, alternative: str) -> bool:
        return False


def off(step: float) -> Sampling:
    return Changed(lambda x: x + step)  # type: ignore[operator]


def first(scene: dict) -> dict:
    return scene["objects"][0]["properties"]


def swap_flag(scene: dict) -> None:
    scene["params"]["flag"] = 1


def forget(scene: dict) -> None:
    del scene["params"]["r"]


def drop_property(scene: dict) -> None:
    del first(scene)["taste"]


def one_more(scene: dict) -> None:
    scene["objects"].append(scene["objects"][0])


def whole_turns(scene: dict) -> None:
    scene["objects"][0]["heading"] += 4 * 3.141592653589793


def other_value(scene: dict) -> None:
    scene["params"]["x"] = 3


NAN, INFINITY = float("nan"), float("inf")
class Weighs(Sampling):
    """Every density changed by a function."""

    def __init__(self, change: Callable[[float], float]) -> None:
        self.change = change

    def density(self, task: Task, draws: Sequence[object]) -> float:
        return self.change(Ourselves().density(task, draws))


def refuse(density: float) -> float:
    raise Refused("run", "no")


ERROR = "plumbing-error"
DENSITY = "plumbing-density"
CASES: dict[str, tuple[Sampling | Ourselves, str, str, str]] = {
    # values
    "the least that is needed": (Sampling(), "plumbing-values", "passed", ""),
    "values off by 1e-3": (off(1e-3), "plumbing-values", "failed", "params.r is 5.001, not 5.0 (tolerance 1e-09)"),
    "values off by less than the tolerance": (off(1e-10), "plumbing-values", "passed", ""),
    "NaN for numbers": (Changed(lambda _: NAN), "plumbing-values", "failed", "params.r is nan"),
    "1 for true": (Edited(swap_flag), "plumbing-values", "failed", "params.flag is 1, not True"),
    "a parameter missing": (Edited(forget), "plumbing-values", "failed", "the scene has no params.r"),
    "a property missing": (Edited(drop_property), "plumbing-values", "failed", "the scene has no objects[0].taste"),
    "an object too many": (Edited(one_more), "plumbing-values", "failed", "the scene has 3 objects, not 2"),
    "headings a turn away": (Edited(whole_turns), "plumbing-values", "passed", ""),
    "a scene too few": (MissesAScene(), "plumbing-values", "failed", "gave 2 scenes, and 3 were asked for"),
    "an empty scene": (AcceptsEverything(), "plumbing-values", "failed", "the scene has no params.r"),
    "an error instead of scenes": (Raises(Refused("run", "no")), "plumbing-values", "failed", "refused in phase run: no"),
    "nothing accepted": (Raises(NeverAccepted()), "plumbing-values", "failed", "no run was accepted: the requirements are not reported"),
    "a crash": (Raises(RuntimeError("out of memory")), "plumbing-values", "errored", "RuntimeError: out of memory"),
    # rules
    "rules that do not fire": (Traces(), "plumbing-values", "failed", "these rules did not fire: O-Distance-Ego"),
    "rules that must not fire": (Traces("O-Distance-Ego", "O-Angle"), "plumbing-values", "failed", "these rules fired and must not: O-Angle"),
    "the right rules": (Traces("O-Distance-Ego", "E-Variable"), "plumbing-values", "passed", ""),
    # probabilities
    "exact fractions": (Ourselves(), "plumbing-probabilities", "passed", ""),
    "frequencies instead of fractions": (Sampling(), "plumbing-probabilities", "passed", ""),
    "fractions of another law": (
        Enumerates(lambda e: Enumerated(tuple((Fraction(1, len(e.outcomes)), s) for _, s in e.outcomes), e.acceptance)),
        "plumbing-probabilities", "failed", "params.x is 1 with probability 1/2, not 1/7",
    ),
    "another acceptance": (
        Enumerates(lambda e: Enumerated(e.outcomes, Fraction(1))), "plumbing-probabilities", "failed", "accepted with probability 1, not 7/8",
    ),
    "an outcome missing": (
        Enumerates(lambda e: Enumerated(e.outcomes[:1], e.acceptance)), "plumbing-probabilities", "failed", "not 1/7",
    ),
    "enumeration gives up": (Enumerates(lambda e: None), "plumbing-probabilities", "passed", ""),
    "an outcome that is none": (Edited(other_value), "plumbing-probabilities", "failed", "params.x is 3, which is none of the outcomes"),
    "always the same outcome": (Repeats(), "plumbing-probabilities", "failed", "the samples of params.x contradict the law"),
    "frequencies of a continuous program": (Sampling(), "plumbing-sampled-probabilities", "passed", ""),
    "the same scene again": (Repeats(), "plumbing-sampled-probabilities", "failed", "the samples of params.low contradict the law"),
    # distribution
    "a sampler": (Sampling(), "plumbing-distribution", "passed", ""),
    "another distribution": (Changed(lambda x: x**2), "plumbing-distribution", "failed", "the samples of ego.v contradict the law"),  # type: ignore[operator]
    "a slightly wider distribution": (Changed(lambda x: x * 1.05), "plumbing-distribution", "failed", "contradict the law"),  # type: ignore[operator]
    "one value": (Repeats(), "plumbing-distribution", "failed", "contradict the law"),
    "no finite numbers": (Changed(lambda _: INFINITY), "plumbing-distribution", "failed", "ego.v is inf, which is not a finite number"),
    "no numbers": (Changed(lambda _: "x"), "plumbing-distribution", "failed", "ego.v is 'x', which is not a finite number"),
    "another mean": (Changed(lambda x: x**0.5), "plumbing-moments", "failed", "the samples of ego.v contradict the law"),  # type: ignore[operator]
    "the mean alone": (Changed(lambda _: 0.5), "plumbing-moments", "failed", "contradict the law"),
    "out of the moments' range": (Changed(lambda x: x + 1), "plumbing-moments", "failed", "contradict the law: e-value 10^inf"),  # type: ignore[operator]
    # support
    "points all over": (Sampling(), "plumbing-support", "passed", ""),
    "points outside": (Changed(lambda x: x * 2), "plumbing-support", "failed", "which lies outside its support"),  # type: ignore[operator]
    "NaN for points": (Changed(lambda _: NAN), "plumbing-support", "failed", "which lies outside its support"),
    "points in one half": (Changed(lambda x: abs(x)), "plumbing-support", "failed", "ego.position reaches[0] in none of 60 scenes"),  # type: ignore[arg-type]
    # rejection
    "the right rejection": (Raises(NeverAccepted(frozenset({"collision"}))), "plumbing-rejection", "passed", ""),
    "a rejection without its reason": (Raises(NeverAccepted()), "plumbing-rejection", "passed", ""),
    "a rejection for another reason": (
        Raises(NeverAccepted(frozenset({"visibility"}))), "plumbing-rejection", "failed", "not because of collision alone: these failed: visibility",
    ),
    "everything accepted": (AcceptsEverything(), "plumbing-rejection", "failed", "gave 1 scenes, and no run may be accepted"),
    "an error instead of a rejection": (Raises(Refused("run", "no")), "plumbing-rejection", "failed", "instead of never accepted: no"),
    # error
    "the right error": (Raises(Refused("resolve", "twice", class_name="SpecifiedTwice", line=2)), ERROR, "passed", ""),
    "an error without details": (Raises(Refused("resolve", "twice")), ERROR, "passed", ""),
    "an error of another phase": (Raises(Refused("run", "no", line=2)), ERROR, "failed", "refused in phase run, not resolve: no"),
    "an error in another line": (Raises(Refused("resolve", "no", line=1)), ERROR, "failed", "refused with line 1, not 2: no"),
    "an error of another class": (Raises(Refused("resolve", "no", class_name="Other")), ERROR, "failed", "refused with class Other"),
    "an error of another rule": (Raises(Refused("resolve", "no", rule="R-Cyclic")), ERROR, "failed", "refused with rule R-Cyclic"),
    "no error at all": (AcceptsEverything(), ERROR, "failed", "gave 1 scenes instead of an error of phase resolve"),
    "a rejection instead of an error": (Raises(NeverAccepted()), ERROR, "failed", "never accepted instead of refused in phase resolve"),
    "a crash instead of an error": (Raises(ValueError("x")), ERROR, "errored", "ValueError: x"),
    # density
    "the right densities": (Ourselves(), DENSITY, "passed", ""),
    "probabilities instead of densities": (Weighs(lambda density: min(density, 1.0)), DENSITY, "failed", "the density of [0.125] is 1.0, not 4.0"),
    "an impossible draw that is possible": (Weighs(lambda density: density or 1e-12), DENSITY, "failed", "the density of [0.5] is 1e-12, not 0.0"),
    "an error instead of a density": (Weighs(refuse), DENSITY, "failed", "refused in phase run: no"),
    "no densities": (Sampling(), DENSITY, "skipped", "sampling does not say how likely a run is"),
    # what does not apply
    "another reading": (Rigid(), "plumbing-other-dialect", "skipped", "the program is not given in paper"),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("what", CASES)
def test_the_verdict_and_its_reason(what: str) -> None:
    implementation, name, status, reason = CASES[what]
    verdict = judge(implementation, VECTORS[name]).verdict
    assert verdict.status == status, verdict.reason
    assert reason in verdict.reason


@pytest.mark.parametrize("kind", ["values", "probabilities", "distribution", "support", "density", "rejection", "error"])
def test_every_matcher_has_an_implementation_that_fails_it_and_one_that_passes(kind: str) -> None:
    seen = {status for _, name, status, _ in CASES.values() if VECTORS[name].kind == kind}
    assert {"passed", "failed"} <= seen


def vector(more: str) -> ConformanceVector:
    (found,) = read_file("f.toml", 'chapter = "C"\n[[vector]]\nname = "v"\npaper = "p"\nprogram = "ego = Object with v Range(0, 1)"\n' + more)
    return found


def test_samples_that_do_not_contradict_the_rival_prove_nothing() -> None:
    law, rival = 'cdf = { name = "uniform", low = 0, high = 1 }', 'rival.cdf = { name = "uniform", low = 0, high = 1.01 }'
    verdict = judge(Ourselves(), vector(f'distribution = {{ of = "ego.v", samples = 50, {law}, {rival} }}')).verdict
    assert verdict.status == "failed"
    assert "do not contradict the rival" in verdict.reason


def test_a_vector_about_a_reading_that_is_not_followed_is_skipped() -> None:
    about = vector('readings = { soft = "run" }\nrejection = { attempts = 1, requirement = "require" }')
    assert judge(Rigid(), about).verdict.reason == "sampling does not follow soft = run"


def test_the_implementation_chooses_among_the_dialects_that_are_given() -> None:
    given = vector('variants.scenic-3 = "ego = new Object with v 3"\nvalues = { objects = [{ index = 0, v = 3 }], tolerance = 0 }')

    class Released(Ourselves):
        dialects = ("scenic-3", "paper")

    assert judge(Released(), given).dialect == "scenic-3"
    assert judge(Released(), given).verdict.status == "passed"
    assert judge(Released(), given, "paper").verdict.status == "failed"
    assert judge(Released(), given, "pldi19").verdict.status == "skipped"


def test_an_error_of_any_of_the_phases_of_a_list_is_right() -> None:
    given = vector('error = { phase = ["check", "run"] }')
    assert [judge(Raises(Refused(phase, "no")), given).verdict.status for phase in ("parse", "check", "resolve", "run")] == [
        "failed", "passed", "failed", "passed",
    ]
    assert judge(Raises(Refused("parse", "no")), given).verdict.reason == "refused in phase parse, not check or run: no"
    assert judge(Raises(NeverAccepted()), given).verdict.reason.startswith("never accepted instead of refused in phase check or run")
