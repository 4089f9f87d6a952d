"""Traces: every rule that fired in a run, with its probability, what it changed, and where it stands in the source."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ..semantics.config import Config
from ..semantics.outcome import Change, Done, Draw, Next, Observe, Outcome, Stuck
from ..semantics.rules import RULES
from ..semantics.syntax.nodes import NOWHERE, Span
from ..semantics.values import Instance, unwrap
from .running import Accepted, Chooser, Run, run


@dataclass(frozen=True, slots=True)
class Event:
    """One rule that fired.

    `log_density` is the logarithm of its probability (density), 0 for rules without; `change` says what became what;
    `kind` is "rule", "draw", "requirement", "done" or "stuck".
    """

    number: int
    rule: str
    kind: str
    span: Span
    log_density: float = 0.0
    change: str = ""

    @property
    def name(self) -> str:
        """The paper's name of the rule."""
        return RULES[self.rule].name if self.rule in RULES else ""

    def to_json(self) -> dict[str, object]:
        """The event for the page that steps through a trace."""
        return {
            "number": self.number, "rule": self.rule, "name": self.name, "kind": self.kind, "file": self.span.file, "line": self.span.line,
            "column": self.span.column, "endLine": self.span.end_line, "endColumn": self.span.end_column, "logDensity": finite(self.log_density),
            "change": self.change,
        }


def finite(number: float) -> float | str:
    """A number as JSON can hold it."""
    return number if math.isfinite(number) else repr(number)


@dataclass
class Trace:
    """The events of one run, the draws by address, and how the run ended."""

    events: list[Event] = field(default_factory=list)
    draws: dict[tuple[int, ...], object] = field(default_factory=dict)
    run: Run | None = None

    @property
    def log_density(self) -> float:
        """The logarithm of the product of the probabilities of all rules that fired: the density of the execution trace."""
        return math.fsum(e.log_density for e in self.events)

    @property
    def accepted(self) -> bool:
        """Whether the run ended with a scene."""
        return isinstance(self.run, Accepted)

    def witness(self, outcome: Outcome, drawn: object) -> None:
        """Add an outcome of the run."""
        event = event_of(len(self.events) + 1, outcome, drawn)
        if event is not None:
            self.events.append(event)
        if isinstance(outcome, Draw):
            self.draws[outcome.address] = drawn


def trace(config: Config, choose: Chooser, *, fuel: int) -> Trace:
    """Run once and keep every rule that fired. Raises the program's errors."""
    found = Trace()
    found.run = run(config, choose, fuel=fuel, witness=found.witness)
    return found


def event_of(number: int, outcome: Outcome, drawn: object) -> Event | None:
    """The event of an outcome; bookkeeping between rules has none."""
    match outcome:
        case Next(rule=""):
            return None
        case Next(rule=rule, node=node, change=change, config=config):
            span = node.span if node is not None else getattr(config.control, "span", NOWHERE)
            return Event(number, rule, "rule", span, change=describe(change))
        case Draw(rule=rule, node=node, distribution=distribution):
            parameters = ", ".join(f"{k}={show(v)}" for k, v in distribution.parameters.items())
            change = f"{show(drawn)} ~ {distribution.name}({parameters})"
            return Event(number, fired(rule, drawn), "draw", node.span, distribution.log_density(drawn), change)
        case Observe(rule=rule, requirement=requirement):
            return Event(number, rule, "requirement", requirement.span, change=f"{requirement.text}: holds")
        case Done(rule=rule):
            return Event(number, rule, "done", NOWHERE, change="all default requirements hold: (π, O)")
        case Stuck(rule=rule, requirement=requirement):
            return Event(number, rule, "stuck", requirement.span, -math.inf, f"{requirement.text}: does not hold, so no rule applies")
        case _:
            return None


def fired(rule: str, drawn: object) -> str:
    """Which of the two soft requirement rules the coin chose; any other draw has one rule."""
    return rule if rule != "S-SoftReq" else "S-SoftReq-Check" if drawn else "S-SoftReq-Skip"


def describe(change: Change | None) -> str:
    """What a step changed, in the paper's notation."""
    if change is None or (change.where == "" and change.name != "order"):
        return ""
    if change.where == "print":
        return f"prints {change.value}"
    if change.name == "order" and isinstance(change.value, tuple):
        return "order: " + ", ".join(f"{s.name} → {{{', '.join(names)}}}" for s, names in change.value)
    if isinstance(change.value, Instance) and change.where == "O":
        return f"O ∪ {{{change.name}}}"
    return f"{change.where}[{change.name} / {show(change.value)}]"


def show(value: object) -> str:
    """A value in a line of a trace: short, and the same in every run of the same seed."""
    inner = unwrap(value)[0]
    text = f"{inner:.6g}" if isinstance(inner, float) else repr(inner)
    return text if len(text) <= 80 else text[:77] + "..."


def lines_of(programs: Mapping[str, str], span: Span) -> str:
    """The source line of a place, stripped; empty where there is none."""
    lines = programs.get(span.file, "").splitlines()
    return lines[span.line - 1].strip() if 0 < span.line <= len(lines) else ""
