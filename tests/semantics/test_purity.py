"""`step` is a function: a configuration that is stepped again gives the same outcome, whatever was stepped in the meantime.

Outcomes are compared by all that a program can reach from their states. The rivals: a machine that notes nothing, and one that forgets the notes of
one kind.
"""

from __future__ import annotations

import enum
import gc
import hashlib
import pickle
import random
from collections import defaultdict
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

import pytest
import scenic_ref
from scenic_ref.conformance import load_vectors
from scenic_ref.conformance.implementations.protocol import Refused
from scenic_ref.conformance.implementations.reference import Ourselves
from scenic_ref.conformance.judge import fired_in
from scenic_ref.interpreter.runtime import program_run
from scenic_ref.semantics.machine.config import Config, State
from scenic_ref.semantics.machine.outcome import Draw, Outcome
from scenic_ref.semantics.machine.sandbox_table import ATTRIBUTES, is_user_made
from scenic_ref.semantics.machine.values import Bound, Dynamic, Function, Method, Module, Random
from scenic_ref.semantics.step import step
from scenic_ref.semantics.store import budget, scopes, undo_log
from scenic_ref.semantics.store.budget import Metered
from scenic_ref.semantics.store.containers import Counter, OrderedDict, deque
from scenic_ref.semantics.store.errors import without_addresses
from scenic_ref.semantics.store.generators import Generator
from scenic_ref.semantics.store.scopes import Scope
from scenic_ref.semantics.store.sets import Set
from scenic_ref.semantics.store.undo_log import STORED, content_of

from .stepping import stepping

LONG, NUMBERS = 1000, {bool, int, float, type(None)}
"""Longer lists of nothing but these are compared by a digest: millions of elements, written out for each configuration, would take all memory."""


def told(value: Any, seen: dict[int, tuple[int, object]]) -> object:
    """All that a program can reach from a value, as something to compare; `seen` numbers what was met before."""
    if isinstance(value, (bool, int, float, str, bytes, type(None))) and not is_user_made(value):
        return repr(value) if not isinstance(value, int) or value.bit_length() < 1000 else hex(value)  # too long for a decimal one
    if id(value) in seen:
        return ("again", seen[id(value)][0])
    seen[id(value)] = (len(seen), value)
    match value:
        case Scope():
            around = None if value.parent is None or value.parent.kind == "builtins" else told(value.parent, seen)
            return (value.kind, [(name, told(bound, seen)) for name, bound in value.bindings.items()], around)
        case Random():
            return ("random", told(value.value, seen))
        case Function():
            return (value.name, told(value.scope, seen), told(dict(value.defaults), seen))
        case Method():
            return (told(value.function, seen), told(value.instance, seen))
        case Module():
            return (value.name, told(value.scope, seen))
        case Dynamic():
            return (repr(value), None if value.space is None else told(value.space, seen))
        case Metered():
            return "iterator"
        case enum.auto():
            return "auto"
        case Generator():
            frame, scope = value.suspended or (None, None)
            return (value.running, value.place, [told(part, seen) for part in (value.ahead, scope, getattr(frame, "sources", ()))])
        case Bound():
            return (value.name, told(value.subject, seen))
        case type() if is_user_made(value):
            return (value.__name__, [(n, told(v, seen)) for n, v in vars(value).items() if not (n.startswith("_") and n.endswith("_"))])
        case dict():
            parts: object = [(told(k, seen), told(v, seen)) for k, v in dict.items(value)]
        case Set():
            parts = [told(v, seen) for v in value.order]
        case list() if len(value) > LONG and set(map(type, list.__iter__(value))) <= NUMBERS:
            parts = hashlib.blake2b(pickle.dumps(list(list.__iter__(value)))).digest()
        case list():
            parts = [told(v, seen) for v in list.__iter__(value)]
        case tuple() | frozenset():
            parts = [told(v, seen) for v in value]
        case BaseException():
            parts = [told(v, seen) for v in value.args]
        case deque():
            parts = [told(v, seen) for v in value]
        case _:
            parts = without_addresses(repr(value)) if not is_user_made(value) else ""
    return (type(value).__name__, parts, told(vars(value), seen) if is_user_made(value) and hasattr(value, "__dict__") else None)


