"""Builtins that are rules of the machine rather than host functions, because they must see randomness or Scenic values."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .assignment import set_attribute
from .config import Config, Stack, State, value
from .draws import ask
from .errors import RunError
from .expressions import elements, get_attribute
from .functions import InScope
from .host import HostException, host
from .kinds import kind_name
from .outcome import Change, Next, Outcome
from .premises import describe_origin
from .scopes import Scope
from .syntax import python_expressions as p
from .syntax.nodes import Node
from .values import Dynamic, Function, Instance, Method, Random, ScenicClass, Special, plain, unwrap, wrap

Arguments = tuple[object, ...]
Keywords = Mapping[str, object]
Rule = Callable[[Node, Arguments, Keywords, Stack, State], Outcome]


def resample(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """⟨resample(D)⟩ →^{P_θ(v)} v: another sample from the distribution that D was drawn from, with the same θ (reading `resample`)."""
    if len(arguments) != 1 or keywords:
        raise HostException(TypeError("resample() takes one argument, the value to draw again"))
    subject = arguments[0]
    if type(subject) is not Random:
        if state.reading("resample-constant") == "point-mass" and not isinstance(subject, (list, dict, set)):
            return value("E-Resample-Constant", subject, stack, state, node)
        raise RunError(f"resample needs a value drawn from a distribution, not {kind_name(subject)}", node.span, rule="E-Resample")
    distribution = subject.origin.distribution
    if distribution is None:
        raise RunError(
            f"resample needs one of the built-in distributions, not an operation on one (this value depends on {describe_origin(subject.origin)})",
            node.span, rule="E-Resample", hint="resample the operands instead: resample(x) + resample(y)",
        )
    return ask(node, distribution, "E-Resample", stack, state, subject.origin.text)


def print_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`print(...)`: the driving loop shows the text; the semantics itself has no output."""
    texts = [describe(argument, state) for argument in arguments]
    separator = keywords.get("sep", " ")
    text = (separator if isinstance(separator, str) else " ").join(texts)
    return value("E-Print", None, stack, state, node, Change("print", "", text))


def describe(argument: object, state: State) -> str:
    """A value as `print` and `str` show it: instances with their class and position."""
    inner = plain(argument)
    if isinstance(inner, Instance):
        position = unwrap(state.objects[inner.number].get("position"))[0]
        return f"{inner.class_.name} at {position}"
    return str(unwrap(inner)[0])


def isinstance_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`isinstance(v, C)` for Scenic and Python classes, or a tuple of them."""
    if len(arguments) != 2:
        raise HostException(TypeError("isinstance() takes two arguments"))
    subject, classes = arguments
    inner = plain(subject)
    result = any(_is_instance(inner, c) for c in _flat(plain(classes)))
    origin = subject.origin if type(subject) is Random else None
    return value("E-Call-Host", wrap(result, origin), stack, state, node)


def _flat(classes: object) -> list[object]:
    return [c for group in classes for c in _flat(group)] if isinstance(classes, tuple) else [classes]


def _is_instance(subject: object, class_: object) -> bool:
    if isinstance(class_, ScenicClass):
        return isinstance(subject, Instance) and subject.class_.is_subclass_of(class_)
    if isinstance(class_, type):
        return isinstance(subject, class_) and not isinstance(subject, (Instance, ScenicClass, Function, Method, Dynamic))
    raise HostException(TypeError("isinstance() needs a class or a tuple of classes"))


def issubclass_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`issubclass(C, D)`."""
    if len(arguments) != 2:
        raise HostException(TypeError("issubclass() takes two arguments"))
    subject, classes = arguments
    others = _flat(classes)
    if isinstance(subject, ScenicClass):
        return value("E-Call-Host", any(isinstance(c, ScenicClass) and subject.is_subclass_of(c) for c in others), stack, state, node)
    python = tuple(c for c in others if isinstance(c, type))
    return value("E-Call-Host", host(state.settings.door, state, issubclass, subject, python), stack, state, node)


def type_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`type(v)`: the class of a value."""
    if len(arguments) != 1 or keywords:
        raise RunError("type() takes one argument: classes are made with `class`", node.span, rule="E-Call-Host")
    inner = plain(arguments[0])
    result = inner.class_ if isinstance(inner, Instance) else type(inner)
    origin = arguments[0].origin if type(arguments[0]) is Random else None
    return value("E-Call-Host", wrap(result, origin), stack, state, node)


def getattr_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`getattr(v, name[, default])`, under the same rules as `v.name`."""
    if len(arguments) not in (2, 3) or not isinstance(plain(arguments[1]), str):
        raise HostException(TypeError("getattr() takes a value, a name and perhaps a default"))
    access = p.Attribute(value=p.Constant(value=None), name=str(plain(arguments[1])), span=node.span)
    subject = arguments[0]
    try:
        result = get_attribute(plain(subject), access, state)
    except HostException as problem:
        if len(arguments) == 3 and isinstance(problem.exception, AttributeError):
            return value("E-Attribute", arguments[2], stack, state, node)
        raise
    origin = subject.origin if type(subject) is Random else None
    return value("E-Attribute", wrap(result, origin), stack, state, node)


