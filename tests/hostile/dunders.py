"""Programs of hostile classes and extreme arguments: none may end its process, read memory, or end in an error of ours.

Each program has classes whose special methods lie, raise, and change what is just being looked at, and puts their instances through the
functions, methods and operators of the table (`semantics/machine/sandbox_table.py`). Programs run in processes that may die:

`python tests/hostile/dunders.py 100000 [SEED [PROCESSES]]` runs that many; `python tests/hostile/dunders.py 1 SEED:K` shows program K and runs it.
Holes in Python's own C code show best in a build with assertions (Debian: python3.11-dbg, with the environment's packages on PYTHONPATH).
"""

from __future__ import annotations

import faulthandler
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from functools import cache, lru_cache
from pathlib import Path
from types import FrameType
from typing import NamedTuple

from scenic_ref.api.scenario import Scenario
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.machine import sandbox_table
from scenic_ref.semantics.python.builtins import EXCEPTION_NAMES
from scenic_ref.semantics.store import budget, errors
from scenic_ref.semantics.syntax import Program

try:
    import resource
except ImportError:  # a system without limits on processes
    resource = None

BASES = (
    "object", "object", "object", "int", "float", "str", "tuple", "list", "dict", "set", "collections.deque", "collections.Counter",
    "collections.OrderedDict", "collections.defaultdict", "Exception", "KeyError", "UnicodeDecodeError", "OSError", "StopIteration",
)  # fmt: skip
ORDINARY = ("items", "keys", "values", "get", "copy", "_fields", "_field_defaults", "_asdict", "args", "isidentifier", "replace", "split", "value")
"""Names of ordinary methods of Python's types that a class below them may lie about."""
MISCHIEF = (
    "L.clear()", "D.clear()", "S.clear()", "O.clear()", "Q.clear()", "C.clear()", "del L[:]", "L.append(self)", "D[self] = 1", "L.pop()", "D.pop(0, 1)",
    "O.popitem()", "O.move_to_end(1)", "Q.append(1)", "Q.popleft()", "Q.rotate(1)", "C.update([1, 2])", "next(I[0])", "next(I[1])", "next(I[2])",
    "list(I[0])", "list(I[1])", "list(I[2])", "L.sort()", "L.reverse()", "L.extend(L)", "D.update({1: 2, 3: 4})", "S.add(7)", "S.discard(1)", "S.update([5, 6])",
    "raise ValueError(self)", "raise StopIteration()", "raise KeyError(self)", "X.append(L[:])", "L[:] = [1]", "D['new'] = self", "self.v = L", "N[0] = 0",
    "raise IndexError()", "W[0] = [W]", "str(self)", "hash(self)", "self == self", "O[self] = 1", "O.pop(1, 0)", "E[0].args = (self,)", "F.clear()", "F[self] = 1",
)  # fmt: skip
"""What a method does at one of its calls."""
LIES = (
    "0", "1", "-1", "2 ** 70", "-2 ** 70", "None", "True", "False", "'a'", "''", "3", "1.5", "float('nan')", "NotImplemented", "self", "[]", "[1]", "(1, 2)", "{}", "iter([1])", "iter([])",
    "o", "L", "10 ** 400", "range(3)", "'x' * 9", "b'a'", "complex(1, 2)", "H0()", "H1()", "itertools.count()", "slice(1, 2)", "len", "print", "object()", "'\\ud800'", "'\\x00'",
)  # fmt: skip
EXTREMES = (
    "0", "1", "-1", "2", "7", "-7", "10 ** 12", "-10 ** 12", "2 ** 31", "2 ** 63", "-2 ** 63", "2 ** 64 - 1", "10 ** 30", "float('nan')", "float('inf')", "-float('inf')", "1e308", "-0.0", "1e-320",
    "True", "None", "'a'", "''", "'utf-8'", "'strict'", "'{0}'", "'%s %d'", "'\\ud800'", "'\\x00'", "b'a'", "b''", "[]", "()", "{}", "(1, 2)", "[1, 2]", "slice(None)", "slice(-10 ** 12, 10 ** 12, -1)",
    "range(3)", "range(10 ** 30)", "Vector(1, 2)", "ego", "Object", "everywhere", "CircularRegion((0, 0), 1)", "lambda *a: 1", "lambda *a: L.clear() or 1", "len", "str", "int", "Range(0, 1)", "NotImplemented",
    "L", "D", "S", "O", "Q", "C", "F", "W[0]", "I[0]", "I[1]", "I[2]", "H0()", "H1()", "H2()", "H0", "H1", "A[0]", "A[1]", "A[2]", "A[3]", "E[0]", "X", "K(1)", "P(1, 2)", "P", "Colour", "Colour.RED", "T",
)  # fmt: skip
"""Arguments."""
OPERATORS = ("+", "-", "*", "/", "//", "%", "**", "<<", ">>", "&", "|", "^", "==", "!=", "<", "<=", ">", ">=", "in", "not in", "is", "and", "or")
TAKEN = {
    "itertools": "accumulate compress count cycle dropwhile filterfalse islice pairwise repeat starmap takewhile zip_longest combinations "
    "combinations_with_replacement permutations product chain chain.from_iterable tee groupby",
    "functools": "partial reduce cmp_to_key", "collections": "namedtuple Counter OrderedDict defaultdict deque", "math": " ".join(
        name for name in ["factorial", "comb", "perm", "prod", "lcm", "gcd", "isqrt", "floor", "ceil", "trunc", "fsum", "dist", "hypot", "ldexp", "fmod", "pow", "sqrt", "log", "isclose", "copysign", "nextafter", "ulp"]
    ),
}  # fmt: skip
CALLED = (
    *sorted(sandbox_table.BUILTINS), "set", "frozenset", "sum", "iter", "next", "pow", "round", "repr", "ascii", "format", "hash", "map", "filter", "zip", "enumerate", "reversed",
    "isinstance", "issubclass", "type", "getattr", "hasattr", "setattr", "callable", "print", "Uniform", "Discrete", "Options", "Range", "Normal", "DiscreteRange", "str.maketrans", "dict.fromkeys",
    "str.join", "str.format", "list.sort", "list.index", "dict.update", "dict.get", "tuple.index", "int", "float", "PolygonalRegion", "PolylineRegion", "PointSetRegion", "CircularRegion",
    "RectangularRegion", "VectorField", "Vector", *(f"{module}.{name}" for module, names in TAKEN.items() for name in names.split()),
)  # fmt: skip
VALUES = ("L", "D", "S", "O", "Q", "C", "F", "W[0]", "I[0]", "I[1]", "A[0]", "A[1]", "A[2]", "A[3]", "E[0]", "H0()", "H1()", "H2()", "'abc'", "'{0} %s'", "b'abc'", "7", "2.5", "(1, 2)", "T", "Colour.RED", "Colour",
          "P(1, 2)", "range(9)", "slice(1, 2)", "D.items()", "D.keys()", "D.values()", "O.items()", "frozenset(T)", "V", "everywhere", "CircularRegion((0, 0), 1)")  # fmt: skip
