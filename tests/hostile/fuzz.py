"""Random and mutated programs: each must end in success or in an error of the program, never in one of ours.

`python tests/hostile/fuzz.py 20000 [SEED [PROCESSES]]` runs that many, each measured; the suite runs 2,000. Program K of a seed is always the same,
so that a failure can be repeated: `python tests/hostile/fuzz.py 1 SEED:K` shows it and runs it alone.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import re
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import FrameType
from typing import NamedTuple

import scenic_ref
from scenic_ref.conformance import load_vectors
from scenic_ref.semantics.store import errors

ROOT = Path(__file__).parent.parent.parent
WORDS = ["ego", "Object", "Point", "OrientedPoint", "Car", "at", "on", "in", "of", "by", "from", "to", "for", "with", "facing", "toward", "visible", "left", "right", "front", "back", "ahead", "behind", "beyond", "following", "follow", "deg", "relative", "offset", "along", "can", "see", "require", "mutate", "param", "model", "import", "def", "return", "if", "else", "elif", "while", "class", "self", "lambda", "not", "and", "or", "is", "None", "True", "1", "0", "-1", "2.5", "1e308", "1e-320", "float('nan')", "float('inf')", "'x'", "[]", "()", "{}", "(1,2)", "(0,0)", "[1,2]", "Range(0,1)", "Range(1,0)", "Uniform(1,2)", "Uniform()", "Normal(0,1)", "Normal(0,-1)", "TruncatedNormal(0,1,9,10)", "Discrete({1:2})", "Discrete({})", "resample", "everywhere", "nowhere", "CircularRegion((0,0),3)", "x", "y", "f(x)", "=", "==", "<", ">", "+", "-", "*", "/", "//", "%", "**", "@", ",", ":", ".", "(", ")", "[", "]", "{", "}", ";", "#", "...", "*", "**", "take", "wait", "do", "terminate", "try", "except", "finally", "raise", "assert", "del", "global", "nonlocal", "pass", "break", "continue", "for", "x", "in", "range(3)"]
LINES = (
    "x = Range(0, 1)", "y = Uniform(1, 2, 'a', (1, 2), ego)", "ego = Object", "ego = Object at (0, 0), facing x", "Object left of ego by 2",
    "Object on CircularRegion((3, 3), 2)", "Object visible, with requireVisible False", "require x < 0.5", "require[0.3] x < 0.5", "mutate", "mutate ego by 2",
    "param a = x, b = [x, y]", "def f(a, b=x, *c, **d): return (a, b, c, d)", "z = f(1, 2, 3, k=4)", "class A:\n    p: self.q\n    q: Range(0, 1)",
    "o = A with q 3", "class B(object):\n    def __init__(self, v):\n        self.v = v\n    def __add__(self, o):\n        return self.v + o", "w = B(x) + 1",
    "for i in range(3):\n    Object at (i * 3, 9), with requireVisible False", "if z:\n    pass", "v = VectorField('v', lambda p: p.x)", "Object at (5, 5), facing 3 deg relative to v",
    "k = [i * x for i in range(4) if i]", "s = f'{x:.3f} {y!r}'", "try:\n    1 / 0\nexcept ZeroDivisionError as e:\n    t = str(e)", "p = Point at (1, x)",
    "q = follow v for 3", "r = CircularRegion((0, 0), x) ", "u = ego in r", "n = sorted([3, 1, x], key=lambda t: -t)", "g = (lambda t: t + x)(1)", "del x", "assert y",
    "l = list(map(lambda t: t + x, [1, 2]))", "d = distance to p", "h = relative heading of 30 deg", "Object beyond ego by (0, 3)", "import math", "from math import *",
    "import os", "c = math.sin(x)", "behavior Bh():\n    take 1", "monitor M():\n    wait", "scenario S():\n    setup:\n        ego = Object", "x += 1", "k[0] = x", "ego.width = x",
    "a1, (b1, *c1) = 1, (2, 3, 4)", "while x:\n    break", "m = max(k)", "x.y.z", "x[0]", "f()", "ego()", "Object()", "-ego", "ego + 1", "not ego", "x < ego", "ego in ego", "[][x]",
)


@cache
def corpus() -> list[str]:
    """Programs to mutate: the examples, and those of the conformance vectors in the paper's dialect."""
    texts = [p.read_text() for p in sorted((ROOT / "examples").rglob("*.scenic"))]
    return texts + [vector.texts["paper"] for vector in load_vectors() if "paper" in vector.texts]


def mutated(source: random.Random, text: str) -> str:
    """A program with a few tokens or lines deleted, doubled, swapped, replaced or inserted."""
    pieces = re.findall(r"\w+|\s+|[^\w\s]", text)
    for _ in range(source.choice((1, 1, 1, 2, 3, 6))):
        if not pieces:
            break
        place = source.randrange(len(pieces))
        kind = source.randrange(6)
        if kind == 0:
            del pieces[place]
        elif kind == 1:
            pieces.insert(place, pieces[place])
        elif kind == 2:
            other = source.randrange(len(pieces))
            pieces[place], pieces[other] = pieces[other], pieces[place]
        elif kind == 3:
            pieces[place] = source.choice(WORDS)
        elif kind == 4:
            pieces.insert(place, f" {source.choice(WORDS)} ")
        else:
            pieces.insert(place, f"\n{source.choice(LINES)}\n")
    return "".join(pieces)


