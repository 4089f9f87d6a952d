"""A crawler: from all that a program can name, whatever the machine gives for attributes, elements, iteration and calls, level by level.

What it meets is judged by the table (`allowed.is_value`), deep inside containers as well, and so is what library code hands to the program's own
functions. Values of one signature are looked into a few times, not each.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Iterator

import scenic_ref
from scenic_ref.interpreter.runtime.answerers import from_stream
from scenic_ref.interpreter.runtime.program_run import Accepted, generate_scene
from scenic_ref.semantics.machine import sandbox_table
from scenic_ref.semantics.machine.config import Config, State, Value
from scenic_ref.semantics.machine.host_calls import DoorStuck, HostException
from scenic_ref.semantics.machine.outcome import Draw, Fault, Next, Observe
from scenic_ref.semantics.machine.values import Bound, Function, Method, Native, Random, value_in_run
from scenic_ref.semantics.python import calls
from scenic_ref.semantics.python.expressions import elements, get_attribute, get_item
from scenic_ref.semantics.step import step
from scenic_ref.semantics.store.errors import ScenicError
from scenic_ref.semantics.store.scopes import Scope
from scenic_ref.semantics.store.sets import FrozenSet, Set
from scenic_ref.semantics.syntax import python_expressions as p

LEVELS = 3
PER_SIGNATURE = 2
"""So many values of one signature are looked into."""
STEPS = 300
"""The most steps of one call."""
KEPT = 12
"""So many elements of an iteration are kept."""

KINDS = """
ego = Object at (0, 0)
import math, itertools, functools, collections, enum, random, typing
import scenic.simulators.gta.model as gta
import scenic.simulators.gta.map as gtamap
import scenic.domains.driving.actions as actions
import mars, gtaLib
workspace = Workspace(everywhere)
seen = []
def spy(*arguments, **keywords):
    seen.append(arguments)
    seen.append(keywords)
    return 1
class Plain(object):
    shared = [1]
    def __init__(self, a=1, *rest): self.a = a
    def method(self): return self
    def __getattr__(self, name):
        seen.append(name)
        return name
    def __format__(self, text):
        seen.append(text)
        return 'x'
    def __eq__(self, other):
        seen.append(other)
        return True
    def __lt__(self, other):
        seen.append(other)
        return True
    def __hash__(self): return 1
    def __add__(self, other):
        seen.append(other)
        return other
    def __radd__(self, other):
        seen.append(other)
        return other
    def __getitem__(self, index):
        seen.append(index)
        if index != 0: raise IndexError(index)
        return index
    def __len__(self): return 1
    def __contains__(self, other):
        seen.append(other)
        return True
    def __call__(self, *arguments):
        seen.append(arguments)
        return arguments
    def __round__(self, *digits):
        seen.append(digits)
        return 1
    @property
    def fixed(self): return self
    @staticmethod
    def static(*a): return a
    @classmethod
    def of_class(cls, *a): return cls
class Below(Plain): pass
class Listed(list):
    def __getattr__(self, name): return self
class Mapped(dict):
    def __missing__(self, key):
        seen.append(key)
        return key
class Texted(str): pass
class Numbered(int): pass
class Scaled(float): pass
class Tupled(tuple): pass
class Gathered(set): pass
class Queued(collections.deque): pass
class Counted(collections.Counter): pass
class Ordered(collections.OrderedDict): pass
class Defaulted(collections.defaultdict): pass
class Mistake(Exception):
    def __init__(self, text): self.text = text
class Wrong(ValueError): pass
class Colour(enum.Enum):
    RED = 1
    GREEN = enum.auto()
    def shade(self): return self
class Whole(enum.IntEnum):
    ONE = 1
class Bits(enum.Flag):
    A = 1
    B = 2
Pair = collections.namedtuple('Pair', 'left right')
class Below2(Pair): pass
class Thing:
    size: 3
    def grow(self): return self
behavior Wander(n=1):
    wait
monitor Watch():
    wait
scenario Part(n=1):
    setup:
        inner = 3
def caught(f):
    try: f()
    except Exception as e: return e
