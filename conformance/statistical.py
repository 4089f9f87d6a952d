"""The matchers that look at many scenes: `probabilities`, `distribution` and `support`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from ..inference.comparison.exact_laws import Categorical, evidence
from .fields import VectorFields
from .implementation import Enumerated, Enumerating, Implementation, NeverAccepted, Refused, Task
from .laws import THRESHOLD, Law, contradiction, read_law
from .matching import Disagreement, disagreed, draw, read, requirements
from .paths import Path, close, is_number, read_path
from .shapes import Shape, read_shape
from .verdict import PASSED, VectorVerdict

SAME = 1e-9
"""How near a value must be to an outcome to count as that outcome."""


@dataclass(frozen=True, slots=True)
class Probabilities:
    """The exact distribution of a quantity with finitely many values, and perhaps the probability that a run is accepted.

    An implementation that enumerates must give exactly these fractions; any other is sampled, and its samples must contradict `rival`.
    """

    of: Path
    outcomes: tuple[object, ...]
    probabilities: tuple[Fraction | float, ...]
    rival: tuple[Fraction | float, ...]
    acceptance: Fraction | float | None
    samples: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """By enumeration where that is possible, by sampling elsewhere."""
        try:
            exact = enumerated(implementation, task) if self.is_exact else None
            if exact is None:
                self.check_samples(read(draw(implementation, task, self.samples), self.of))
            else:
                self.check_enumeration(exact)
        except Disagreement as disagreement:
            return disagreed(disagreement)
        return PASSED

    @property
    def is_exact(self) -> bool:
        """Whether all probabilities are fractions."""
        return all(isinstance(p, Fraction) for p in self.probabilities)

    def numbers(self, values: Sequence[object]) -> list[int]:
        """Which outcome each value is. Raises `Disagreement` for a value that is none of them."""
        found: list[int] = []
        for value in values:
            same = [number for number, outcome in enumerate(self.outcomes) if close(value, outcome, SAME)]
            if not same:
                raise Disagreement(f"{self.of} is {value!r}, which is none of the outcomes")
            found.append(same[0])
        return found

    def check_enumeration(self, exact: Enumerated) -> None:
        """The fractions themselves. Raises `Disagreement`."""
        found = [Fraction(0)] * len(self.outcomes)
        numbers = self.numbers(read([scene for _, scene in exact.outcomes], self.of))
        for number, (probability, _) in zip(numbers, exact.outcomes, strict=True):
            found[number] += probability
        for outcome, expected, probability in zip(self.outcomes, self.probabilities, found, strict=True):
            if probability != expected:
                raise Disagreement(f"{self.of} is {outcome!r} with probability {probability}, not {expected}")
        if self.acceptance is not None and not agree(exact.acceptance, self.acceptance):
            raise Disagreement(f"a run is accepted with probability {exact.acceptance}, not {self.acceptance}")

    def check_samples(self, values: Sequence[object]) -> None:
        """Frequencies must not contradict the probabilities, and must contradict the rival's. Raises `Disagreement`."""
        numbers = self.numbers(values)
        told_apart(evidence(numbers, law_of(self.probabilities)), evidence(numbers, law_of(self.rival)), f"{self.of}")


def agree(found: Fraction, expected: Fraction | float) -> bool:
    """Whether an exact probability is the expected one, which may be rounded."""
    return found == expected if isinstance(expected, Fraction) else abs(float(found) - expected) <= SAME


def law_of(probabilities: Sequence[Fraction | float]) -> Categorical:
    """The distribution of the number of an outcome."""
    return Categorical(dict(enumerate(probabilities)))


def told_apart(against: float, against_rival: float, what: str) -> None:
    """The samples must not contradict the law, and must contradict the rival. Raises `Disagreement`."""
    if against >= THRESHOLD:
        raise Disagreement(f"the samples of {what} contradict the law: e-value 10^{against:.1f}, and 10^{THRESHOLD:g} is enough")
    if against_rival < THRESHOLD:
        raise Disagreement(f"the samples of {what} do not contradict the rival: e-value 10^{against_rival:.1f}, and 10^{THRESHOLD:g} is needed")


