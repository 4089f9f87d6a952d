"""Reading `condition-truth=any` by columns: the same scenes as the interpreter's."""

from __future__ import annotations

import pytest
import scenic_ref

PROGRAMS = {
    "few values": "x = Uniform(0, 1, 3)\nego = Object at (x, 0)\nrequire x",
    "a number": "x = Range(-1, 1)\nego = Object at (x, 0)\nrequire max(x, 0)",
    "texts": "x = Uniform('', 'a')\nego = Object at (Range(0, 1), 0), with x x\nrequire x",
    "nothing or an object": "p = Object at (5, 5)\nx = Uniform(None, p)\nego = Object at (Range(0, 1), 0)\nrequire x\nparam b = x is p",
    "lists": "x = Uniform([], [Range(0, 1)])\nego = Object at (Range(0, 1), 0), with x x\nrequire x",
    "a soft requirement": "x = Uniform(0, 2)\nego = Object at (Range(0, 1), 0), with x x\nrequire[0.5] x",
    "at the end": "x = Range(-1, 1)\nego = Object at (0, 0)\nmutate\nrequire max(0, ego.position.x + x)",
}


@pytest.mark.parametrize("time", ["statement", "end"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_the_batch_backend_takes_any_truth_as_the_interpreter_does(name: str, time: str) -> None:
    scenario = scenic_ref.loads(PROGRAMS[name], readings={"condition-truth": "any", "require-time": time})
    plain, batch = (list(scenario.sample_many(40, seed=1, backend=backend)) for backend in ("interpreter", "batch"))
    assert [s.to_json() for s in plain] == [s.to_json() for s in batch]
    assert max(s.attempts for s in plain) > 1