values = [
    None, True, 1, -3, 2.5, 1e300, 10**30, complex(1, 2), '', 'a', 'abc {0} %s', b'ab', [], [1, 2, 3], ['b', 'a'], (), (1, 2), ((0, 0), (1, 0), (1, 1)), {}, {'a': 1},
    {1: 'b'}, {1, 2}, frozenset([1]), range(3), slice(1, 2), NotImplemented, spy, lambda *a: a, Plain(), Plain, Below(), Below, Listed([1, [2]]), Listed,
    Mapped({'a': 1}), Mapped, Texted('x'), Texted, Numbered(3), Scaled(2.0), Tupled((1, 2)), Gathered([1]), Queued([1]), Counted('aab'), Ordered(a=1),
    Defaulted(list), Mistake('m'), Mistake, Wrong(1, 2), Colour.RED, Colour, Whole.ONE, Whole, Bits.A | Bits.B, Bits, Pair(1, 2), Pair, Below2(1, 2), Plain().method,
    Plain.method, Plain.static, Plain.of_class, Plain().fixed, Thing, ego, Thing at (9, 9), Point at (1, 2), OrientedPoint at (1, 2), Wander, Wander(), Watch,
    Watch(), Part, Part(), collections.deque([1, 2]), collections.Counter('aab'), collections.OrderedDict(a=1), collections.defaultdict(list, a=[1]), iter([1, 2]),
    itertools.count(), itertools.chain([1], [2]), itertools.tee([1]), itertools.groupby([1, 1]), functools.partial(spy, 1), functools.partial(len),
    functools.cmp_to_key(spy), functools.cmp_to_key(spy)(1), random.Random(3), (0, 0) offset by (1, 2), Vector(1, 2), everywhere, nowhere, CircularRegion((0, 0), 3),
    SectorRegion((0, 0), 3, 0, 1), RectangularRegion((0, 0), 0, 2, 2), PolygonalRegion([(0, 0), (2, 0), (2, 2)]), PolylineRegion([(0, 0), (1, 1)]),
    PointSetRegion('p', [(0, 0), (1, 1)]), Workspace(CircularRegion((0, 0), 9)), CircularRegion((0, 0), 3).intersect(RectangularRegion((0, 0), 0, 2, 2)),
    CircularRegion((0, 0), 3).difference(RectangularRegion((0, 0), 0, 2, 2)), VectorField('f', lambda v: 1), PolygonalVectorField('g', [(PolygonalRegion([(0, 0), (2, 0), (2, 2)]), 1)]),
    Range(0, 1), Uniform(1, 'a', [2]), Discrete({ego: 1}), Normal(0, 1), [Range(0, 1)], {'a': Range(0, 1)}, str.maketrans('a', 'b'), {1: 2}.keys(), {1: 2}.values(),
    {1: 2}.items(), [].append, 'a'.join, {}.get, str.upper, list.append, property(spy), staticmethod(spy), classmethod(spy), caught(lambda: 1 / 0), caught(lambda: {}['a']),
    caught(lambda: [].nope), caught(lambda: int('a')), caught(lambda: len(1)), caught(lambda: 'a' + 1), caught(lambda: next(iter([]))), caught(lambda: ego.nope),
    caught(lambda: CircularRegion('a')), caught(lambda: math.sqrt(-1)), caught(lambda: Pair()), caught(lambda: Colour(7)), caught(lambda: b'\\xff'.decode('utf-8')),
]
"""

TYPICAL = """
ONE = [1, -1, 2.5, 'a', 'b', '{0}', b'a', None, [1, 2], ['b', 'a'], (1, 2), ((0, 0), (1, 0), (1, 1)), {'a': 1}, {1, 2}, spy, Plain(), Plain, ego, Vector(1, 2), everywhere,
       CircularRegion((0, 0), 3), ValueError, Colour.RED, str, iter([1, 2]), Mistake('m'), len, print, Range(0, 1)]
TWO = [(1, 2), ('a', 'b'), ('a', 1), (spy, [1, 2]), ([1, 2], spy), ([1, 2], 1), ({'a': 1}, 'a'), (Plain(), 'a'), (Plain, '__init__'), ((0, 0), 1), (Plain(), [Plain()]),
       ('P', 'a b'), (len, [[1]]), (str, ['a']), (enumerate, [1, 2]), (zip, [[1], [2]]), (type, [1]), (getattr, [1]), (1, Object), (Plain, object), ('utf-8', 'strict')]
