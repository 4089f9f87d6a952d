"""The matchers that look at many scenes, `probabilities`, `distribution` and `support`, with the distributions and sets that a vector may name."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from ...inference.comparison.exact_laws import DEFAULT_ALPHA, BoundedMean, Categorical, Continuous, evidence
from ..implementations.protocol import Enumerated, Enumerating, Implementation, NeverAccepted, Refused, Task
from ..strict_tables import VectorFields
from ..verdict import PASSED, VectorVerdict
from .common import Disagreement, Path, close, disagreement_verdict, draw, is_json_number, read_at_path, read_path, requirements

THRESHOLD = -math.log10(DEFAULT_ALPHA)
"""log10 of the e-value that contradicts a law: a statistical vector accuses a correct implementation with probability at most `DEFAULT_ALPHA`."""

Cdf = Callable[[float], float]
Family = tuple[Cdf, float, float]
"""A distribution function, and the ends of the interval outside of which there are no values."""


@dataclass(frozen=True, slots=True)
class Moments:
    """The mean of a quantity that lies between `low` and `high`, and perhaps the mean of its square."""

    mean: float
    low: float
    high: float
    second: float | None = None


Law = Continuous | Moments


def contradiction(values: Sequence[float], law: Law) -> float:
    """How strongly the values contradict the law: the logarithm to base 10 of the largest e-value that they reached.

    With the mean of the squares there are two bets, with half of the stake on each: half of the larger is at most what they reach together.
    (The larger one alone would not be an e-value.)
    """
    if isinstance(law, Continuous):
        return evidence(values, law)
    if not all(law.low <= value <= law.high for value in values):
        return math.inf
    strongest = evidence(values, BoundedMean(law.mean, law.low, law.high))
    if law.second is None:
        return strongest
    most = max(law.low**2, law.high**2)
    return max(strongest, evidence([value**2 for value in values], BoundedMean(law.second, 0.0, most))) - math.log10(2)


def read_law(fields: VectorFields) -> Law:
    """The distribution function or the moments that a table holds. Raises `UsageError`."""
    if fields.has("cdf") == fields.has("moments"):
        raise fields.wrong("either cdf or moments is needed, and not both")
    return read_cdf(fields.table("cdf")) if fields.has("cdf") else read_moments(fields.table("moments"))


def read_moments(fields: VectorFields) -> Moments:
    """`{mean, low, high, second}`."""
    second = fields.number("second") if fields.has("second") else None
    law = Moments(fields.number("mean"), fields.number("low"), fields.number("high"), second)
    fields.done()
    if not law.low <= law.mean <= law.high:
        raise fields.wrong("the mean must lie between low and high")
    return law


def read_cdf(fields: VectorFields) -> Continuous:
    """`{name = "uniform", low = 0, high = 1}` and so on."""
    name = fields.text("name")
    if name not in FAMILIES:
        raise fields.wrong(f"there is no distribution function {name!r}: there are {', '.join(FAMILIES)}")
    cdf, low, high = FAMILIES[name](fields)
    fields.done()
    return Continuous(name, cdf, low, high)


def ordered_interval(fields: VectorFields) -> tuple[float, float]:
    """`low` and `high`, in this order."""
    low, high = fields.number("low"), fields.number("high")
    if not low < high:
        raise fields.wrong("low must be below high")
    return low, high


def deviation(fields: VectorFields) -> float:
    """`deviation`, above 0."""
    found = fields.number("deviation")
    if found <= 0:
        raise fields.wrong("deviation must be above 0")
    return found


def clip_to_unit(value: float) -> float:
    """The value, moved into [0, 1]."""
    return min(max(value, 0.0), 1.0)


def standard_normal(z: float) -> float:
    """The distribution function of the standard normal, precise in both tails."""
    return 0.5 * math.erfc(-z / math.sqrt(2))


def uniform(fields: VectorFields) -> Family:
    """F(x) = (x - low) / (high - low)."""
    low, high = ordered_interval(fields)
    return lambda x: clip_to_unit((x - low) / (high - low)), low, high


def normal(fields: VectorFields) -> Family:
    """F(x) = Φ((x - mean) / deviation)."""
    mean, std = fields.number("mean"), deviation(fields)
    return lambda x: standard_normal((x - mean) / std), -math.inf, math.inf


def truncated_normal(fields: VectorFields) -> Family:
    """F(x) = (Φ(z(x)) - Φ(z(low))) / (Φ(z(high)) - Φ(z(low))) with z(x) = (x - mean) / deviation."""
    mean, std = fields.number("mean"), deviation(fields)
    low, high = ordered_interval(fields)
    below, within = standard_normal((low - mean) / std), standard_normal((high - mean) / std) - standard_normal((low - mean) / std)
    return lambda x: clip_to_unit((standard_normal((x - mean) / std) - below) / within), low, high


def triangular(fields: VectorFields) -> Family:
    """The density rises linearly from low to mode and falls linearly to high."""
    low, high = ordered_interval(fields)
    mode = fields.number("mode")
    if not low <= mode <= high:
        raise fields.wrong("mode must lie between low and high")

    def cdf(x: float) -> float:
        if x <= low or x >= high:
            return 0.0 if x <= low else 1.0
        if x < mode:
            return (x - low) ** 2 / ((high - low) * (mode - low))
        return 1 - (high - x) ** 2 / ((high - low) * (high - mode))

    return cdf, low, high


def power(fields: VectorFields) -> Family:
    """F(x) = ((x - low) / (high - low)) ** exponent."""
    low, high = ordered_interval(fields)
    exponent = fields.number("exponent")
    if exponent <= 0:
        raise fields.wrong("exponent must be above 0")
    return lambda x: clip_to_unit((x - low) / (high - low)) ** exponent, low, high


def piecewise_linear(fields: VectorFields) -> Family:
    """F goes through the knots [x, F(x)] in straight lines, from [.., 0] to [.., 1]."""
    knots = fields.points("knots")
    rising = all(a[0] < b[0] and a[1] <= b[1] for a, b in pairwise(knots))
    if not rising or len(knots) < 2 or knots[0][1] != 0 or knots[-1][1] != 1:
        raise fields.wrong("the knots must rise from [.., 0] to [.., 1]")
    places = [x for x, _ in knots]

    def cdf(x: float) -> float:
        after = bisect_right(places, x)
        if after in (0, len(knots)):
            return 0.0 if after == 0 else 1.0
        (x0, f0), (x1, f1) = knots[after - 1], knots[after]
        return f0 + (f1 - f0) * (x - x0) / (x1 - x0)

    return cdf, places[0], places[-1]


FAMILIES: Mapping[str, Callable[[VectorFields], Family]] = {
    "uniform": uniform,
    "normal": normal,
    "truncated-normal": truncated_normal,
    "triangular": triangular,
    "power": power,
    "piecewise-linear": piecewise_linear,
}
"""The closed table of distribution functions."""


Place = tuple[float, float]
Shape = Callable[[object, float], bool]
"""Whether a decoded JSON value lies in the set, give or take a tolerance."""


def read_shape(fields: VectorFields) -> Shape:
    """`{interval = {low, high}}`, `{disc = {center, radius}}` and so on; `{any = [...]}` is a union. Raises `UsageError`."""
    name = next(iter(fields.rest), "")
    if name == "any":
        shape = union([read_shape(part) for part in fields.tables("any")])
    elif name in SHAPES:
        inner = fields.table(name)
        shape = SHAPES[name](inner)
        inner.done()
    else:
        raise fields.wrong(f"there is no shape {name!r}: there are any, {', '.join(SHAPES)}")
    fields.done()
    return shape


def union(parts: Sequence[Shape]) -> Shape:
    """Return the union of the parts."""
    return lambda value, tolerance: any(part(value, tolerance) for part in parts)


def point_of_pair(value: object) -> Place | None:
    """A pair of finite numbers as a point."""
    if isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 2 and all(is_json_number(v) and math.isfinite(v) for v in value):
        return float(value[0]), float(value[1])
    return None


def of_points(inside: Callable[[Place, float], bool]) -> Shape:
    """A set of points from its predicate."""

    def shape(value: object, tolerance: float) -> bool:
        place = point_of_pair(value)
        return place is not None and inside(place, tolerance)

    return shape


def interval_set(fields: VectorFields) -> Shape:
    """The numbers from low to high."""
    low, high = fields.number("low"), fields.number("high")
    return lambda value, tolerance: is_json_number(value) and low - tolerance <= value <= high + tolerance


def disc(fields: VectorFields) -> Shape:
    """The points at most radius from center; at least `inner` from it, if that is given."""
    center, radius, inner = fields.point("center"), fields.number("radius"), fields.number("inner", 0.0)
    return of_points(lambda p, tolerance: inner - tolerance <= math.dist(p, center) <= radius + tolerance)


def sector(fields: VectorFields) -> Shape:
    """The points of a disc that lie within angle / 2 of the heading (radians, anticlockwise from North)."""
    center, radius, heading, angle = fields.point("center"), fields.number("radius"), fields.number("heading"), fields.number("angle")

    def inside(p: Place, tolerance: float) -> bool:
        x, y = p[0] - center[0], p[1] - center[1]
        distance = math.hypot(x, y)
        turn = math.remainder(math.atan2(-x, y) - heading, math.tau)
        return distance <= radius + tolerance and (distance <= tolerance or abs(turn) <= angle / 2 + tolerance)

    return of_points(inside)


def rectangle(fields: VectorFields) -> Shape:
    """The points at most width / 2 across the heading and length / 2 along it from center."""
    center, heading, width, length = fields.point("center"), fields.number("heading", 0.0), fields.number("width"), fields.number("length")

    def inside(p: Place, tolerance: float) -> bool:
        x, y = p[0] - center[0], p[1] - center[1]
        across, along = x * math.cos(heading) + y * math.sin(heading), y * math.cos(heading) - x * math.sin(heading)
        return abs(across) <= width / 2 + tolerance and abs(along) <= length / 2 + tolerance

    return of_points(inside)


def polygon(fields: VectorFields) -> Shape:
    """The points inside or on the boundary of a simple polygon."""
    corners = fields.points("points")
    edges = list(pairwise((*corners, corners[0])))

    def inside(p: Place, tolerance: float) -> bool:
        if any(distance_to_segment(p, a, b) <= tolerance for a, b in edges):
            return True
        crossings = sum((a[1] > p[1]) != (b[1] > p[1]) and p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in edges)
        return crossings % 2 == 1

    return of_points(inside)


def polyline(fields: VectorFields) -> Shape:
    """The points on a chain of segments."""
    segments = list(pairwise(fields.points("points")))
    return of_points(lambda p, tolerance: any(distance_to_segment(p, a, b) <= tolerance for a, b in segments))


def points(fields: VectorFields) -> Shape:
    """Return the set of some single points."""
    listed = fields.points("points")
    return of_points(lambda p, tolerance: any(math.dist(p, q) <= tolerance for q in listed))


def distance_to_segment(p: Place, a: Place, b: Place) -> float:
    """The distance of a point from a segment."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    share = 0.0 if square == 0 else min(max(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0.0), 1.0)
    return math.dist(p, (a[0] + share * dx, a[1] + share * dy))


