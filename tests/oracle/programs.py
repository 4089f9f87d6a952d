"""Dynamic programs as data: what the oracle runs, and their text in Scenic. Expressions are texts that Python and Scenic read alike.

Nothing here is the project's: the oracle and its programs import nothing of it.
"""

from __future__ import annotations

from dataclasses import dataclass

Line = tuple["Statement", ...]
"""A block: one statement after the other."""


@dataclass(frozen=True)
class TakeActions:
    """`take E, ...`."""

    values: tuple[str, ...]


@dataclass(frozen=True)
class LetStepPass:
    """`wait`."""


@dataclass(frozen=True)
class Assign:
    """`NAME = E` or `NAME.x = E`."""

    target: str
    value: str


@dataclass(frozen=True)
class Demand:
    """`require B`, or `require[p] B`."""

    condition: str
    probability: str = ""


@dataclass(frozen=True)
class Declaration:
    """`require always B`, `require eventually B` or `terminate when B`."""

    kind: str
    condition: str


@dataclass(frozen=True)
class Watchman:
    """`monitor NAME:`, which runs from here on."""

    name: str
    body: Line


@dataclass(frozen=True)
class Leave:
    """`terminate`, `abort`, `return`, `break`, `continue`."""

    word: str


@dataclass(frozen=True)
class Branch:
    """`if B: ... else: ...`."""

    condition: str
    then: Line
    otherwise: Line


@dataclass(frozen=True)
class Repeat:
    """`for i in range(TIMES):`, or `while B:` if there is a condition."""

    times: int
    condition: str
    body: Line


@dataclass(frozen=True)
class Invitation:
    """`NAME(E)`: a behavior or scenario with its argument `n`, and its weight where one of several is chosen."""

    name: str
    argument: str
    weight: int = 1


@dataclass(frozen=True)
class Extent:
    """`for N steps`, or `until B` if there is a condition."""

    steps: int
    condition: str = ""


@dataclass(frozen=True)
class Carry:
    """`do`, `do choose` or `do shuffle`, with or without a limit."""

    way: str
    what: tuple[Invitation, ...]
    limit: Extent | None = None


@dataclass(frozen=True)
class Attempt:
    """`try: ... interrupt when B: ... except E: ...`."""

    body: Line
    interrupts: tuple[tuple[str, Line], ...]
    catches: tuple[tuple[str, Line], ...] = ()


@dataclass(frozen=True)
class Overriding:
    """`override OBJECT with x E`, or `with behavior B(E)`."""

    thing: str
    x: str = ""
    behavior: Invitation | None = None


@dataclass(frozen=True)
class Creation:
    """`NAME = Object at (PLACE, 0), with x E, with behavior B(E)`."""

    name: str
    place: str
    x: str
    behavior: Invitation | None = None


Statement = (
    TakeActions | LetStepPass | Assign | Demand | Declaration | Watchman | Leave | Branch | Repeat | Carry | Attempt | Overriding | Creation
)


@dataclass(frozen=True)
class Procedure:
    """`behavior NAME(n=1):`."""

    name: str
    preconditions: tuple[str, ...]
    invariants: tuple[str, ...]
    body: Line


@dataclass(frozen=True)
class ModularScenario:
    """`scenario NAME(n=1):`, with or without a compose block."""

    name: str
    preconditions: tuple[str, ...]
    invariants: tuple[str, ...]
    setup: Line
    compose: Line | None


@dataclass(frozen=True)
class DynamicProgram:
    """Behaviors, scenarios (the first is Main if there are any), and the statements of the program itself, which make ego."""

    behaviors: tuple[Procedure, ...]
    scenarios: tuple[ModularScenario, ...]
    top: Line


# As text


def text_of(program: DynamicProgram) -> str:
    """The program in Scenic."""
    lines = ["def now():", "    return simulation.currentTime"]
    for behavior in program.behaviors:
        lines += [f"behavior {behavior.name}(n=1):", *indented(guards(behavior)), *indented(block(behavior.body))]
    lines += block(program.top)
    for scenario in program.scenarios:
        head = f"scenario {scenario.name}({'' if scenario.name == 'Main' else 'n=1'}):"
        lines += [head, *indented(guards(scenario)), "    setup:", *indented(indented(block(scenario.setup)))]
        if scenario.compose is not None:
            lines += ["    compose:", *indented(indented(block(scenario.compose)))]
    return "\n".join(lines) + "\n"


def guards(one: Procedure | ModularScenario) -> list[str]:
    """The lines with its guards."""
    return [*(f"precondition: {b}" for b in one.preconditions), *(f"invariant: {b}" for b in one.invariants)]


def indented(lines: list[str]) -> list[str]:
    """The lines, four spaces to the right."""
    return [f"    {line}" for line in lines]


def block(statements: Line) -> list[str]:
    """The lines of a block."""
    return [line for statement in statements for line in lines_of(statement)] or ["pass"]


def lines_of(statement: Statement) -> list[str]:
    """The lines of a statement."""
    match statement:
        case TakeActions(values):
            return [f"take {', '.join(values)}"]
        case LetStepPass():
            return ["wait"]
        case Assign(target, value):
            return [f"{target} = {value}"]
        case Demand(condition, probability):
            return [f"require[{probability}] {condition}" if probability else f"require {condition}"]
        case Declaration(kind, condition):
            return [f"{kind} {condition}"]
        case Watchman(name, body):
            return [f"monitor {name}:", *indented(block(body))]
        case Leave(word):
            return [word]
        case Branch(condition, then, otherwise):
            return [f"if {condition}:", *indented(block(then)), "else:", *indented(block(otherwise))]
        case Repeat(times, condition, body):
            return [f"while {condition}:" if condition else f"for i in range({times}):", *indented(block(body))]
        case Carry(way, what, limit):
            weighted = way and any(one.weight != 1 for one in what)
            names = ", ".join(f"{called(one)}: {one.weight}" if weighted else called(one) for one in what)
            names = f"{{{names}}}" if weighted else names
            ending = "" if limit is None else f" until {limit.condition}" if limit.condition else f" for {limit.steps} steps"
            return [f"do {way} {names}{ending}" if way else f"do {names}{ending}"]
        case Attempt(body, interrupts, catches):
            lines = ["try:", *indented(block(body))]
            for condition, handler in interrupts:
                lines += [f"interrupt when {condition}:", *indented(block(handler))]
            for exception, handler in catches:
                lines += [f"except {exception}:", *indented(block(handler))]
            return lines
        case Overriding(thing, x, behavior):
            return [f"override {thing} with x {x}" if behavior is None else f"override {thing} with behavior {called(behavior)}"]
        case Creation(name, place, x, behavior):
            return [f"{name} = Object at ({place}, 0), with x {x}" + ("" if behavior is None else f", with behavior {called(behavior)}")]


def called(one: Invitation) -> str:
    """A behavior or scenario with its argument."""
    return f"{one.name}({one.argument})"
