"""Algorithm 1, resolveSpecifiers: which specifier determines each property, and in which order they are evaluated.

The five phases and their comments are the algorithm's own. Reading `alg1-graph`: the vertices of the graph are
specifiers, the image of specForProperty.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..store.errors import (
    CyclicDependencies,
    MissingProperty,
    ResolutionError,
    SpecifiedTwice,
    SpecifiedTwiceOptionally,
)
from ..syntax.nodes import NOWHERE, Node, Span
from .specifiers import Form


@dataclass(frozen=True, slots=True, eq=False)
class Specification:
    """A specifier as Algorithm 1 sees it: what it specifies, optionally or not, and its dependencies; those that say the same are different.

    `node` is the specifier, or the expression of a default value; `form` and `arguments` are those of an evaluated
    specifier (no form for `with`, default values, and arguments that wait for the object's position).
    """

    node: Node
    name: str
    specifies: tuple[str, ...]
    optional: tuple[str, ...] = ()
    dependencies: tuple[str, ...] = ()
    form: Form | None = None
    arguments: tuple[object, ...] | None = None
    is_default: bool = False
    waits: bool = False


Ordered = tuple[tuple[Specification, tuple[str, ...]], ...]


def resolve_specifiers(
    span: Span,
    specifiers: Sequence[Specification],
    defaults: Mapping[str, Specification],
    known: frozenset[str] | None = None,
    absent: frozenset[str] = frozenset(),
) -> Ordered:
    """Algorithm 1 (resolveSpecifiers): "specifiers S in G in topological order", each with the set of properties P for which specForProperty(P) = S.

    `defaults` is defaultValueExpressions(class). `known`, if given, keeps optional specifications to those properties (reading `optional-unknown` =
    ignore); `absent` are dependencies that may be missing (reading `point-size`). Raises a named `ResolutionError` where the algorithm says "syntax
    error".
    """
    # 1. gather all specified properties
    spec_for_property: dict[str, Specification] = {}
    optional_specs: dict[str, list[Specification]] = {}
    for specifier in specifiers:
        for name in specifier.specifies:
            if name in spec_for_property:
                raise specified_twice(name, spec_for_property[name], specifier)
            spec_for_property[name] = specifier
        for name in specifier.optional:
            if known is None or name in known:
                optional_specs.setdefault(name, []).append(specifier)

    # 2. filter optional specifications
    for name, candidates in optional_specs.items():
        if name in spec_for_property:
            continue
        if len(candidates) > 1:
            raise specified_twice_optionally(name, candidates)
        spec_for_property[name] = candidates[0]

    # 3. add default specifiers as needed
    for name, default in defaults.items():
        if name not in spec_for_property:
            spec_for_property[name] = default

    # 4. build dependency graph
    used = tuple(dict.fromkeys(spec_for_property.values()))
    determined: dict[Specification, list[str]] = {s: [] for s in used}
    for name, specifier in spec_for_property.items():
        determined[specifier].append(name)
    predecessors: dict[Specification, list[tuple[str, Specification]]] = {s: [] for s in used}
    for specifier in used:
        for dependency in specifier.dependencies:
            if dependency not in spec_for_property:
                if dependency in absent:
                    continue
                raise missing_property(dependency, specifier, span)
            predecessors[specifier].append((dependency, spec_for_property[dependency]))

    # 5. construct specifier and property evaluation order
    order = _topological_order(used, predecessors, span)
    return tuple((s, tuple(determined[s])) for s in order)


def postpone_specifier(remaining: Ordered, changed: Specification, span: Span) -> Ordered:
    """The order of the specifiers that are left, the first of which has turned out to have the dependencies of `changed`; a circle is an error."""
    left = ((changed, remaining[0][1]), *remaining[1:])
    by_name = {name: specifier for specifier, names in left for name in names}
    predecessors = {s: [(d, by_name[d]) for d in s.dependencies if d in by_name] for s, _ in left}
    determined = dict(left)
    return tuple((s, determined[s]) for s in _topological_order(tuple(determined), predecessors, span))


def specified_twice(name: str, first: Specification, second: Specification) -> SpecifiedTwice:
    """Algorithm 1 (resolveSpecifiers), gather all specified properties: if "P ∈ dom specForProperty", "syntax error: property P specified twice"."""
    text = f"the property {name} is specified twice: by `{first.name}` and by `{second.name}`"
    names = (first.name, second.name)
    seen = [name for name in names if name in VISIBILITY]
    hint = ""
    if "with height" in names:
        hint = "height is another spelling of length, unless the reading is `height=own`, as in the profiles of the releases"
    elif len(seen) == 1:
        hint = f"to require it of the other's position, leave `{seen[0]}` out and write {VISIBILITY[seen[0]]}, x being this object, P the viewer"
    return SpecifiedTwice(text, second.node.span, rule="R-SpecifiedTwice", hint=hint)


VISIBILITY = {"visible": "`require P can see x`", "not visible": "`require not (P can see x)`"}
"""Specifiers that in the released Scenic 3 require something of the position that another one gives, and how that is said here."""


def specified_twice_optionally(name: str, candidates: list[Specification]) -> SpecifiedTwiceOptionally:
    """Algorithm 1 (resolveSpecifiers), filter optional specifications: if "|optionalSpecsForProperty (P)| > 1", "syntax error: property P
    specified twice".
    """
    names = " and by ".join(f"`{c.name}`" for c in candidates)
    return SpecifiedTwiceOptionally(
        f"the property {name} is specified optionally twice: by {names}", candidates[1].node.span, rule="R-SpecifiedTwiceOptionally",
        hint=f"say which is meant with an explicit specifier for {name}",
    )


def missing_property(dependency: str, specifier: Specification, span: Span) -> MissingProperty:
    """Algorithm 1 (resolveSpecifiers), build dependency graph: if "D ∉ dom specForProperty", "syntax error: missing property D required by S"."""
    text = f"`{specifier.name}` needs the property {dependency}, which this object does not have"
    return MissingProperty(text, _place(specifier, span), rule="R-MissingProperty")


def _place(specifier: Specification, span: Span) -> Span:
    return span if specifier.is_default else specifier.node.span


def _topological_order(
    used: tuple[Specification, ...],
    predecessors: Mapping[Specification, list[tuple[str, Specification]]],
    span: Span,
) -> list[Specification]:
    """Repeatedly the first specifier whose dependencies are all placed (Kahn's algorithm, stable)."""
    placed: set[Specification] = set()
    order: list[Specification] = []
    waiting = list(used)
    while waiting:
        ready = [s for s in waiting if not predecessors[s] or all(p in placed for _, p in predecessors[s])]
        if not ready:
            raise cyclic(waiting, predecessors, span)
        order.extend(ready)
        placed.update(ready)
        waiting = [s for s in waiting if s not in placed]
    return order


def cyclic(
    waiting: list[Specification], predecessors: Mapping[Specification, list[tuple[str, Specification]]], span: Span
) -> ResolutionError:
    """Algorithm 1 (resolveSpecifiers), build dependency graph: if "G is cyclic", "syntax error: specifiers have cyclic dependencies". The message
    prints one circle.
    """
    unplaced = set(waiting)
    path: list[tuple[str, Specification]] = []
    current = waiting[0]
    seen: list[Specification] = []
    while current not in seen:
        seen.append(current)
        dependency, following = next((d, p) for d, p in predecessors[current] if p in unplaced)
        path.append((dependency, current))
        current = following
    cycle = path[seen.index(current) :]
    names = tuple(dependency for dependency, _ in cycle)
    steps = ", ".join(f"`{specifier.name}` needs {dependency}" for dependency, specifier in cycle)
    place = next((s.node.span for _, s in cycle if not s.is_default), next((s.node.span for _, s in cycle if s.node.span != NOWHERE), span))
    example = "position with `at`" if "position" in names else f"`with {names[0]} 2`"
    return CyclicDependencies(
        f"the specifiers depend on each other in a circle: {steps}", place, cycle=(*names, names[0]), rule="R-Cyclic",
        hint=f"specify one of these properties without the others, for example {example}",
    )