SHAPES: Mapping[str, Callable[[VectorFields], Shape]] = {
    "interval": interval_set,
    "disc": disc,
    "sector": sector,
    "rectangle": rectangle,
    "polygon": polygon,
    "polyline": polyline,
    "points": points,
}
"""The closed table of shapes."""


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
            exact = exact_distribution(implementation, task) if self.is_exact else None
            if exact is None:
                self.check_samples(read_at_path(draw(implementation, task, self.samples), self.of))
            else:
                self.check_enumeration(exact)
        except Disagreement as disagreement:
            return disagreement_verdict(disagreement)
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
        numbers = self.numbers(read_at_path([scene for _, scene in exact.outcomes], self.of))
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


def exact_distribution(implementation: Implementation, task: Task) -> Enumerated | None:
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
            values = [finite_number(value, self.of) for value in read_at_path(draw(implementation, task, self.samples), self.of)]
            told_apart(contradiction(values, self.law), contradiction(values, self.rival), f"{self.of}")
        except Disagreement as disagreement:
            return disagreement_verdict(disagreement)
        return PASSED


def finite_number(value: object, of: Path) -> float:
    """A finite number. Raises `Disagreement` for anything else."""
    if not is_json_number(value) or not math.isfinite(value):
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
    """The set in which a quantity always lies, and sets that it must reach in `samples` samples."""

    of: Path
    within: Shape
    reaches: tuple[Shape, ...]
    tolerance: float
    samples: int

    def match(self, implementation: Implementation, task: Task) -> VectorVerdict:
        """Every sample lies within; each set is reached by one."""
        try:
            values = read_at_path(draw(implementation, task, self.samples), self.of)
            outside = next((value for value in values if not self.within(value, self.tolerance)), None)
            if outside is not None:
                raise Disagreement(f"{self.of} is {outside!r}, which lies outside its support")
            for index, shape in enumerate(self.reaches):
                if not any(shape(value, 0.0) for value in values):
                    raise Disagreement(f"{self.of} reaches[{index}] in none of {self.samples} scenes")
        except Disagreement as disagreement:
            return disagreement_verdict(disagreement)
        return PASSED


def read_support(fields: VectorFields) -> QuantitySupport:
    """The table `support` of a vector. Raises `UsageError`."""
    reaches = tuple(read_shape(table) for table in fields.tables("reaches"))
    found = QuantitySupport(read_path(fields), read_shape(fields.table("within")), reaches, fields.number("tolerance"), fields.count("samples"))
    fields.done()
    return found

