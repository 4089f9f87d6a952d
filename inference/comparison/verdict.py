"""The verdict of a comparison, with everything that is needed to believe it or to repeat it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

MOST_NAMED = 12
MOST = 1 << 40
"""The largest number of scenes that a verdict calls needed."""
FIRST_BLOCK, BURNED_SHARE = (100, 4000), 8
"""The least and the most scenes that give the cells, and of how many one gives them."""
Kind = Literal["different", "equivalent", "inconclusive"]


@dataclass(frozen=True)
class Feature:
    """How one feature, or a pair of them, compares: log10 of its e-value, and the counts (or expected counts) in its cells."""

    name: str
    evidence: float
    labels: tuple[str, ...]
    counts: tuple[float, ...]
    others: tuple[float, ...]

    @property
    def distance(self) -> float:
        """The total variation distance between the observed frequencies of the cells."""
        a, b = sum(self.counts) or 1.0, sum(self.others) or 1.0
        return sum(abs(x / a - y / b) for x, y in zip(self.counts, self.others, strict=True)) / 2

    @property
    def worst_cell(self) -> int:
        """The cell in which the frequencies differ most, in standard deviations."""
        a, b = sum(self.counts) or 1.0, sum(self.others) or 1.0
        apart = [abs(x / a - y / b) / math.sqrt((x + y + 1) / (a + b)) for x, y in zip(self.counts, self.others, strict=True)]
        return max(range(len(apart)), key=apart.__getitem__) if apart else 0


@dataclass(frozen=True)
class Verdict:
    """The outcome of `compare`.

    `evidence` is log10 of the combined e-value at its largest: "different" means that it reached -log10 `alpha`, which happens with
    probability at most `alpha` if there is no difference. "equivalent" means that it did not, though a difference of `detect_tv` in total variation
    in the cells of any one feature would have made it with probability 0.99; "inconclusive", that there were too few
    scenes for this: `detectable` is the smallest difference that these would have shown. `n` scenes of each side were used after
    `burned` ones, which only gave the cells; `features` begins with the worst, and the power is stated for `stated` of them.
    `impossible` lists impossible values, one line each.
    `skipped` are features that only one of the sides has. `seeds` are those of what was drawn for the comparison.
    """

    kind: Kind
    evidence: float
    alpha: float
    detect_tv: float
    detectable: float
    n: int
    needed: int
    burned: int
    features: tuple[Feature, ...]
    stated: int
    impossible: tuple[str, ...]
    skipped: tuple[str, ...]
    constants: int
    exact: bool
    seeds: tuple[int, int]
    replay: str = ""

    @property
    def worst(self) -> str:
        """The feature with the most evidence of a difference."""
        return self.features[0].name if self.features else "(none)"

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> list[str]:
        """The verdict in sentences."""
        return [*self._headline(), *self._why(), *([f"replay: {self.replay}"] if self.replay else [])]

    def _headline(self) -> list[str]:
        sides = f"{self.n:,} scenes against the exact law" if self.exact else f"{self.n:,} scenes of each side"
        burned = f" ({self.burned:,} more of each gave the cells)" if self.burned else ""
        risk = f"{self.alpha:g}"
        match self.kind:
            case "different" if self.impossible:
                return ["different: the samples hold values that the program cannot give"]
            case "different":
                return [f"different: {sides}{burned}; the risk of a false alarm is at most {risk}"]
            case "equivalent" if not self.stated:
                return [f"equivalent: {sides}{burned}, in which nothing that is compared varies on either side"]
            case "equivalent":
                return [
                    f"equivalent within the stated power: {sides}{burned}; a difference of {self.detect_tv:.2%} in total variation in the cells of "
                    f"any of {self.stated:,} features would have shown with probability 0.99 (risk of a false alarm {risk})"
                ]
            case _:
                if self.detectable >= 1:
                    return [f"inconclusive: so few scenes cannot show any difference; for {self.detect_tv:.4g} {self._enough}"]
                return [
                    f"inconclusive: no evidence of a difference in {sides}{burned}, but these would have shown differences of "
                    f"{self.detectable:.2%} or more only; for {self.detect_tv:.4g} {self._enough}"
                ]

    @property
    def enough(self) -> int:
        """How many samples a difference of `detect_tv` needs, those that only give the cells included."""
        return self.needed if self.exact else self.needed + min(max(math.ceil(self.needed / (BURNED_SHARE - 1)), FIRST_BLOCK[0]), FIRST_BLOCK[1])

    @property
    def _enough(self) -> str:
        return f"some {self.enough:,} samples are needed" if self.needed < MOST else f"more than {MOST:,} samples are needed"

    def _why(self) -> list[str]:
        if self.impossible:
            return [f"impossible: {line}" for line in self.impossible]
        found = [f"evidence: 10^{self.evidence:.1f}, where 10^{-math.log10(self.alpha):.1f} means different"]
        if self.features:
            worst, cell = self.features[0], self.features[0].worst_cell
            a, b = sum(worst.counts) or 1.0, sum(worst.others) or 1.0
            found += [
                f"worst feature: {worst.name} (10^{worst.evidence:.1f}), most in the cell {worst.labels[cell]}: "
                f"{worst.counts[cell] / a:.3%} of the samples, {worst.others[cell] / b:.3%} expected"
            ]
        if self.skipped:
            more = f" and {len(self.skipped) - MOST_NAMED:,} more" if len(self.skipped) > MOST_NAMED else ""
            found += [f"not compared, since only one side has them: {', '.join(self.skipped[:MOST_NAMED])}{more}"]
        return found
