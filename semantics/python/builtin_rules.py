"""Builtins that are rules of the machine rather than host functions, because they must see randomness or Scenic values."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Collection, Iterator, Mapping
from enum import Enum
from types import BuiltinFunctionType, MethodType, NoneType
from typing import Any

from ..machine.conditions import random_branch
from ..machine.config import Stack, State, value
from ..machine.draws import ask
from ..machine.host_calls import HostException, decided_by, host, raw
from ..machine.operand_kinds import kind_name
from ..machine.outcome import Change, Outcome
from ..machine.premises import describe_origin
from ..machine.sandbox_table import is_known, is_user_made
from ..machine.value_nesting import check_written
from ..machine.values import (
    HOLDING,
    Dynamic,
    Function,
    Instance,
    Method,
    Origin,
    Random,
    Special,
    each,
    unwrap,
    value_in_run,
    wrap,
)
from ..space.regions import PolylineRegion
from ..store.errors import RunError
from ..store.postponed_values import refuse_waiting
from ..store.scenic_classes import Above, ScenicClass
from ..store.scopes import MISSING, Scope
from ..store.sets import FrozenSet
from ..store.undo_log import STORED
from ..syntax import python_expressions as p
from ..syntax.nodes import Node
from .assignment import assigned_to, set_attribute
from .call_costs import call_with_copies
from .elementwise_builtins import ELEMENTWISE
from .expressions import attribute_is, conclude_attribute, get_attribute, hashed_container, instance_text
from .functions import return_host_result
from .iteration import elements
from .released_members import member
from .string_methods import addressless_str

Arguments = tuple[object, ...]
Keywords = Mapping[str, object]
Rule = Callable[[Node, Arguments, Keywords, Stack, State], Outcome]


def resample(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """⟨resample(D)⟩ →^{P_θ(v)} v: another sample from the distribution that D was drawn from, with the same θ (reading `resample`)."""
    if len(arguments) != 1 or keywords:
        raise HostException(TypeError("resample() takes one argument, the value to draw again"))
    subject = arguments[0]
    origin = subject.origin if type(subject) is Random else random_part(subject)
    if origin is None:
        return resample_constant(node, subject, stack, state)
    distribution = origin.distribution if type(subject) is Random else None
    if distribution is None:
        raise RunError(
            f"resample needs one of the built-in distributions, not an operation on one (this value depends on {describe_origin(origin)})",
            node.span, rule="E-Resample", hint="resample the operands instead: resample(x) + resample(y), or (resample(x), resample(y))",
        )
    return ask(node, distribution, "E-Resample", stack, state, origin.text)


def random_part(value: object) -> Origin | None:
    """Return where a part of the value that is random comes from: an element of a container, an argument, an attribute; None if no part is."""
    attributes = list(getattr(value, "__dict__", {}).values()) if is_user_made(value) and not isinstance(value, type) else []
    return unwrap(value.arguments if isinstance(value, Dynamic) else value)[1] or unwrap(attributes)[1]


def resample_constant(node: Node, subject: object, stack: Stack, state: State) -> Outcome:
    """Give the value itself, as if drawn from a point mass, or raise `RunError` (reading `resample-constant`); an instance or a container is none."""
    if state.simulation is not None:
        raise RunError(
            "while a scenario runs, resample needs a variable that a value was drawn into: what is computed, or stands in a container or "
            "property, no longer knows its distribution", node.span, rule="E-Resample", hint="write the distribution again",
        )  # fmt: skip
    if state.reading("resample-constant") == "point-mass" and may_be_a_point_mass(subject):
        return value("E-Resample-Constant", subject, stack, state, node)
    hint = "resample the draws behind its properties, or define it again" if isinstance(subject, Instance) else ""
    raise RunError(f"resample needs a value drawn from a distribution, not {kind_name(subject)}", node.span, rule="E-Resample", hint=hint)


def may_be_a_point_mass(value: object) -> bool:
    """Return whether a value that is not random is one that cannot change: no instance, no container but a tuple or frozen set of such values."""
    if is_user_made(value) and not isinstance(value, (type, Enum)) and hasattr(value, "__dict__"):
        return False
    is_fixed = isinstance(value, (tuple, FrozenSet))
    return all(map(may_be_a_point_mass, value)) if is_fixed else not isinstance(value, (Instance, Iterator, *HOLDING))  # type: ignore[arg-type]


def print_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """If ⟨E_i⟩ → v_i then ⟨print(E_1, ..., E_n)⟩ → None: the driving loop shows the text; the semantics itself has no output."""
    texts = [addressless_str(unwrap(instance_text(argument, state))[0]) for argument in arguments]
    separator = keywords.get("sep", " ")
    text = (separator if isinstance(separator, str) else " ").join(texts)
    return value("E-Print", None, stack, state, node, Change("print", "", text))


def verbose_print(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`verbosePrint(...)` of the released implementations prints where the user asks for details, and nothing here."""
    return return_host_result(node, None, stack, state)


