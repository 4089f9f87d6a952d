"""Who may do what: the one table of the values that a program nobody vouched for meets, and of what it may ask of them.

A program meets the reference's own values, and of Python's the harmless ones below; of each only the attributes and methods that stand here.
Everything else (arrays, shapes, modules, slots, what a bound method is bound to) is never handed out. Names of classes of the program itself
are the program's own. `docs/security.md` says what is promised.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

import builtins
import math
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import Enum, Flag, IntEnum, auto
from functools import cmp_to_key
from types import BuiltinFunctionType, EllipsisType, FunctionType, MethodDescriptorType, MethodType, ModuleType, NoneType, NotImplementedType
from typing import Any

from ..space.fields import PolygonalVectorField, VectorField
from ..space.regions import (
    CircularRegion,
    PolygonalRegion,
    PolylineRegion,
    RectangularRegion,
    Region,
    SectorRegion,
    Workspace,
)
from ..space.symbol_seam import NotLifted, Symbol
from ..space.vectors import Vector
from ..store.budget import Metered
from ..store.containers import Counter, OrderedDict, deque
from ..store.generators import Generator
from ..store.postponed_values import Waiting
from ..store.scenic_classes import Above, ScenicClass
from ..store.sets import FrozenSet, Set
from .values import (
    Applicable,
    Bound,
    Constructor,
    Dynamic,
    Entries,
    Function,
    Hint,
    Instance,
    Method,
    Module,
    Native,
    Pairs,
    Random,
    Special,
)
from .world_queries import Clock, Closest, Parameters

Names = frozenset[str]


def names(text: str) -> Names:
    """The names in a text."""
    return frozenset(text.split())


SEQUENCE = names("count index")
MAPPING = names("clear copy get items keys pop popitem setdefault update values fromkeys")
SET = names("copy difference intersection isdisjoint issubset issuperset symmetric_difference union")
WHOLE_SET = SET | names("add clear difference_update discard intersection_update pop remove symmetric_difference_update update")

ATTRIBUTES: Mapping[type, Names] = {
    # numbers
    bool: names(""),
    int: names("numerator denominator real imag bit_length bit_count conjugate is_integer as_integer_ratio"),
    float: names("real imag conjugate is_integer as_integer_ratio hex fromhex"),
    complex: names("real imag conjugate"),
    # texts
    str: SEQUENCE | names(
        "capitalize casefold center encode endswith expandtabs find format format_map isalnum isalpha isascii isdecimal isdigit isidentifier islower "
        "isnumeric isprintable isspace istitle isupper join ljust lower lstrip partition removeprefix removesuffix replace rfind rindex rjust "
        "rpartition rsplit rstrip split splitlines startswith strip swapcase title translate maketrans upper zfill"
    ),
    bytes: SEQUENCE | names("decode endswith find hex isalnum isalpha isdigit lower startswith strip upper"),
    # containers
    list: SEQUENCE | names("append clear copy extend insert pop remove reverse sort"),
    tuple: SEQUENCE,
    dict: MAPPING,
    Set: WHOLE_SET,
    FrozenSet: SET,
    range: SEQUENCE | names("start stop step"),
    slice: names("start stop step indices"),
    deque: SEQUENCE | names("append appendleft clear copy extend extendleft insert maxlen pop popleft remove reverse rotate"),
    Counter: names("elements most_common subtract total"),
    OrderedDict: names("move_to_end"),
    defaultdict: names(""),
    type({}.keys()): names("isdisjoint"),
    type({}.values()): names(""),
    type({}.items()): names("isdisjoint"),
    # other values of Python
    NoneType: names(""),
    NotImplementedType: names(""),
    EllipsisType: names(""),
    object: names(""),
    BaseException: names("args"),
    StopIteration: names("value"),
    property: names("setter getter deleter"),
    staticmethod: names(""),
    classmethod: names(""),
    BuiltinFunctionType: names("__name__"),
    MethodType: names("__name__"),
    MethodDescriptorType: names("__name__"),
    Enum: names("name value"),
    auto: names(""),
    # the reference's own
    Vector: names("x y"),
    VectorField: names("name at"),
    PolygonalVectorField: names("headingFunction defaultHeading"),
    Region: names("contains_point containsPoint distance_to intersect intersects union difference bounds measure orientation name"),
    CircularRegion: names("center radius"),
    SectorRegion: names("center radius heading angle"),
    RectangularRegion: names("position heading width length"),
    PolygonalRegion: names("polygon polygons"),
    PolylineRegion: names("lineString heading_at nearestSegmentTo signedDistanceTo project pointAlongBy equallySpacedPoints pointsSeparatedBy"),
    Workspace: names("region"),
}
"""The attributes of each type of values; those of the types that it is derived from are its own as well."""

HOLDS = "Python holds the element that it asks a method about; the method may not change the container (`versions.check_idle`)"
COPIED = f"{HOLDS}; what is ordered is a copy"
NOTHING = "calls nothing of a program"
ASKED_ONCE = "a number that a class of the program stands for is asked for once, before anything is made"
SAFE: Mapping[type, str] = {
    bool: NOTHING, int: NOTHING, float: NOTHING, complex: NOTHING,
    str: f"Python takes the characters that are there, whatever a class below it says; {ASKED_ONCE}; formats are ours",
    bytes: f"as text; {ASKED_ONCE}",
    list: COPIED, tuple: f"cannot change; {COPIED}", dict: HOLDS, range: NOTHING, slice: ASKED_ONCE, defaultdict: f"as a dictionary; {HOLDS}",
    deque: "ours: a copy is gone through", Counter: "ours: counts in Python, not in C",
    OrderedDict: "ours: a dictionary, which has an order as it is",
    type({}.keys()): HOLDS, type({}.values()): HOLDS, type({}.items()): HOLDS,
    NoneType: NOTHING, NotImplementedType: NOTHING, EllipsisType: NOTHING, object: NOTHING,
    BaseException: "a place in a text, of which Python would read the characters, lies within it (`prices.check_exception`)",
    StopIteration: "as other exceptions", property: "cannot change; its functions are called last",
    staticmethod: NOTHING, classmethod: NOTHING, BuiltinFunctionType: "what it is called with is checked for the function that it is",
    MethodType: "as a function", MethodDescriptorType: "as a function",
    Enum: "made by Python code", auto: NOTHING,
}  # fmt: skip
"""Of each type of Python's: why its C code survives the methods of a program that it calls. `tests/hostile/dunders.py` puts it to the test."""