def state_told(state: State) -> object:
    """All that a program can reach from a state."""
    seen: dict[int, tuple[int, object]] = {}
    shared = [state.sigma, dict(state.params), {n: dict(p) for n, p in state.objects.items()}, state.ego, state.workspace, dict(state.modules)]
    return ([told(part, seen) for part in shared], state.scene, state.draws, state.depth, state.made)


def outcome_told(outcome: Outcome) -> object:
    """What an outcome says, with all that a program can reach from it."""
    parts: list[object] = [type(outcome).__name__, getattr(outcome, "rule", "")]
    for part in outcome:
        if isinstance(part, Config):
            control = getattr(part.control, "value", None)
            stack, depth = part.stack, 0
            while stack:
                stack, depth = stack[1], depth + 1
            parts += [type(part.control).__name__, getattr(part.control, "kind", ""), told(control, {}), depth, state_told(part.state)]
        elif isinstance(part, State):
            parts.append(state_told(part))
        elif isinstance(part, Exception):
            parts.append(str(part))
    if isinstance(outcome, Draw):
        parts += [outcome.address, outcome.distribution.name, told(vars(outcome.distribution), {})]  # not its `repr`, which writes a shared part again and again
    return parts


class Kept(NamedTuple):
    """A configuration, what was left of the budget before its step, which is not taken back (`docs/machine.md`), and what the step said."""

    config: Config
    left: int
    told: object


class Again:
    """A step function that steps many configurations again, the present one and older ones, and compares; `share` says how many it keeps, `most` at most how many, spread over the whole run."""

    def __init__(self, share: float, seed: int = 0, most: int = 1000) -> None:
        self.share = share
        self.most = most
        self.random = random.Random(seed)
        self.kept: list[Kept] = []
        self.met = self.compared = 0

    def __call__(self, config: Config) -> Outcome:
        """One step, perhaps the second of its configuration."""
        budget = config.state.settings.door.budget
        before = budget.left
        outcome = step(config)
        if self.random.random() >= self.share:
            return outcome
        self.met += 1
        if len(self.kept) == self.most and self.random.random() * self.met >= self.most:
            return outcome
        kept, after = Kept(config, before, outcome_told(outcome)), budget.left
        if len(self.kept) == self.most:
            self.kept.pop(self.random.randrange(self.most))
        self.kept.append(kept)
        self.compare(self.random.choice(self.kept))
        self.compare(kept)
        budget.left = before
        outcome = step(config)
        budget.left = after
        return outcome

    def compare(self, kept: Kept) -> None:
        """Step it again, unless its run was driven on from a later one: the next time step of a simulation."""
        kept.config.state.settings.door.budget.left = kept.left
        try:
            again = outcome_told(step(kept.config))
        except undo_log.DrivenOn:
            return
        if again != kept.told:  # not `assert`: its report of two big outcomes would take gigabytes
            raise AssertionError(f"stepped again, another outcome at {scenic_ref.semantics.step.place(kept.config)}")
        self.compared += 1

    def compare_all(self) -> None:
        """Step everything that was kept once more, in another order."""
        for kept in self.random.sample(self.kept, len(self.kept)):
            self.compare(kept)