def hasattr_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`hasattr(v, name)`."""
    if len(arguments) != 2 or not isinstance(plain(arguments[1]), str):
        raise HostException(TypeError("hasattr() takes a value and a name"))
    access = p.Attribute(value=p.Constant(value=None), name=str(plain(arguments[1])), span=node.span)
    try:
        get_attribute(plain(arguments[0]), access, state)
    except HostException as problem:
        if isinstance(problem.exception, AttributeError):
            return value("E-Attribute", False, stack, state, node)
        raise
    return value("E-Attribute", True, stack, state, node)


def setattr_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`setattr(v, name, w)`, under the same rules as `v.name = w`."""
    if len(arguments) != 3 or not isinstance(plain(arguments[1]), str):
        raise HostException(TypeError("setattr() takes a value, a name and a value"))
    return value("S-Assignment", None, stack, set_attribute(arguments[0], str(plain(arguments[1])), arguments[2], node, state), node)


def callable_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`callable(v)`."""
    if len(arguments) != 1:
        raise HostException(TypeError("callable() takes one argument"))
    inner = plain(arguments[0])
    return value("E-Call-Host", not isinstance(inner, (Instance, ScenicClass)) and callable(inner), stack, state, node)


_F, _X, _XS = p.Name(name="<function>"), p.Name(name="<element>"), p.Name(name="<elements>")


def map_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`map(f, xs)` is `[f(x) for x in xs]`, a list; with several iterables the elements are taken side by side."""
    if len(arguments) < 2:
        raise HostException(TypeError("map() takes a function and at least one iterable"))
    function, *iterables = arguments
    if len(iterables) == 1:
        return _comprehend(node, function, iterables[0], p.Call(function=_F, arguments=(_X,), span=node.span), (), stack, state)
    rows = list(zip(*(elements(i, node, state) for i in iterables), strict=False))
    element = p.Call(function=_F, arguments=(p.Starred(value=_X),), span=node.span)
    return _comprehend(node, function, rows, element, (), stack, state)


def filter_rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
    """`filter(f, xs)` is `[x for x in xs if f(x)]`, a list (Section 3.3 picks from one with `Uniform(*roads)`)."""
    if len(arguments) != 2:
        raise HostException(TypeError("filter() takes a function and an iterable"))
    test = _X if arguments[0] is None else p.Call(function=_F, arguments=(_X,), span=node.span)
    return _comprehend(node, arguments[0], arguments[1], _X, (test,), stack, state)


def _comprehend(
    node: Node, function: object, iterable: object, element: p.Expression, tests: tuple[p.Expression, ...], stack: Stack, state: State
) -> Outcome:
    scope = Scope("comprehension", state.sigma, bindings={"<function>": function, "<elements>": iterable})
    clause = p.ComprehensionClause(target=_X, iterable=_XS, conditions=tests)
    body = p.Comprehension(kind="list", element=element, clauses=(clause,), span=node.span)
    return Next("E-Call-Host", Config(body, (InScope(state.sigma), stack), state._replace(sigma=scope)), node)


STRUCTURAL: Mapping[str, Callable[..., object]] = {
    "len": len, "list": list, "tuple": tuple, "zip": lambda *xs, **k: list(zip(*xs, **k)),
    "enumerate": lambda xs, start=0: list(enumerate(xs, start)),
    "reversed": lambda xs: list(reversed(xs)), "dict": dict,
}
"""Builtins that look at a container, not at its elements: these keep their randomness. Lazy ones give lists."""

STRUCTURAL_METHODS = frozenset(
    {"append", "extend", "insert", "clear", "copy", "reverse", "items", "keys", "values", "get", "setdefault", "update", "pop", "popitem", "add"}
)


def structural(name: str) -> Rule:
    """The rule of a builtin that looks at a container only."""
    function = STRUCTURAL[name]

    def rule(node: Node, arguments: Arguments, keywords: Keywords, stack: Stack, state: State) -> Outcome:
        if any(type(a) is Random for a in arguments):
            return value("E-Call-Host", host(state.settings.door, state, function, *arguments, **keywords), stack, state, node)
        sized = [a for a in arguments if isinstance(a, range)]
        if name != "len" and any(len(a) > 10_000_000 for a in sized):
            raise RunError("a range with so many elements cannot be turned into a collection", node.span, rule="E-Call-Host")
        return value("E-Call-Host", call_raw(function, arguments, keywords, state), stack, state, node)

    return rule


def call_raw(function: Callable[..., object], arguments: Arguments, keywords: Keywords, state: State) -> object:
    """Call host code that does not look at the elements of containers."""
    state.settings.door.state = state
    try:
        return function(*arguments, **keywords)
    except Exception as exception:
        raise HostException(exception) from exception


SPECIALS: Mapping[str, Rule] = {
    "resample": resample,
    "print": print_rule,
    "isinstance": isinstance_rule,
    "issubclass": issubclass_rule,
    "type": type_rule,
    "getattr": getattr_rule,
    "hasattr": hasattr_rule,
    "setattr": setattr_rule,
    "callable": callable_rule,
    "map": map_rule,
    "filter": filter_rule,
    **{name: structural(name) for name in STRUCTURAL},
}

SPECIAL_VALUES: Mapping[str, Special] = {name: Special(name) for name in SPECIALS}
