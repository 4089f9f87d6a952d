"""A generator of programs: well-formed, finite and ill-formed ones, for Hypothesis (`strategies`) or from a seed (`random_programs`)."""

from __future__ import annotations

from .choice_sources import Choices, SeededChoices
from .programs import generate, random_program, random_programs
from .settings import ProgramSettings

__all__ = ["Choices", "ProgramSettings", "SeededChoices", "generate", "random_program", "random_programs"]