METHODS = sorted({name for known in sandbox_table.ATTRIBUTES.values() for name in known} | {"__init__", "__name__"})
BEFORE = """import math, itertools, functools, collections, enum
N = [0]
L = []
D = {}
S = set()
O = collections.OrderedDict()
Q = collections.deque()
C = collections.Counter()
F = collections.defaultdict(list)
X = []
W = [[]]
I = [iter([1, 2])] * 3
E = [ValueError(1)]
A = [1, 2, 3, 4]
T = (1, 2)
P = collections.namedtuple('P', 'x y')
class Colour(enum.Enum):
    RED = 1
    BLUE = 2
ego = Object at (0, 0)
V = VectorField('V', lambda v: 1)
"""
FILLED = """K = functools.cmp_to_key(lambda a, b: a.v - b.v)
def made(c):
    try:
        return c()
    except Exception as e:
        X.append(e)
        return c
A = [made(H0), made(H1), made(H2), made(H0)]
T = (A[0], 1, A[1])
def fill():
    N[0] = 0
    L[:] = [*A, 1, 2]
    for i in [*A, 0, 1, 'k']:
        try:
            Q.append(i)
            D[i] = i
            O[i] = i
            S.add(i)
            C[i] = i
            F[i]
        except Exception as e:
            X.append(e)
def begun(make):
    try:
        return make()
    except Exception as e:
        return iter([1, 2])
"""
ITERATORS = (
    "iter(A[{0}])", "itertools.chain(A[{0}], L)", "itertools.islice(A[{0}], 5)", "itertools.takewhile(A[{0}], L)", "itertools.groupby(L)", "itertools.groupby(L, A[{0}])", "itertools.tee(A[{0}])[0]", "itertools.cycle(A[{0}])",
    "itertools.zip_longest(A[{0}], L)", "itertools.pairwise(A[{0}])", "itertools.accumulate(L)", "itertools.accumulate(A[{0}], A[{1}])", "itertools.compress(L, A[{0}])", "itertools.filterfalse(A[{0}], L)", "itertools.starmap(A[{0}], [L])",
    "itertools.product(A[{0}], L)", "itertools.combinations(L, 2)", "zip(A[{0}], L)", "map(A[{0}], L)", "enumerate(A[{0}])", "iter(A[{0}], 1)", "reversed(A[{0}])", "reversed(L)", "iter(D)", "iter(O)", "iter(Q)", "iter(S)",
    "iter(D.items())", "(x for x in A[{0}])", "itertools.chain.from_iterable(A)", "itertools.repeat(A[{0}], 3)", "itertools.count(A[{0}], A[{1}])", "itertools.permutations(L)",
)  # fmt: skip