KEY = type(cmp_to_key(lambda first, second: 0))
"""What `functools.cmp_to_key` gives."""

OWN: tuple[type, ...] = (
    Above, Bound, Clock, Closest, Constructor, Dynamic, Entries, Function, Generator, Hint, Instance, Metered, Method, Module, Native, Pairs,
    Parameters, Random, ScenicClass, Special, Waiting, Symbol, Region, VectorField, KEY, Applicable,
)  # fmt: skip
"""Types of the machine, and of what it computes with: the rules of the language say what may be done with them."""

BUILTINS: Names = names(
    "abs all any bin bool bytes chr classmethod complex divmod float hex int max min object oct ord property range slice sorted staticmethod str "
    "list tuple dict len"
)
"""The builtins that are Python's own: they go through what is there, and make no more."""

OURS_OF_MATH: Names = names("factorial comb perm prod lcm")
"""What of `math` is ours, since Python's own makes more than fits into memory by one call, or never ends."""

OF_MATH = {name: value for name, value in vars(math).items() if callable(value) and not name.startswith("_") and name not in OURS_OF_MATH}
THROUGH = "holds the iterator, and each element that it is at"
SAFE_FUNCTIONS: Mapping[Callable[..., object], str] = {
    **{kind: SAFE[kind] for kind in (getattr(builtins, name) for name in sorted(BUILTINS)) if isinstance(kind, type)},
    abs: "calls one method of its argument, and keeps nothing", divmod: "as the operators", len: "asks for one number, which is checked",
    all: THROUGH, any: THROUGH, max: f"{THROUGH}, and the best so far", min: f"{THROUGH}, and the best so far",
    sorted: "makes a list of its own first, which nobody else has", ord: "Python takes the character that is there",
    bin: ASKED_ONCE, hex: ASKED_ONCE, oct: ASKED_ONCE, chr: ASKED_ONCE,
    str.maketrans: "goes through a dictionary, which its keys' methods may not change; characters as they are",
    **dict.fromkeys(OF_MATH.values(), "each number is asked for once; what comes from an iterator is held until then"),
}  # fmt: skip
"""Of each function and class of Python's that may be called: why its C code survives the methods of a program that it calls."""

