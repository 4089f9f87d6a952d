"""The programs of a campaign: small ones aimed at what implementations get wrong, each on one theme, and those of the generator."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...interpreter.runtime.random_streams import fold, mix
from ..generator import ProgramSettings, SeededChoices, random_program
from ..generator.dynamic_programs import dynamic_program
from ..generator.mistakes import ill_formed

RELEASED = ("not visible", "terminate after", "distance past (")
"""What the paper's syntax does not have."""
FREE = "with requireVisible False, with allowCollisions True"
"""For objects about which nothing is required: few runs are rejected, and much is seen of where they are."""


class AimedWriter:
    """The text of one program, from a random generator."""

    def __init__(self, random: np.random.Generator) -> None:
        self.random = random

    def pick(self, *options: str) -> str:
        """One of some texts."""
        return options[int(self.random.integers(len(options)))]

    def chance(self, share: float) -> bool:
        """Whether something happens that does so with that probability."""
        return bool(self.random.random() < share)

    def number(self, low: float, high: float) -> str:
        """A number of that size: written, or drawn from finitely or infinitely many."""
        a, b = (round(float(x), 1) for x in np.sort(self.random.uniform(low, high, 2)))
        c = round((a + b) / 2, 2)
        return self.pick(
            f"{a}", f"{c}", f"Range({a}, {b})", f"Uniform({a}, {b})", f"Discrete({{{a}: 1, {b}: 3}})", f"Normal({c}, {round((b - a) / 8, 3)})",
            f"TruncatedNormal({c}, {round((b - a) / 2 + 0.1, 3)}, {a}, {b})", f"Range({a}, Uniform({c}, {b}))",
        )  # fmt: skip

    def constant(self, low: float, high: float) -> str:
        """A number that is not drawn."""
        return f"{round(float(self.random.uniform(low, high)), 1)}"

    def flag(self) -> str:
        """Return the source of a truth value."""
        return self.pick("True", "False", "Uniform(True, False)", "Discrete({True: 3, False: 1})")

    def place(self, reach: float = 10) -> str:
        """Return the source of a vector."""
        return f"({self.number(-reach, reach)}, {self.number(-reach, reach)})"

    def angle(self) -> str:
        """A heading or an angle, also of more than half a turn."""
        return f"({self.number(-200, 200)}) deg"

    def region(self) -> str:
        """Return the source of a region."""
        c = f"({self.constant(-5, 5)}, {self.constant(-5, 5)})"
        return self.pick(
            f"CircularRegion({c}, {self.constant(3, 8)})",
            f"RectangularRegion({c}, {self.constant(-90, 90)} deg, {self.constant(3, 9)}, {self.constant(3, 9)})",
            f"SectorRegion({c}, {self.constant(3, 9)}, {self.constant(-180, 180)} deg, {self.constant(20, 340)} deg)",
            "PolygonalRegion([(-6, -6), (6, -6), (6, 0), (0, 0), (0, 6), (-6, 6)])", f"PolygonalRegion({self.star()})",
            "PolylineRegion([(-6, 0), (0, 3), (6, 0)])",
            "PointSetRegion('p', [(0, 0), (3, 4), (-2, 5)])",
        )  # fmt: skip

    def star(self) -> str:
        """The corners of a polygon that is seen whole from a point within: three to seven of them, at random distances."""
        turns = np.arange(count := int(self.random.integers(3, 8))) * math.tau / count
        reach = self.random.uniform(2, 8, count)
        corners = np.round(self.random.uniform(-2, 2, 2) + reach[:, None] * np.stack([np.cos(turns), np.sin(turns)], axis=1), 1)
        return "[" + ", ".join(f"({x}, {y})" for x, y in corners.tolist()) + "]"

    def field(self) -> str:
        """A vector field, as a name that is defined before."""
        return self.pick("F", "G")

    def fields(self) -> list[str]:
        """Return the definitions of the vector fields F and G."""
        return ["F = VectorField('F', lambda p: 30 deg)", "G = VectorField('G', lambda p: p.x * 10 deg)"]

    def properties(self, count: int) -> list[str]:
        """Specifiers of some properties, each value drawn."""
        options = [
            ("width", self.number(0.5, 3)), ("length", self.number(0.5, 4)), ("requireVisible", self.flag()), ("allowCollisions", self.flag()),
            ("viewAngle", f"{self.number(20, 360)} deg"), ("viewDistance", self.number(3, 30)), ("speed", self.number(0, 5)),
            ("mutationScale", self.pick("0", "Uniform(0, 1)")), ("positionStdDev", self.number(0, 2)), ("headingStdDev", f"{self.number(0, 60)} deg"),
            ("foo", self.number(0, 9)), ("velocity", self.place(3)), ("angularSpeed", self.number(-1, 1)),
        ]  # fmt: skip
        chosen = self.random.choice(len(options), size=count, replace=False)
        return [f"with {options[int(k)][0]} {options[int(k)][1]}" for k in chosen]

    def objects(self, specifiers: Sequence[str]) -> str:
        """An object with these specifiers."""
        return "Object " + ", ".join(specifiers)

    def visibility(self) -> list[str]:
        """Who sees whom, with view angles up to a full turn."""
        sees = f"with viewAngle {self.number(20, 360)} deg, with viewDistance {self.number(3, 20)}"
        lines = [f"ego = Object at {self.place(3)}, facing {self.angle()}, {sees}"]
        seen = self.pick("visible", f"at {self.place()}", f"offset by {self.place()}", "not visible", f"in {self.region()}")
        lines.append(f"o = Object {seen}, {', '.join(self.properties(int(self.random.integers(0, 3))))}".rstrip(", "))
        what = self.pick("o", self.place(), "front of o", f"(OrientedPoint at {self.place()}, facing {self.angle()})")
        lines.append(self.pick(f"param sees = ego can see {what}", f"require ego can see {what}", f"param sees = o can see {what}", "pass"))
        return lines

    def pruning(self) -> list[str]:
        """Return a program with the structures that the paper's pruning looks for: containment, orientation,
        distance.
        """
        roads = f"PolygonalRegion([(-9, -3), (9, -3), (9, 3), (-9, 3)], orientation={self.field()})"
        region = self.pick("road", self.region())
        lines = [*self.fields(), f"road = {roads}"]
        if self.chance(0.5):
            lines.append("workspace = Workspace(road)")
        lines.append(f"ego = Object in {region}{self.pick('', ', facing ' + self.angle(), f', facing {self.angle()} relative to F')}")
        lines.append(f"o = Object {self.pick('in', 'on')} {region}, with requireVisible {self.flag()}, with width {self.number(0.2, 2)}")
        lines.append(self.pick(
            f"require (distance to o) < {self.constant(2, 6)}", f"require abs(relative heading of o) < {self.constant(10, 60)} deg",
            f"require (angle to o) < {self.constant(0, 90)} deg", f"require (distance from ego to o) >= {self.constant(1, 4)}",
        ))  # fmt: skip
        return lines

    def tails(self) -> list[str]:
        """Rare values of distributions."""
        x = self.pick(
            f"Normal({self.constant(-1, 1)}, {self.constant(0.1, 3)})", f"TruncatedNormal(0, 1, {self.constant(0.5, 2)}, {self.constant(2.1, 4)})",
            "Range(0, 1)", "Discrete({1: 1, 2: 1, 3: 1})", f"Uniform(Range(0, 1), {self.constant(0, 2)})", "Range(2, 1)", "DiscreteRange(0, 3)",
        )
        how = self.pick("x > 0.8", "abs(x) > 1", "x * x > 0.5", "x >= 1", "not (x < 0.7)", "x < y", "x + y > 1")
        lines = [f"x = {x}", f"y = {self.pick('resample(x)', 'x', self.number(0, 1))}"]
        lines.append(f"ego = Object at ({self.pick('x', '0')}, y)")
        lines.append(self.pick(f"require {how}", f"require[{self.pick('0.1', '0.5', '0.9', 'Range(0.1, 0.9)', '1', '0')}] {how}"))
        lines.append("param x = x, y = y")
        return lines

    def mutation(self) -> list[str]:
        """Noise, and what is required of noisy objects."""
        lines = [f"workspace = Workspace({self.region()})"] if self.chance(0.4) else []
        noisy = f"with positionStdDev {self.number(0.1, 1)}, with headingStdDev {self.number(1, 20)} deg"
        lines.append(f"ego = Object at {self.place(1)}, facing {self.angle()}" + (f", {noisy}" if self.chance(0.5) else ""))
        lines.append(f"o = Object at {self.place(4)}, {', '.join(self.properties(2))}")
        lines.append(self.pick("mutate", "mutate ego", "mutate o", f"mutate ego, o by {self.constant(0.2, 3)}", f"mutate by {self.constant(0.2, 3)}"))
        lines.append(self.pick("param h = o.heading, x = ego.position.x", "require (distance to o) > 1", "param d = distance to o", "mutate o by 2"))
        return lines

    def defaults(self) -> list[str]:
        """Default values of classes, with every specifier."""
        lines = [*self.fields(), "class A:"]
        foo = [f"foo: {self.number(0, 5)}", "bar: self.width * 2"]
        values = [
            f"width: {self.number(0.5, 2)}", f"position: {self.place()}", f"heading: {self.pick(self.angle(), 'F at self.position')}",
            "length: self.foo + 1", "requireVisible: Uniform(True, False)", f"viewAngle: {self.number(90, 360)} deg", "mutationScale: 1",
            "baz: (self.foo, self.bar)", "allowCollisions: True",
        ]  # fmt: skip
        chosen = sorted(self.random.choice(len(values), size=2, replace=False).tolist())
        lines += [f"    {line}" for line in (foo if self.chance(0.9) else [])] + [f"    {values[k]}" for k in chosen]
        lines += [f"    {self.pick('foo: 1', 'bar: 3', 'foo: 2')}"] if self.chance(0.1) else []
        if self.chance(0.5):
            lines += ["class B(A):", f"    {self.pick(*foo, *values)}"]
        head = "B" if "class B(A):" in lines else "A"
        lines.append(f"ego = {head} {self.specifier(ego=False)}")
        lines.append(f"o = {self.pick(head, 'Object')} {self.specifier()}, {self.pick(FREE, 'with allowCollisions True')}")
        lines += [f"p = A at {self.place()}, {FREE}"] if self.chance(0.7) else []
        return lines

    def specifier(self, *, ego: bool = True) -> str:
        """One or two specifiers of a position or a heading."""
        v, s = self.place(), self.number(0.5, 4)
        free = [
            f"at {v}", f"in {self.region()}", f"on {self.region()}", f"left of {v} by {s}", f"ahead of {v} by {s}", f"right of {v}",
            f"behind {v} by {s}",
        ]  # fmt: skip
        with_ego = [
            f"offset by {v}", f"offset along {self.angle()} by {v}", f"beyond {v} by {self.place(3)}",
            f"beyond {v} by {self.place(3)} from {self.place()}",
            "visible", f"visible from ({self.pick('Point', 'OrientedPoint')} at {v})", f"left of ego by {s}", f"ahead of ego by {s}", "right of ego",
            f"behind ego by {s}", f"following F for {s}", f"following G from {v} for {s}", f"left of (front of ego) by {s}",
            f"beyond ego by {self.place(3)}",
        ]  # fmt: skip
        where = self.pick(*(free if not ego else [*free, *with_ego]))
        if where.startswith(("left", "right", "ahead", "behind")) and "ego" not in where and self.chance(0.8):
            return where + self.pick("", f", facing {self.angle()}")  # what needs the position would make a circle
        turned = [
            "", "", f", facing {self.angle()}", ", facing F", f", facing toward {v}", f", facing away from {v}",
            f", facing {self.angle()} relative to F",
        ]  # fmt: skip
        about = [f", apparently facing {self.angle()}", f", apparently facing {self.angle()} from {v}", ", facing 10 deg relative to ego"]
        return where + self.pick(*turned, *(about if ego else []))

    def operators(self) -> list[str]:
        """Every operator, its operands drawn or not."""
        lines = [*self.fields(), f"ego = Object {self.specifier(ego=False)}"]
        lines.append(f"o = Object at ({self.constant(12, 20)}, {self.constant(12, 20)}), facing {self.angle()}")
        lines.append(f"P = OrientedPoint at {self.place()}, facing {self.angle()}")
        v, w, h = self.place(), self.place(), self.angle()
        options = [
            f"relative heading of {h}", f"relative heading of {h} from {self.angle()}", "relative heading of o", "apparent heading of o",
            f"apparent heading of P from {v}",
            f"distance to {v}", f"distance from {v} to {w}", "distance from o to P", "distance past o", f"distance past {v} of P", f"angle to {v}",
            f"angle from {v} to {w}", f"ego can see {v}", "P can see o", f"{v} in {self.region()}", f"o in {self.region()}", f"F at {v}", f"G at {v}",
            f"{h} relative to F", f"{h} relative to {self.angle()}", f"{v} relative to {w}", f"{v} relative to P", "P offset by (1, 2)",
            f"{v} offset by {w}",
            f"{v} offset along {h} by {w}", f"{v} offset along F by {w}", "front of o", "back left of o", "left of ego",
            f"follow F from {v} for {self.number(0, 4)}",
            f"follow G from {v} for {self.number(0, 4)}", "(front of o).heading", "(right of ego).position", f"(o offset by {v})", f"-{h}",
        ]  # fmt: skip
        chosen = self.random.choice(len(options), size=2, replace=False)
        lines += [f"param q{n} = {options[int(k)]}" for n, k in enumerate(chosen)]
        return lines

    def specifiers(self) -> list[str]:
        """Some objects, each placed by a specifier, perhaps beside the one before."""
        lines = [*self.fields(), f"ego = Object at {self.place(3)}, facing {self.angle()}"]
        lines += [f"o = Object {self.specifier()}, {FREE}" for _ in range(int(self.random.integers(2, 5)))]
        side = self.pick("left of", "right of", "ahead of", "behind")
        lines += [f"p = Object {side} o by {self.number(0.5, 4)}, {FREE}"] if self.chance(0.3) else []
        return lines

    def regions(self) -> list[str]:
        """Points in regions of every kind, with an orientation or without, and what is in them."""
        polygon = f"PolygonalRegion({self.star()}{self.pick('', ', orientation=F', ', orientation=G')})"
        lines = [*self.fields(), f"R = {polygon}", f"ego = Object {self.pick('in', 'on')} {self.pick('R', self.region())}, {FREE}"]
        where = self.pick("R", "R", self.region())
        lines += [f"o = Object {self.pick('in', 'on')} {where}{self.pick('', ', facing F', f', facing {self.angle()}')}, {FREE}"]
        point = f"p = Point in {self.region()}\nparam p = p.position"
        lines.append(self.pick("pass", f"param inside = {self.place()} in R", f"require o in {self.region()}", point))
        return lines

    def functions(self) -> list[str]:
        """Functions: a default is drawn once, a body at every call; arguments of every kind."""
        drawn = self.number(0, 5)
        lines = [self.pick(
            f"def f(a={drawn}):\n    return a", f"def f(a={drawn}, b={self.number(0, 2)}):\n    return a + b", f"f = lambda a={drawn}: a * 2",
            f"def f(a={drawn}):\n    return a + {self.number(0, 1)}", f"def f(*rest, a={drawn}):\n    return a + len(rest)",
            f"def outer(n={drawn}):\n    def inner(a=n):\n        return a\n    return inner\nf = outer()",
            f"def f(a={drawn}, **rest):\n    return a",
        )]  # fmt: skip
        calls = [self.pick("f()", "f()", f"f(a={self.number(0, 5)})", "f() + f()") for _ in range(3)]
        if self.chance(0.3):
            lines += ["class A:", f"    foo: {calls[0]}", f"ego = A at (f(), 0), {FREE}", f"o = A at (9, {calls[1]}), {FREE}"]
        else:
            lines += [f"ego = Object at ({calls[0]}, {calls[1]})", f"param x = {calls[2]}, y = f()"]
        return lines

    def soft(self) -> list[str]:
        """Soft requirements on relations, more than one; or one that seldom holds by chance, so that it counts how often the coin is thrown."""
        if self.chance(0.5):
            lines = [f"x = {self.pick('Range(0, 1)', 'Uniform(0, 0.2, 0.4, 0.6, 0.8)', 'Normal(0.4, 0.2)')}", "ego = Object at (x, 0)"]
            return [*lines, f"require[{self.constant(0.3, 0.8)}] {self.pick('x < 0.15', 'x >= 0.75', '(distance from (0.1, 0) to ego) < 0.15')}"]
        lines = [f"ego = Object at {self.place(3)}, facing {self.angle()}", f"o = Object at {self.place()}, with requireVisible {self.flag()}"]
        relations = [
            f"(distance to o) < {self.constant(2, 9)}", f"(relative heading of o) > {self.constant(-1, 1)}", "ego can see o",
            f"(angle to o) < {self.constant(-1, 1)}",
            f"o in {self.region()}", f"(apparent heading of o) < {self.constant(-1, 1)}",
        ]  # fmt: skip
        return lines + [f"require[{self.constant(0, 1)}] {self.pick(*relations)}" for _ in range(int(self.random.integers(1, 3)))]

    def drawn(self) -> list[str]:
        """Every property drawn at random."""
        lines = [self.objects([f"at {self.place(3)}", f"facing {self.angle()}", *self.properties(2)])]
        lines = [f"ego = {lines[0]}"]
        lines += [self.objects([f"at {self.place(6)}", *self.properties(3)]) for _ in range(int(self.random.integers(1, 3)))]
        return lines

    def dynamics(self) -> list[str]:
        """Overrides, interrupts in sub-scenarios, objects that are made during a run."""
        lines = ["behavior B(n=1):", "    try:", f"        {self.pick('while True: take n', 'take n, self.foo', 'do C() for 2 steps')}"]
        lines[-1:] = ["        while True:", "            take n"] if "while" in lines[-1] else [lines[-1]]
        when = self.pick("simulation.currentTime == 1", "self.position.x > 0", "self.foo > 1")
        lines += [f"    interrupt when {when}:", f"        {self.pick('take 7', 'do C()', 'abort', 'wait')}"]
        lines += ["behavior C():", f"    take {self.pick('5', 'self.foo', 'self.heading')}"]
        lines += [f"    {self.pick('take 6', 'wait', 'terminate', 'self.foo = 3')}"]
        lines += ["scenario Part(n=2):", "    setup:"]
        made = f"Object at ({self.constant(20, 30)}, 9), with behavior B(n)"
        lines += [f"        {self.pick('override ego with foo n', 'override ego with behavior C', made, 'y = n')}"]
        ends = ("terminate when simulation.currentTime >= 2", "terminate after 2 steps", "pass", "require ego.foo < 5")
        lines += [f"        {self.pick(*ends)}"]
        if self.chance(0.5):
            lines += ["    compose:", f"        {self.pick('wait', 'terminate', 'wait')}", "        wait"]
        ego = f"ego = Object at {self.place(2)}, with foo {self.pick('0', '2', 'Uniform(0, 2)')}, with behavior B"
        lines += ["scenario Main():", "    setup:", f"        {ego}"]
        run = self.pick(
            "do Part()", "do Part(3) for 2 steps", "do Part() until simulation.currentTime == 1", "do choose Part(1), Part(4)",
            "do shuffle Part(1), Part(4)", "do Part(), Part(5)",
        )  # fmt: skip
        lines += ["    compose:"]
        if self.chance(0.4):
            lines += ["        try:", f"            {run}", f"        interrupt when {self.pick('simulation.currentTime == 1', 'ego.foo == 2')}:"]
            lines += [f"            {self.pick('do Part(6) for 1 steps', 'wait', 'abort')}"]
        else:
            lines += [f"        {run}"]
        return [*lines, f"        {self.pick('wait', 'do Part(9)', 'terminate', 'pass')}"]

    @property
    def themes(self) -> Sequence[Callable[[], list[str]]]:
        """The methods that write a program of each theme."""
        return (
            self.visibility, self.pruning, self.tails, self.mutation, self.defaults, self.specifiers, self.specifiers, self.regions,
            self.functions, self.operators, self.operators, self.soft, self.drawn, self.dynamics,
        )  # fmt: skip

    def program(self, theme: int) -> str:
        """A whole program, about that one of the themes."""
        text = "\n".join(self.themes[theme]()) + "\n"
        if not any(words in text for words in RELEASED):
            return text
        return "# dialect: scenic-2.1\n" + text.replace("simulation.", "simulation().")  # where the clock is called