CHANGES = {
    "a variable": "x = 1\nx += 1\nx = x * 3\ndel x\nx = 4\n",
    "a nonlocal variable": "def make():\n    n = 0\n    def up():\n        nonlocal n\n        n += 1\n        return n\n    return up\nf = make()\nf()\nf()\n",
    "a loop": "s = 0\nfor i in range(4):\n    s = s + i\nelse:\n    s = -s\n",
    "a comprehension": "xs = [i * j for i in range(3) for j in range(i)]\n",
    "except as": "try:\n    1 / 0\nexcept ZeroDivisionError as e:\n    y = str(e)\nz = 1\n",
    "a list": "xs = [3, 1, 2]\nxs.append(9)\nxs[0] = 7\nxs.sort()\nxs.insert(1, 5)\nxs.pop()\nxs.pop(0)\nxs += [4, 4]\nxs *= 2\nxs[1:3] = [8]\n"
    "del xs[0]\nxs.remove(4)\nxs.reverse()\nxs.extend(xs)\nys = xs\nys.clear()\n",
    "random elements": "xs = [Range(0, 1)]\nxs.append(Range(1, 2))\nxs[0] = Range(3, 4)\nxs += [Uniform(1, 2)]\n",
    "a dictionary": "d = {'a': 1, 'b': 2}\nd['c'] = 3\nd['a'] = 9\ndel d['a']\nd['a'] = 4\nd.setdefault('q', []).append(1)\nd.update({'b': 0})\nd.popitem()\n"
    "d.pop('b')\nd |= {'z': 1}\nd[(1, 2)] = 3\nd[1.0] = 4\nd[True] = 5\n",
    "a set": "s = {1, 2}\ns.add(3)\ns.discard(1)\ns |= {7, 8}\ns -= {2}\ns.pop()\ns.update([4])\ns.remove(4)\ns.clear()\n",
    "a deque": "from collections import deque\nd = deque([1, 2, 3], 4)\nd.append(4)\nd.append(5)\nd.appendleft(0)\nd.rotate(1)\nd.popleft()\nd[0] = 9\ndel d[1]\n"
    "d.extendleft([6])\nd += [1]\n",
    "a Counter": "from collections import Counter\nc = Counter('abca')\nc['a'] += 1\nc.update('zz')\nc.subtract('ab')\nc += Counter('q')\n",
    "a defaultdict": "from collections import defaultdict\nd = defaultdict(list)\nd['a'].append(1)\nd['b']\nd['a'] += [2]\nx = [d[k] for k in ('p', 'q')]\n",
    "an OrderedDict": "from collections import OrderedDict\nd = OrderedDict()\nd['a'] = 1\nd['b'] = 2\nd.move_to_end('a')\nd['a'] = 3\nd.popitem(False)\ndel d['a']\n",
    "an instance": "class P(object):\n    def __init__(self):\n        self.n = 0\n    def up(self):\n        self.n += 1\np = P()\np.up()\np.m = [p.n]\np.m.append(2)\n",
    "an attribute of a class": "class P(object):\n    n = 0\np = P()\nP.n = 1\nP.n = 2\nP.m = 3\np.n = 5\nsetattr(P, 'm', 4)\n",
    "a property": "class P(object):\n    def get(self):\n        return self.v\n    def put(self, x):\n        self.v = x\n    w = property(get, put)\np = P()\np.w = 1\np.w = 2\n",
    "a class below list": "class S(list):\n    def __init__(self, xs):\n        list.__init__(self, xs)\n    def push(self, x):\n        self.append(x)\n        self.last = x\n"
    "s = S([1])\ns.push(2)\ns.push(3)\ns[0] = 8\nlist.__init__(s, [5])\ndel s[0]\n",
    "a class below dict": "class D(dict):\n    def __setitem__(self, k, v):\n        dict.setdefault(self, k, [])\n        self.get(k).append(v)\nd = D()\nd['a'] = 1\nd['a'] = 2\n",
    "an unbound method": "xs = [1]\nlist.append(xs, 2)\nlist.sort(xs)\nf = xs.append\nf(3)\ns = {1}\ng = s.add\ng(5)\n",
    "callbacks of library code": "xs = []\nys = max([3], key=xs.append)\nzs = list(map(xs.append, [7]))\ndef f(a, b):\n    xs.append(a)\n    return a + b\n"
    "import functools\nt = functools.reduce(f, [1, 2, 3])\nseen = {}\ndef key(v):\n    seen[v] = len(seen)\n    return -v\nx2 = sorted([1, 2, 3], key=key)\n"
    "m = max([1, 2], key=key)\ng = functools.partial(xs.append, 5)\ng()\n",
    "an iterator": "it = iter([1, 2, 3])\na = next(it)\nb = next(it)\nc = list(it)\nd = next(it, None)\n",
    "iterators of iterators": "import itertools\na = iter('abcdef')\nb = itertools.chain(a, [9])\nx = next(b)\ny = next(a)\nz = [*b]\n"
    "c = itertools.count(3)\np = [next(c), next(c)]\nq, r = itertools.tee([1, 2, 3])\nnext(q)\ns = list(r)\nfor v in zip(c, [1, 2]):\n    w = v\n",
    "a tuple that holds a list": "t = ([1], {})\nt[0].append(2)\nt[1]['a'] = t\n",
    "a default argument": "def f(x, xs=[]):\n    xs.append(x)\n    return xs\nf(1)\nf(2)\n",
    "a global": "n = 0\ndef f():\n    global n\n    n += 1\nf()\nf()\n",
    "a parameter": "xs = [1]\nparam xs = xs\nxs.append(2)\nparam y = 3\nparam y = 4\n",
    "properties": "o = Object at 5 @ 5, with tag [1]\no.tag.append(2)\no.tag = 3\nego.width = Range(1, 2)\n",
    "a soft requirement": "xs = [1]\nrequire[0.5] xs[0] == 1\nxs[0] = 2\nrequire xs[0] == 2\nxs.append(3)\n",
    "an exception's text": "class E(Exception):\n    pass\ne = E('a')\ne.n = 1\ntry:\n    raise e\nexcept E as f:\n    f.n = 2\n",
    "an exception that is made by its class": "class E(Exception):\n    def __init__(self, a):\n        self.n = str(self)\n        Exception.__init__(self, 'x', a)\n        self.m = str(self)\n"
    "e = E(1)\ns = StopIteration(1)\nt = str(s)\n",
    "what is refused": "from enum import Enum\nfrom collections import namedtuple\nclass Color(Enum):\n    RED = 1\ntry:\n    Color.RED = 5\nexcept AttributeError:\n    y = 1\n"
    "P = namedtuple('P', 'x')\np = P(1)\ntry:\n    p.x = 3\nexcept AttributeError:\n    z = 2\n",
    "a factory that takes": "from collections import defaultdict\nxs = [1, 2, 3]\nd = defaultdict(xs.pop)\nd['a']\nd['b']\n",
    "hashes of the program": "class K(object):\n    def __hash__(self):\n        self.w = ego.width\n        return 3\nk = K()\nx = abs(-1)\nego.width = 5\nd = {k: 1}\ny = k.w\n",
    "a module": "import math as m\nfrom math import pi\nx = m.sin(pi)\n",
    "a lambda": "fs = []\nfor i in range(3):\n    fs.append(lambda: i)\nxs = [f() for f in fs]\n",
}  # fmt: skip


