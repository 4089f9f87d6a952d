"""The dynamic listings of the paper and the programs of `examples/driving`: all have a graph, and by it the scenes of the interpreter."""

from __future__ import annotations

from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.conformance.listings import read_manifest

EXAMPLES = Path(__file__).parents[2] / "examples"
LISTINGS = {EXAMPLES / "paper" / "dynamic" / program.file: program.readings for program in read_manifest(EXAMPLES / "paper" / "dynamic")[1]}
PROGRAMS = {**LISTINGS, **{path: {} for path in sorted((EXAMPLES / "driving").glob("*.scenic"))}}


def test_there_are_as_many_as_the_folders_hold():
    assert set(LISTINGS) == set((EXAMPLES / "paper" / "dynamic").glob("*.scenic"))
    assert len(PROGRAMS) >= 52


@pytest.mark.sampled(8)
@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_each_has_a_graph_and_the_scenes_of_the_interpreter(path):
    scenario = scenic_ref.load(path, readings=PROGRAMS[path])
    assert scenario.not_lifted is None
    lines = {backend: [scene.to_line() for scene in scenario.sample_many(10, seed=7, backend=backend)] for backend in ("batch", "interpreter")}
    assert lines["batch"] == lines["interpreter"]
