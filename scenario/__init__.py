"""A scenario: a program with its readings, dialect, modules and parameters, ready to be sampled (DESIGN, section 7)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from ..inference.enumeration import DEFAULT_RUNS, Enumeration, enumerate_runs
from ..inference.rejection import DEFAULT_ATTEMPTS, Sampled, sample
from ..interpreter.checks import check
from ..interpreter.choosers import from_stream
from ..interpreter.modules import library_of, read_text, with_old_imports
from ..interpreter.parser import parse
from ..interpreter.running import DEFAULT_FUEL, rehearse
from ..interpreter.scenes import Scene
from ..semantics.config import Config, Settings
from ..semantics.errors import UsageError
from ..semantics.programs import initial, make_settings
from ..semantics.readings import select
from ..semantics.syntax import Program
from ..simulators.worlds import WORLDS
from .constants import constants_of


class Scenario:
    """A loaded program.

    `profile` and `readings` choose among the readings of the paper; `params` are global parameters that win over the
    program's own; `model` is the world model that replaces the program's (or is added, if it names none).
    """

    def __init__(
        self, program: Program, *, profile: str = "paper", readings: Mapping[str, str] | None = None, params: Mapping[str, object] | None = None,
        model: str | None = None, trust: bool = False, directory: Path | None = None, fuel: int = DEFAULT_FUEL,
    ) -> None:
        self.program = program
        self.readings = select(profile, readings)
        self.params = dict(params or {})
        self.model = model
        self.trust = trust
        self.directory = directory
        self.fuel = fuel
        check(program)


    @cached_property
    def settings(self) -> Settings:
        """What stays the same during the runs of this scenario."""
        library = library_of(
            self.program, worlds=WORLDS, model=self.model, trust=self.trust, directory=self.directory,
            dialect=self.program.dialect if self.program.dialect != "paper" else None,
        )
        if self.model is not None and isinstance(library.get(self.model), Exception):
            raise UsageError(f"the world model: {library[self.model]}", hint=getattr(library[self.model], "hint", ""))
        return make_settings(self.readings, library, self.params, self.model)  # type: ignore[arg-type]

    def start(self) -> Config:
        """The configuration that every run begins with."""
        return initial(with_old_imports(self.program, self.settings.library), self.settings)  # type: ignore[arg-type]

    @cached_property
    def rehearsed(self) -> bool:
        """True once the program was run through without a branch on a random value. Raises the program's error."""
        rehearse(self.start(), from_stream(0, 0, 0), fuel=self.fuel)
        return True

    @cached_property
    def constants(self) -> dict[str, object]:
        """The features of a scene that are the same whatever is drawn, by their place in the scene format. Raises `AttemptsExhausted`."""
        assert self.rehearsed
        return constants_of(self.start, fuel=self.fuel)

    def sample(self, seed: int = 0, index: int = 0, *, max_attempts: int = DEFAULT_ATTEMPTS) -> Scene:
        """Scene number `index` of `seed`."""
        return self.sampled(seed, index, max_attempts=max_attempts).scene

    def sampled(self, seed: int = 0, index: int = 0, *, max_attempts: int = DEFAULT_ATTEMPTS) -> Sampled:
        """The scene with the statistics of its attempts."""
        assert self.rehearsed
        return sample(self.start, seed, index, max_attempts=max_attempts, fuel=self.fuel)

    def enumerate(
        self, *, max_runs: int = DEFAULT_RUNS, discretize: int | None = None, on_run: Callable[[int, Fraction], None] | None = None
    ) -> Enumeration:
        """The exact distribution of the scenes; see `enumerate_runs`."""
        assert self.rehearsed
        return enumerate_runs(self.start, max_runs=max_runs, discretize=discretize, fuel=self.fuel, on_run=on_run)

    def sample_many(self, n: int, seed: int = 0, *, start: int = 0, max_attempts: int = DEFAULT_ATTEMPTS) -> Iterator[Scene]:
        """Scenes `start` to `start + n - 1` of `seed`, one after the other."""
        return (self.sample(seed, index, max_attempts=max_attempts) for index in range(start, start + n))


def loads(
    text: str, *, file: str = "<string>", dialect: str | None = None, profile: str = "paper", readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, directory: Path | None = None,
    fuel: int = DEFAULT_FUEL,
) -> Scenario:
    """The scenario of a program text. Raises `ParseError`, `CheckError`, `UsageError`."""
    program = parse(text, file, dialect)
    return Scenario(program, profile=profile, readings=readings, params=params, model=model, trust=trust, directory=directory, fuel=fuel)


def load(
    path: str | Path, *, dialect: str | None = None, profile: str = "paper", readings: Mapping[str, str] | None = None,
    params: Mapping[str, object] | None = None, model: str | None = None, trust: bool = False, fuel: int = DEFAULT_FUEL,
) -> Scenario:
    """The scenario of a program file; modules next to it can be imported."""
    where = Path(path)
    return loads(
        read_text(where), file=str(path), dialect=dialect, profile=profile, readings=readings, params=params, model=model, trust=trust,
        directory=where.parent, fuel=fuel,
    )
