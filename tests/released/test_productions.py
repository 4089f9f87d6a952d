"""The table of productions: every program of `productions.toml` is read, or refused, as the table says."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.semantics.readings import READINGS
from scenic_ref.semantics.store.errors import ProgramError

PRODUCTIONS = tomllib.loads(Path(__file__).with_name("productions.toml").read_text(encoding="utf-8"))["production"]
CASES = [(entry, dialect) for entry in PRODUCTIONS for dialect in entry["dialects"]]


def in_dialect(program: str, dialect: str) -> str:
    """The program of the table, which has `new`, in a dialect."""
    return program if dialect == "scenic-3" else re.sub(r"\bnew ", "", program)


@pytest.mark.parametrize("entry, dialect", CASES, ids=[f"{dialect}: {entry['form']}" for entry, dialect in CASES])
def test_the_program_of_a_production_is_read_or_refused_as_the_table_says(entry: dict, dialect: str) -> None:
    program = in_dialect(entry["program"], dialect)
    if entry["status"] == "refused":
        with pytest.raises(ProgramError) as refused:
            scenic_ref.loads(program, dialect=dialect, profile=dialect).sample(seed=1)
        assert entry["says"] in str(refused.value)
        return
    scenario = scenic_ref.loads(program, dialect=dialect, profile=dialect)
    if entry.get("simulated"):
        scenario.simulate(seed=1, steps=4)
    else:
        scenario.sample(seed=1)


def test_no_production_is_undecided() -> None:
    for entry in PRODUCTIONS:
        assert entry["status"] in ("read", "reading", "refused")
        assert all(name in READINGS for name in entry.get("readings", ()))
        assert bool(entry.get("readings")) is (entry["status"] == "reading")
        assert bool(entry.get("why")) is bool(entry.get("says")) is (entry["status"] == "refused")