MORE = [(1, 2, 3), ('a', 'b', 'c'), ((0, 0), 1, 2), (Plain(), 'a', 1), (spy, [1], [2]), ((0, 0), 3, 0, 1), ((0, 0), 0, 2, 2), (1, 'a', 3, 'b', 5)]
"""


def started() -> State:
    """The state after a program that holds a value of each kind, and the typical arguments of calls."""
    scenario = scenic_ref.loads(KINDS + TYPICAL)
    ended = generate_scene(scenario.start(), from_stream(0, 0, 0))
    assert isinstance(ended, Accepted)
    return ended.state


def inside(value: object, seen: set[int]) -> Iterator[object]:
    """The value and all that it holds: elements, keys, what a random value is, the attributes of what the program made, an exception's arguments."""
    if id(value) in seen:
        return
    seen.add(id(value))
    yield value
    parts: list[object] = []
    if type(value) is Random:
        parts.append(value.value)
    elif isinstance(value, dict):
        parts += [*value.keys(), *value.values()]
    elif isinstance(value, (list, tuple, Set, FrozenSet, set, frozenset, deque)):
        parts += list(value)
    if isinstance(value, BaseException):
        parts += value.args
    if sandbox_table.is_user_made(value) and not isinstance(value, type):
        parts += [v for name, v in getattr(value, "__dict__", {}).items() if not sandbox_table.is_hidden(name)]
    for part in parts:
        yield from inside(part, seen)


