"""The first wall: a program holds only values of the table, reaches nothing else by whatever way, and leaves nothing behind."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from contextlib import suppress
from itertools import product
from pathlib import Path

import pytest
import scenic_ref
from scenic_ref.semantics.machine import host_calls, sandbox_table
from scenic_ref.semantics.python import expressions
from scenic_ref.semantics.store import errors

sys.path.insert(0, str(Path(__file__).parent))
crawling = importlib.import_module("crawling")
sys.path.pop(0)

OF_PYTHON = sandbox_table.names(
    "NoneType NotImplementedType bool builtin_function_or_method bytes classmethod complex dict dict_items dict_keys dict_values float int list method "
    "method_descriptor object property range slice staticmethod str tuple type Counter OrderedDict defaultdict deque EnumType auto KeyWrapper"
)
"""The types of Python, beside exceptions, of which a program may meet values. A name that is added here is one that somebody has thought about."""
OURS = ("scenic_ref.semantics.", "scenic_ref.simulators.", "scenic_ref.interpreter.language.modules")
HELD = sandbox_table.names("list dict tuple str int float bool bytes complex object property range slice staticmethod classmethod Counter OrderedDict defaultdict deque") | {
    "Enum", "IntEnum", "Flag", "auto",
}  # fmt: skip
"""The classes of Python, beside exceptions, that a program may hold."""


def stranger(found: type, known: frozenset[str] | set[str]) -> bool:
    """Whether a type is none of Python's `known` ones, no exception, none of ours and none of the program's."""
    if issubclass(found, Exception) or found.__module__ == "scenic" or found.__module__.startswith(OURS):
        return False
    return found.__name__ not in known or found.__module__ not in ("builtins", "types", "collections", "enum", "functools")


@pytest.mark.slow
def test_nothing_is_reached_that_is_not_in_the_table():
    crawl = crawling.Crawl(crawling.started())
    crawl.all()
    assert not crawl.strangers, crawl.strangers[:20]
    assert not [t for t in crawl.types if stranger(t, OF_PYTHON) and t.__name__ != "ABCMeta"]
    assert not [t for t in crawl.classes if stranger(t, HELD)]
    assert sum(crawl.met.values()) > 200_000
    assert len(crawl.looked_into) > 600
    assert crawl.met["refused"] > 50_000


def test_the_crawler_finds_what_an_open_border_lets_through(monkeypatch):
    monkeypatch.setattr(expressions, "may_ask", lambda value, name: True)
    monkeypatch.setattr(host_calls, "check_value", lambda result, state: None)
    crawl = crawling.Crawl(crawling.started())
    for way, value in [r for r in crawl.roots() if r[0] in ("CircularRegion", "spy", "Plain", "math") or r[0].startswith("values[")][:60]:
        list(crawl.around(way, value))
    found = " ".join(crawl.strangers)
    assert [name for name in ("mappingproxy", "method-wrapper", "builtins.function", "wrapper_descriptor", "getset_descriptor") if name not in found] == []


# Ways out


SECRET = "SCENIC_REF_SECRET"
DUNDERS = (
    "__class__", "__dict__", "__globals__", "__subclasses__", "__mro__", "__bases__", "__base__", "__init_subclass__", "__reduce_ex__", "__reduce__", "__getattribute__",
    "__setattr__", "__self__", "__func__", "__code__", "__closure__", "__builtins__", "__module__", "__loader__", "__wrapped__", "__new__", "__dir__", "__sizeof__", "mro",
)  # fmt: skip
SUBJECTS = {
    "a number": "1", "a text": "'a'", "a list": "[1]", "a class": "C", "an object": "C()", "a method": "C().m", "a function": "f",
    "a builtin": "len", "ours": "sum", "a region": "CircularRegion((0, 0), 1)", "a polygon": "PolygonalRegion([(0, 0), (1, 0), (1, 1)])",
    "everywhere": "everywhere", "a field": "F", "a vector": "Vector(1, 2)", "a Scenic class": "Object", "an instance": "ego",
    "an exception": "caught()", "an enumeration": "E", "a member": "E.A", "a named tuple": "P(1, 2)", "a record": "P",
    "an iterator": "itertools.count()", "a module": "math", "a partial": "functools.partial(len)", "a behavior": "B", "a distribution": "Range",
    "random": "Range(0, 1)", "a generator": "random.Random(1)", "the clock": "simulation", "a property": "property(f)",
    "a bound method": "[].append", "a name of typing": "typing.List[int]",
}  # fmt: skip
BEFORE = """
import math, itertools, functools, collections, enum, random, typing
class C(object):
    def m(self): return self