def local_path(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`localPath(P)` of the released implementations: the path P as seen from the folder of the program's file, as a text."""
    path = value_in_run(arguments[0]) if len(arguments) == 1 else None
    if not isinstance(path, str) or keywords:
        raise HostException(TypeError("localPath() takes one argument, a path as a text"))
    folder, slash, _ = node.span.file.rpartition("/")
    return return_host_result(node, path if path.startswith("/") else folder + slash + path, stack, state)


MAPS = "scenic.domains.driving.roads", "_maps"
"""A module of the driving library, and the name in it of the maps that were read before the program runs (or why not), by the texts for them."""
WITHOUT_EFFECT = frozenset({"useCache", "writeCache", "ref_points", "fill_gaps", "fill_intersections", "elide_short_roads"})
"""Parameters of the released `fromFile` that change nothing here: maps are kept while they are in use, curves are exact, and a map is what it is."""
CONSTANTS = (float, int, str, NoneType)
"""What a program may write down as a tolerance, right or wrong."""
NO_PICKLES = "reading a pickle may run whatever is in it: Network.fromFile reads an OpenDRIVE file (.xodr), and networks are not written"


def network_from_file(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`Network.fromFile(P, ...)` of the driving library: the map of the file P, which was read before, since the machine reads no files."""
    other = next((name for name in keywords if name not in WITHOUT_EFFECT and name != "tolerance"), None)
    if other is not None or not arguments:
        raise HostException(TypeError(f"Network.fromFile has no {other} in this reference" if arguments else "Network.fromFile() takes a path"))
    module, path = state.settings.library.get(MAPS[0]), value_in_run(arguments[0])
    maps = module.get(MAPS[1]) if isinstance(module, Mapping) else None
    tolerance = value_in_run(keywords.get("tolerance"))
    key = path if tolerance is None else (path, tolerance)
    found = maps.get(key) if isinstance(maps, Mapping) and isinstance(path, str) and isinstance(tolerance, CONSTANTS) else None
    if found is None or isinstance(found, str):
        ways = "a text, localPath(a text), or globalParameters.map" + ("" if tolerance is None else ", with a tolerance that is written as a number")
        raise HostException(ValueError(found or f"Network.fromFile reads what the main program names by {ways}: maps are read before it runs"))
    return return_host_result(node, found, stack, state)


def network_from_pickle(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`Network.fromPickle(P)` of the driving library is refused."""
    raise HostException(ValueError(NO_PICKLES))


def isinstance_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`isinstance(v, C)` for Scenic and Python classes, or a tuple of them."""
    if len(arguments) != 2:
        raise HostException(TypeError("isinstance() takes two arguments"))
    subject, (classes, of_classes) = arguments[0], unwrap(arguments[1])

    def is_one(value: object) -> bool:
        return any(_is_instance(value, c) for c in _flat(classes))

    result = each(is_one, value_in_run(subject))
    origin = subject.origin if type(subject) is Random else of_classes
    return return_host_result(node, wrap(result, origin), stack, state)


def _flat(classes: object) -> list[object]:
    return [c for group in classes for c in _flat(group)] if isinstance(classes, tuple) else [classes]


def _is_instance(subject: object, class_: object) -> bool:
    if isinstance(class_, ScenicClass):
        return isinstance(subject, Instance) and subject.class_.is_subclass_of(class_)
    if isinstance(class_, type):
        return class_ is object or (isinstance(subject, class_) and not isinstance(subject, (Instance, ScenicClass, Function, Method, Dynamic)))
    raise HostException(TypeError("isinstance() needs a class or a tuple of classes"))


def issubclass_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`issubclass(C, D)`."""
    if len(arguments) != 2:
        raise HostException(TypeError("issubclass() takes two arguments"))
    (subject, classes), origin = unwrap(arguments)  # type: ignore[misc]
    others = _flat(classes)
    if isinstance(subject, ScenicClass):
        result: object = any(c is object or (isinstance(c, ScenicClass) and subject.is_subclass_of(c)) for c in others)
    else:
        result = raw(state.settings.door, state, issubclass, subject, tuple(c for c in others if isinstance(c, type)))
    return return_host_result(node, wrap(result, origin), stack, state)


def type_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`type(v)`: the class of a value."""
    if len(arguments) != 1 or keywords:
        raise RunError("type() takes one argument: classes are made with `class`", node.span, rule="E-Call-Host")
    inner = value_in_run(arguments[0])
    result = inner.class_ if isinstance(inner, Instance) else type(inner)
    if isinstance(result, type) and not is_known(result) and not state.settings.trusted:
        raise RunError(f"type() of {kind_name(inner)} is not a class of this language", node.span, rule="E-Call-Host")
    origin = arguments[0].origin if type(arguments[0]) is Random else None
    return return_host_result(node, wrap(result, origin), stack, state)


def getattr_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`getattr(v, name[, default])`, under the same rules as `v.name`."""
    if len(arguments) not in (2, 3) or not isinstance(value_in_run(arguments[1]), str):
        raise HostException(TypeError("getattr() takes a value, a name and perhaps a default"))
    subject, name = arguments[:2]
    if member(subject, str(value_in_run(name)), state) is not None:
        if type(name) is Random:
            raise random_branch(name, node, "which member of this value is meant")
        return conclude_attribute(p.Attribute(value=p.Constant(value=None), name=str(name), span=node.span), [subject], stack, state)
    result, origin = _attribute_or_missing(node, arguments, state)
    if result is MISSING:
        result = arguments[2]
    return attribute_is(node, result if origin is None else wrap(unwrap(result)[0], origin), stack, state)


def hasattr_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`hasattr(v, name)`."""
    if len(arguments) != 2 or not isinstance(value_in_run(arguments[1]), str):
        raise HostException(TypeError("hasattr() takes a value and a name"))
    result, origin = _attribute_or_missing(node, (*arguments, None), state)
    known = result is not MISSING or member(arguments[0], str(value_in_run(arguments[1])), state) is not None
    return attribute_is(node, wrap(known, origin), stack, state)


def _attribute_or_missing(node: Node, arguments: Arguments, state: State) -> tuple[object, Origin | None]:
    """The attribute of the first argument that the second names, MISSING if there is none and a third argument; what made the choice random."""
    subject, name = arguments[:2]
    origin = next((v.origin for v in (subject, name) if type(v) is Random), None)
    access = p.Attribute(value=p.Constant(value=None), name=str(value_in_run(name)), span=node.span)
    try:
        with decided_by(origin, state):
            return get_attribute(value_in_run(subject), access, state), origin
    except HostException as problem:
        if len(arguments) == 3 and isinstance(problem.exception, AttributeError):
            return MISSING, origin
        raise


def setattr_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`setattr(v, name, w)`, under the same rules as `v.name = w`."""
    if len(arguments) != 3 or not isinstance(value_in_run(arguments[1]), str):
        raise HostException(TypeError("setattr() takes a value, a name and a value"))
    if type(arguments[1]) is Random:
        raise RunError("the name of the attribute that is assigned may not be random", node.span, rule="S-Assignment")
    return assigned_to(node, None, node, stack, set_attribute(arguments[0], str(value_in_run(arguments[1])), arguments[2], node, state))


def callable_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`callable(v)`."""
    if len(arguments) != 1:
        raise HostException(TypeError("callable() takes one argument"))
    inner = value_in_run(arguments[0])
    result = not isinstance(inner, (Instance, ScenicClass)) and callable(inner)
    origin = arguments[0].origin if type(arguments[0]) is Random else None
    return return_host_result(node, wrap(result, origin), stack, state)


def super_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`super(C, v)`: v, as the classes see it that stand behind C among its own; `super()` in a method is that for its class and first argument."""
    if keywords or len(arguments) not in (0, 2):
        raise HostException(TypeError("super() takes a class and an instance of it, or stands in a method and takes nothing"))
    if not arguments:
        return return_host_result(node, above_method(node, state), stack, state)
    class_, subject = arguments
    classes = classes_of(subject, node)
    place = next((i for i, found in enumerate(classes) if found is class_), None)
    if place is None:
        raise HostException(TypeError("super(C, v) needs a class C, and an instance of it or a class below it"))
    return return_host_result(node, Above(subject, classes[place + 1 :]), stack, state)


def classes_of(subject: object, node: Node) -> tuple[ScenicClass | type, ...]:
    """The class of a value, or of all among which a draw chose, or a class itself, and those that stand behind it, in Python's order."""
    if type(subject) is Random:
        support = subject.origin.distribution.support() if subject.origin.distribution is not None else None
        first, *others = [value_in_run(v) for v, _ in support or ((None, 1),)]
        if not isinstance(first, Instance) or not all(isinstance(v, Instance) and v.class_ is first.class_ for v in others):
            raise random_branch(subject, node, "the value whose classes super() looks through")
        subject = first
    if isinstance(subject, (Instance, ScenicClass)):
        return (subject.class_ if isinstance(subject, Instance) else subject).lineage
    return (subject if isinstance(subject, type) else type(subject)).__mro__


def above_method(node: Node, state: State) -> Above:
    """The first argument of the method that runs, as the classes see it that stand behind the one in which the method is defined."""
    scope: Scope | None = state.sigma
    while scope is not None and scope.kind != "function":
        scope = scope.parent
    if scope is None or not scope.bindings:
        raise RunError("super() stands in a method", node.span, rule="E-Call-Host", hint="name the class: Base.method(self, ...)")
    subject = next(iter(scope.bindings.values()))
    classes = classes_of(subject, node)
    for place, class_ in enumerate(classes):
        members = class_.methods if isinstance(class_, ScenicClass) else vars(class_)
        functions = (getattr(m, "__func__", getattr(m, "fget", m)) for m in members.values())
        if any(isinstance(f, Function) and f.names is scope.names and f.scope is scope.parent for f in functions):
            return Above(subject, classes[place + 1 :])
    raise RunError("super() stands in a method of a class, which this function is not", node.span, rule="E-Call-Host")


def str_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`str(v)` of an instance is what `print` shows."""
    if len(arguments) == 1 and not keywords and isinstance(value_in_run(arguments[0]), Instance):
        return return_host_result(node, instance_text(arguments[0], state), stack, state)
    texts = host(state.settings.door, state, addressless_str if len(arguments) == 1 and not keywords else str, *arguments, **keywords)
    return return_host_result(node, texts, stack, state)


def length_of(container: Any) -> int:
    """Return the number of elements, of a polyline that of its points."""
    return sum(map(len, container.lines)) if isinstance(container, PolylineRegion) else len(container)


def dictionary_of(*entries: Any, **named: object) -> object:
    """Return a dictionary whose keys are all known, or a random one."""
    return _known_dictionary(dict(*entries, **named))


STRUCTURAL: Mapping[Callable[..., object], Callable[..., object]] = {
    len: length_of,
    bool: bool,
    list: list,
    tuple: tuple,
    dict: dictionary_of,
}
"""Builtins that look at a container, not at its elements: these keep their randomness."""


def _known_dictionary(entries: dict) -> object:
    """A dictionary whose keys are all known, or a random one."""
    return hashed_container(dict, list(entries.items()))


def structural(builtin: Callable[..., object]) -> Rule:
    """The rule of a builtin that looks at a container only."""
    function = STRUCTURAL[builtin]

    def rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
        options = () if builtin is dict else keywords.values()
        refuse_waiting(arguments)
        if any(type(a) is Random for a in (*arguments, *options)):
            return return_host_result(node, host(state.settings.door, state, function, *arguments, **keywords), stack, state)
        made = raw(state.settings.door, state, function, *arguments, **keywords)
        state.settings.door.budget.made(value_in_run(made))
        return return_host_result(node, made, stack, state)

    return rule


KEEPING = frozenset({"copy", "items", "keys", "values", "get"})
"""Methods that do not change a container and do not look at its elements."""

GIVING = frozenset({"pop", "popitem", "popleft", "setdefault"})


COMPARING = frozenset({"sort", "remove"})
"""Methods that compare the elements."""


def container_method(function: object) -> str:
    """The name of the method, if this is a method of a Python container that changes it or does not look at the elements."""
    name = getattr(function, "__name__", "") if isinstance(function, (BuiltinFunctionType, MethodType)) else ""
    known = (name in STORED or name in KEEPING) and isinstance(getattr(function, "__self__", None), (list, dict, set, deque))
    return name if known else ""


def call_container_method(
    node: Node, function: BuiltinFunctionType | MethodType, arguments: Arguments, keywords: Keywords, state: State
) -> object:
    """Call a method of `container_method`: stored elements keep their randomness, but where they stand may not be random."""
    name, owner = function.__name__, function.__self__
    stored: Collection[int] = STORED.get(name, ())
    counting = isinstance(owner, (set, Counter))
    places = [a for i, a in enumerate(arguments) if counting or i not in stored]
    if name == "update" and isinstance(owner, dict) and not counting and arguments:
        if type(arguments[0]) is Random:
            raise random_place(name, node)
        entries = raw(state.settings.door, state, dict, arguments[0])
        arguments, places = (entries, *arguments[1:]), [*entries]  # type: ignore[misc]
    elif name in ("extend", "extendleft"):
        arguments = tuple(elements(a, node, state) for a in arguments)
    met = unwrap([*places, *(keywords.values() if counting or name in ("sort", "pop") else ())])[1] is not None
    if met and name in KEEPING:
        return host(state.settings.door, state, getattr(unwrap(owner)[0], name), *arguments, **keywords)
    if met or (name in ("sort", "remove") and unwrap(owner)[1] is not None):
        raise random_place(name, node)
    if name in COMPARING:
        check_written(owner)
    result = raw(state.settings.door, state, call_with_copies, function, *arguments, **keywords)
    if name in STORED and name not in GIVING and type(result) is Random:  # a key function or comparison of the program met something random
        raise random_place(name, node)
    return result


def random_place(name: str, node: Node) -> RunError:
    """The error where a change of a container would make its shape random."""
    return RunError(
        f"{name}() would make it random which element stands where", node.span, rule="E-Call-Host",
        hint="make a new container, with sorted(...), a comprehension or an operator",
    )


SPECIALS: Mapping[str, Rule] = {
    "resample": resample,
    "print": print_rule,
    "verbosePrint": verbose_print,
    "localPath": local_path,
    "Network.fromFile": network_from_file,
    "Network.fromPickle": network_from_pickle,
    "isinstance": isinstance_rule,
    "issubclass": issubclass_rule,
    "type": type_rule,
    "getattr": getattr_rule,
    "hasattr": hasattr_rule,
    "setattr": setattr_rule,
    "callable": callable_rule,
    "super": super_rule,
}

SPECIAL_VALUES: Mapping[str, Special] = {name: Special(name) for name in SPECIALS if name.isidentifier()}

HOST_RULES: Mapping[Callable[..., object], Rule] = {
    **{builtin: structural(builtin) for builtin in STRUCTURAL}, str: str_rule, **ELEMENTWISE,
}  # fmt: skip
"""Python's own builtins with a rule of their own where the program calls them; elsewhere they are ordinary values."""