def aimed_program(seed: int, number: int) -> str:
    """Aimed program `number` of `seed`: its text, in the paper's syntax or in that of Scenic 2.1.

    As many of them, one after the other, as there are themes are about each once.
    """
    writer = AimedWriter(np.random.default_rng([fold(seed), mix(number)]))
    return writer.program(in_turn(seed, number, len(writer.themes)))


def in_turn(seed: int, number: int, count: int) -> int:
    """Return which of `count` things comes at a place when they take turns, in another order each time."""
    turn, place = divmod(number, count)
    return int(np.random.default_rng([fold(seed), mix(turn), count]).permutation(count)[place])


THEMES = {"aimed": 6, "static": 5, "dynamic": 2, "mistaken": 1}
"""How often each kind of program is invented, in each turn of so many together: what is rare does not stay away by chance."""
KINDS = [theme for theme, often in THEMES.items() for _ in range(often)]
FEATURE = 0.35
"""The probability that a program may use a feature of the general generator: with few at a time, one fault does not hide another."""


class Invented(NamedTuple):
    """A program: what kind it is, and its text."""

    theme: str
    text: str


def generate_themed_program(seed: int, number: int) -> Invented:
    """Program `number` of a campaign's seed."""
    random = np.random.default_rng([fold(seed), mix(number), 16])
    kind = in_turn(seed, number, len(KINDS))
    match KINDS[kind]:
        case "aimed":
            return Invented("aimed", aimed_program(seed, number // len(KINDS) * THEMES["aimed"] + kind))
        case "static":
            return Invented("static", random_program(seed, number, knobs(random)).text)
        case "dynamic":
            return Invented("dynamic", dynamic_program(seed, number, int(random.integers(1, 3)), int(random.integers(0, 2))))
        case _:
            return Invented("mistaken", ill_formed(SeededChoices(seed, number)).text)


def knobs(random: np.random.Generator) -> ProgramSettings:
    """A small program with few features, half of the time a finite one."""
    settings = ProgramSettings(
        max_objects=int(random.integers(1, 4)), max_statements=int(random.integers(1, 9)), max_depth=int(random.integers(0, 3)),
        max_classes=int(random.integers(0, 2)), finite=bool(random.random() < 0.5),
    )  # fmt: skip
    return replace(settings, **{name: 0.9 if random.random() < FEATURE else 0.0 for name, _ in settings.features()})

