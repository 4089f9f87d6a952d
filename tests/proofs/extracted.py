"""The machine of the proofs as a program of its own: Coq extracts it to OCaml, with which Debian's Coq comes."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from .coq import PROOFS, built

EXTRACTION = """From Coq Require Import List QArith Extraction ExtrOcamlBasic.
Import ListNotations.
From ScenicRef Require Import kernel.Distribution.
From ScenicRef Require Import kernel.Machine.
Definition told := {function}.
Extraction Language OCaml.
Extraction "machine.ml" told.
"""
TYPE = re.compile(r"^type (?:value|operator|comparison0|binary|attribute|specifier0|expr|statement) =\n((?:\| .*\n)+)", re.MULTILINE)
"""The types of what programs are made of, each with its constructors."""
CONSTRUCTOR = re.compile(r"\| (\w+)(?: of (.*))?")
PARENTHESES = re.compile(r"\([^()]*\)")
WORD = re.compile(r"\(Qmake \((-?\d+)\) (\d+)\)|(\d+)%nat|\b([A-Z]\w*)")
"""What OCaml writes otherwise than Coq: fractions, natural numbers, and constructors, which take all arguments at once."""
PREAMBLE = """open Machine
let rec nat n = if n = 0 then O else S (nat (n - 1))
let positive digits =
  let next p digit = if digit = '1' then XI p else XO p in
  Seq.fold_left next XH (String.to_seq (String.sub digits 1 (String.length digits - 1)))
let q sign above below =
  { qnum = (if above = "0" then Z0 else if sign < 0 then Zneg (positive above) else Zpos (positive above)); qden = positive below }
let rec digits = function XH -> "1" | XO p -> digits p ^ "0" | XI p -> digits p ^ "1"
let z = function Z0 -> {|"0"|} | Zpos p -> {|"|} ^ digits p ^ {|"|} | Zneg p -> {|"-|} ^ digits p ^ {|"|}
let list told l = "[" ^ String.concat "," (List.map told l) ^ "]"
let tell program = print_endline (list (list (list z)) (told program))
"""
"""Numbers of the machine from those of OCaml, and back, in binary digits."""
Told = list[list[list[int]]]
"""An answer of a function that gives lists of lists of integers."""


@cache
def extracted(function: str) -> TemporaryDirectory[str]:
    """The folder of the extracted function, compiled, which is deleted at the end."""
    built()
    folder = TemporaryDirectory()
    (Path(folder.name) / "Extracted.v").write_text(EXTRACTION.format(function=function))
    run(["coqc", "-Q", str(PROOFS), "ScenicRef", "Extracted.v"], folder.name)
    run(["ocamlc", "-w", "-a", "-c", "machine.mli", "machine.ml"], folder.name)
    return folder


def run(command: list[str], folder: str) -> str:
    """What a command prints, which has to succeed."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def answers(function: str, terms: Iterable[str]) -> list[Told]:
    """What the extracted function gives for each term, as `evaluated` of `coq.py` reads what Coq gives."""
    folder = extracted(function).name
    lines = [PREAMBLE, *constructors((Path(folder) / "machine.mli").read_text()), *(f"let () = tell ({WORD.sub(in_ocaml, term)})" for term in terms)]
    with TemporaryDirectory() as place:
        (Path(place) / "asked.ml").write_text("\n".join(lines) + "\n")
        printed = run(["ocaml", "-I", folder, str(Path(folder) / "machine.cmo"), "asked.ml"], place)
    return [[[[int(digits, 2) for digits in row] for row in rows] for rows in json.loads(line)] for line in printed.splitlines()]


def constructors(interface: str) -> Iterator[str]:
    """Functions that take the arguments of a constructor one after the other, as in Coq."""
    for block in TYPE.findall(interface):
        for name, types in CONSTRUCTOR.findall(block):
            names = [f"x{i}" for i in range(PARENTHESES.sub("", types).count("*") + 1)] if types else []
            made = f"{name} ({', '.join(names)})" if names else name
            yield f"let {of_constructor(name)} {' '.join(names)} = {made}"


def of_constructor(name: str) -> str:
    """The name of that function."""
    return f"make_{name}"


def in_ocaml(found: re.Match[str]) -> str:
    """A word of Coq in OCaml."""
    above, below, natural, name = found.groups()
    if above is not None:
        number = int(above)
        return f'(q ({-1 if number < 0 else 1}) "{abs(number):b}" "{int(below):b}")'
    return of_constructor(name) if natural is None else f"(nat {natural})"