def run_twice(program: str, watching: Again, readings: dict[str, str] | None = None) -> None:
    """Sample a scene of a program with another step function."""
    scenario = scenic_ref.loads("ego = Object\n" + program, readings=readings or {})
    with stepping(watching):
        scenario.sample(seed=0, max_attempts=50)
    watching.compare_all()


@pytest.mark.sampled(8)
@pytest.mark.parametrize("capture", ["statement", "end"])
@pytest.mark.parametrize("change", CHANGES)
def test_every_kind_of_change_is_taken_back(change: str, capture: str) -> None:
    watching = Again(share=1.0)
    run_twice(CHANGES[change], watching, {"require-time": capture})
    assert watching.compared > 3 * 5


def test_what_a_requirement_changes_that_is_decided_anew_is_taken_back() -> None:
    watching = Again(share=1.0)
    program = "xs = []\ndef f(v):\n    xs.append(v)\n    if v > 0.5:\n        xs.append(v)\n        return True\n    return False\nx = Range(0, 1)\n"
    run_twice(program + "require f(x)\nxs.append(3)\nparam n = len(xs)\n", watching, {"random-branch": "in-requirements"})
    assert watching.compared > 3 * 5


def test_what_scenarios_bind_that_are_set_up_and_given_up_is_taken_back() -> None:
    """The precondition of the second is false: what the first has bound, whose scope is filled again, must not stay."""
    program = (
        "scenario A(n=1):\n    setup:\n        x = n\n        y = x + 1\n        Object at 20 @ y, with requireVisible False\n    compose:\n        wait\n"
        "scenario B():\n    precondition: False\n    setup:\n        z = 3\n"
        "scenario Main():\n    setup:\n        ego = Object\n    compose:\n        try:\n            do A(), B()\n"
        "        except GuardViolation:\n            wait\n        do A(2)\n"
    )
    watching = Again(share=1.0)
    scenario = scenic_ref.loads(program)
    with stepping(watching):
        scenario.simulate("still", 3, max_attempts=5, backend="interpreter")
    watching.compare_all()
    assert watching.compared > 100


