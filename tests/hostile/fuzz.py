"""Random and mutated programs: each must end in success or in an error of the program, never in one of ours.

`python tests/hostile/fuzz.py 10000` runs that many; the suite runs a few hundred. The generator is seeded, so that a
failure can be repeated.
"""

from __future__ import annotations

import random
import re
import sys
from pathlib import Path

import scenic_ref
from scenic_ref.conformance import load_vectors
from scenic_ref.semantics import errors

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


def attacks(seed: int, count: int) -> dict[str, int]:
    """How `count` programs ended. Raises with the program's text when one ended in anything but an error of its own."""
    source = random.Random(seed)
    texts = corpus()
    ends: dict[str, int] = {}
    for number in range(count):
        text = mutated(source, source.choice(texts)) if source.random() < 0.6 else random_program(source)
        try:
            end = attack(text)
        except BaseException as defect:
            raise AssertionError(f"program {number} of seed {seed} ended in {type(defect).__name__}: {defect}\n{text}") from defect
        ends[end] = ends.get(end, 0) + 1
    return ends


if __name__ == "__main__":
    for name, times in sorted(attacks(int(sys.argv[2]) if len(sys.argv) > 2 else 0, int(sys.argv[1])).items(), key=lambda item: -item[1]):
        print(f"{times:6} {name}")
