"""The judge of samples: what is known of the program, the exact law or a reference, and the verdict."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from itertools import chain
from pathlib import Path

from scipy.special import betaincinv

from ..api import Scenario
from ..data.scene import Scene
from ..inference.comparison import DEFAULT_ALPHA, DEFAULT_TV, Sampler, Verdict, compare
from ..inference.comparison.comparison import check_settings, with_law
from ..inference.comparison.feature_names import SampleNames
from ..inference.comparison.known_features import Facts
from ..inference.comparison.rounding import DEFAULT_TOLERANCE
from ..inference.comparison.sample_files import AnyScene, scenes_in
from ..inference.comparison.sample_files import Samples as Given
from ..inference.comparison.scene_columns import leaves
from ..inference.enumeration import Enumeration
from ..inference.rejection import DEFAULT_ATTEMPTS
from ..interpreter.language.dialects import DIALECTS
from ..semantics.readings import select
from ..semantics.store.errors import RunsExhausted, UsageError
from ..semantics.store.suggestions import did_you_mean

REFERENCE_SEED = 20_190_625
def same_distribution(
    samples: Samples, scenario: Scenario, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, seed: int = REFERENCE_SEED,
    tolerance: float = DEFAULT_TOLERANCE, ignore: Sequence[str] = (), map: Mapping[str, str] | None = None, reference: Reference | None = None,
) -> Verdict:  # fmt: skip
    """Whether `samples` (scenes, or the path of a file of them) were drawn from the distribution of `scenario`.

    P("different") <= `alpha` if they were. A program with at most a few thousand runs is enumerated, and the samples are compared with
    the exact law; for any other, as many scenes are drawn with `seed` as there are samples, or taken from `reference`. What does not depend on
    any draw must be the same in every sample, and what does must be what a draw can give. Numbers that differ by at most `tolerance` (relative
    to the larger of them and 1) are equal, so that samples may be rounded. The features `ignore` are not compared; `map` gives the program's
    names for what the samples call features and classes otherwise.
    Raises `UsageError` for samples that cannot be compared, and the program's errors.
    """
    if not isinstance(scenario, Scenario):
        raise UsageError(f"samples are compared with a scenario, not with a {type(scenario).__name__}", hint="scenic_ref.load(path) gives one")
    return judge_samples(
        samples, scenario, alpha=alpha, detect_tv=detect_tv, seed=seed, tolerance=tolerance, ignore=ignore, map=map, reference=reference,
    )  # fmt: skip


def assert_same_distribution(
    samples: Samples, scenario: Scenario, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, seed: int = REFERENCE_SEED,
    tolerance: float = DEFAULT_TOLERANCE, ignore: Sequence[str] = (), map: Mapping[str, str] | None = None, reference: Reference | None = None,
    inconclusive: str = "fail",
) -> Verdict:  # fmt: skip
    """`same_distribution`, as an assertion whose message names the worst feature and how to replay it.

    An inconclusive comparison fails as well, since it has not shown what was asked, unless `inconclusive` is "pass".
    """
    if inconclusive not in ("fail", "pass"):
        raise UsageError(f'inconclusive is "fail" or "pass", not {inconclusive!r}')
    verdict = same_distribution(
        samples, scenario, alpha=alpha, detect_tv=detect_tv, seed=seed, tolerance=tolerance, ignore=ignore, map=map, reference=reference,
    )  # fmt: skip
    if verdict.kind == "different" or (verdict.kind == "inconclusive" and inconclusive == "fail"):
        raise AssertionError(str(verdict))
    return verdict


MOST_RUNS = 2_000
DRAWN_FOR_NONE = 20
"""Scenes that are drawn to find out how likely a scene is, if the samples hold none."""

Samples = str | Path | Iterable[Scene] | Iterable[Mapping[str, object]]
Reference = str | Path | Sampler | Sequence[Mapping[str, object]] | Sequence[Scene]
Drawing = Callable[[int], AbstractContextManager[Sampler]]
"""Gives what draws a number of scenes."""


def judge_samples(
    samples: Samples, scenario: Scenario, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, seed: int = REFERENCE_SEED,
    tolerance: float = DEFAULT_TOLERANCE, ignore: Sequence[str] = (), map: Mapping[str, str] | None = None,
    reference: Reference | None = None, draw: Drawing | None = None, replay: str = "",
) -> Verdict:  # fmt: skip
    """The verdict of `same_distribution`; `draw` stands for the scenario where scenes are drawn."""
    check_settings(alpha, detect_tv, None, tolerance)
    names = SampleNames(tuple(ignore), dict(map or {}))
    scenes, first = open_samples(samples)
    scenario.rehearse()
    again = replay or replay_of(samples, scenario, alpha, detect_tv, seed, tolerance, names, drawn=reference is None)
    if first is None:
        return verdict_on_none(scenario, alpha, detect_tv, seed, again)
    if scenario.impossible is not None:
        told = scenario.impossible.message.removeprefix("no scene is possible: ")
        return without_comparison(f"the program has no scenes, but the samples do: {told}", alpha, detect_tv, seed, again)
    check_columns(first, scenario, names)
    classes = frozenset(str(value) for name, value in scenario.constants.items() if name.endswith(".class"))
    names = SampleNames(names.ignore, names.map, classes)
    facts = scenario.facts.without(names.ignored)
    law = None if reference is not None else enumerate_if_small(scenario)
    facts = facts if law is None else with_law(facts, law, names)
    given = Given(scenes, seed, facts=facts, names=names, tolerance=tolerance)
    if reference is None and law is None and seed in given.drawn:
        raise UsageError(f"the samples were drawn with seed {seed}, and would be compared with themselves", hint="give another --seed")
    with nullcontext(scenario) if draw is None or law is not None or reference is not None else draw(given.n) as drawing:
        other = law or (drawing if reference is None else known_reference(reference, given, facts, names, seed, tolerance))
        return compare(
            given, other, alpha=alpha, detect_tv=detect_tv, seeds=(seed, seed), facts=facts, names=names, tolerance=tolerance, replay=again,
        )  # fmt: skip


def open_samples(samples: Samples) -> tuple[Path | Iterable[AnyScene], AnyScene | None]:
    """The samples, and the first of them, None if there is none. Raises `UsageError` for what holds no scenes."""
    if isinstance(samples, (str, Path)):
        return Path(samples), next((scene for _, scene in scenes_in(samples)), None)
    scenes = iter(check_scene_types(samples))
    first = next(scenes, None)
    return chain([] if first is None else [first], scenes), first


def check_scene_types(samples: Iterable[AnyScene]) -> Iterable[AnyScene]:
    """The samples. Raises `UsageError` for what is not a scene."""
    for number, scene in enumerate(samples, 1):
        if not isinstance(scene, (Scene, Mapping)):
            raise UsageError(f"sample {number} is a {type(scene).__name__}, not a scene", hint="a Scene, or a JSON object in the scene format")
        yield scene


def check_columns(first: AnyScene, scenario: Scenario, names: SampleNames) -> None:
    """The columns of a CSV file must be features of the program's scenes. Raises `UsageError`."""
    columns = first.get("columns") if isinstance(first, Mapping) else None
    if isinstance(columns, Mapping):
        known = dict(leaves(scenario.sample().to_json()))
        called = {names.feature(name): name for name in columns if name not in ("weight", "seed") and not names.ignored(name)}
        wrong = [name for name in called if name not in known]
        if wrong:
            hint = did_you_mean(wrong[0], known, f"--ignore {called[wrong[0]]} leaves it out")
            raise UsageError(f"scenes of the program have no {wrong[0]}", hint=hint)


