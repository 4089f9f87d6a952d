"""Run every Scenic program of a folder as a new user would, and say which run, which are refused and why, and which are too slow.

    python tools/run_programs.py PROGRAMS --maps MAPS -o results.jsonl

Each distinct text is run once: `check`, `run -n 2` and, where it has behaviors, monitors or compose blocks, `simulate --steps 40`. The
dialect is the one that the first line names, else `scenic-3` for a program that makes objects by `new`, else `scenic-2.1`. A map that a program
asks for by `localPath` is looked up by its file name in the folder MAPS, and so is one that it leaves to the command line. The table that is
printed counts programs by class; the file has a line for each program with the command that failed and what was said.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

MOVES = re.compile(r"^\s*(?:behavior|monitor|compose\s*:|do\s|take\s)|\bwith\s+behavior\b", re.MULTILINE)
NEW = re.compile(r"\bnew\s+[A-Z]\w*|\brequire\s+monitor\b")
NAMED_MAP = re.compile(r"(?P<name>[\w.+-]+)\.(?:xodr|net\.xml)")
TOWN = re.compile(r"""(?:carla_map|lgsvl_map|Town|town|MAP|map_name)\s*=\s*['"](?P<name>[\w+-]+)['"]""")
CLASSES: tuple[tuple[str, str], ...] = (
    (r"needs --trust|there is no module \w+: the Python package", "it imports a Python module, which is refused without --trust"),
    (r"there is no module|there is no file|has no \w+ in this reference", "a module or file that was not published with it"),
    (r"three-dimensional|two coordinates", "three dimensions"),
    (r"needs its simulator|about a simulator|only \w+ has|blueprints", "what only a vendor's simulator has"),
    (
        r"there is no global parameter|several scenarios to begin with|argument|needs a value for",
        "a part of something larger, which gives it its parameters",
    ),
    (r"no other formulas|stands directly behind `require`", "temporal formulas beyond `always` and `eventually`"),
    (r"'NoneType' object is not subscriptable|KeyError: '(?:intersection|road|lane)\d", "a part of something larger, which gives it its parameters"),
    (r"is not part of the language|belongs to dialect", "statements that are outside the language, such as Python's `with`"),
    (r"no scene|no simulation", "no scene or simulation is found, on this map"),
    (r"values must not be empty", "what it looks for is not on this map"),
    (
        r"^syntax error|is not defined|is used before it is assigned|stands outside of|expects|has no attribute|has no property",
        "its own mistakes: each was read",
    ),
)
"""What the last error of a program says, and the class that it makes; the first that matches counts."""
ERRORS = re.compile(r"^(?:[\w ]*error|attempts exhausted): .*(?:\n(?!warning|note).*)*", re.MULTILINE)


class Outcome(NamedTuple):
    """What became of one program: its class, the command that ended it, what that said, and the seconds that all commands took."""

    file: str
    verdict: str
    why: str
    command: str
    said: str
    seconds: float


class Settings(NamedTuple):
    """What is the same for all programs."""

    command: tuple[str, ...]
    maps: Mapping[str, Path]
    fallback: Path | None
    seconds: float


def distinct_programs(folder: Path) -> Iterator[Path]:
    """Yield one file for each text among the `.scenic` files of a folder, in the order of their paths."""
    seen: set[str] = set()
    for path in sorted(folder.rglob("*.scenic")):
        if path.is_file():
            digest = hashlib.sha256(path.read_bytes()).hexdigest()
            if digest not in seen:
                seen.add(digest)
                yield path


def options_of(text: str, settings: Settings) -> list[str]:
    """Return the options that a user of a release would give: the dialect, and the map where one is at hand."""
    options = [] if "# dialect:" in text else ["--dialect", "scenic-3" if NEW.search(text) else "scenic-2.1"]
    wanted = [found["name"].lower() for pattern in (NAMED_MAP, TOWN) for found in pattern.finditer(text)]
    place = next((settings.maps[name] for name in wanted if name in settings.maps), None)
    if place is None and re.search(r"scenic\.(?:domains\.driving|simulators\.\w+(?:\.driving)?)[\w.]*model", text):
        place = settings.fallback
    return options if place is None else [*options, "--map", str(place)]


