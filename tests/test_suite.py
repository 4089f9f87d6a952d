"""What tests/conftest.py holds the suite to: a run that leaves a process behind, or skips a test for no extra, fails, with workers and without."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

LEAVES = "import subprocess\ndef test_one():\n    subprocess.Popen(['sleep', '1000'])\n"
SKIPS = "import pytest\ndef test_one():\n    pytest.skip('not today')\n"
ENDS = "import subprocess\ndef test_one():\n    subprocess.Popen(['sleep', '0.2'])\n"


@pytest.mark.slow
@pytest.mark.parametrize("workers", [(), ("-n", "2")], ids=["alone", "workers"])
@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        (LEAVES, 1, "FAILED a process is left: sleep 1000 (started by test_it.py::test_one (call))"),
        (SKIPS, 1, "was skipped, and not for an extra: not today"),
        (ENDS, 0, "1 passed"),
    ],
    ids=["leaves", "skips", "ends"],
)
def test_a_run_is_held_to_what_the_suite_promises(text: str, code: int, told: str, workers: tuple[str, ...], tmp_path: Path):
    rules = (Path(__file__).parent / "conftest.py").read_text()
    assert rules.count("ENDING = 60") == 1
    (tmp_path / "conftest.py").write_text(rules.replace("ENDING = 60", "ENDING = 2"))
    (tmp_path / "test_it.py").write_text(text)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *workers, "test_it.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment)
    assert (done.returncode, told in done.stdout) == (code, True), done.stdout + done.stderr


def test_shares_of_a_run_are_all_its_tests_once(tmp_path: Path):
    (tmp_path / "conftest.py").write_text((Path(__file__).parent / "conftest.py").read_text())
    (tmp_path / "test_it.py").write_text("import pytest\n@pytest.mark.parametrize('k', range(30))\ndef test_one(k):\n    pass\n")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--collect-only", "--share"]
    found: list[str] = []
    for number in range(3):
        done = subprocess.run([*command, f"{number}/3", "test_it.py"], cwd=tmp_path, capture_output=True, text=True, env=environment)
        of_share = [line for line in done.stdout.splitlines() if "::" in line]
        assert len(of_share) > 4, done.stdout + done.stderr
        found += of_share
    assert sorted(found) == sorted(f"test_it.py::test_one[{k}]" for k in range(30))
    wrong = subprocess.run([*command, "3/3", "test_it.py"], cwd=tmp_path, capture_output=True, text=True, env=environment)
    assert wrong.returncode == 4 and "invalid share value: '3/3'" in wrong.stderr