def known_reference(reference: Reference, given: Given, facts: Facts, names: SampleNames, seed: int, tolerance: float) -> Sampler | Given:
    """The reference, which must be scenes of the program, and not the samples themselves. Raises `UsageError`."""
    if not isinstance(reference, (str, Path, Sequence)):
        return reference
    found = Given(reference, seed, facts=facts, names=names, tolerance=tolerance, theirs=False)
    if found.n == 0:
        raise UsageError(f"{reference} holds no scenes" if isinstance(reference, (str, Path)) else "the reference holds no scenes")
    if found.found.lines:
        raise UsageError(f"the reference holds what the program cannot give: {found.found.lines[0]}", hint="draw it again from this program")
    same = given.shared_with(found)
    if same is not None:
        raise UsageError(f"samples and reference both hold scene {same[1]} of seed {same[0]}", hint="draw the reference with another seed")
    return found


def enumerate_if_small(scenario: Scenario) -> Enumeration | None:
    """The exact distribution, if it takes few runs; otherwise None."""
    try:
        return scenario.enumerate(max_runs=MOST_RUNS)
    except (UsageError, RunsExhausted):
        return None


# No scenes at all


def verdict_on_none(scenario: Scenario, alpha: float, detect_tv: float, seed: int, replay: str, tried: int = DEFAULT_ATTEMPTS) -> Verdict:
    """The verdict on samples that hold no scene: a sampler that tries `tried` times would have found one, unless scenes are very rare.

    Raises `AttemptsExhausted` if the program gives none either.
    """
    if scenario.impossible is not None:
        raise scenario.impossible
    attempts = [scene.attempts for scene in scenario.sample_many(DRAWN_FOR_NONE, seed)]
    often = sum(attempts) / len(attempts)
    accepted = float(betaincinv(len(attempts), sum(attempts) - len(attempts) + 1, alpha / 2))  # less than P(a run is accepted), but for this risk
    text = f"the samples hold no scene, though the program gives one in {often:,.3g} attempts on average"
    if tried * math.log1p(-min(accepted, 1 - 1e-16)) <= math.log(alpha / 2):
        return without_comparison(text, alpha, detect_tv, seed, replay)
    raise UsageError(f"{text}: too rarely to say that a scene is missing", hint="give samples")


