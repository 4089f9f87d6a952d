"""For the tests of other implementations: were these scenes drawn from the distribution of that scenario?

    from scenic_ref.testing import assert_same_distribution

    def test_my_sampler():
        scenes = [my_sampler.scene() for _ in range(5000)]          # in the scene format
        assert_same_distribution(scenes, scenic_ref.load("scene.scenic"), detect_tv=0.15)
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path

from ..inference.enumeration import Enumeration
from ..inference.statistics import DEFAULT_ALPHA, DEFAULT_TV, Sampler, Verdict, compare
from ..inference.statistics.columns import leaves, table_of
from ..inference.statistics.comparison import AnyScene
from ..inference.statistics.impossible import wrong_constants
from ..inference.statistics.reading import read_samples
from ..interpreter.scenes import Scene
from ..scenario import Scenario
from ..semantics.errors import RunsExhausted, UsageError
from ..semantics.readings import select
from .simulators import BrokenContract, check_simulator

REFERENCE_SEED = 20_190_625
MOST_RUNS = 2_000

Samples = str | Path | Iterable[Scene] | Iterable[Mapping[str, object]]
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
    if not isinstance(scenario, Scenario):
        raise UsageError(f"samples are compared with a scenario, not with a {type(scenario).__name__}", hint="scenic_ref.load(path) gives one")
    scenes = read_samples(samples) if isinstance(samples, (str, Path)) else checked(samples)
    if reference is not None and not hasattr(reference, "sample_many"):
        check_reference(scenes, reference, scenario)  # type: ignore[arg-type]
    check_columns(scenes, scenario)
    law = None if reference is not None else enumerated(scenario)
    if law is None and reference is None:
        check_seed(scenes, seed)
    other = law if law is not None else reference if reference is not None else draw or scenario
    again = replay or replay_of(samples, scenario, alpha, detect_tv, seed, drawn=reference is None and draw is None)
    return compare(scenes, other, alpha=alpha, detect_tv=detect_tv, seeds=(seed, seed), constants=scenario.constants, replay=again)


def checked(samples: Iterable[Scene] | Iterable[Mapping[str, object]]) -> Sequence[Scene] | Sequence[Mapping[str, object]]:
    """The samples as a list. Raises `UsageError` for what is no scene."""
    scenes = samples if isinstance(samples, Sequence) else list(samples)
    for number, scene in enumerate(scenes, 1):
        if not isinstance(scene, (Scene, Mapping)):
            raise UsageError(f"sample {number} is a {type(scene).__name__}, not a scene", hint="a Scene, or a JSON object in the scene format")
    return scenes  # type: ignore[return-value]


def check_reference(samples: Sequence[AnyScene], reference: Sequence[AnyScene], scenario: Scenario) -> None:
    """The reference must be scenes of the program, and not the samples themselves. Raises `UsageError`."""
    wrong = wrong_constants(table_of(reference), scenario.constants)
    if wrong:
        raise UsageError(f"the reference holds what the program cannot give: {wrong[0]}", hint="draw it again from this program")
    known = {numbered(scene) for scene in reference} - {None}
    same = next((number for scene in samples if (number := numbered(scene)) in known), None)
    if same is not None:
        raise UsageError(f"samples and reference both hold scene {same[1]} of seed {same[0]}", hint="draw the reference with another seed")


def numbered(scene: AnyScene) -> tuple[object, object] | None:
    """The seed and number of a scene, if it says which it is."""
    seed, index = (scene.seed, scene.index) if isinstance(scene, Scene) else (scene.get("seed"), scene.get("scene"))
    return None if seed is None or index is None else (seed, index)


def replay_of(samples: object, scenario: Scenario, alpha: float, detect_tv: float, seed: int, *, drawn: bool) -> str:
    """The command that makes the comparison again, where there is one; else the call, for the reader to fill in."""
    options = f"alpha={alpha:g}, detect_tv={detect_tv:g}, seed={seed}"
    plain = not scenario.params and scenario.model is None and not scenario.trust and scenario.readings == select("paper", None)
    if drawn and plain and isinstance(samples, (str, Path)) and Path(scenario.program.file).is_file():
        words = ["scenic-ref", "check", scenario.program.file, "--samples", str(samples)]
        return shlex.join([*words, "--alpha", f"{alpha:g}", "--detect-tv", f"{detect_tv:g}", "--seed", str(seed)])
    return f"same_distribution(..., {options}), with the same samples and the same scenario"


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


__all__ = ["BrokenContract", "assert_same_distribution", "check_simulator", "same_distribution"]
