"""What Coq says: terms are evaluated in the theories of `proofs/`, which are built first."""

from __future__ import annotations

import fcntl
import re
import shutil
import subprocess
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

PROOFS = Path(__file__).resolve().parents[2] / "proofs"
TOKEN = re.compile(r"[\[\](){}]|;|,|#|-?\d+|[A-Za-z_][\w.']*|%\w+")


def is_there() -> bool:
    """Whether this system has what `make proofs` needs, and the OCaml that Debian's Coq comes with (`extracted.py`)."""
    if any(shutil.which(tool) is None for tool in ("coqc", "coq_makefile", "ocamlc", "ocaml")):
        return False
    return subprocess.run(["coqc", "--print-version"], capture_output=True, text=True).stdout.startswith("8.16.")


needs_coq = pytest.mark.skipif(not is_there(), reason="this system has no Coq 8.16, or not its OCaml (Debian: apt-get install coq)")
Term = Any
"""What `read` gives: an integer, a name, a list, or a tuple of such."""


@cache
def built() -> None:
    """The theories of `proofs/` are compiled, by one worker at a time."""
    with (PROOFS / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        made = subprocess.run(["make", "--silent", "proofs"], cwd=PROOFS.parent, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr


def evaluated(theories: Iterable[str], terms: Iterable[str], folder: Path) -> list[Term]:
    """The normal form of each term, where `theories` (such as `scenes.Resolution`) are imported: `read` by this module.

    `folder` is an empty one, for the file that Coq is given.
    """
    answers = printed(theories, (f"Eval vm_compute in ({term})." for term in terms), folder)
    return [read(answer.partition("= ")[2].rpartition("\n     : ")[0]) for answer in answers]


def printed(theories: Iterable[str], commands: Iterable[str], folder: Path) -> list[str]:
    """What Coq prints at each command, where the theories are imported."""
    built()
    between = "Check tt."
    lines = [
        "Set Printing Width 1000000.", "Set Printing Depth 1000000.", "From Coq Require Import List.", "Import ListNotations.",
        *(f"From ScenicRef Require Import {theory}." for theory in theories),
        *(f"{command}\n{between}" for command in commands),
    ]  # fmt: skip
    file = folder / "Asked.v"
    file.write_text("\n".join(lines) + "\n")
    answer = subprocess.run(["coqc", "-Q", str(PROOFS), "ScenicRef", str(file)], capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    return answer.stdout.split("tt\n     : unit\n")[:-1]


def read(text: str) -> Term:
    """A value as Coq prints it: numbers, lists, pairs, and applied constructors as tuples that begin with their names; `3 # 4` is ("#", 3, 4)."""
    tokens = [token for token in TOKEN.findall(text) if not token.startswith("%")]
    tokens.reverse()  # so that the next one is the last
    found = application(tokens)
    assert not tokens, text
    return found


def application(tokens: list[str]) -> Term:
    """A constructor with its arguments, a fraction, or one atom."""
    parts: list[Term] = []
    while tokens and tokens[-1] not in ("]", ")", ";", ",", "#"):
        parts.append(atom(tokens))
    found: Term = parts[0] if len(parts) == 1 else tuple(parts)
    if tokens and tokens[-1] == "#":
        tokens.pop()
        return ("#", found, atom(tokens))
    return found


def atom(tokens: list[str]) -> Term:
    """A number, a name, a list, or what stands between parentheses."""
    token = tokens.pop()
    if token in ("[", "("):
        items = list(separated(tokens, ";" if token == "[" else ","))
        tokens.pop()
        if token == "[":
            return items
        return items[0] if len(items) == 1 else tuple(items)
    return int(token) if token.lstrip("-").isdigit() else token


def separated(tokens: list[str], sign: str) -> Iterator[Term]:
    """Values with a sign between them, up to the closing bracket."""
    while tokens[-1] not in ("]", ")"):
        yield application(tokens)
        if tokens[-1] == sign:
            tokens.pop()