FUNCTIONS = frozenset(SAFE_FUNCTIONS)
"""The functions of Python that a program may hold."""

CLASSES: Names = names("__name__ __doc__")
"""What any class may be asked for beside the methods of its instances."""

BASES: frozenset[type] = frozenset({object, list, dict, Set, tuple, str, int, float, deque, Counter, OrderedDict, defaultdict, Enum, IntEnum, Flag})
"""The Python classes, beside exceptions and classes of the program, from which a class of the program may be derived."""

OVERRIDES: Names = names(
    "__init__ __repr__ __str__ __format__ __eq__ __ne__ __lt__ __le__ __gt__ __ge__ __hash__ __bool__ __len__ __getitem__ __setitem__ __delitem__ "
    "__contains__ __iter__ __next__ __reversed__ __call__ __getattr__ __neg__ __pos__ __abs__ __invert__ __int__ __float__ __complex__ __index__ "
    "__round__ __trunc__ __floor__ __ceil__ __missing__ __doc__ __add__ __radd__ __iadd__ __sub__ __rsub__ __isub__ __mul__ "
    "__rmul__ __imul__ __matmul__ __rmatmul__ __imatmul__ __truediv__ __rtruediv__ __itruediv__ __floordiv__ __rfloordiv__ __ifloordiv__ __mod__ "
    "__rmod__ __imod__ __divmod__ __rdivmod__ __pow__ __rpow__ __ipow__ __lshift__ __rlshift__ __ilshift__ __rshift__ __rrshift__ __irshift__ "
    "__and__ __rand__ __iand__ __or__ __ror__ __ior__ __xor__ __rxor__ __ixor__"
)
"""The names between two underscores that a Python class of the program may define."""

LOOKING = names("__eq__ __ne__ __lt__ __le__ __gt__ __ge__ __hash__ __bool__ __len__ __repr__ __str__ __format__")
"""Those of them that Python calls while it looks through a container, which they may not change (`versions.check_idle`)."""

MARK = "__scenic_user_class__"


def is_user_class(value: object) -> bool:
    """Whether `value` is a Python class of the program."""
    return isinstance(value, type) and MARK in value.__dict__


def is_user_made(value: object) -> bool:
    """Whether `value` is an instance of a Python class of the program, or that class."""
    return is_user_class(value if isinstance(value, type) else type(value))


def own_word(value: object, name: str, otherwise: object = None) -> Any:
    """An attribute by which Python's own callables say what they are; classes of the program, and their instances, may make it up: not asked."""
    return otherwise if is_user_made(value) else getattr(value, name, otherwise)


def may_override(name: str, member: object) -> bool:
    """Whether a class of the program may define `name`, one of `OVERRIDES`, as that: as a function of its own, whose steps are counted."""
    return isinstance(member, Function) or member is None or name == "__doc__"


def as_member(name: str, member: object) -> object:
    """Return the member that a class of the program holds under a name: of `LOOKING`, a function that is
    known for it.
    """
    return replace(member, looks=True) if name in LOOKING and isinstance(member, Function) else member


def is_hidden(name: str) -> bool:
    """Whether a name of a class of the program is Python's affair rather than the program's."""
    return name == MARK or (name.startswith("_") and name.endswith("_") and name not in OVERRIDES)


OF_RECORDS = names("_asdict _fields _make _replace")
"""What a named tuple has beside its fields."""


