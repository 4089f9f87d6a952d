"""Thirteen wrong machines: each is caught by vectors, and by `check` on scenes that it draws."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.testing import same_distribution

sys.path.insert(0, str(Path(__file__).parent))
faults = importlib.import_module("faults")
sys.path.pop(0)

SCENES = 1500


def run(machine: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(machine)}
    return subprocess.run([sys.executable, "-P", "-m", "scenic_ref", *arguments], capture_output=True, text=True, env=environment, cwd=machine)


@pytest.fixture(params=faults.FAULTS, ids=lambda fault: fault.name)
def fault(request):
    return request.param


@pytest.mark.slow
def test_vectors_and_check_catch_the_fault(fault, tmp_path):
    machine = faults.wrong_machine(fault, tmp_path)
    program = tmp_path / "program.scenic"
    program.write_text(fault.program)
    drawn = run(machine, "run", str(program), "-n", str(SCENES), "--seed", "77", "--backend", "interpreter", "-o", str(tmp_path / "scenes.jsonl"))
    assert drawn.returncode == 0, drawn.stderr
    assert same_distribution(tmp_path / "scenes.jsonl", scenic_ref.loads(fault.program)).kind == "different"

    names = [word for name in fault.vectors for word in ("--vector", name)]
    judged = run(machine, "conformance", *names, "--json", str(tmp_path / "results.json"))
    assert judged.returncode == 1, judged.stdout + judged.stderr
    results = json.loads((tmp_path / "results.json").read_text())["results"]
    assert {result["name"] for result in results if result["status"] == "failed"} == set(fault.vectors)


@pytest.mark.parametrize("fault", faults.FAULTS, ids=lambda fault: fault.name)
def test_what_a_fault_replaces_stands_once(fault):
    for file, old, _ in fault.edits:
        assert (faults.ROOT / file).read_text().count(old) == 1, (file, old)


@pytest.mark.parametrize("fault", faults.FAULTS, ids=lambda fault: fault.name)
def test_the_machine_without_the_fault_is_not_accused(fault):
    scenario = scenic_ref.loads(fault.program)
    assert same_distribution(list(scenario.sample_many(SCENES, seed=77)), scenario).kind == "inconclusive"