@pytest.mark.parametrize("seed", range(3))
def test_what_was_kept_of_one_run_is_stepped_in_any_order(seed: int) -> None:
    watching = Again(share=0.3, seed=seed)
    run_twice("".join(CHANGES[c] for c in ("a list", "a dictionary", "an instance", "an iterator", "callbacks of library code")), watching)
    assert watching.compared > 60


FORGOTTEN: dict[str, tuple[Any, str, list[str]]] = {
    "variables": (scopes, "Entry", ["a variable", "a nonlocal variable", "a loop"]),
    "items": (undo_log, "Item", ["a list", "random elements"]),
    "what was appended": (undo_log, "Tail", ["a list", "random elements", "a lambda"]),
    "contents": (undo_log, "Content", ["a list", "a set", "a deque", "an OrderedDict"]),
    "entries": (undo_log, "Entry", ["a dictionary", "a defaultdict", "an instance"]),
    "attributes of classes": (undo_log, "Slot", ["an attribute of a class"]),
    "places of iterators": (budget, "Slot", ["an iterator"]),
}


class Nothing:
    """A note that takes nothing back."""

    before = undo_log.MISSING

    def __init__(self, *_: object) -> None:
        pass

    def undo(self) -> Nothing:
        """Nothing."""
        return self


@pytest.mark.parametrize("kind", FORGOTTEN)
def test_the_comparison_notices_a_kind_of_note_that_is_forgotten(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, name, changes = FORGOTTEN[kind]
    monkeypatch.setattr(module, name, Nothing)
    for change in changes:
        with pytest.raises(AssertionError):
            run_twice(CHANGES[change], Again(share=1.0))


FILLED: list[Callable[[], Any]] = [
    lambda: [3, 1, 2], lambda: {"a": 1, "b": 2}, lambda: Set([1, 2]), lambda: deque([3, 1, 2]), lambda: Counter("aab"),
    lambda: OrderedDict(a=1, b=2), lambda: defaultdict(list, a=1),
]  # fmt: skip
ARGUMENTS: list[tuple[Any, ...]] = [(), (1,), ("a",), ([7],), ({"q": 7},), ({1},), (0, 1), ("a", 5), ("z", 5)]


@pytest.mark.parametrize("make", FILLED, ids=[type(make()).__name__ for make in FILLED])
def test_every_method_that_changes_a_container_is_known(make: Callable[[], Any]) -> None:
    names = {name for kind in type(make()).__mro__ for name in ATTRIBUTES.get(kind, ())}
    assert len(names) > 5
    for name in sorted(names):
        for arguments in ARGUMENTS:
            container, as_it_was = make(), content_of(make())
            with suppress(Exception):  # not every method takes every argument
                getattr(container, name)(*arguments)
            if repr(content_of(container)) != repr(as_it_was):
                assert name in STORED, name


def test_a_draw_that_was_kept_is_answered_in_its_own_version():
    seen: list[tuple[Draw, object]] = []

    def keep(config: Config) -> Outcome:
        outcome = step(config)
        if isinstance(outcome, Draw) and outcome.distribution.name == "Uniform":
            items = config.state.sigma.lookup("xs")
            seen.append((outcome, items))
        return outcome

    with stepping(keep):
        scenic_ref.loads("ego = Object\nxs = [Range(0, 1)]\ny = Uniform(xs, xs)\nxs.append(5)\n").sample(seed=0)
    draw, items = seen[-1]
    assert len(items) == 2  # type: ignore[arg-type]
    draw.resume(items)
    assert len(items) == 1  # type: ignore[arg-type]


LOOP = "require ego.width < 20\nxs = [0] * 50\nfor i in range(300):\n    x = i\n    xs.pop() if xs else xs.extend([1])\n"


@pytest.mark.slow
@pytest.mark.parametrize("program", [LOOP, "behavior B():\n    x = 0\n    while True:\n        x = x + 1\n        take 1\nego = Object with behavior B\n"])
def test_a_run_keeps_nothing_that_only_served_to_go_back(program: str) -> None:
    before: list[undo_log.Version] = []  # of other tests: kept, so that no new one has the identity of one of them
    alive: list[int] = []

    def living() -> list[undo_log.Version]:
        return [thing for thing in gc.get_objects() if type(thing) is undo_log.Version]

    def watch(config: Config) -> Outcome:
        outcome = step(config)
        if len(alive) < 4000:
            alive.append(len({*map(id, living())} - {*map(id, before)}) if len(alive) % 200 == 199 else 0)
        return outcome

    scenario = scenic_ref.loads(program if "ego" in program[:4] or "behavior" in program else "ego = Object\n" + program)
    gc.collect()
    before += living()
    with stepping(watch):
        if "behavior" in program:
            scenario.simulate(steps=100, seed=0, backend="interpreter")
        else:
            scenario.sample(seed=0)
    assert len(alive) > 400 and max(alive) < 40, max(alive)


def test_a_configuration_that_was_driven_on_says_so():
    config = scenic_ref.loads("ego = Object\n").start()
    program_run.generate_scene(config, lambda draw: draw.distribution.sample(lambda: 0.5))
    with pytest.raises(undo_log.DrivenOn, match="cannot be stepped again"):
        step(config)


def test_a_new_version_is_made_only_where_something_changes() -> None:
    seen = set()

    def watch(config: Config) -> Outcome:
        seen.add(id(config.state.version))
        return step(config)

    with stepping(watch):
        scenic_ref.loads("ego = Object\nx = 1 + 2 + 3 + 4 + 5\ny = 2\n").sample(seed=0)
    assert len(seen) < 60


TAKES_MORE = {"builtin-functions", "iterators-of-the-library"}
"""Have iterators over a function that changes a list: what it did is not taken back (`docs/machine.md`)."""
VECTORS = [v for v in load_vectors() if v.name not in TAKES_MORE and not v.name.startswith("too-m")]
"""Without `too-much-…` and `too-many-…` either, which use up their budget and so take long."""
PARTS = 8


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_configurations_of_the_vectors_can_be_stepped_again(part: int) -> None:
    ours, compared = Ourselves(), 0
    for vector in VECTORS[part::PARTS]:
        watching = Again(share=0.1, seed=part, most=50)
        task = replace(vector.task(next(d for d in ours.dialects if d in vector.texts)), seed=0)
        with stepping(watching), suppress(Refused):
            fired_in(ours, vector, task)
        compared += watching.compared
    assert compared > 1000
