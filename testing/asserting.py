"""Whether samples were drawn from the distribution of a scenario, as an answer and as an assertion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..inference.comparison import DEFAULT_ALPHA, DEFAULT_TV, Verdict
from ..inference.comparison.rounding import DEFAULT_TOLERANCE
from ..scenario import Scenario
from ..semantics.kernel.errors import UsageError
from .judging import REFERENCE_SEED, Reference, Samples, judged


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
    return judged(
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