def without_comparison(line: str, alpha: float, detect_tv: float, seed: int, replay: str) -> Verdict:
    """A difference that shows before anything is compared."""
    return Verdict(
        kind="different", evidence=math.inf, alpha=alpha, detect_tv=detect_tv, detectable=1.0, n=0, needed=0, burned=0, features=(), stated=0,
        impossible=(line,), skipped=(), constants=0, exact=False, seeds=(seed, seed), replay=replay,
    )  # fmt: skip


def replay_of(
    samples: object, scenario: Scenario, alpha: float, detect_tv: float, seed: int, tolerance: float, names: SampleNames, *, drawn: bool
) -> str:  # fmt: skip
    """The command that makes the comparison again, where there is one; else the call, for the reader to fill in."""
    options = f"alpha={alpha:g}, detect_tv={detect_tv:g}, seed={seed}"
    usual = select(DIALECTS[scenario.program.dialect].profile)
    plain = not scenario.params and scenario.model is None and not scenario.trust and scenario.readings == usual
    if drawn and plain and isinstance(samples, (str, Path)) and Path(scenario.program.file).is_file():
        words = ["scenic-ref", "check", scenario.program.file, "--samples", str(samples), "--alpha", f"{alpha:g}", "--detect-tv", f"{detect_tv:g}"]
        words += ["--seed", str(seed), *(["--tolerance", f"{tolerance:g}"] if tolerance != DEFAULT_TOLERANCE else [])]
        words += [w for feature in names.ignore for w in ("--ignore", feature)]
        words += [w for theirs, ours in names.map.items() for w in ("--map", f"{theirs}={ours}")]
        return shlex.join(words)
    return f"same_distribution(..., {options}), with the same samples and the same scenario"

