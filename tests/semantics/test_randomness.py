"""What is random stays random: through containers, changes in place, comparisons and Python's protocols; what would lose it is refused."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store import errors

EGO = "ego = Object\n"
CHOICE = "a = Object at 5 @ 5\nb = Object at 9 @ 9\nu = Uniform(a, b)\n"
BOX = "class Box(object):\n    def __init__(self, x): self.x = x\n"


def result_of(program):
    return scenic_ref.loads(EGO + program).sample().params["r"]


VALUES = {
    "a non-random chain stops at the first link that fails": ("n = 3\nxs = [1]\nparam r = 0 < n < 2 < xs[5]\n", False),
    "a random chain is a random truth value": ("x = Range(0, 1)\nparam r = 0 <= x < 2 < 3\n", True),
    "not in a region": ("param r = 0 @ 0 not in CircularRegion(0 @ 0, 3)\n", False),
    "in a region within a chain": ("c = CircularRegion(0 @ 0, 3)\nparam r = 1 < 2 == (0 @ 0 in c) + 1\n", True),
    "equal random members of a set are one": ("param r = len({Uniform(1, 1), Uniform(1, 1), 1})\n", 1),
    "a random key is found": ("d = {Uniform(1, 1): 5}\nparam r = d[1]\n", 5),
    "dict() with a random key": ("param r = dict([(Uniform(1, 1), 2)])[1]\n", 2),
    "Discrete chooses among random values": ("param r = Discrete({Range(3, 3): 1, Range(3, 3): 2})\n", 3),
    "a random part of a tuple as key": ("d = {(0, 1): 4}\ni = Uniform(1, 1)\nparam r = d[(0, i)]\n", 4),
    "get with a random key": ("param r = {1: 'a', 2: 'b'}.get(Uniform(2, 2))\n", "b"),
    "enumerate from a random start": ("param r = enumerate([5], start=Uniform(2, 2))\n", [(2, 5)]),
    "stored elements stay where they are put": (
        "xs = [1, 2]\nxs.append(Uniform(3, 3))\nxs.extend([Uniform(4, 4)])\nxs.insert(0, Uniform(0, 0))\nparam r = (len(xs), xs)\n",
        (5, [0, 1, 2, 3, 4]),
    ),
    "augmented assignment reduces the index once": (
        "c = [0]\ndef f():\n    c[0] += 1\n    return 0\na = [1]\na[f()] += 1\nparam r = (a, c)\n", ([2], [1]),
    ),
    "augmented assignment takes the index once": ("it = [0, 1]\na = [5, 6]\na[it.pop()] += 10\nparam r = a\n", [5, 16]),
    "augmented assignment reads before it reduces the operand": (
        "x = 1\ndef f():\n    global x\n    x = 10\n    return 1\nx += f()\nparam r = x\n", 2,
    ),
    "augmented assignment in place": (
        "a = [1]\nb = a\na += [Uniform(2, 2)]\na *= 2\ns = {1}\nt = s\ns |= {2}\nd = {}\ne = d\nd |= {1: Uniform(3, 3)}\nparam r = (b, t, e)\n",
        ([1, 2, 1, 2], {1, 2}, {1: 3}),
    ),
    "__iadd__ of the program": (
        BOX + "    def __iadd__(self, o):\n        self.x = self.x + o\n        return self\n"
        "p = Box(1)\nq = p\np += Uniform(1, 1)\nparam r = q.x\n",
        2,
    ),
    "builtins are ordinary values": (
        "param r = (isinstance([], list), type([]) is list, sorted(['aaa', 'b'], key=len), list(map(len, ['ab'])), filter(None, [0, 1]))\n",
        (True, True, ["b", "aaa"], [2], [1]),
    ),
    "a class below list": (
        "class L(list):\n    def double(self): return 2 * len(self)\nl = L([1])\nl.append(Uniform(3, 3))\nparam r = (l.double(), sum(l))\n", (4, 4),
    ),
    "defaultdict(list)": ("from collections import defaultdict\nd = defaultdict(list)\nd[1].append(Uniform(2, 2))\nparam r = d[1]\n", [2]),
    "a value view with random values": ("d = {1: Uniform(2, 2)}\nparam r = sum(d.values())\n", 2),
    "unpacking binds from left to right": ("i = 0\na = [0, 0]\ni, a[i] = 1, 5\nparam r = (i, a)\n", (1, [0, 5])),
    "properties and static and class methods": (
        "class A(object):\n    @property\n    def f(self): return 3\n    @staticmethod\n    def g(x): return x\n"
        "    @classmethod\n    def h(cls, x): return (cls is A, x)\na = A()\nparam r = (a.f, a.g(2), a.h(5))\n",
        (3, 2, (True, 5)),
    ),
    "properties of Scenic classes": (
        "class Foo:\n    @property\n    def area(self): return self.width * self.length\n"
        "f = Foo at 9 @ 9, with width Uniform(2, 2)\nparam r = f.area\n",
        2,
    ),
    "an instance as text": ("param r = (str(ego), f'{ego}')\n", ("Object at (0.0, 0.0)", "Object at (0.0, 0.0)")),
    "a heading that was drawn can be drawn again": ("a = Object at 9 @ 9, facing Uniform(1, 1)\nparam r = resample(a.heading)\n", 1),
    "super with arguments": (
        BOX + "class A(Box):\n    def __init__(self): super(A, self).__init__(Uniform(3, 3))\nparam r = A().x\n", 3,
    ),
    "super of Python's classes": (
        "class A(list):\n    def __init__(self, xs):\n        super(A, self).__init__(xs)\n        super().append(Uniform(7, 7))\n"
        "class B(dict):\n    def __init__(self, entries): super().__init__(entries)\n    def get(self, k): return super().get(k, 5)\n"
        "class E(ValueError):\n    def __init__(self, n): super().__init__(f'n is {n}')\n"
        "class O(object):\n    def __init__(self): super().__init__()\n"
        "a, b, o = A([1, 2]), B({3: 4}), O()\ntry: raise E(2)\nexcept ValueError as e: t = str(e)\n"
        "param r = (len(a), a[2], b.get(3), b.get(4), t)\n",
        (3, 7, 4, 5, "n is 2"),
    ),
    "super in a class method of a Scenic class": (
        "class C:\n    @classmethod\n    def f(cls): return 5\n"
        "class D(C):\n    @classmethod\n    def f(cls): return super().f() + super(D, cls).f()\nparam r = D.f()\n",
        10,
    ),
    "getattr of a member of the releases keeps its randomness": (
        "p = Uniform(4, 4) @ 6\nparam r = (hasattr(ego, 'corners'), getattr(p, 'distanceTo')(1 @ 2))\n", (True, 5),
    ),
    "names of functions": (
        BOX + "b = Box(3)\nbehavior B():\n    wait\n"
        "param r = (Box.__init__.__name__, b.__init__.__name__, B.__name__, Range.__name__, print.__name__, type(frozenset()).__name__)\n",
        ("__init__", "__init__", "B", "Range", "print", "frozenset"),
    ),
    "a key is there, whatever its value is": (
        "from collections import OrderedDict, defaultdict\nd = {1: Uniform(2, 3)}\n"
        "r = [1 in d, 2 in d, 2 not in d, 1 in OrderedDict(d), 1 in d.keys()]\nif 1 in d and not 2 in d:\n    param r = r\n",
        [True, False, True, True, True],
    ),
    "an element is there, whatever the others are": (
        "xs = [Uniform(2, 3), 'a', (Uniform(4, 5), 6)]\nif 'a' in xs and 'a' in tuple(xs):\n    param r = 'a' not in xs\n", False,
    ),
    "the truth of a container is that of its length": (
        "xs = [Uniform(0, 1)]\nd = {1: Uniform(0, 1)}\nif xs and d and not not xs and bool(d):\n    param r = 1 if (xs[0],) else 2\n", 1,
    ),
    "joined containers keep their elements apart": (
        "xs = [Uniform(0, 1)] + [5]\nys = (Uniform(0, 1), 6, 7) * 2\nd = {1: Uniform(0, 1)} | {2: 7}\nif xs[1] == 5 and ys[4] == 6 and d[2] == 7:\n"
        "    param r = len(xs) + len(ys) + len(d)\n",
        10,
    ),
    "the standard deviation by the releases' name": (
        "param r = [Normal(mean=1, stddev=0), TruncatedNormal(mean=5, stddev=0, low=4, high=6), Options(opts=[3]), Discrete(opts={4: 1})]\n",
        [1, 5, 3, 4],
    ),
    "an identity is not random": ("xs = [Uniform(1, 2)]\nif xs is xs:\n    param r = 1\n", 1),
}


@pytest.mark.parametrize("claim", VALUES)
def test_value(claim):
    program, expected = VALUES[claim]
    assert result_of(program) == expected


BRANCHES = {
    "chain": ("x = Range(0, 1)\n", "0 < x < 2 < 3"),
    "not in a region": ("x = Range(0, 1) @ 0\n", "x not in CircularRegion(0 @ 0, 3)"),
    "a chain with not in": ("x = Range(0, 1) @ 0\n", "1 < 2 not in [x] == 3"),
    "__getitem__": (BOX + "    def __getitem__(self, i): return self.x\n", "Box(Uniform(1, 2))[0] == 1"),
    "__getattr__": ("u = Uniform(1, 2)\nclass A(object):\n    def __getattr__(self, n): return u\n", "A().foo == 1"),
    "__len__": (BOX + "    def __len__(self): return self.x\n", "len(Box(Uniform(1, 2))) == 1"),
    "__setitem__": (BOX + "    def __setitem__(self, i, v): self.x = v\nb = Box(0)\nb[1] = Uniform(1, 2)\n", "b.x == 1"),
    "get": ("d = {1: 'a', 2: 'b'}\n", "d.get(Uniform(1, 2)) == 'a'"),
    "a set": ("", "len({Uniform(1, 2), 1}) == 1"),
    "a set comprehension": ("", "len({Uniform(1, 2) for x in range(3)}) == 1"),
    "the keys of a dict comprehension": ("", "len({Uniform(1, 2): x for x in range(3)}) == 1"),
    "a dict display of a random one": ("", "1 in {**Uniform({1: 2}, {3: 4})}"),
    "a deque": ("from collections import deque\nq = deque([1])\nq.append(Uniform(1, 2))\n", "2 in q"),
    "a value view": ("d = {1: Uniform(1, 2)}\n", "1 in d.values()"),
    "hasattr": ("", "hasattr(ego, Uniform('width', 'foo'))"),
    "the text of an exception": (
        "class E(Exception):\n    def __init__(self, x): self.x = x\ne = E(Uniform(1, 2))\n", "str(e) == '1' or f'{e}' == '1' or [e] == 3",
    ),
    "an element that may be the one": ("", "3 in [1, Uniform(2, 3)]"),
    "an element of a random list": ("", "1 in Uniform([1], [1, 2])"),
    "a random item": ("", "Uniform(1, 2) in [1, 2]"),
    "a random key": ("", "Uniform(1, 2) in {1: 2}"),
    "a class of the program that says what is in it": (
        "u = Uniform(1, 2)\nclass L(list):\n    def __contains__(self, x): return x == u\n    def __bool__(self): return u == 1\n", "2 in L()",
    ),
    "a class of the program that says whether it is true": ("u = Uniform(1, 2)\nclass L(list):\n    def __bool__(self): return u == 1\n", "L()"),
    "the elements of joined lists": ("", "([1] + [Uniform(2, 3)])[1] == 2"),
    "hasattr of a member of the releases": ("", "hasattr(ego, Uniform('corners', 'foo'))"),
    "getattr of a member of the releases": ("", "getattr(ego, Uniform('corners', 'foo'), 1)"),
    "hasattr of a random subject": ("", "hasattr(Uniform(ego, 1), 'width')"),
    "getattr": ("", "getattr(ego, Uniform('width', 'length')) == 1"),
    "getattr's default": ("", "getattr(ego, Uniform('foo', 'length'), 3) == 3"),
    "callable": ("", "callable(Uniform(1, ego))"),
    "type": ("", "type(Uniform(1, 'a')) is int"),
    "isinstance with a random class": ("", "isinstance(1, Uniform(int, str))"),
    "issubclass with a random class": ("", "issubclass(bool, Uniform(int, str))"),
    "str of an object at a random place": ("a = Object at Range(3, 4) @ 5\n", "str(a) == ''"),
}


@pytest.mark.parametrize("claim", BRANCHES)
def test_random_result_decides_no_branch(claim):
    before, condition = BRANCHES[claim]
    with pytest.raises(errors.RandomBranch):
        scenic_ref.loads(f"{EGO}{before}if {condition}:\n    pass\n").sample()


REFUSALS = {
    "pop from a dict": ("d = {1: 2, 3: 4}\nd.pop(Uniform(1, 3))\n", "pop() would make"),
    "pop from a list": ("xs = [1, 2]\nxs.pop(Uniform(0, 1))\n", "pop() would make"),
    "insert": ("xs = [1]\nxs.insert(Uniform(0, 1), 3)\n", "insert() would make"),
    "sort by a random key": ("u = Uniform(1, 2)\nxs = [1, 2]\nxs.sort(key=lambda x: u * x)\n", "sort() would make"),
    "sort random elements": ("xs = [Uniform(1, 2), 1]\nxs.sort()\n", "sort() would make"),
    "discard": ("s = {1}\ns.discard(Uniform(1, 2))\n", "discard() would make"),
    "add": ("s = {1}\ns.add(Uniform(1, 2))\n", "add() would make"),
    "update with random keys": ("d = {1: 2}\nd.update([(Uniform(1, 2), 3)])\n", "update() would make"),
    "del": ("xs = [1, 2]\ndel xs[Uniform(0, 1)]\n", "index of an assignment"),
    "a random slice": ("xs = [1, 2]\nxs[Uniform(0, 1):] = [3]\n", "index of an assignment"),
    "|= on a set": ("s = {1}\ns |= {Uniform(1, 2)}\n", "with a random operand"),
    "a property": (CHOICE + "u.width = 2\n", "which instance of Object"),
    "a new property": (CHOICE + "u.foo = 1\n", "which instance of Object"),
    "setattr": (CHOICE + "setattr(u, 'foo', 1)\n", "which instance of Object"),
    "an attribute of an instance of a Python class": (BOX + "u = Uniform(Box(1), Box(2))\nu.x = 3\n", "which Box"),
    "append to a random list": ("u = Uniform([1], [2])\nu.append(3)\n", "which list"),
    "an element of a random list": ("u = Uniform([1], [2])\nu[0] = 3\n", "which list"),
    "del in a random list": ("u = Uniform([1], [2])\ndel u[0]\n", "which list"),
    "+= on a random list": ("u = Uniform([1], [2])\nu += [9]\n", "which list"),
    "extend by a random number of elements": ("xs = [1]\nxs.extend(Uniform([1], [2, 3]))\n", "how many elements this has"),
    "** with random names": ("def f(x): return x\nparam r = f(**Uniform({'x': 1}, {'x': 2}))\n", "which arguments"),
    "iteration over what is random": (
        "u = Uniform([1], [2])\nclass A(object):\n    def __iter__(self): return iter(u)\nfor v in A():\n    pass\n", "what its iterator gives",
    ),
    "a draw in __iter__": (
        "class A(object):\n    def __iter__(self): return iter([Uniform(1, 2)])\nparam r = [*A()]\n", "draws a random value while library code",
    ),
    "print as a key": ("param r = sorted([1, 2], key=print)\n", "library code cannot call print"),
    "super": ("param r = super()\n", "super() stands in a method"),
    "super of a random class": ("class A(object): pass\nclass B(A): pass\nparam r = super(Uniform(A, B), B())\n", "super(C, v) needs a class"),
    "super of a random value": (BOX + "param r = super(Box, Uniform(Box(1), Box(2)))\n", "whose classes super() looks through"),
    "super of object, with arguments": (
        "class A(object):\n    def __init__(self): super().__init__(3)\nparam r = A()\n", "takes exactly one argument",
    ),
    "super of a container, with too many arguments": (
        "class A(list):\n    def __init__(self): super().__init__(3, 4)\nparam r = A()\n", "expected at most 1",
    ),
    "super of a container, a method that it lacks": (
        "class A(list):\n    def f(self): return super().get(3)\nparam r = A().f()\n", "super() has no attribute get",
    ),
    "a special method of a Scenic class": ("class A:\n    def __str__(self): return 'a'\n", "a Scenic class cannot say what __str__ is"),
    "super of another class": (BOX + "param r = super(int, Box(1))\n", "super(C, v) needs a class"),
}


@pytest.mark.parametrize("claim", REFUSALS)
def test_change_that_would_be_random_is_refused(claim):
    program, message = REFUSALS[claim]
    with pytest.raises(errors.ScenicError) as caught:
        scenic_ref.loads(EGO + program).sample()
    assert message in caught.value.message


def test_a_method_that_all_chosen_instances_share_is_called_on_the_random_instance():
    program = "class C:\n    def area(self):\n        return self.width * 2\nego = C\nb = C at (5, 5), with width 3\n"
    program += "param r = Uniform(ego, b).area()\n"
    found = {scenic_ref.loads(program).sample(0, index).params["r"] for index in range(20)}
    assert found == {2, 6}


def test_an_exception_that_depends_on_a_draw_may_not_be_caught():
    program = "ego = Object\nx = Uniform(0, 1)\ntry:\n    y = 1 / x\nexcept ZeroDivisionError:\n    pass\n"
    with pytest.raises(errors.RandomBranch, match="ZeroDivisionError"):
        for index in range(20):
            scenic_ref.loads(program).sample(0, index)


OWN_ERROR = "class E(Exception):\n    def __init__(self, x): self.x = x\n"


@pytest.mark.parametrize("statement", ["assert False, x", "raise ValueError(x)", "raise E(x)"])
def test_a_handler_may_not_see_what_an_exception_is_made_of_if_that_is_drawn(statement):
    program = f"ego = Object\nx = Uniform(1, 2)\n{OWN_ERROR}try:\n    {statement}\nexcept Exception as e:\n    param r = str(e)\n"
    with pytest.raises(errors.RandomBranch, match="that this catches") as caught:
        scenic_ref.loads(program).sample()
    assert caught.value.span.line == 7


@pytest.mark.parametrize(("statement", "text"), [
    ("assert False, x", "AssertionError: 2"), ("raise ValueError(x)", "ValueError: 2"), ("raise E(x)", "E: 2"), ("raise E([x, 'a'])", "E: [2, 'a']"),
])  # fmt: skip
def test_an_exception_says_what_was_drawn_in_this_run_and_where_it_was_raised(statement, text):
    with pytest.raises(errors.UncaughtException) as caught:
        scenic_ref.loads(f"ego = Object\nx = Uniform(2, 2)\n{OWN_ERROR}{statement}\n").sample()
    assert (caught.value.message, caught.value.span.line) == (text, 5)


def test_the_text_of_an_exception_that_something_drawn_is_in_is_the_same_in_every_backend():
    scenario = scenic_ref.loads(f"ego = Object\n{OWN_ERROR}e = E(Uniform(1, 2))\nparam r = [str(e), f'{{e}}', repr(e), '%s' % e]\n")
    scenes = [scenario.sample(3, index).params["r"] for index in range(12)]
    assert [s.params["r"] for s in scenario.sample_many(12, 3)] == scenes
    assert {tuple(texts) for texts in scenes} == {(str(n), str(n), f"E({n})", str(n)) for n in (1, 2)}


def test_an_element_that_says_itself_what_it_equals_is_asked_as_in_python() -> None:
    text = "log = []\nclass K(object):\n    def __eq__(self, other):\n        log.append(1)\n        return False\n    def __hash__(self): return 1\n"
    scene = scenic_ref.loads(text + "ego = Object\nfound = 1 in [K(), 1] and 'a' not in {K(): 1}\nparam r = [found, len(log)]\n").sample(seed=0)
    assert scene.params["r"] == [True, 1]


def test_a_parameter_by_two_names_is_an_error() -> None:
    with pytest.raises(errors.RunError, match=r"the parameters of Normal are \(mean, stdDev\)"):
        scenic_ref.loads("ego = Object\nx = Normal(mean=0, stddev=1, stdDev=100)\n").sample(seed=0)


RESAMPLED = """import collections
P = collections.namedtuple('P', ['x', 'y'])
behavior B(x): wait
class Drawn(object):
    def __init__(self): self.x = Range(0, 1)
