"""Settings of the generator: what generated programs may hold, and how large they get, in one record."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from ...semantics.store.errors import UsageError

LEAST = {"max_objects": 1, "max_classes": 0, "max_statements": 0, "max_depth": 0, "max_loop": 1, "max_outcomes": 1}


@dataclass(frozen=True, slots=True)
class ProgramSettings:
    """The knobs. A knob that is a float is the probability with which a program may use the feature at all; 0 switches it off.

    `finite` leaves out every draw with infinitely many values, so that `Scenario.enumerate` gives the exact distribution, in at
    most `max_outcomes` runs.
    """

    # Sizes
    max_objects: int = 4
    """Objects of the scene that a program creates, ego among them (one more where a loop or a function creates the last)."""
    max_classes: int = 2
    """Classes with default values, which may be subclasses of each other."""
    max_statements: int = 16
    """Statements at the top level, besides the creation of ego and the closing `param`."""
    max_depth: int = 3
    """How deep expressions nest."""
    max_loop: int = 3
    """Turns of a loop, elements of a list."""
    area: float = 20.0
    """Objects stand within this many metres of the origin along each axis, by and large."""

    # Finite programs
    finite: bool = False
    """Whether all draws have finitely many values."""
    max_outcomes: int = 64
    """In finite programs, the largest product of the numbers of values of all draws."""

    # Features
    classes: float = 0.6
    """`class` with interdependent default values, subclasses."""
    functions: float = 0.5
    """`def` with random defaults, `*args`, `**kwargs`, closures; `lambda`."""
    loops: float = 0.5
    """`for`, `while`, `break`, `continue`, comprehensions."""
    branches: float = 0.4
    """`if`, `elif`, conditional expressions, on conditions that are not random; `try`."""
    containers: float = 0.4
    """Lists, dictionaries, slices, f-strings."""
    nested: float = 0.6
    """Distributions of distributions, and unnormalised weights that are computed."""
    resample: float = 0.4
    """`resample(x)`."""
    points: float = 0.6
    """`OrientedPoint`s and operators that give them: derived points."""
    fields: float = 0.5
    """`VectorField` and everything that takes one."""
    regions: float = 0.4
    """Regions: containment, distance and, unless `finite`, random points of them."""
    visibility: float = 0.5
    """`can see`, `visible`, view angles and distances."""
    requirements: float = 0.7
    """`require`."""
    soft: float = 0.5
    """`require[p]`."""
    mutate: float = 0.3
    """`mutate`; with standard deviations of 0 if `finite`."""
    choice_of_objects: float = 0.3
    """`Uniform(ego, other)`: an object that is itself random."""
    workspace: float = 0.2
    """`workspace`, and objects with `regionContainedIn`."""
    chained_draws: float = 0.5
    """Parameters of distributions that are random values."""
    waiting: float = 0.4
    """Values that wait for the position of an object, in variables and lists (needs `fields`)."""
    random_length: float = 0.3
    """Lists of random length, what `filter` leaves of a list, random pairs that are unpacked."""
    released: float = 0.3
    """Dialect `scenic-2.1`: operators, members and distributions of the released implementations."""

    def __post_init__(self) -> None:
        """Raises `UsageError` for a size below its least value and for a probability outside [0, 1]."""
        for name, least in LEAST.items():
            if getattr(self, name) < least:
                raise UsageError(f"{name} is at least {least}, not {getattr(self, name)}")
        if not self.area > 0:
            raise UsageError(f"area is above 0, not {self.area}")
        for name, probability in self.features():
            if not 0 <= probability <= 1:
                raise UsageError(f"{name} is a probability, not {probability}")

    def features(self) -> tuple[tuple[str, float], ...]:
        """The features with their probabilities, in the order of the fields."""
        return tuple((field.name, value) for field in fields(self) if type(value := getattr(self, field.name)) is float and field.name != "area")

    def as_finite(self) -> ProgramSettings:
        """Return these settings for finite programs."""
        return replace(self, finite=True)