def random_program(source: random.Random) -> str:
    """Lines that fit together more or less, or words that do not."""
    if source.random() < 0.2:
        return " ".join(source.choice(WORDS) for _ in range(source.randrange(1, 25)))
    lines = ["x = Range(0, 1)", "ego = Object at (0, 0)", "z = k = [1, 2]", "f = lambda a: a"] if source.random() < 0.9 else []
    lines += [source.choice(LINES) for _ in range(source.randrange(1, 6))]
    text = "\n".join(lines) + "\n"
    return mutated(source, text) if source.random() < 0.3 else text


def attack(text: str) -> str:
    """What becomes of a program: "scene", or the class of its error. Any other exception is a defect of ours."""
    try:
        scenic_ref.loads(text, fuel=20_000).sample(0, max_attempts=3).to_line()
    except (errors.ProgramError, errors.Gap, errors.AttemptsExhausted, errors.UsageError) as error:
        str(error)
        return type(error).__name__
    return "scene"


EXTREME = (
    "0", "-0.0", "1", "-1", "1e-320", "1e-9", "1e9", "1e154", "1e308", "-1e308", "1e309", "10 ** 400", "float('nan')", "float('inf')", "2 ** 63", "0.1 + 0.2", "180 deg", "1e20 deg",
)
"""Numbers at the ends of what there is."""
SHAPES = (
    "CircularRegion(({0}, {1}), {2})", "SectorRegion(({0}, {1}), {2}, {3}, {4})", "RectangularRegion(({0}, {1}), {2}, {3}, {4})",
    "PolygonalRegion([({0}, {1}), ({2}, {1}), ({2}, {3})])", "PolygonalRegion([({0}, {1}), ({2}, {3}), ({0}, {3}), ({2}, {1})])",
    "PolygonalRegion([({4} * i, {3} * (i % 7)) for i in range(2000)])", "PolylineRegion([({0}, {1}), ({2}, {3}), ({4}, {0})])",
    "PolylineRegion([(i * {0}, (i % 2) * {1}) for i in range(3000)])", "PointSetRegion('p', [({0}, {1}), ({2}, {3})])", "everywhere", "nowhere",
)
PLACES = (
    "ego = Object in R", "ego = Object on R, with width {0}, with length {1}", "ego = Object at ({0}, {1}), facing {2}", "ego = Object in visible R, with viewAngle {3}",
    "ego = Object at ({0}, {1}), with viewDistance {2}\nObject visible, with width {3}", "ego = Object at (0, 0)\nObject beyond ego by ({0}, {1})\nrequire ego in R",
    "ego = Object at (0, 0)\nx = (distance to ({0}, {1})) + (angle to ({2}, {3}))\nparam x = x", "ego = Object in R, with regionContainedIn S",
    "ego = Object at (0, 0)\nObject following VectorField('f', lambda v: {0}) from ({1}, {2}) for {3}", "ego = Object in R.intersect(S)", "ego = Object in R.difference(S)",
    "workspace = Workspace(R)\nego = Object in workspace", "ego = Object at (Range({0}, {1}), Normal({2}, {3}))", "ego = Object at TruncatedNormal({0}, {1}, {2}, {3}) @ 1",
    "ego = Object at (0, 0), facing toward ({0}, {1})\nmutate ego by {2}", "ego = Object in R\nfor i in range(200): Object in S, with allowCollisions True, with requireVisible False",
)
LETTERS = "\x00\x1b\t\r\u2028\ufeff\ud7ff'\"\\({[:#%@=,;0e_\u0661\u5b57"


def of_limits(source: random.Random) -> str:
    """A map of limits: regions and objects with numbers at the ends of what there is."""
    numbers = lambda: [source.choice(EXTREME) for _ in range(5)]  # noqa: E731 (drawn anew for each)
    shapes = [source.choice(SHAPES).format(*numbers()) for _ in range(2)]
    return f"R = {shapes[0]}\nS = {shapes[1]}\n{source.choice(PLACES).format(*numbers())}\n"


def in_bytes(source: random.Random, text: str) -> str:
    """A program with characters deleted, doubled, changed or put in, or cut off, or joined with another."""
    letters = list(text)
    for _ in range(source.choice((1, 1, 2, 4, 16))):
        place = source.randrange(len(letters) + 1)
        kind = source.randrange(5)
        if kind == 0:
            del letters[place : place + source.choice((1, 1, 5))]
        elif kind == 1:
            letters[place:place] = letters[place : place + source.randrange(1, 40)]
        elif kind == 2:
            letters.insert(place, source.choice(LETTERS))
        elif kind == 3 and place < len(letters):
            letters[place] = chr(max(1, min(0xD7FF, ord(letters[place]) ^ (1 << source.randrange(8)))))
        else:
            other = source.choice(corpus())
            letters[place:] = other[source.randrange(len(other) + 1) :]
    return "".join(letters)