def enumerated(implementation: Implementation, task: Task) -> Enumerated | None:
    """The exact distribution if the implementation can find it. Raises `Disagreement` if it refuses the program."""
    try:
        return implementation.enumerated(task) if isinstance(implementation, Enumerating) else None
    except Refused as refused:
        raise Disagreement(f"{refused.when}: {refused.message}") from None
    except NeverAccepted as never:
        raise Disagreement(f"no run was accepted: {requirements(never)}") from None


def read_probabilities(fields: VectorFields) -> Probabilities:
    """The table `probabilities` of a vector. Raises `UsageError`."""
    of, outcomes = read_path(fields), fields.tables("outcomes")
    values = tuple(outcome.any("value") for outcome in outcomes)
    probabilities = tuple(outcome.probability("probability") for outcome in outcomes)
    rival = tuple(fields.as_probability("rival", share) for share in fields.items("rival"))
    acceptance = fields.probability("acceptance") if fields.has("acceptance") else None
    found = Probabilities(of, values, probabilities, rival, acceptance, fields.count("samples"))
    for table in (*outcomes, fields):
        table.done()
    for name, shares in (("outcomes", probabilities), ("rival", rival)):
        if len(shares) != len(values) or abs(sum(shares) - 1) > SAME:
            raise fields.wrong(f"the probabilities of {name} must be one for each outcome and add up to 1")
    return found


@dataclass(frozen=True, slots=True)
class QuantityLaw:
    """The distribution of a real quantity: its distribution function, or moments of it; the same samples must contradict `rival`."""

    of: Path
    law: Law
    rival: Law
    samples: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Samples against the law and against its rival."""
        try:
            values = [number(value, self.of) for value in read(draw(implementation, task, self.samples), self.of)]
            told_apart(contradiction(values, self.law), contradiction(values, self.rival), f"{self.of}")
        except Disagreement as disagreement:
            return disagreed(disagreement)
        return PASSED


def number(value: object, of: Path) -> float:
    """A finite number. Raises `Disagreement` for anything else."""
    if not is_number(value) or not math.isfinite(value):
        raise Disagreement(f"{of} is {value!r}, which is not a finite number")
    return float(value)


def read_distribution(fields: VectorFields) -> QuantityLaw:
    """The table `distribution` of a vector. Raises `UsageError`."""
    of, law = read_path(fields), read_law(fields)
    rival = fields.table("rival")
    found = QuantityLaw(of, law, read_law(rival), fields.count("samples"))
    rival.done()
    fields.done()
    return found


@dataclass(frozen=True, slots=True)
class QuantitySupport:
    """Where a quantity always lies, and sets that it must reach in `samples` samples."""

    of: Path
    within: Shape
    reaches: tuple[Shape, ...]
    tolerance: float
    samples: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Every sample lies within; each set is reached by one."""
        try:
            values = read(draw(implementation, task, self.samples), self.of)
            outside = next((value for value in values if not self.within(value, self.tolerance)), None)
            if outside is not None:
                raise Disagreement(f"{self.of} is {outside!r}, which lies outside its support")
            for index, shape in enumerate(self.reaches):
                if not any(shape(value, 0.0) for value in values):
                    raise Disagreement(f"{self.of} reaches[{index}] in none of {self.samples} scenes")
        except Disagreement as disagreement:
            return disagreed(disagreement)
        return PASSED


def read_support(fields: VectorFields) -> QuantitySupport:
    """The table `support` of a vector. Raises `UsageError`."""
    reaches = tuple(read_shape(table) for table in fields.tables("reaches"))
    found = QuantitySupport(read_path(fields), read_shape(fields.table("within")), reaches, fields.number("tolerance"), fields.count("samples"))
    fields.done()
    return found
