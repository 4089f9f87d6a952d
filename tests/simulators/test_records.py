"""What a program records is part of the simulation, and of its file."""

from __future__ import annotations

import json

from scenic_ref.api import loads
from scenic_ref.data.simulation import to_line

PROGRAM = """
ego = Object at 1 @ 2
record simulation().currentTime as time
record initial ego.position
record final 2 * simulation().currentTime as 'the end'
"""


def test_recorded_values_have_their_time_steps():
    run = loads(PROGRAM, dialect="scenic-2.1", profile="scenic-2.1").simulate(steps=2, seed=1).simulation
    assert run.records["time"] == ((0, 0), (1, 1), (2, 2))
    assert [step for step, _ in run.records["line 4"]] == [0]
    assert run.records["the end"] == ((2, 4),)
    written = json.loads(to_line(run, 1))["records"]
    assert written == {"time": [[0, 0], [1, 1], [2, 2]], "line 4": [[0, [1.0, 2.0]]], "the end": [[2, 4]]}


def test_without_a_record_statement_there_is_none_in_the_file():
    run = loads("ego = Object at 1 @ 2\n").simulate(steps=2, seed=1).simulation
    assert "records" not in json.loads(to_line(run, 1))


def test_of_two_statements_of_one_name_the_last_counts():
    run = loads("ego = Object at 1 @ 2\nrecord ego.x as a\nrecord ego.y as a\n", dialect="scenic-2.1").simulate(steps=2, seed=1).simulation
    assert run.records["a"] == ((0, 2), (1, 2), (2, 2))