def by_grammar(source: random.Random, text: str) -> str:
    """A program with lines, or what stands in brackets, exchanged for those of another one: mostly well-formed."""
    other = source.choice(corpus())
    pattern = source.choice((r"\([^()\n]*\)", r"(?m)^.*$", r"\b\d+(?:\.\d+)?\b", r"(?<=, )[^,\n]+", r"(?<== )[^\n]+"))
    mine, theirs = list(re.finditer(pattern, text)), re.findall(pattern, other)
    for found in sorted(source.sample(mine, min(len(mine), source.choice((1, 1, 2, 4)))), key=lambda m: -m.start()):
        text = text[: found.start()] + (source.choice(theirs) if theirs else "") + text[found.end() :]
    return text


def program(seed: int | str, number: int) -> str:
    """Program `number` of a seed."""
    source = random.Random(f"{seed}:{number}")
    kind = source.random()
    if kind < 0.01 or number < 0:
        return of_limits(source)
    if kind < 0.4:
        return random_program(source) if kind < 0.2 else mutated(source, source.choice(corpus()))
    return in_bytes(source, source.choice(corpus())) if kind < 0.65 else by_grammar(source, source.choice(corpus()))


MOST_SECONDS, MOST_MEMORY = 60, 2 << 30


class Ended(NamedTuple):
    """What became of a program: its end, the processor time it took, in seconds, and the most memory of the process so far, in bytes."""

    number: int
    end: str
    seconds: float
    memory: int


class TooLong(BaseException):
    """A program does not end; no handler of errors catches it."""


def too_long(number: int, frame: FrameType | None) -> None:
    raise TooLong(f"no end after {MOST_SECONDS} s of processor time, in {traceback.format_stack(frame, 3)}")


def attacked(job: tuple[int | str, int]) -> Ended:
    """One program run, of which a minute is the most (where the system has timers); an end that begins with "DEFECT" is ours."""
    seed, number = job
    begun = time.process_time()
    if timed := hasattr(signal, "setitimer"):
        signal.signal(signal.SIGPROF, too_long)
        signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS, 1)
    try:
        end = attack(program(seed, number))
    except BaseException as defect:
        end = f"DEFECT {type(defect).__name__}: {defect}"[:500]
    finally:
        if timed:
            signal.setitimer(signal.ITIMER_PROF, 0)
    return Ended(number, end, time.process_time() - begun, peak())


def peak() -> int:
    """The most memory that this process has had, in bytes; 0 where the system does not say."""
    try:
        import resource
    except ImportError:
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def limits_first(count: int, maps: int) -> Iterator[int]:
    """The numbers of a campaign: those below 0 are maps of limits."""
    yield from range(-maps, count)


def campaign(seed: int | str, count: int, maps: int, processes: int) -> list[Ended]:
    """What became of so many programs and maps of limits, run by so many processes."""
    jobs = [(seed, number) for number in limits_first(count, maps)]
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        return list(pool.imap_unordered(attacked, jobs, chunksize=20))


def attacks(seed: int | str, count: int, maps: int = 0) -> Counter[str]:
    """How `count` programs and `maps` maps of limits ended. Raises with the program's text when one ended in anything but an error of its own."""
    ends: Counter[str] = Counter()
    for number in limits_first(count, maps):
        ended = attacked((seed, number))
        assert not ended.end.startswith("DEFECT"), f"program {number} of seed {seed} ended in {ended.end}\n{program(seed, number)}"
        ends[ended.end] += 1
    return ends


def main(count: int, seed: str, processes: int) -> int:
    """Run a campaign, and tell; 1 if a program ended in a defect, took more than a minute, or more than 2 GiB."""
    if ":" in seed:
        name, _, number = seed.partition(":")
        print(program(name, int(number)))
        print(attacked((name, int(number))))
        return 0
    found = campaign(seed, count, max(1, count // 100), processes)
    for end, times in Counter(e.end for e in found).most_common():
        print(f"{times:6} {end}")
    slowest = sorted(found, key=lambda e: -e.seconds)[:5]
    print(f"{len(found)} programs, {sum(e.seconds for e in found):.0f} s of processor time; at most {max(e.memory for e in found) >> 20} MiB in a process")
    print("slowest:", ", ".join(f"{seed}:{e.number} {e.seconds:.1f} s ({e.end[:40]})" for e in slowest))
    wrong = [e for e in found if e.end.startswith("DEFECT") or e.seconds > MOST_SECONDS or e.memory > MOST_MEMORY]
    for ended in wrong[:20]:
        print(f"--- {seed}:{ended.number} {ended.end}, {ended.seconds:.1f} s\n{program(seed, ended.number)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    words = [*sys.argv[1:], *("2000", "0", str(os.cpu_count() or 1))[len(sys.argv) - 1 :]]
    sys.exit(main(int(words[0]), words[1], int(words[2])))
