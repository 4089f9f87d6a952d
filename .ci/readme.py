"""Runs the README's commands in a folder of their own, one after the other; one that needs a missing extra must say so, by name."""

import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
TOLD = re.compile(r"needs the package (\w+)\n.*scenic-ref\[\w+\]")


def commands() -> list[list[str]]:
    """The commands of scenic-ref in the README, without their comments."""
    lines = (ROOT / "README.md").read_text().splitlines()
    return [shlex.split(line[2:], comments=True)[1:] for line in lines if line.startswith("$ scenic-ref")]


def main() -> int:
    """How many failed."""
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(ROOT / "examples", Path(folder, "examples"))
        for command in commands():
            done = subprocess.run([sys.executable, "-m", "scenic_ref", *command], cwd=folder, capture_output=True, text=True, check=False)
            fine = done.returncode == 0 or (done.returncode == 2 and TOLD.search(done.stderr))
            failed += not fine
            how = "ok" if done.returncode == 0 else "needs an extra" if fine else f"FAILED ({done.returncode})"
            print(f"{how}: scenic-ref {' '.join(command)}", flush=True)
            if not fine:
                print(done.stderr, flush=True)
    return failed


sys.exit(main())
