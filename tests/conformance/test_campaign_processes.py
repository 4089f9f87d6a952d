"""What a campaign starts: the command that is judged, and processes that end with the campaign, however it ends."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from scenic_ref.conformance.implementations.environments import here

from .test_fuzzing import other


def test_links_in_a_command_are_not_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Python of a virtual environment is one, and another Python without it."""
    (tmp_path / "python").symlink_to(sys.executable)
    monkeypatch.chdir(tmp_path)
    assert [here("python"), here("-m")] == [str(tmp_path / "python"), "-m"]


def of_session(number: int) -> list[int]:
    """The processes of a session."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        with suppress(ProcessLookupError):
            if os.getsid(int(path.name)) == number:
                found.append(int(path.name))
    return found


@pytest.mark.slow
def test_a_campaign_that_is_killed_leaves_no_process(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "scenic_ref", "fuzz", "--impl", other(tmp_path), "--time", "1h", "-o", str(tmp_path / "campaign")]
    with subprocess.Popen(command, start_new_session=True, stderr=subprocess.DEVNULL) as begun:
        try:
            journal = tmp_path / "campaign" / "campaign.jsonl"
            while begun.poll() is None and not (journal.exists() and len(journal.read_text().splitlines()) > 2):
                time.sleep(0.1)
            assert len(of_session(begun.pid)) > 2  # those that examine are there
        finally:
            begun.kill()
    for _ in range(1200):  # however long it takes
        if not of_session(begun.pid):
            return
        time.sleep(0.1)
    raise AssertionError(of_session(begun.pid))
