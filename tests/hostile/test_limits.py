"""Short programs that would take for ever, or all the memory: each ends in a program error soon, and Ctrl-C is heard in the middle of it."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest
import scenic_ref
from scenic_ref.semantics.store import errors

LONGEST = 250
"""No program takes more than so many times the processor time of a fixed calculation of about a tenth of a second."""

IMPORTS = "import itertools, collections, functools, math, random\n"
USER = (
    "class N(int):\n    def __gt__(self, o): return False\n    def __lt__(self, o): return False\n    def __rmul__(self, o): return 0\n    def __mul__(self, o): return 0\n"
    "class I(object):\n    def __index__(self): return 10 ** 10\nclass L(list):\n    def __len__(self): return 0\nclass S(str):\n    def __len__(self): return 0\n"
    "class E(object):\n    def __iter__(self): return self\n    def __next__(self): return 1\nclass T(object):\n    def __getitem__(self, i): return 'b' * 1000000\n"
)
LISTED = [
    "a = [1]\nfor i in range(100): a = a + a", "x = list(itertools.repeat(0))", "x = list(zip(itertools.count(), itertools.count()))", "x = collections.deque(itertools.repeat(0))",
    "x = ''.join(itertools.repeat('a'))", "x = []\nx.extend(itertools.repeat(1))", "def f(*a): return 1\nx = f(*itertools.count())", "x = list(itertools.product(range(100), repeat=5))",
    "x = list(itertools.product(range(1000), repeat=10 ** 9))", "x = list(itertools.permutations(range(20)))", "x = random.Random(1).choices([1], k=10 ** 10)",
    "x = '{:2000000000}'.format(1)", "x = sum(itertools.count())", "x = math.factorial(10 ** 7)", "x = list(E())", "a = [0] * 10\nfor i in range(20): a = [a] * 10\nx = str(a)",
    "a = [0] * 10\nfor i in range(20): a = [a] * 10\nparam x = a",
    "a = [0] * 10\nb = [0] * 10\nfor i in range(20):\n    a = [a] * 10\n    b = [b] * 10\nx = a == b",
]  # fmt: skip
OTHERS = [
    "x = round(5, -10 ** 9)", "x = pow(3 ** 60000, 3 ** 60000, 3 ** 60000 + 1)", "x = '%*d' % (10 ** 10, 1)", "x = bytes(10 ** 10)", "x = [1] * 10 ** 6\nwhile True: y = sum(x)",
    "x = [1] * 10 ** 6\ny = sorted([x] * 10 ** 6, key=sum)", "x = [1] * 10 ** 6\ny = sorted([x] * 10 ** 6, key=list)", "x = [1] * 10 ** 6\ny = sorted([x] * 10 ** 6, key=functools.partial(max))",
    "x = 1\nwhile True: x = x << 1000", "x = 5 in itertools.repeat(1)", "x = max(itertools.count())", "a, b = itertools.count()", "x = [*itertools.count()]",
    "x = list(collections.Counter({'a': 10 ** 12}).elements())", "x = ','.join(['a' * 10 ** 6] * 10 ** 6)", "x = any(itertools.repeat(False))", "x = math.comb(10 ** 6, 5 * 10 ** 5)",
    "x = math.prod([10 ** 20000] * 1000)", "for i in itertools.count(): pass", "x = set(itertools.count())", "x = [1] * 10 ** 6\nwhile True: y = 5 in x",
    "x = [1] * 10 ** 6\nwhile True: y = x.count(2)", "x = ('a' * 2000000).rfind('ab' + 'a' * 1000000)", "x = ('a' * 1000000).strip('b' * 1000000 + 'a')",
    "x = ('a' * 10000).translate(T())", "x = ('a' * 10 ** 6 + 'b').startswith(('a' * 10 ** 6 + 'c',) * 10 ** 6)", "x = L([0] * 10 ** 6) * 10 ** 5", "x = ''.join([S('a' * 10 ** 6)] * 10 ** 5)",
    "x = [0] * I()", "x = 'a' * I()", "x = bytes(I())", "x = [0] * N(10 ** 10)", "x = 'a'.ljust(N(10 ** 10))", "x = math.factorial(N(10 ** 7))", "x = 2 ** N(10 ** 9)", "x = 1 << N(10 ** 10)",
    "x = ('\\xe9' * 10 ** 6).encode('punycode')", "x = random.Random(1).choices([1], k=N(10 ** 10))", "x = functools.reduce(lambda a, b: a + a, itertools.count(), [1])",
    "x = list(itertools.accumulate(itertools.repeat([1]), lambda a, b: a + b))", "x = list(map(lambda v: v, itertools.count()))", "x = list(filter(None, itertools.count()))",
    "x = list(itertools.chain.from_iterable(itertools.repeat([1] * 1000)))", "x = dict.fromkeys(itertools.count())", "x = min(itertools.count(), key=lambda v: v)",
    "x = collections.deque([0]) \nx *= 10 ** 10", "x = [0]\nx *= 10 ** 10", "x = 'a' * 10 ** 6\nfor i in range(10 ** 6): x = x.replace('a', 'aa')", "x = list(iter(lambda: 1, 2))",
    "x = itertools.tee(itertools.count(), 10 ** 9)", "x = 'a\\tb'.expandtabs(10 ** 10)", "x = f'{1:>10000000000}'", "x = range(10 ** 12).index(5.5)", "x = random.Random(1).sample(range(10 ** 9), 10 ** 8)",
    "def f(): return f()\nx = f()", "x = 'x'.zfill(N(10 ** 10))", "x = sum([[1] * 10 ** 4] * 10 ** 5, [])", "x = (1,) * 10 ** 10", "x = [[0] * 10 ** 6 for i in range(10 ** 6)]",
]  # fmt: skip

CROWDED = "k = [i * (2 ** 61 - 1) for i in range(40000)]\n"
SHARED = "a = (1,)\nfor i in range(40): a = (a, a)\n"
HASHED = [
    *(CROWDED + use for use in ("x = dict.fromkeys(k)", "x = set(k)", "x = {*k}", "x = dict(zip(k, k))", "x = collections.Counter(k)", "x = {1}.union(k)", "x = list(map(set, [k]))", "x = sorted([k], key=set)", "x = set(items=k)", "x = {}\nx.update(zip(k, k))")),
    *(SHARED + use for use in ("x = {a: 1}", "x = a in {1: 2}", "x = {1: 2}.get(a)", "x = {1: 2}[a]", "x = set([a])", "x = {}\nx[a] = 1", "x = {1}\nx.add(a)", "x = {}\ndel x[a]", "x = {b for b in [a]}")),
    "class H(object):\n    def __hash__(self): return 1\nk = [H() for i in range(30000)]\nx = set(k)",
]  # fmt: skip
CHANGING = "n = [0]\nclass A(object):\n    def __index__(self):\n        n[0] += 1\n        return 1 if n[0] % 2 else 3 * 10 ** 9\n"


@pytest.mark.parametrize("use", ["'a' * A()", "A() * 'a'", "[0] * A()", "'a'.ljust(A())", "'a'.zfill(A())", "'a\\t'.expandtabs(A())"])
def test_a_number_that_changes_is_asked_for_once(use):
    scene = scenic_ref.loads(f"ego = Object at (0, 0)\n{CHANGING}x = {use}\nparam x = len(x), n = n[0]\n").sample()
    assert scene.params["x"] < 10 and scene.params["n"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("text", LISTED + OTHERS + HASHED)
def test_what_would_take_for_ever_is_an_error_soon(text, effort):
    def ends() -> None:
        with pytest.raises(errors.ProgramError):
            scenic_ref.loads("ego = Object at (0, 0)\n" + IMPORTS + USER + text + "\n", fuel=300_000).sample(max_attempts=1)

    assert any(effort(ends) < LONGEST for _ in range(3))  # a busy machine only adds to it


# Ctrl-C


INTERRUPTING = """
import os, threading, time
from scenic_ref.cli import main
from scenic_ref.interpreter.runtime.process_sandbox import WALL
from scenic_ref.semantics.store import budget
budget.LARGEST_WORK = 10 ** 18
def interrupt():
    while not WALL.timing.startswith("one run"): pass
    begun = time.process_time()
    while time.process_time() < begun + 0.5: pass
    os.write(1, b"now\\n")
threading.Thread(target=interrupt, daemon=True).start()
main()
"""
LONG_CALLS = {
    "sum": "x = sum(itertools.count())", "any": "x = any(itertools.repeat(False))", "in": "x = 5 in itertools.repeat(1)", "iterator": "x = max(E())", "list": "x = max(itertools.cycle([1]))",
    "key": "x = min(itertools.count(), key=lambda v: v)", "reduce": "x = functools.reduce(lambda a, b: a, itertools.count())", "loop": "while True: pass", "machine": "for i in itertools.count(): pass",
    "operator": "x = [1] * 10 ** 6\nwhile True: y = 5 in x",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG_CALLS)
def test_ctrl_c_is_heard_within_a_long_call(name, tmp_path):
    (tmp_path / "p.scenic").write_text("ego = Object at (0, 0)\n" + IMPORTS + USER + LONG_CALLS[name] + "\n")
    command = [sys.executable, "-c", INTERRUPTING, "run", "p.scenic", "--fuel", "1000000000", "--limit-seconds", "600"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None and running.stdout.readline() == "now\n"
        running.send_signal(signal.SIGINT)
        _, told = running.communicate()
    assert (running.returncode, told.count("interrupted"), "Traceback" in told) == (130, 1, False), told[-500:]