def run_program(file: Path, settings: Settings) -> Outcome:
    """Run one program by each command until one fails."""
    text = file.read_text("utf-8", errors="replace")
    options = options_of(text, settings)
    checks = [option for option in options if option != "--map"]
    if "--map" in options:
        checks = [*options[: options.index("--map")], "-p", f"map={options[-1]!r}"]
    commands = [["check", str(file), *checks], ["run", str(file), "-n", "2", "-o", os.devnull, *options]]
    if MOVES.search(text):
        commands.append(["simulate", str(file), "--steps", "40", "--simulator", "kinematic", "-o", os.devnull, *options])
    begun = time.perf_counter()
    for words in commands:
        try:
            done = subprocess.run(
                [*settings.command, *words], capture_output=True, text=True, errors="replace", timeout=settings.seconds, check=False, cwd=file.parent
            )
        except subprocess.TimeoutExpired:
            return Outcome(str(file), "too slow", f"over {settings.seconds:g} s", words[0], "", time.perf_counter() - begun)
        if done.returncode:
            why = "an internal error" if done.returncode in (4, -11, -6) else reason_of(done.stderr)
            return Outcome(str(file), "refused", why, words[0], done.stderr.strip()[-2000:], time.perf_counter() - begun)
    return Outcome(str(file), "runs", "", commands[-1][0], "", time.perf_counter() - begun)


def reason_of(said: str) -> str:
    """Return the class of a refusal, by its error; notes and warnings before it do not count."""
    error = ERRORS.search(said)
    text = said if error is None else error[0]
    return next((name for pattern, name in CLASSES if re.search(pattern, text, re.MULTILINE)), "another reason: read it")


def maps_in(folder: Path | None) -> dict[str, Path]:
    """Return the OpenDRIVE maps of a folder by their names in small letters, without the suffix."""
    return {} if folder is None else {path.stem.lower(): path.resolve() for path in sorted(folder.rglob("*.xodr"))}


def table_of(outcomes: list[Outcome]) -> list[str]:
    """Return the classes with their counts as lines of a Markdown table."""
    counts = Counter((one.verdict, one.why) for one in outcomes)
    lines = ["| what became of it | why | programs |", "| --- | --- | ---: |"]
    return lines + [f"| {verdict} | {why} | {count} |" for (verdict, why), count in counts.most_common()]


def main() -> int:
    """Run the programs; the exit status is 1 if one ended in an internal error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=Path, help="the folder with the programs")
    parser.add_argument("--maps", type=Path, help="a folder with OpenDRIVE maps")
    parser.add_argument("--fallback", type=Path, help="the map for programs that name one that is not there, or none")
    parser.add_argument("--seconds", type=float, default=60, help="the time for one command (default 60)")
    parser.add_argument("--jobs", type=int, default=1, help="programs at a time (default 1)")
    parser.add_argument("--only", type=Path, help="a file of results: only programs that did not run there")
    parser.add_argument("-o", type=Path, dest="output", default=Path("results.jsonl"), help="the file for the results, one line each")
    asked = parser.parse_args()
    fallback = None if asked.fallback is None else asked.fallback.resolve()
    settings = Settings((sys.executable, "-m", "scenic_ref"), maps_in(asked.maps), fallback, asked.seconds)
    files = list(distinct_programs(asked.programs))
    if asked.only is not None:
        failed = {found["file"] for found in map(json.loads, asked.only.read_text().splitlines()) if found["verdict"] != "runs"}
        files = [file for file in files if str(file.resolve()) in failed]
    outcomes: list[Outcome] = []
    with ThreadPoolExecutor(asked.jobs) as pool, asked.output.open("w", encoding="utf-8") as output:
        for outcome in pool.map(lambda file: run_program(file.resolve(), settings), files):
            outcomes.append(outcome)
            output.write(json.dumps(outcome._asdict(), ensure_ascii=False) + "\n")
            output.flush()
            if sys.stderr.isatty():
                print(f"\r{len(outcomes):,} of {len(files):,}", end="", file=sys.stderr, flush=True)
    print("\n".join(table_of(outcomes)))
    return int(any(one.why == "an internal error" for one in outcomes))


if __name__ == "__main__":
    sys.exit(main())
