"""A real editor: Neovim without a screen, by its own client of the protocol."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CARS = "# A car.\nclass Car(Object):\n    width: 2\n"
PROGRAM = 'from cars import *\nx = "😋"\nego = Car at 1 @ 2\nz = "😋é"; y = nosuch\n'


def lines_for_init() -> str:
    """What the documentation says to put into init.lua."""
    page = (Path(__file__).parents[2] / "docs" / "editors.md").read_text()
    (found,) = re.findall(r"^```lua\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    return found


@pytest.mark.slow
@pytest.mark.extra("lsp")
def test_neovim_gets_diagnostics_hover_completion_and_definitions(tmp_path: Path):
    nvim = shutil.which("nvim")
    if nvim is None:
        pytest.skip("this system has no nvim (Debian: apt-get install neovim)")
    (tmp_path / "cars.scenic").write_text(CARS)
    program = tmp_path / "main.scenic"
    program.write_text(PROGRAM)
    command = tmp_path / "bin" / "scenic-ref"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -m scenic_ref "$@"\n')
    command.chmod(0o755)
    (tmp_path / "init.lua").write_text(lines_for_init())
    path = f"{command.parent}{os.pathsep}{os.environ['PATH']}"
    own = {"XDG_STATE_HOME": str(tmp_path / "state"), "NVIM_LOG_FILE": str(tmp_path / "log")}
    variables = {**os.environ, **own, "PATH": path, "FILE": str(program)}
    script = Path(__file__).with_name("try.lua")
    command = [nvim, "--headless", "--clean", "-n", "-u", str(tmp_path / "init.lua"), "-c", f"luafile {script}", "-c", "cquit 1"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=variables, cwd=tmp_path)
    found = {name: json.loads(value) for name, _, value in (line.partition("\t") for line in ended.stdout.splitlines()) if value}
    assert ended.returncode == 0, ended.stdout + ended.stderr
    column = len('z = "😋é"; y = '.encode())
    message = "nosuch is not defined\nassign it first, or import it; a text stands in quotation marks"
    assert found["diagnostic"] == [3, column, column + len("nosuch"), message, 1]
    assert "**P-At**" in found["hover"]
    assert found["definition"][0]["range"]["start"] == {"line": 1, "character": 6}
    assert {"at", "facing toward", "with"} <= set(found["completion"])
    assert found["mended"] == 0
    assert found["jumped"] == ["cars.scenic", [2, 6]]
