"""Factorised rejection: which draws may be made apart from all others, again and again until what is required of them alone holds.

The draws of a program are independent, and a requirement is about those that it is computed from. So a component (draws, and the requirements
about nothing else) may be drawn by rejection on its own: the product of such conditional distributions is the distribution of all draws given
all these requirements. Components form a tree. A requirement about draws of several components belongs to one around them, and if it fails,
all of that is drawn again: to draw again only the object that collides would be wrong, since it favours what is easily completed. For the same
reason draws that others are relative to are in one component with these (Section "Domain-Specific Sampling Techniques" has no such method).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count

from .evaluation_plan import LEAST_REJECTED, PlanStep, cone, cost, only_rejects, plan, roots_of
from .graph import Graph, GraphNode, RowDraw, Site
from .symbolic import children

Address = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Component:
    """Draws that are repeated together with those of the `parts`, each of which is drawn on its own first, until the events hold.

    The events are about nothing else.
    """

    own: frozenset[Address]
    events: tuple[int, ...]
    parts: tuple[Component, ...] = ()

    @property
    def addresses(self) -> frozenset[Address]:
        """All draws, those of the parts included."""
        return self.own.union(*(part.addresses for part in self.parts))


def components(graph: Graph) -> Component:
    """The tree of components; without parts if the requirements leave none, or if some runs may take another course (see `obstacle`).

    What is never drawn again within a scene belongs to no component.
    """
    everything = frozenset(a for node in graph.nodes for a in drawn_at([node]))
    if obstacle(graph) is not None:
        return Component(everything, tuple(range(len(graph.events))))
    about = [frozenset(drawn_at(cone(roots_of(event), set()))) for event in graph.events]
    tops: list[Component] = []
    for place in sorted(range(len(about)), key=lambda k: len(about[k])):
        met = [c for c in tops if c.addresses & about[place]]
        tops = [c for c in tops if c not in met]
        tops.append(join_components(about[place].difference(*(c.addresses for c in met)), (place,), met))
    loose = tuple(event for c in tops if not c.addresses for event in c.events)
    tops = [c for c in tops if c.addresses]
    return join_components(everything.difference(*(c.addresses for c in tops)), loose, tops)


def join_components(own: frozenset[Address], events: tuple[int, ...], parts: Sequence[Component]) -> Component:
    """A component around others; one part alone is drawn again whenever the whole is, so that they are the same."""
    if len(parts) == 1:
        (part,) = parts
        return Component(part.own | own, (*part.events, *events), part.parts)
    return Component(own, events, tuple(parts))


def drawn_at(nodes: Sequence[GraphNode]) -> set[Address]:
    """The draws among the nodes that differ from attempt to attempt."""
    return {n.function.address for n in nodes if isinstance(n.function, (Site, RowDraw)) and not n.function.per_scene}


def obstacle(graph: Graph) -> str | None:
    """Why draws may not be repeated apart: the graph does not describe all runs."""
    return None if all(map(only_rejects, graph.events)) else "some runs may take another course, or call functions that the language does not have"


# Which are worth it


WORTH = 0.8
"""A part stays apart if the expected cost of all is at most this share of what it is without."""
NEVER = 1 / 1024
"""The probability with which a requirement is taken to hold that no run has met."""
LEAST = 1e-100
"""No probability is taken to be smaller."""


def worthwhile(graph: Graph, component: Component, rejects: Mapping[int, float]) -> Component:
    """The tree without the parts that do not pay, as those that only delay a cheap requirement which most attempts fail.

    `rejects` says how often each event rejects a run; events are taken to be independent.
    """
    if not component.parts:
        return component
    parts = [worthwhile(graph, part, rejects) for part in component.parts]
    best = join_components(component.own, component.events, parts)
    for part in parts:
        if part not in best.parts:
            continue  # it was the only one that was left, so that it is part of the whole already
        others = [p for p in best.parts if p is not part]
        without = join_components(best.own | part.own, (*best.events, *part.events), [*others, *part.parts])
        if WORTH * expense(graph, without, rejects) < expense(graph, best, rejects):
            best = without
    return best


def expense(graph: Graph, component: Component, rejects: Mapping[int, float]) -> float:
    """The expected cost of drawing a component until it is accepted, in operations on numbers."""
    known = event_node_numbers(graph, component.parts)
    total = sum(expense(graph, part, rejects) for part in component.parts)
    alive = 1.0
    rate = lambda k: min(rejects.get(k, 0.5), 1 - NEVER)  # noqa: E731
    prices = {k: cost(cone(roots_of(graph.events[k]), known)) / max(rate(k), LEAST_REJECTED) for k in component.events}
    for k in sorted(component.events, key=prices.__getitem__):
        nodes = cone(roots_of(graph.events[k]), known)
        known.update(node.number for node in nodes)
        total += alive * cost(nodes)
        alive = max(alive * (1 - rate(k)), LEAST)
    return total / alive


def event_node_numbers(graph: Graph, parts: Iterable[Component]) -> set[int]:
    """The nodes that the events of the parts are about, by number."""
    roots = [root for part in parts for k in part.events for root in roots_of(graph.events[k])]
    return {n.number for n in cone(roots, set())}.union(*(event_node_numbers(graph, part.parts) for part in parts))


# Plans


@dataclass(frozen=True, eq=False, slots=True)
class Stage:
    """How a component is evaluated: its parts, then its steps, which give `outputs`. `number` counts the stages of the tree, the whole being 0."""

    number: int
    own: frozenset[Address]
    steps: tuple[PlanStep, ...]
    outputs: tuple[GraphNode, ...]
    parts: tuple[Stage, ...]

    @property
    def all(self) -> list[Stage]:
        """The stage and all stages of its parts."""
        return [self, *(inner for part in self.parts for inner in part.all)]


def stages(graph: Graph, whole: Component, outputs: Sequence[GraphNode], rejects: Mapping[int, float]) -> Stage:
    """The plan of each component. `rejects` says how often an event rejects a run."""
    numbers = count()

    def make(component: Component, outputs: Sequence[GraphNode]) -> Stage:
        number = next(numbers)
        inside = [event_node_numbers(graph, [part]) | sites(graph, part.addresses) for part in component.parts]
        known = set[int]().union(*inside)
        needed = frontier([*outputs, *(root for k in component.events for root in roots_of(graph.events[k]))], known)
        parts = [make(part, [n for n in needed if n.number in there]) for part, there in zip(component.parts, inside, strict=True)]
        return Stage(number, component.own, plan(graph, outputs, rejects, component.events, known), tuple(outputs), tuple(parts))

    return make(whole, outputs)


def sites(graph: Graph, addresses: Collection[Address]) -> set[int]:
    """The numbers that are drawn at some addresses, by their nodes: they are of the attempt of the component that the address belongs to."""
    drawn = (n for n in graph.nodes if isinstance(n.function, (Site, RowDraw)) and not n.function.per_scene)
    return {n.number for n in drawn if n.function.address in addresses}  # type: ignore[union-attr]


def frontier(roots: Sequence[GraphNode], known: Collection[int]) -> list[GraphNode]:
    """The known nodes that the roots are computed from, or are."""
    found = {n.number: n for n in (*roots, *(child for node in cone(list(roots), set(known)) for child in children(node)))}
    return [found[number] for number in sorted(found) if number in known]


# Report


def describe_factorisation(graph: Graph, chosen: Component, places: Sequence[tuple[str, Sequence[GraphNode]]]) -> list[str]:
    """Describe the parts that are drawn separately, or the reason why none are. `places` has each object's
    name, and the nodes that its position is made of.
    """
    off = "factorised rejection is off"
    if not chosen.parts:
        reason = obstacle(graph)
        return [f"{off}: {reason or ('it would not save work' if components(graph).parts else 'the requirements connect all draws')}"]
    homes = [(name, drawn_at(cone(list(nodes), set()))) for name, nodes in places]

    def lines(component: Component, depth: int) -> Iterator[str]:
        for part in component.parts:
            inside = [name for name, home in homes if home and home <= part.addresses]
            which = ", ".join(inside[:MOST_NAMED]) + (", ..." if len(inside) > MOST_NAMED else "")
            lines_of = sorted({e.requirement.span.line for k in part.events if (e := graph.events[k]).requirement and e.requirement.span.line})
            where = f" (line{'s' * (len(lines_of) > 1)} {', '.join(map(str, lines_of[:MOST_NAMED]))})" if lines_of else ""
            yield (
                f"{'  ' * depth}{pluralise_count(len(part.addresses), 'draw')}, "
                f"{pluralise_count(len(part.events), 'requirement')}{where}{which and ': ' + which}"
            )
            yield from lines(part, depth + 1)

    return ["drawn apart, each again until the requirements about it alone hold:", *lines(chosen, 1)]


MOST_NAMED = 6


def pluralise_count(number: int, what: str) -> str:
    """A number of things."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