def hostile_class(source: random.Random, name: str) -> str:
    """A class some of whose methods do something bad at one of their calls, and then lie."""
    lines = [f"class {name}({source.choice(BASES)}):"]
    every = sorted(sandbox_table.OVERRIDES - {"__doc__", "__init__"})
    methods = source.sample(every, source.randrange(2, 14)) + source.sample(("__eq__", "__hash__", "__lt__", "__str__", "__repr__", "__iter__", "__next__"), 3)
    if source.random() < 0.2:
        methods += source.sample(ORDINARY, 2)
    if source.random() < 0.15:
        methods.append("__init__")
    lines.append("    v = 1")
    for method in dict.fromkeys(methods):
        lines.append(f"    def {method}(self, o=None, *rest):" if source.random() < 0.9 else f"    def {method}(self):")
        for _ in range(source.choice((0, 1, 1, 2))):
            lines.append(f"        N[0] = N[0] + 1\n        if N[0] {source.choice(('==', '==', '>', '<'))} {source.randrange(1, 9)}: {source.choice(MISCHIEF)}")
        lie = "1" if method == "__hash__" and source.random() < 0.7 else source.choice(LIES)
        lines.append(f"        return {lie if method != '__init__' else 'None'}")
    if source.random() < 0.05:
        lines.append(f"    {source.choice(('_fields', '_field_defaults', 'items'))} = {source.choice(EXTREMES[:30])}")
    return "\n".join(lines) + "\n"


def arguments(source: random.Random) -> str:
    """The arguments of a call."""
    return ", ".join(source.choice(EXTREMES) for _ in range(source.choice((0, 1, 1, 1, 2, 2, 3, 5))))


