"""The programs of a campaign: aimed ones, those of the general generator with few features each, dynamic ones, and ones with a mistake."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...interpreter.runtime.random_streams import fold, mix
from ..programs import ProgramSettings, SeededChoices, random_program
from ..programs.dynamic import dynamic_program
from ..programs.ill_formed import ill_formed
from .aimed import aimed_program, in_turn

THEMES = {"aimed": 6, "static": 5, "dynamic": 2, "mistaken": 1}
"""How often each kind of program is invented, in each turn of so many together: what is rare does not stay away by chance."""
KINDS = [theme for theme, often in THEMES.items() for _ in range(often)]
FEATURE = 0.35
"""The probability that a program may use a feature of the general generator: with few at a time, one fault does not hide another."""


class Invented(NamedTuple):
    """A program: what kind it is, and its text."""

    theme: str
    text: str


def invented(seed: int, number: int) -> Invented:
    """Program `number` of a campaign's seed."""
    random = np.random.default_rng([fold(seed), mix(number), 16])
    kind = in_turn(seed, number, len(KINDS))
    match KINDS[kind]:
        case "aimed":
            return Invented("aimed", aimed_program(seed, number // len(KINDS) * THEMES["aimed"] + kind))
        case "static":
            return Invented("static", random_program(seed, number, knobs(random)).text)
        case "dynamic":
            return Invented("dynamic", dynamic_program(seed, number, int(random.integers(1, 3)), int(random.integers(0, 2))))
        case _:
            return Invented("mistaken", ill_formed(SeededChoices(seed, number)).text)


def knobs(random: np.random.Generator) -> ProgramSettings:
    """A small program with few features, half of the time a finite one."""
    settings = ProgramSettings(
        max_objects=int(random.integers(1, 4)), max_statements=int(random.integers(1, 9)), max_depth=int(random.integers(0, 3)),
        max_classes=int(random.integers(0, 2)), finite=bool(random.random() < 0.5),
    )  # fmt: skip
    return replace(settings, **{name: 0.9 if random.random() < FEATURE else 0.0 for name, _ in settings.features()})