class Crawl:
    """One crawl: how many values it met by the way that led there, and those that no program may hold, each with its way."""

    def __init__(self, state: State) -> None:
        bindings = state.sigma.module.bindings
        self.state = state
        self.looked_into: Counter[object] = Counter()
        self.met: Counter[str] = Counter()
        self.types: set[type] = set()
        self.classes: set[type] = set()
        self.strangers: list[str] = []
        self.spied: list[object] = bindings["seen"]  # type: ignore[assignment]
        self.arguments = [(v,) for v in bindings["ONE"]] + [*bindings["TWO"], *bindings["MORE"]]  # type: ignore[attr-defined, misc]
        self.names = sorted({name for names in sandbox_table.ATTRIBUTES.values() for name in names} | DUNDERS | INNARDS)

    def all(self) -> None:
        """Go through everything, level by level."""
        level = list(self.roots())
        for way, value in level:
            self.judge(way, value)
        for _ in range(LEVELS):
            level = [found for way, value in level if self.is_new(value) for found in self.around(way, value)]

    def roots(self) -> Iterator[tuple[str, object]]:
        """All that a program can name."""
        module = self.state.sigma.module
        assert module.parent is not None
        for scope in (module.parent, module, *(m.scope for m in self.state.modules.values())):  # type: ignore[attr-defined]
            yield from scope.bindings.items()
        yield from ((f"values[{i}]", v) for i, v in enumerate(module.bindings["values"]))  # type: ignore[arg-type]

    def is_new(self, value: object) -> bool:
        """Whether too few values of this signature were looked into as yet."""
        self.state.settings.door.budget.left = 2_000_000  # a name may be looked up by a function of the program
        signature = signature_of(value)
        self.looked_into[signature] += 1
        return self.looked_into[signature] <= PER_SIGNATURE

    def judge(self, way: str, value: object) -> None:
        """Note what is no value of a program, in the value or inside it."""
        self.met[way[way.rfind(" ") + 1 :].split("(")[0][:1]] += 1
        for part in inside(value, set()):
            self.types.add(type(part))
            if isinstance(part, type):
                self.classes.add(part)
            if not sandbox_table.is_value(part):
                self.strangers.append(f"{way}: {type(part).__module__}.{type(part).__qualname__} {part!r:.80}")

    def around(self, way: str, value: object) -> Iterator[tuple[str, object]]:
        """What the machine gives for the value's attributes, elements, iteration and calls; each is judged."""
        for kind, found in self.reached(value):
            self.judge(f"{way} {kind}", found)
            yield f"{way} {kind}", found
        while self.spied:
            self.judge(f"{way} given to the program", self.spied.pop())

    def reached(self, value: object) -> Iterator[tuple[str, object]]:
        """The ways that lead on from a value, and where."""
        inner = value_in_run(value)
        for name in {*self.names, *dir(type(inner)), *(dir(inner) if isinstance(inner, type) else ())}:
            yield from self.tried(f".{name}", lambda name=name: get_attribute(inner, p.Attribute(value=p.Constant(value=None), name=name), self.state))
        for index in (0, -1, "a", 1, None, "RED", slice(0, 1)):
            node = p.Subscript(value=p.Constant(value=None), index=p.Constant(value=None))
            yield from self.tried(f"[{index!r}]", lambda index=index, node=node: get_item(node, [value, index], self.state))
        yield from self.tried("*", lambda: elements(value, p.Constant(value=None), self.state)[:KEPT])
        if callable(inner) or isinstance(inner, Method):
            for given in ((), *self.arguments):
                yield from self.tried("()", lambda given=given: self.called(value, given))
            yield from self.tried("(key=)", lambda: self.called(value, ([2, 1],), {"key": self.arguments[14][0]}))

    def tried(self, kind: str, ask: object) -> Iterator[tuple[str, object]]:
        """What is given, if anything is; an exception that the program could catch is a value as well."""
        self.state.settings.door.budget.left = 2_000_000
        try:
            yield kind, ask()  # type: ignore[operator]
        except HostException as problem:
            yield f"{kind} except", problem.exception
        except (ScenicError, DoorStuck):
            self.met["refused"] += 1

    def called(self, function: object, arguments: Iterable[object], keywords: dict[str, object] | None = None) -> object:
        """The value of a call by the machine. Raises `HostException` for an exception of the program."""
        state = self.state._replace(sigma=Scope("module", self.state.sigma.module))
        node = p.Call(function=p.Constant(value=None))
        outcome = calls.apply(node, function, tuple(arguments), keywords or {}, (), state)
        for _ in range(STEPS):
            match outcome:
                case Draw() as draw:
                    after: Config = draw.resume(from_stream(0, 0, 0)(draw))
                case Next(config=after) | Observe(config=after):
                    pass
                case Fault(error=error):
                    raise error
                case _:
                    return None
            if not after.stack:
                if isinstance(after.control, Value):
                    return after.control.value
                if getattr(after.control, "kind", "") == "raise":
                    raise HostException(after.control.value)  # type: ignore[union-attr]
                return None
            outcome = step(after)
        return None


DUNDERS = frozenset(
    name for c in (object, type, int, str, list, dict, set, property, BaseException, type(lambda: 0), type(len), type("".join), super, Counter) for name in dir(c)
)  # fmt: skip
INNARDS = sandbox_table.names(
    "gi_frame gi_code cr_frame tb_frame f_globals f_back func args keywords fget fset mro __mro__ _fields _asdict _make _replace _member_map_ _value_ _name_ "
    "_value2member_map_ _missing_ obj name path sampler cumulative shape ctypes tofile polygon exterior tolist base data scope body door budget left settings "
    "function subject members value origin class_ definition bindings parent lineage methods superclass order renewed items __wrapped__ cache_info getstate seed "
    "setstate with_traceback add_note obj characters_written filename errno exception span rule hint"
)


def signature_of(value: object) -> object:
    """What is taken for alike: the type, for functions and classes the name, for containers and random values the types inside."""
    inner = value_in_run(value)
    wrapped = type(value) is Random
    if isinstance(inner, type):
        return wrapped, "class", inner
    if isinstance(inner, (Native, Bound, Function)) or (callable(inner) and hasattr(inner, "__name__")):
        return wrapped, type(inner), getattr(inner, "name", None) or getattr(inner, "__name__", "")
    if isinstance(inner, (list, tuple, set, frozenset, deque)):
        return wrapped, type(inner), tuple(sorted({type(i).__name__ for i in inner}))[:2]
    if isinstance(inner, dict):
        return wrapped, type(inner), tuple(sorted({type(i).__name__ for i in inner.values()}))[:2]
    return wrapped, type(inner)