def operation(source: random.Random) -> str:
    """A statement that puts hostile values through something of the table."""
    kind = source.randrange(12)
    one, other = source.choice(VALUES), source.choice(VALUES)
    if kind < 3:
        return f"r = {one}.{source.choice(METHODS)}({arguments(source)})"
    if kind < 5:
        return f"r = {source.choice(CALLED)}({arguments(source)})"
    if kind == 5:
        return f"r = {one} {source.choice(OPERATORS)} {other}"
    if kind == 6:
        return f"r = {source.choice(EXCEPTION_NAMES)}({arguments(source)})"
    if kind == 7:
        return source.choice(("raise {0}({1})", "r = str({0}({1}))", "E[0] = {0}({1})")).format(source.choice(EXCEPTION_NAMES), arguments(source))
    if kind == 8:
        return source.choice((
            "r = f'{{{0}}} {{{1}!r}} {{{0}:>9}}'", "r = '%s %r' % ({0}, {1})", "r = '{{}} {{!r}}'.format({0}, {1})", "r = [*{0}, *{1}]", "r = {{**{0}}}", "r = {{{0}: {1}}}",
            "r = {{{0}, {1}}}", "r = {0}[{1}]", "{0}[{1}] = {0}", "a, *b = {0}", "r = print(*{0})", "for r in {0}: {1}", "r = [x for x in {0} if x]", "del {0}[{1}]", "r = {0}[::{1}]", "L += {0}",
            "O |= {0}", "S &= {0}", "Q *= {0}", "C -= {0}", "D |= {0}", "assert {0}, {1}", "r = len(*{0}, **{1})", "{0}.v = {1}", "r = -{0}", "r = not {0}", "r = {0} if {1} else 1", "r = ~{0}",
            "require {0}", "param q = {0}", "x = Object at (9, 9), with foo {0}", "x = Object at ({0}, {1}), with requireVisible False", "raise {0}", "r = Uniform({0}, {1})", "r = '%({0})s %*d' % {1}",
            "r = sorted({0}, key={1})", "r = min({0}, {1})", "r = list({0}) < list({1})", "r = [{0}] < [{1}]", "r = ({0}, 1) == ({1}, 2)",
        )).format(one, other)  # fmt: skip
    if kind == 9:
        return f"r = {source.choice(('L', 'D', 'S', 'O', 'Q', 'C', 'F'))} {source.choice(('==', '!=', '<', '<=', '|', '&', '-', '+'))} {source.choice(('L[:]', 'D', 'S', 'O', 'Q', 'C', 'F', 'O.copy()', 'D.copy()', 'C.copy()', 'Q.copy()', 'S.copy()', 'dict(D)', 'list(L)', 'D.items()'))}"
    if kind == 10:
        return f"I[{source.randrange(3)}] = {source.choice(ITERATORS).format(source.randrange(4), source.randrange(4))}"
    return source.choice(("r = next(I[{0}])", "r = list(I[{0}])", "r = [next(I[{0}]), next(I[{0}]), next(I[{0}])]", "for r in I[{0}]: next(I[{0}])")).format(source.randrange(3))


@cache
def pool(name: str) -> list[str]:
    """Hostile classes, of which programs take theirs."""
    return [hostile_class(random.Random(f"{name}:{i}"), name) for i in range(400)]


def pieces(seed: int | str, number: int) -> list[str]:
    """The parts of program `number` of a seed, many of which stand in other programs as well."""
    source = random.Random(f"{seed}:{number}")
    lines = [BEFORE, *(source.choice(pool(f"H{i}")) for i in range(3)), FILLED, "fill()\n"]
    for place in range(3):
        made = source.choice(ITERATORS).format(source.randrange(4), source.randrange(4))
        lines.append(f"I[{place}] = begun(lambda: {made})\n")
    for _ in range(source.randrange(3, 10)):
        lines.append(f"try:\n    fill()\n    {operation(source)}\nexcept Exception as e:\n    X.append(e)\n    r = str(e)\n")
    last = (*LAST, operation(source))
    return [*lines, f"{source.choice(last)}\n"]


LAST = ("param p = X", "param p = L, q = D", "Object at (5, 5), with foo A[0]", "raise E[0]", "param p = [str(x) for x in X]", "print(X)", "raise A[1]", "param p = A[2]", "1")


def program(seed: int | str, number: int) -> str:
    """The text of program `number` of a seed."""
    return "".join(pieces(seed, number))


@lru_cache(5000)
def parsed(piece: str) -> Program | None:
    """A part of programs, or None if it is none."""
    try:
        return parse(piece, "<string>", None)
    except errors.ProgramError:
        return None


def put_together(seed: int | str, number: int) -> Program:
    """Program `number` of a seed, parsed; parts that are none are left out."""
    found = [part for part in map(parsed, pieces(seed, number)) if part is not None]
    return Program(tuple(statement for part in found for statement in part.statements), "<string>", "")


# Attacks


MOST_SECONDS, MOST_MEMORY = 20, 3 << 30
ADDRESS = re.compile(r"0x[0-9a-f]{8,}")