def is_record(class_: type) -> bool:
    """Whether the class is one that `namedtuple` made."""
    return class_.__bases__ == (tuple,) and "_field_defaults" in class_.__dict__


def is_given(class_: type, name: str) -> bool:
    """Whether a class of the program has a member that the program gave it, and not Python, which made it a named tuple or an enumeration."""
    if name not in class_.__dict__ or is_hidden(name):
        return False
    if is_record(class_):
        return name in class_.__dict__["_fields"] or name in OF_RECORDS
    found = class_.__dict__[name]
    return not isinstance(found.__func__ if isinstance(found, (classmethod, staticmethod)) else found, FunctionType)


def may_ask(value: object, name: str) -> bool:
    """Whether a program may ask the value, which is none of the machine's types, for the attribute."""
    if isinstance(value, Symbol):
        raise NotLifted(f"the attribute {name} of a random value")
    if name == "__init__" and (isinstance(value, type) or not is_user_made(value)):
        return isinstance(value, type) and is_base(value)
    if isinstance(value, type):
        return (is_known(value) and name in CLASSES) or any(name in of_class(c, name) for c in value.__mro__) or is_member(value, name)
    if is_user_made(value) and name in getattr(value, "__dict__", ()) and not is_hidden(name):
        return True
    return any(name in of_class(c, name) for c in type(value).__mro__)


def names_in(value: object) -> set[str]:
    """The names for which a program may ask a value that is no class, but for those of Python's protocols; for suggestions."""
    found: set[str] = set(getattr(value, "__dict__", ())) if is_user_made(value) else set()
    for class_ in type(value).__mro__:
        found.update(class_.__dict__ if MARK in class_.__dict__ else of_class(class_, ""))
    return {name for name in found if not name.startswith("_")}


def is_base(class_: type) -> bool:
    """Whether a class of the program may be derived from the Python class."""
    return is_user_class(class_) or class_ in BASES or issubclass(class_, Exception)


def of_class(class_: type, name: str) -> Names | dict[str, None]:
    """The names that one class gives to its instances: those of the table, or those that the program defined."""
    if MARK in class_.__dict__:
        return {name: None} if is_given(class_, name) else {}
    return ATTRIBUTES.get(class_) or getattr(class_, "__dict__", {}).get("scenic_names", frozenset())


def is_member(class_: type, name: str) -> bool:
    """Whether the name is one of an enumeration's members."""
    return issubclass(class_, Enum) and name in class_.__members__


def is_known(class_: type) -> bool:
    """Whether a class may be a value: one of the program, of the table, an exception, or one that says itself what programs may ask of it."""
    if class_ is MethodType:  # a program that could make methods would call what it likes past the checks of what is called
        return False
    if is_user_class(class_) or class_ in ATTRIBUTES or class_ in BASES or class_ in FUNCTIONS or issubclass(class_, Exception):
        return True
    return hasattr(class_, "scenic_names") or issubclass(class_, (Region, VectorField))


def may_make(class_: type) -> bool:
    """Whether a program may call the class: of ours those that it has under a name, not those that it only finds as the class of a value."""
    return getattr(class_, "scenic_made", False) is not True


def is_value(value: object) -> bool:
    """Whether a program may hold the value. Of functions, methods and the like it may ask for their names, but what they belong to decides."""
    class_ = type(value)
    if class_ is MethodType:
        return isinstance(value.__func__, (Function, Native)) or may_ask(value.__self__, value.__func__.__name__)  # type: ignore[attr-defined]
    if class_ is BuiltinFunctionType:
        subject = value.__self__  # type: ignore[attr-defined]
        return value in FUNCTIONS if subject is None or isinstance(subject, ModuleType) else may_ask(subject, value.__name__)  # type: ignore[attr-defined]
    if class_ is MethodDescriptorType:
        return value.__name__ in ATTRIBUTES.get(value.__objclass__, ())  # type: ignore[attr-defined]
    if class_ in ATTRIBUTES or issubclass(class_, OWN):
        return True
    if isinstance(value, type):
        return is_known(value)
    return is_known(class_)