class E(enum.Enum):
    A = 1
P = collections.namedtuple('P', 'a b')
F = VectorField('F', lambda v: 1)
def f(*a): return a
behavior B():
    wait
def caught():
    try: [].nope
    except AttributeError as e: return e
ego = Object at (0, 0)
out = []
"""
ACCESS = {
    "attribute": "out.append(({subject}).{name})", "getattr": "out.append(getattr({subject}, '{name}'))",
    "with default": "out.append(getattr({subject}, '{name}', None))", "hasattr": "out.append(None if hasattr({subject}, '{name}') else None)",
    "setattr": "setattr({subject}, '{name}', f)\nout.append(1)", "assignment": "x = {subject}\nx.{name} = f\nout.append(1)",
    "f-string": 'out.append(f"{{({subject}).{name}}}")', "format": "out.append('{{0.{name}}}'.format({subject}))",
    "format_map": "out.append('{{x.{name}}}'.format_map({{'x': {subject}}}))", "str.format": "out.append(str.format('{{0.{name}}}', {subject}))",
    "partial": "out.append(functools.partial('{{0.{name}}}'.format)({subject}))", "map": "out.extend(map('{{0.{name}}}'.format, [{subject}]))",
    "map getattr": "out.extend(map(getattr, [{subject}], ['{name}']))", "key": "sorted([{subject}], key=lambda v: out.append(v.{name}) or 0)",
    "property": "class D(object):\n    @property\n    def p(self): return ({subject}).{name}\nout.append(D().p)",
    "class attribute": "class D(object):\n    p = ({subject}).{name}\nout.append(D.p)",
    "override": "class D(object):\n    def __getattr__(self, name): return getattr({subject}, name)\nout.append(D().{name})",
    "subclass": "class D(C):\n    {name} = f\nout.append(D())", "reduce": "out.append(functools.reduce(getattr, ['{name}'], {subject}))",
    "starmap": "out.extend(itertools.starmap(getattr, [({subject}, '{name}')]))",
    "raise": "try: raise ValueError({subject})\nexcept ValueError as e: out.append(e.args[0].{name})",
    "match": "out.append([v.{name} for v in ({subject},)])",
}  # fmt: skip
SHARE = 7
"""Each way is tried with one in so many pairs, with others than the way before it; together about 2,300 programs."""


def ends_of(text: str) -> str | list[object]:
    """The error of a program, or what it put into `out`."""
    config = scenic_ref.loads(BEFORE + text + "\n", fuel=50_000)
    try:
        ended = crawling.generate_scene(config.start(), crawling.from_stream(0, 0, 0), fuel=50_000)
    except errors.ScenicError as error:
        assert not isinstance(error, errors.InternalError)
        return str(error)
    if not isinstance(ended, crawling.Accepted):
        return ended.requirement.text
    return list(ended.state.sigma.bindings["out"])


@pytest.mark.slow
@pytest.mark.parametrize("way", ACCESS)
def test_no_way_of_access_gives_what_is_private(way):
    template, refused = ACCESS[way], 0
    pairs = list(product(DUNDERS, SUBJECTS))[list(ACCESS).index(way) % SHARE :: SHARE]
    for name, subject in pairs:
        given = ends_of(template.format(subject=SUBJECTS[subject], name=name))
        if isinstance(given, str):
            refused += 1
            continue
        for value in given:
            assert all(map(sandbox_table.is_value, crawling.inside(value, set()))), (way, name, subject)
            if way in ("f-string", "format", "format_map", "str.format", "partial", "map"):
                assert not ("0x" in str(value) or "<class" in str(value) or "<slot" in str(value)), (way, name, subject, value)
    assert refused > (0 if way in ("with default", "hasattr", "subclass") else len(pairs) * 0.6)


ROUTES = {
    "__getattribute__ of a class": "class C(object): pass\ng = C.__getattribute__\nx = g(CircularRegion, '__dict__')['__init__'].__globals__['os'].popen('touch {file}')",
    "a metaclass": "T = type(int)\nclass M(T): pass\nx = M('a', (), {{}})",
    "a text from the environment": "f = CircularRegion\nx = '{{0.__init__.__globals__[os].environ[{secret}]}}'.format(f)",
    "format_map": "x = str.format_map('{{x.__init__.__globals__}}', {{'x': CircularRegion}})",
    "partial of format": "import functools\nx = functools.partial('{{0.__class__}}'.format)(1)",
    "an array that writes files": "PolygonalRegion([(0, 0), (1, 0), (1, 1)]).sampler.cumulative.tofile('{file}')",
    "an array's memory": "x = PolygonalRegion([(0, 0), (1, 0), (1, 1)]).sampler.cumulative.ctypes.shape",
    "a state that stays": "class C(object): pass\nC.__setattr__(everywhere, 'x', 1)",
    "a member of an enumeration in the making": (
        "import enum\nclass C(enum.Enum):\n    def __contains__(self, n): return True\n    def __init__(self, v):\n        if v == 2: self.__reduce_ex__\n"
        "    scenic_names = 1\n    B = 2"
    ),
    "a slot that is a builtin": "class C(object):\n    __getitem__ = bytes\nx = C()[10 ** 10]",
    "a slot that is assigned": "class C(object): pass\nC.__getitem__ = bytes\nx = C()[10 ** 10]",
    "a slot that is a static builtin": "class C(object):\n    __getitem__ = staticmethod(bytes)\nx = C()[10 ** 10]",
    "a codec": "x = 'a'.encode('zlib_codec')",
    "names of an exception": "try: [].nope\nexcept AttributeError as e: x = e.obj",
    "a traceback": "try: 1 / 0\nexcept ZeroDivisionError as e: x = e.__traceback__.tb_frame.f_globals",
    "slots": "class C(object):\n    __slots__ = ('a',)",
    "a hook of classes": "class C(object):\n    def __init_subclass__(cls): pass",
    "a pickle": "class C(object):\n    def __reduce__(self): return print, (1,)",
    "a copy": "class C(object):\n    def __deepcopy__(self, memo): return 1",
    "a descriptor": "class C(object):\n    def __set_name__(self, owner, name): pass",
    "a finaliser": "class C(object):\n    def __del__(self): pass",
    "a subclass of a type of ours": "class C(CircularRegion): pass",
    "a subclass of a generator": "import random\nclass C(random.Random): pass",
    "a state of a generator": "import random\nx = random.Random(1).getstate()",
    "super": "class C(object):\n    def m(self): return super().m\nx = C().m()",
    "type with three arguments": "x = type('C', (object,), {{}})",
    "a class of a function": "x = type(lambda: 0)",
    "a class of a class": "class C(object): pass\nx = type(C)",
    "a class of a module": "import math\nx = type(math)",
}
"""Ways out that were found, or tried: each is a program error."""


@pytest.mark.parametrize("name", ROUTES)
def test_routes_that_are_closed(name, tmp_path, monkeypatch):
    monkeypatch.setenv(SECRET, "the secret")
    file = tmp_path / "written"
    with pytest.raises(errors.ProgramError) as caught:
        scenic_ref.loads("ego = Object\n" + ROUTES[name].format(file=file, secret=SECRET) + "\n", fuel=100_000).sample()
    assert "the secret" not in str(caught.value)
    assert not file.exists()


# What one program does, the next does not see


LEAVES = {
    "a region": "everywhere.x = 1", "a class of ours": "CircularRegion.x = 1", "a builtin class": "int.x = 1",
    "a list of a module": "import math\nmath.pi = 3",
    "a world": "import scenic.simulators.gta.map as m\nm.MODELS.append(1)\nm.COLOR_WEIGHTS.clear()\nm.road = 1",
    "itertools": "import itertools\nitertools.chain = 1", "chain": "import itertools\nitertools.chain.from_iterable = 1",
    "an exception": "ValueError.x = 1", "ours": "sum.x = 1", "a builtin": "len = 1\nsum = 2",
    "an action": "import scenic.domains.driving.actions as a\na.SetThrottleAction.x = 1", "a class of Scenic": "Object.x = 1",
    "a distribution": "Range.x = 1",
}  # fmt: skip
AFTER = """
import math, itertools
import scenic.simulators.gta.map as m
ego = Object at (0, 0)
param x = [hasattr(v, 'x') for v in (everywhere, CircularRegion, int, ValueError, sum, Object, Range)], y = math.pi, z = len(m.MODELS), u = len(m.COLOR_WEIGHTS)
param v = list(itertools.chain.from_iterable([[1], [2]])), w = len([sum([1, 2])]), r = m.road is m.curb
"""


@pytest.mark.parametrize("use", ["list(List)", "3 in List", "[*List]", "isinstance(3, List)", "List()", "List.foo", "type(List)"])
def test_names_of_typing_are_for_annotations(use):
    with pytest.raises(errors.ScenicError):
        scenic_ref.loads(f"from typing import List\nego = Object\nx = {use}\n").sample()


def test_a_program_leaves_nothing_behind():
    before = scenic_ref.loads(AFTER).sample().params
    for text in LEAVES.values():
        with suppress(errors.ProgramError):
            scenic_ref.loads("ego = Object at (0, 0)\n" + text + "\n").sample()
        assert scenic_ref.loads(AFTER).sample().params == before, text


# What would end the process


CHAINS = {
    "enumerate": "import functools\nx = functools.reduce(enumerate, range(N), [])",
    "zip": "import functools\nx = functools.reduce(zip, [[1]] * N, [1])", "slices": "x = 1\nfor i in range(N): x = slice(x)",
    "slices by reduce": "import functools\nx = functools.reduce(slice, range(N), 1)",
    "static methods": "x = len\nfor i in range(N): x = staticmethod(x)", "properties": "x = len\nfor i in range(N): x = property(x)",
    "class methods": "x = len\nfor i in range(N): x = classmethod(x)",
    "setters": "x = property(len)\nfor i in range(N): x = property(len).setter(x)",
    "keys": "import functools\nk = functools.cmp_to_key(max)\nx = 1\nfor i in range(N): x = k(x)",
    "files": "x = 1\nfor i in range(N): x = OSError(1, 'a', x)", "objects of errors": "x = 1\nfor i in range(N): x = AttributeError('a', obj=x)",
    "paths": "x = 1\nfor i in range(N): x = ImportError('a', path=x)", "names": "x = 1\nfor i in range(N): x = NameError('a', name=x)",
    "accumulated": "import itertools\nx = list(itertools.accumulate([1] * N, slice))",
    "iterators": "import itertools\nx = []\nfor i in range(N // 4): x = itertools.chain(x)\nx = list(x)",
}  # fmt: skip


@pytest.mark.slow
def test_no_chain_of_values_ends_the_process(tmp_path):
    for name, text in CHAINS.items():
        (tmp_path / f"{name}.scenic").write_text(f"ego = Object at (0, 0)\nN = 200000\n{text}\nx = 1\n")
    code = (
        "import sys, scenic_ref\nfrom scenic_ref.semantics.store.errors import ProgramError\n"
        "for file in sys.argv[1:]:\n    print(file, flush=True)\n    try: scenic_ref.load(file).sample()\n    except ProgramError: pass\n"
    )
    files = sorted(map(str, tmp_path.glob("*.scenic")))
    done = subprocess.run([sys.executable, "-c", code, *files], capture_output=True, text=True, check=False, env={**os.environ})
    assert (done.returncode, done.stdout.splitlines()) == (0, files), done.stdout.splitlines()[-1] + done.stderr[-500:]