class TooLong(BaseException):
    """A program does not end; no handler of errors catches it."""


def too_long(number: int, frame: FrameType | None) -> None:
    raise TooLong(f"no end after {MOST_SECONDS} s of processor time")


def attack(program: Program) -> str:
    """What becomes of a program: "scene", or the class of its error; an end that begins with "DEFECT" is ours."""
    try:
        told = Scenario(program, fuel=20_000).sample(0, max_attempts=2).to_line()
        end = "scene"
    except (errors.ProgramError, errors.Gap, errors.AttemptsExhausted, errors.UsageError) as error:
        told, end = f"{error} {error.hint}", type(error).__name__
    except BaseException as defect:
        return f"DEFECT {type(defect).__name__}: {str(defect)[:300]!r}"
    return f"DEFECT address in {told!r}"[:400] if ADDRESS.search(told) else end


def run_here(seed: str, numbers: Iterator[int]) -> None:
    """Run programs in this process, and write of each that it begins, and how it ended."""
    faulthandler.enable()
    budget.LARGEST_WORK = 20_000_000
    if resource is not None:
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number in numbers:
        print(f"{number} begins", flush=True)
        begun = time.process_time()
        if hasattr(signal, "setitimer"):
            signal.signal(signal.SIGPROF, too_long)
            signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS, 1)
        try:
            end = attack(put_together(seed, number))
        except BaseException as defect:
            end = f"DEFECT {type(defect).__name__} while it was being told"
        finally:
            if hasattr(signal, "setitimer"):
                signal.setitimer(signal.ITIMER_PROF, 0)
        print(f"{number} {time.process_time() - begun:.1f} {end!r}", flush=True)


class Ended(NamedTuple):
    """What became of a program, and the processor time that it took, in seconds."""

    number: int
    seconds: float
    end: str


PER_PROCESS = 400


def run_apart(seed: str, first: int, last: int) -> Iterator[Ended]:
    """Run programs `first` to `last` - 1 in a process that may die; then another one goes on behind the program that it died of."""
    while first < last:
        command = [sys.executable, str(Path(__file__)), "--here", seed, str(first), str(min(last, first + PER_PROCESS))]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace") as process:
            output, told = process.communicate()
        for line in output.splitlines():
            number, word, *rest = line.split(" ", 2)
            if word != "begins":
                yield Ended(int(number), float(word), rest[0].strip("'\""))
            first = int(number) + (word != "begins")
        if process.returncode != 0:
            yield Ended(first, 0.0, f"DEFECT died ({process.returncode}): {told[-1500:]}")
            first += 1


def main(count: int, seed: str, processes: int) -> int:
    """Run a campaign in so many processes, and tell; 1 if a program ended in a defect."""
    if ":" in seed:
        name, _, number = seed.partition(":")
        print(program(name, int(number)), flush=True)
        print(attack(put_together(name, int(number))))
        return 0
    from concurrent.futures import ThreadPoolExecutor

    shares = [(count * i // processes, count * (i + 1) // processes) for i in range(processes)]
    with ThreadPoolExecutor(processes) as pool:
        found = [ended for share in pool.map(lambda s: list(run_apart(seed, *s)), shares) for ended in share]
    for end, times in Counter(e.end[:60] for e in found).most_common(60):
        print(f"{times:6} {end}")
    wrong = [e for e in found if e.end.startswith("DEFECT")]
    slowest = sorted(found, key=lambda e: -e.seconds)[:8]
    print(f"{len(found)} programs, {len(wrong)} defects; slowest:", ", ".join(f"{seed}:{e.number} {e.seconds:.1f} s" for e in slowest))
    for ended in wrong[:60]:
        print(f"--- {seed}:{ended.number} {ended.end}")
    return 1 if wrong else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--here"]:
        run_here(sys.argv[2], iter(range(int(sys.argv[3]), int(sys.argv[4]))))
    else:
        words = [*sys.argv[1:], *("2000", "0", str(os.cpu_count() or 1))[len(sys.argv) - 1 :]]
        sys.exit(main(int(words[0]), words[1], int(words[2])))
