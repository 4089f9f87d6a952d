"""What a program records is part of the simulation, and of its file."""

from __future__ import annotations

import json

import pytest
from scenic_ref.api import loads
from scenic_ref.data.simulation import to_line
from scenic_ref.semantics.store.errors import RunError

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


@pytest.mark.parametrize("backend", ["interpreter", "compiled"])
def test_a_simulation_holds_values_as_they_were(backend: str):
    text = """\
from collections import deque
L, Q, D = [1], deque([1]), {'a': ([1],)}
behavior B():
    while True:
        take (L,)
        L.append(2)
        Q.append(2)
        D['a'][0].append(2)
ego = Object with tags L, with behavior B
param D = D
record L as L
record list(Q) as Q
record D as D
record initial (L, Q) as begin
"""
    written = json.loads(to_line(loads(text, dialect="scenic-2.1").simulate("still", 3, backend=backend).simulation, 1))
    grown = [[1], [1], [1, 2], [1, 2, 2]]  # a behavior goes on where the next time step begins, after the values were recorded
    assert written["records"]["L"] == [[k, kept] for k, kept in enumerate(grown)]
    assert written["records"]["Q"] == written["records"]["L"]
    assert written["records"]["D"] == [[k, {"a": [kept]}] for k, kept in enumerate(grown)]
    assert written["records"]["begin"] == [[0, [[1], {"repr": "deque([1])"}]]]
    assert [step["actions"]["0"] for step in written["steps"][:3]] == [[[1]], [[1, 2]], [[1, 2, 2]]]
    assert (written["scene"]["objects"][0]["properties"]["tags"], written["scene"]["params"]["D"]) == ([1], {"a": [[1]]})


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("L = [1]\nL.append(L)", "a recorded value contains itself"),
        ("L = [1]\nfor i in range(60): L = [L, L]", "a recorded value has more than 2,000,000"),
    ],
)
def test_a_value_that_cannot_be_written_is_not_recorded(value: str, told: str):
    with pytest.raises(RunError, match=told) as found:
        loads(f"{value}\nego = Object\nrecord L\n", dialect="scenic-2.1").simulate("still", 1)
    assert found.value.span.line == value.count("\n") + 3


def test_keys_that_a_class_of_the_program_compares_are_not_asked_while_values_are_written():
    text = """\
class K(object):
    asked = 0
    def __hash__(self):
        K.asked += 1
        return 1
    def __eq__(self, other):
        K.asked += 1
        return 1 < self
D, S = {K(): [1]}, {K()}
ego = Object with value (D, S)
n = K.asked
record K.asked - n as asked
record (D, S) as both
"""
    written = json.loads(to_line(loads(text, dialect="scenic-2.1").simulate("still", 2).simulation, 1))
    assert written["records"]["asked"] == [[0, 0], [1, 0], [2, 0]]


def test_containers_of_classes_of_the_program_are_copied_without_their_methods():
    text = """\
class D(dict):
    def update(self, *rest):
        return 6
    def items(self):
        return 7
behavior B():
    while True:
        wait
        d['a'] = d['a'] + 1
d = D()
d['a'] = 1
d.note = 2
ego = Object with behavior B
record d as d
record d.note as note
"""
    written = json.loads(to_line(loads(text, dialect="scenic-2.1").simulate("still", 2).simulation, 1))
    assert written["records"] == {"d": [[0, {"a": 1}], [1, {"a": 1}], [2, {"a": 2}]], "note": [[0, 2], [1, 2], [2, 2]]}