class Fixed(object):
    def __init__(self): self.x = 1
"""
OPERATION, NO_DRAW = "resample needs one of the built-in distributions", "resample needs a value drawn from a distribution"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("(Range(0, 1), Range(0, 1))", OPERATION), ("(1, (2, Range(0, 1)))", OPERATION), ("Range(0, 1) @ 3", OPERATION),
        ("P(Range(0, 1), 2)", OPERATION), ("frozenset([Range(0, 1)])", OPERATION), ("[Range(0, 1)]", OPERATION),
        ("collections.deque([Range(0, 1)])", OPERATION), ("{1: Range(0, 1)}.values()", OPERATION), ("ValueError(Range(0, 1))", OPERATION),
        ("Drawn()", OPERATION), ("B(Range(0, 1))", OPERATION), ("CircularRegion(0 @ 0, Range(1, 2))", OPERATION),
        ("ego", NO_DRAW), ("Point at 1 @ 2", NO_DRAW), ("OrientedPoint at 1 @ 2", NO_DRAW), ("(ego, 1)", NO_DRAW), ("(1, [2])", NO_DRAW),
        ("Fixed()", NO_DRAW), ("(1, Fixed())", NO_DRAW), ("[1]", NO_DRAW), ("collections.deque([1])", NO_DRAW),
        ("{1: 2}.values()", NO_DRAW), ("(i for i in [1])", NO_DRAW),
    ],
)  # fmt: skip
def test_resample_refuses_what_no_distribution_gave(value: str, message: str) -> None:
    """Readings `resample` and `resample-constant`: it would be the same value again, though that is random or can change."""
    with pytest.raises(errors.RunError) as raised:
        result_of(f"{RESAMPLED}v = {value}\nparam r = resample(v)\n")
    assert raised.value.message.startswith(message)
    assert (raised.value.rule, raised.value.span.line) == ("E-Resample", 10)


@pytest.mark.parametrize("value", ["3", "'a'", "None", "(1, 2)", "(1, ('a', frozenset([2])))", "P(1, 2)", "1 @ 2", "B(1)", "everywhere"])
def test_resample_of_a_value_that_cannot_vary_is_that_value(value: str) -> None:
    assert result_of(f"{RESAMPLED}v = {value}\nparam r = resample(v) == v\n") is True


@pytest.mark.parametrize("value", ["(Range(0, 1), 3)[0]", "[Range(0, 1)][0]", "Uniform((Range(0, 1), 2), (Range(0, 1), 4))"])
def test_resample_of_a_draw_that_stood_in_a_container_is_another_draw(value: str) -> None:
    assert any(not scenic_ref.loads(f"{EGO}v = {value}\nparam r = resample(v) == v\n").sample(seed=n).params["r"] for n in range(9))


DRAWN = EGO + "u = Uniform([1, 2], [3])\nx = Range(0, 3)\n"
LOSSES = {
    "append": "seen = []\nfilter(lambda v: seen.append(v) is None, u)",
    "a method as the function": "seen = []\nfilter(seen.append, u)",
    "global": "g = 0\ndef f(v):\n    global g\n    g = v\nfilter(f, u)",
    "nonlocal": "def g():\n    n = 0\n    def f(v):\n        nonlocal n\n        n += 1\n    filter(f, u)\n    return n\ng()",
    "an entry": "d = {}\ndef f(v):\n    d['a'] = v\nfilter(f, u)",
    "an attribute": "class A(object):\n    pass\na = A()\ndef f(v):\n    a.v = v\nfilter(f, u)",
    "an attribute of a class": "class A(object):\n    pass\ndef f(v):\n    A.v = v\nfilter(f, u)",
    "a count of calls": "n = [0]\ndef f(v):\n    n[0] += 1\nfilter(f, u)",
    "an iterator": "it = iter([1, 2, 3])\nfilter(lambda v: next(it) > 0, u)",
    "a generator": "it = (i for i in range(9))\nfilter(lambda v: next(it) >= 0, u)",
    "a default value": "def f(v, s=[]):\n    s.append(v)\nfilter(f, u)",
    "a property": "ego = Object with tag []\nfilter(lambda v: ego.tag.append(v) is None, u)",
    "by another function": "seen = []\ndef g(v):\n    seen.append(v)\nd = {'g': g}\nfilter(lambda v: d['g'](v), u)",
    "max": "seen = []\nmax(u, key=lambda v: seen.append(v) or 1)",
    "min": "seen = []\nmin(u, key=lambda v: seen.append(v) or 1)",
    "sorted": "seen = []\nsorted(u, key=lambda v: seen.append(v) or 1)",
    "reduce": "import functools\nseen = []\nfunctools.reduce(lambda a, b: seen.append(b) or b, [x, 1])",
    "a comparison": "import functools\nn = []\nsorted([x, 1, 0], key=functools.cmp_to_key(lambda a, b: n.append(1) or a - b))",
    "an index": "class A(object):\n    def __getitem__(self, i):\n        self.v = i\nA()[x]",
    "an operator": "class A(object):\n    def __add__(self, o):\n        self.v = o\nA() + x",
    "a property of a choice": "class A(object):\n    @property\n    def p(self):\n        self.v = 1\nUniform(A(), A()).p",
    "the truth of a choice": "class A(object):\n    def __bool__(self):\n        self.v = 1\n        return True\nnot Uniform(A(), A())",
    "the orientation of a region": (
        "seen = []\nF = VectorField('F', lambda p: (seen.append(p.x), 0)[1])\n"
        "o = Object on PolygonalRegion([(5, 5), (15, 5), (15, 15)], orientation=F)"
    ),
    "a vector field": "seen = []\nF = VectorField('F', lambda p: (seen.append(p.x), 0)[1])\ny = F at (x, 0)",
}  # fmt: skip


@pytest.mark.parametrize("program", LOSSES.values(), ids=LOSSES)
def test_a_function_that_library_code_calls_with_drawn_values_changes_nothing_outside(program: str) -> None:
    with pytest.raises(errors.RunError, match="changes something outside of it while library code calls it with values that a draw decides"):
        scenic_ref.loads(DRAWN + program).sample()


KEEPING = {
    "its own containers": "def f(v):\n    xs = [3]\n    xs.append(v)\n    xs.sort()\n    return {'a': xs}['a'][0] < 3\nparam r = filter(f, u)",
    "its own comprehension": "param r = filter(lambda v: all([w > 1 for w in [v, 2]]), u)",
    "its own objects": "class A(object):\n    pass\ndef f(v):\n    a = A()\n    a.v = v\n    return a.v > 1\nparam r = filter(f, u)",
    "its own generator": "def f(v):\n    it = (w for w in [v, 3])\n    return next(it) < 3\nparam r = filter(f, u)",
    "its own variables, by a function that library code calls": (
        "def f(v):\n    n = []\n    sorted([v, 2], key=lambda w: n.append(w) or w)\n    return len(n) == 2\nparam r = filter(f, u)"
    ),
    "what is not drawn": "seen = []\nfilter(lambda v: seen.append(v) is None, [1, x])\n"
    "max([1, 2], key=lambda v: seen.append(v) or v * x)\nparam r = seen",
}  # fmt: skip


@pytest.mark.parametrize("program", KEEPING.values(), ids=KEEPING)
def test_a_function_that_library_code_calls_with_drawn_values_may_change_what_it_made(program: str) -> None:
    assert scenic_ref.loads(DRAWN + program).sample() is not None


FILTERS = {
    "a comprehension": "ys = filter(lambda v: all([w > 1 for w in v]), Uniform([[1], [2, 3]], [[4, 5], [6]]))",
    "a branch": "def f(v):\n    if v > 1:\n        return True\nys = filter(f, Uniform([1, 2], [3, 4]))",
    "a draw": "ys = filter(lambda v: Range(0, 5) > v, Uniform([1, 2], [3, 4]))",
    "a draw at times": "ys = filter(lambda v: v > 1 and Range(0, 5) > v, Uniform([1, 2], [3, 4]))",
    "a change": "seen = []\nys = filter(lambda v: seen.append(v) is None, Uniform([1, 2], [3, 4]))\nparam seen = seen",
    "objects": "ys = filter(lambda v: (Object at (v * 5, v * 5)) is not None, Uniform([1, 2], [3, 4]))",
    "texts": "ys = filter(lambda v: v > 'b', Uniform('ab', 'cd'))",
    "dictionaries": "ys = filter(lambda v: v > 'b', Uniform({'a': 1}, {'c': 2}))",
    "random elements": "x = Range(0, 3)\nys = filter(lambda v: v > 1, Uniform([x, 2], [3, x]))",
    "another filter": "u = Uniform([1, 2, 5], [3, 4, 7])\nys = filter(lambda v: len(filter(lambda w: w > v, u)) > 1, u)",
    "vectors": "ys = filter(lambda v: v > 1, Uniform(1 @ 2, 3 @ 4))",
    "no function": "ys = filter(None, Uniform([0, 2], [3, 4]))",
}  # fmt: skip


@pytest.mark.parametrize("program", FILTERS.values(), ids=FILTERS)
def test_filter_means_the_same_whether_drawn_lists_are_equally_long(program: str) -> None:
    scenario = scenic_ref.loads(EGO + program + "\nparam n = len(ys), after = Range(0, 1)\n")
    many, one_by_one = (list(scenario.sample_many(200, 1, backend=backend)) for backend in ("auto", "interpreter"))  # type: ignore[arg-type]
    assert [scene.to_json() for scene in many] == [scene.to_json() for scene in one_by_one]
