"""For the tests of other implementations: were these scenes drawn from the distribution of that scenario?

    from scenic_ref.testing import assert_same_distribution

    def test_my_sampler():
        scenes = [my_sampler.scene() for _ in range(5000)]          # in the scene format
        assert_same_distribution(scenes, scenic_ref.load("scene.scenic"), detect_tv=0.15)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path

from ..inference.enumeration import Enumeration
from ..inference.statistics import DEFAULT_ALPHA, DEFAULT_TV, Sampler, Verdict, compare
from ..inference.statistics.columns import leaves
from ..inference.statistics.reading import read_samples
from ..interpreter.scenes import Scene
from ..scenario import Scenario
from ..semantics.errors import RunsExhausted, UsageError

REFERENCE_SEED = 20_190_625
MOST_RUNS = 2_000

Samples = str | Path | Sequence[Scene] | Sequence[Mapping[str, object]]
Reference = Sampler | Sequence[Mapping[str, object]] | Sequence[Scene]


def same_distribution(
    samples: Samples, scenario: Scenario, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, seed: int = REFERENCE_SEED,
    reference: Reference | None = None, draw: Sampler | None = None, replay: str = "",
) -> Verdict:
    """Whether `samples` (scenes, or the path of a file of them) were drawn from the distribution of `scenario`.

    P("different") <= `alpha` if they were. A program with at most a few thousand runs is enumerated, and the samples are compared with
    the exact law; for any other, as many scenes are drawn with `seed` as there are samples (by `draw`, which stands for
    the scenario), or taken from `reference`. What does not depend on any
    draw must be the same in every sample. Raises `UsageError` for samples that cannot be compared, and the program's errors.
    """
    scenes = read_samples(samples) if isinstance(samples, (str, Path)) else samples
    check_columns(scenes, scenario)
    law = None if reference is not None else enumerated(scenario)
    if law is None and reference is None:
        check_seed(scenes, seed)
    other = law if law is not None else reference if reference is not None else draw or scenario
    again = replay or f"assert_same_distribution(samples, scenario, alpha={alpha:g}, detect_tv={detect_tv:g}, seed={seed})"
    return compare(scenes, other, alpha=alpha, detect_tv=detect_tv, seeds=(seed, seed), constants=scenario.constants, replay=again)


def enumerated(scenario: Scenario) -> Enumeration | None:
    """The exact distribution, if it takes few runs; otherwise None."""
    try:
        return scenario.enumerate(max_runs=MOST_RUNS)
    except (UsageError, RunsExhausted):
        return None


def check_columns(scenes: Sequence[Scene] | Sequence[Mapping[str, object]], scenario: Scenario) -> None:
    """The columns of a CSV file must be features of the program's scenes. Raises `UsageError`."""
    first = scenes[0] if len(scenes) else None
    columns = first.get("columns") if isinstance(first, Mapping) else None
    if isinstance(columns, Mapping):
        known = dict(leaves(scenario.sample().to_json()))
        wrong = [name for name in columns if name not in known and name not in ("weight", "seed")]
        if wrong:
            near = get_close_matches(wrong[0], list(known), n=1)
            raise UsageError(f"scenes of the program have no {wrong[0]}", hint=f"did you mean {near[0]}?" if near else "")


def check_seed(scenes: Sequence[Scene] | Sequence[Mapping[str, object]], seed: int) -> None:
    """Samples that were drawn with the seed of the reference would be compared with themselves. Raises `UsageError`."""
    for scene in scenes:
        if (scene.seed if isinstance(scene, Scene) else scene.get("seed")) == seed:
            raise UsageError(f"the samples were drawn with seed {seed}, and would be compared with themselves", hint="give another --seed")


def assert_same_distribution(
    samples: Samples, scenario: Scenario, *, alpha: float = DEFAULT_ALPHA, detect_tv: float = DEFAULT_TV, seed: int = REFERENCE_SEED,
    reference: Reference | None = None, inconclusive: str = "fail",
) -> Verdict:
    """`same_distribution`, as an assertion whose message names the worst feature and how to replay it.

    A comparison that is inconclusive fails as well, since it has not shown what it was asked for, unless `inconclusive` is "pass".
    """
    if inconclusive not in ("fail", "pass"):
        raise UsageError(f'inconclusive is "fail" or "pass", not {inconclusive!r}')
    verdict = same_distribution(samples, scenario, alpha=alpha, detect_tv=detect_tv, seed=seed, reference=reference)
    if verdict.kind == "different" or (verdict.kind == "inconclusive" and inconclusive == "fail"):
        raise AssertionError(str(verdict))
    return verdict


__all__ = ["assert_same_distribution", "same_distribution"]
