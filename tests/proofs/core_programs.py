"""Random programs of the static core, as Scenic text and as terms of `proofs/kernel/Machine.v`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random

NAMES = {
    0: "position", 1: "heading", 2: "width", 3: "length", 4: "viewDistance", 5: "mutationScale", 6: "positionStdDev", 7: "headingStdDev",
    8: "allowCollisions", 9: "requireVisible", **{p: f"p{p}" for p in range(10, 16)},
}  # fmt: skip
OWN = (10, 11, 12, 13)
"""Properties that the classes of the programs define; others of these names are only specified."""


@dataclass(frozen=True)
class Both:
    """An expression, in Scenic and in Coq."""

    scenic: str
    coq: str


def number(value: Fraction) -> Both:
    """A literal."""
    return Both(f"({decimal(value)})", f"(Constant (Number {fraction(value)}))")


def decimal(value: Fraction) -> str:
    """The number as it is written in Scenic: with few digits, since denominators are small powers of two or of ten."""
    return str(value.numerator) if value.denominator == 1 else str(float(value))


def fraction(value: Fraction) -> str:
    """A rational number in Coq."""
    return f"(Qmake ({value.numerator}) {value.denominator})"


def listed(items: Iterable[str]) -> str:
    """A list in Coq."""
    return f"[{'; '.join(items)}]"


def truth(value: bool) -> Both:
    """A literal."""
    return Both(str(value), f"(Constant (Truth {str(value).lower()}))")


def variable(index: int) -> Both:
    """The variable with this number, which is `ego` for 0."""
    return Both("ego" if index == 0 else f"x{index}", f"(Name {index}%nat)")


def attribute(of: Both, name: str) -> Both:
    """A property, or a coordinate."""
    if name in ("x", "y"):
        return Both(f"({of.scenic}).{name}", f"(Attribute {of.coq} Coordinate_{name})")
    return Both(f"({of.scenic}).{name}", f"(Attribute {of.coq} (Property {places()[name]}%nat))")


def places() -> Mapping[str, int]:
    """The numbers of the properties, by name."""
    return {name: p for p, name in NAMES.items()}


def self_(p: int) -> Both:
    """self.p"""
    return Both(f"self.{NAMES[p]}", f"(Self {p}%nat)")


BINARY = {
    "+": "(Arithmetic Plus)", "-": "(Arithmetic Minus)", "*": "(Arithmetic Times)", "/": "(Arithmetic Divided)",
    "==": "(Compare Equal)", "!=": "(Compare Unequal)", "<": "(Compare Less)", "<=": "(Compare At_most)", "@": "VectorOf",
}  # fmt: skip


def binary(sign: str, left: Both, right: Both) -> Both:
    """An operator between two expressions."""
    if sign in ("and", "or"):
        return Both(f"({left.scenic} {sign} {right.scenic})", f"(Boolean {str(sign == 'and').lower()} {left.coq} {right.coq})")
    return Both(f"({left.scenic} {sign} {right.scenic})", f"(Binary {BINARY[sign]} {left.coq} {right.coq})")


def unary(sign: str, inner: Both) -> Both:
    """`-E` or `not E`."""
    return Both(f"({sign} {inner.scenic})", f"({'Negative' if sign == '-' else 'Not'} {inner.coq})")


def uniform(values: Sequence[Both]) -> Both:
    """`Uniform(E, ...)`."""
    text = ", ".join(v.scenic for v in values)
    return Both(f"Uniform({text})", f"(Discrete {listed(f'({v.coq}, {fraction(Fraction(1))})' for v in values)})")


def discrete(values: Sequence[tuple[Both, Fraction]]) -> Both:
    """`Discrete({E: w, ...})`."""
    text = ", ".join(f"{v.scenic}: {decimal(w)}" for v, w in values)
    return Both(f"Discrete({{{text}}})", f"(Discrete {listed(f'({v.coq}, {fraction(w)})' for v, w in values)})")


@dataclass(frozen=True)
class Class:
    """A class with its default value expressions; `has` are the numeric properties that its objects have, `ways` how often they draw."""

    name: str
    defaults: tuple[tuple[int, Both], ...]
    has: tuple[int, ...]
    still: bool = False
    ways: int = 1

    def own(self) -> str:
        """The default value expressions in Coq."""
        return listed(f"({p}%nat, {e.coq})" for p, e in self.defaults)


@dataclass
class Writer:
    """Makes up a program from random numbers: its classes, its statements in Scenic and Coq. `ways` bounds what all draws multiply up to."""

    random: Random
    ways: int = 16
    slips: float = 0.0
    numbers: list[int] = field(default_factory=list[int])
    truths: list[int] = field(default_factory=list[int])
    vectors: list[int] = field(default_factory=list[int])
    drawn: list[int] = field(default_factory=list[int])
    objects: dict[int, Class] = field(default_factory=dict[int, Class])
    classes: list[Class] = field(default_factory=list[Class])
    made: int = 0
    fresh: int = 1

    def slip(self) -> bool:
        """Whether to make a mistake here."""
        return self.random.random() < self.slips

    def may_draw(self, ways: int = 2) -> bool:
        """Whether there may be one more draw of so many values; if so, it is counted."""
        if ways > self.ways:
            return False
        self.ways //= ways
        return True

    def number(self, depth: int = 2, own: Sequence[int] | None = None) -> Both:
        """An expression for a number; in a default value expression, `own` are the properties of self that it may read."""
        random = self.random
        if self.slip():
            by_zero = binary("/", number(Fraction(1)), number(Fraction(0)))
            return random.choice([variable(99), self.vector(0), truth(random.random() < 0.5), attribute(variable(0), "p15"), by_zero])
        kind = random.randrange(11) if depth else random.randrange(3)
        if own and random.random() < 0.5:
            return self_(random.choice(own))
        if kind == 1 and self.numbers:
            return variable(random.choice(self.numbers))
        if kind == 2 and self.objects:
            return self.attribute_of_object()
        if kind == 3:
            return unary("-", self.number(depth - 1, own))
        if kind in (4, 5):
            return binary(random.choice("++--*"), self.number(depth - 1, own), self.number(depth - 1, own))
        if kind == 6:
            by = number(Fraction(random.choice((2, 4))))
            return binary("/", self.number(depth - 1, own), by)
        if kind in (7, 8, 9):
            count = random.choice((2, 2, 3))
            if self.may_draw(count):
                if kind == 7:
                    return uniform([self.number(depth - 1, own) for _ in range(count)])
                return discrete([(number(Fraction(v)), w) for v, w in zip(random.sample(range(-2, 6), count), self.weights(count), strict=True)])
        if kind == 10 and self.vectors:
            return attribute(variable(random.choice(self.vectors)), random.choice("xy"))
        return number(random.choice((Fraction(random.randint(-3, 6)), Fraction(random.randint(-3, 6)), Fraction(random.randint(0, 5), 2))))

    def draw(self) -> Both:
        """A draw among numbers, if there may be one more."""
        if not self.may_draw():
            return self.number(1)
        return discrete([(number(Fraction(v)), w) for v, w in zip(self.random.sample(range(-2, 8), 2), self.weights(2), strict=True)])

    def weights(self, count: int) -> list[Fraction]:
        """Weights of a distribution, most of them positive."""
        if self.slip():
            return [Fraction(self.random.choice((0, -1)))] * count
        return [Fraction(1), *(Fraction(self.random.choice(("1", "2", "0.5", "0.1", "3", "1", "0"))) for _ in range(count - 1))]

    def attribute_of_object(self) -> Both:
        """A numeric property of an object."""
        index, class_ = self.random.choice(list(self.objects.items()))
        if self.random.random() < 0.2:
            return attribute(attribute(variable(index), "position"), self.random.choice("xy"))
        return attribute(variable(index), NAMES[self.random.choice((2, 5, *class_.has))])

    def truth(self, depth: int = 2) -> Both:
        """An expression for a truth value."""
        random = self.random
        if self.slip():
            return self.number(1)
        kind = random.randrange(9)
        if kind == 0:
            return truth(random.random() < 0.7)
        if kind == 1 and self.truths:
            return variable(random.choice(self.truths))
        if kind == 2 and depth:
            return unary("not", self.truth(depth - 1))
        if kind in (3, 4) and depth:
            return binary(random.choice(("and", "or", "or")), self.truth(depth - 1), self.truth(depth - 1))
        if kind == 5 and self.may_draw():
            return discrete(list(zip((truth(True), truth(False)), self.weights(2), strict=True)))
        if kind == 6 and self.vectors:
            return binary(random.choice(("==", "!=")), variable(random.choice(self.vectors)), self.vector(1))
        if kind == 7 and self.objects:
            return binary(random.choice(("==", "!=")), variable(random.choice(list(self.objects))), variable(random.choice(list(self.objects))))
        return binary(random.choice(("<", "<=", "<=", "!=", "==")), self.number(depth), self.number(depth))

    def likely_place(self) -> Both:
        """A coordinate: often one that was drawn."""
        return variable(self.random.choice(self.drawn)) if self.drawn and self.random.random() < 0.5 else self.draw()

    def likely(self) -> Both:
        """A truth value that is true more often than not: that something drawn, if there is anything, is no certain number."""
        random = self.random
        drawn = variable(random.choice(self.drawn)) if self.drawn and random.random() < 0.8 else self.draw()
        if random.random() < 0.4:
            drawn = binary("+", drawn, self.number(1))
        return binary(*random.choice((("!=", drawn, number(Fraction(random.randint(-2, 7)))), ("<=", drawn, number(Fraction(random.randint(4, 9)))))))

    def vector(self, depth: int = 1) -> Both:
        """An expression for a vector."""
        random = self.random
        kind = random.randrange(7) if depth else 0
        if kind == 1 and self.vectors:
            return variable(random.choice(self.vectors))
        if kind == 2:
            other = variable(random.choice(list(self.objects))) if self.objects and random.random() < 0.5 else self.vector(depth - 1)
            return binary(random.choice("+-"), self.vector(depth - 1), other)
        if kind == 3:
            return unary("-", self.vector(depth - 1))
        if kind == 4 and self.may_draw():
            return uniform([self.vector(depth - 1), self.vector(depth - 1)])
        if kind == 5 and self.objects:
            return attribute(variable(random.choice(list(self.objects))), "position")
        if depth == 0 or random.random() < 0.5:
            return binary("@", number(Fraction(random.randint(-4, 8))), number(Fraction(random.randint(-4, 8))))
        return binary("@", self.number(1), self.number(1))

    def class_(self) -> Class:
        """A class right below Object. What is drawn in its defaults is drawn for each object."""
        random = self.random
        defaults: list[tuple[int, Both]] = []
        chosen = random.sample(OWN, random.randint(1, 3))
        before, self.ways = self.ways, random.choice((1, 2))
        ways = self.ways
        for i, p in enumerate(chosen):
            own = chosen if self.slip() else [15] if self.slip() else chosen[i + 1 :]
            defaults.append((p, self.number(1, [*own, 2] if random.random() < 0.1 else own)))
        self.ways = before
        still = random.random() < 0.4
        if still:
            defaults += [(6, number(Fraction(0))), (7, number(Fraction(0)))]
        if random.random() < 0.2:
            defaults.append((random.choice((2, 3)), number(Fraction(random.randint(1, 3)))))
        if random.random() < 0.3:
            defaults.append((8, truth(True)))
        if random.random() < 0.2:
            defaults.append((9, truth(False)))
        random.shuffle(defaults)
        return Class(f"C{len(self.classes)}", tuple(defaults), tuple(chosen), still, ways)

    def object(self) -> tuple[Both, Class]:
        """An object definition, and a class with what its value has."""
        random = self.random
        class_ = random.choice([Class("Object", (), ()), *(c for c in self.classes if c.ways <= self.ways)])
        self.ways //= class_.ways
        self.made += 1
        specifiers: list[tuple[str, str, Both]] = []
        if random.random() < 0.95:
            apart = random.choice((0, 1, 4, 4, 4))
            y = self.likely_place() if apart < 2 or random.random() < 0.3 else number(Fraction(0))
            away = binary("@", number(Fraction(apart * self.made)), binary("*", y, number(Fraction(random.choice((1, 1, 4))))))
            where = self.number(0) if self.slip() else away if random.random() < 0.9 else self.vector(1)
            specifiers.append(("at", "At", where) if random.random() < 0.8 else ("with position", "(With position)", where))
        has = set(class_.has)
        for p in random.sample(OWN, random.choice((0, 1, 1, 2))):
            has.add(p)
            specifiers.append((f"with p{p}", f"(With {p}%nat)", self.number(2)))
        if random.random() < 0.2:
            specifiers.append(("with width", "(With width)", self.truth(0) if self.slip() else number(Fraction(random.randint(0, 7)))))
        if random.random() < 0.15:
            specifiers.append(("with length", "(With extent)", number(Fraction(-1 if self.slip() else random.randint(0, 9)))))
        if random.random() < 0.25:
            specifiers.append(("with viewDistance", "(With viewDistance)", number(Fraction(random.randint(5, 20)))))
        if random.random() < 0.35:
            specifiers.append(("with allowCollisions", "(With allowCollisions)", self.truth(1)))
        if random.random() < 0.2:
            specifiers.append(("with requireVisible", "(With requireVisible)", self.truth(1)))
        if random.random() < 0.1 and self.objects:
            specifiers.append(("with p14", "(With 14%nat)", variable(random.choice(list(self.objects)))))
        if random.random() < 0.06:
            specifiers.append(("with p14", "(With 14%nat)", self.object()[0]))  # twice, if the one before is there
        if self.slip() and specifiers:
            specifiers.append(random.choice(specifiers))
        random.shuffle(specifiers)
        text = " ".join((class_.name, ", ".join(f"{words} {value.scenic}" for words, _, value in specifiers))).strip()
        own = f"(Object {class_.own()} {listed(f'({kind}, {value.coq})' for _, kind, value in specifiers)})"
        return Both(f"({text})", own), Class("", (), tuple(sorted(has)), class_.still)

    def new_variable(self, holds: list[int] | None) -> int:
        """A variable to assign to: often one that has been assigned to before, of the same kind."""
        if holds and self.random.random() < 0.3:
            return self.random.choice(holds)
        self.fresh += 1
        return self.fresh - 1

    def statement(self, line: int) -> Both:
        """A statement that stands on this line."""
        random = self.random
        kind = random.randrange(14)
        if kind < 4:
            makers: list[tuple[list[int], Callable[[], Both]]] = [(self.numbers, self.number), (self.truths, self.truth), (self.vectors, self.vector)]
            held, make = makers[random.choice((0, 0, 1, 2))]
            draws = held is self.numbers and random.random() < 0.6
            value = self.draw() if draws else make()
            x = self.new_variable(held)
            if draws and x not in self.drawn:
                self.drawn.append(x)
            if x not in held:
                held.append(x)
            return assigned(x, value)
        if kind < 6 and self.made < 5:
            value, class_ = self.object()
            if random.random() < 0.3:
                return Both(value.scenic[1:-1], f"Expression {value.coq}")
            x = 0 if random.random() < 0.2 else self.new_variable(None)
            self.objects[x] = class_
            return assigned(x, value)
        if kind < 7 and self.slip():
            return assigned(0, self.number(0))
        if kind < 9:
            name = random.randrange(4)
            value = random.choice((self.number, self.number, self.truth, self.vector))()
            return Both(f"param a{name} = {value.scenic}", f"Param {name}%nat {value.coq}")
        if kind == 9:
            return self.mutation()
        condition = self.truth() if random.random() < 0.15 else self.likely()
        if kind < 12 or not self.may_draw():
            return Both(f"require {condition.scenic}", f"Require {line}%nat {condition.coq}")
        p = random.choice(("0", "0.25", "0.5", "0.5", "0.9", "1"))
        return Both(f"require[{p}] {condition.scenic}", f"SoftRequire {line}%nat {fraction(Fraction(p))} {condition.coq}")

    def mutation(self) -> Both:
        """A `mutate` without noise: by 0, or of objects whose deviations are 0."""
        random = self.random
        still = [x for x, class_ in self.objects.items() if class_.still]
        if self.slip():
            listed_, scale = [variable(random.choice([*self.numbers, 98]))], number(Fraction(-1))
        elif still and random.random() < 0.7:
            listed_, scale = [variable(x) for x in random.choices(still, k=random.randint(1, 2))], number(Fraction(random.randint(0, 3)))
        else:
            listed_ = [variable(x) for x in random.sample(list(self.objects), min(len(self.objects), random.randint(0, 2)))]
            scale = number(Fraction(0))
        text = f"mutate {', '.join(e.scenic for e in listed_)} by {scale.scenic}".replace("  ", " ")
        return Both(text, f"Mutate {listed(e.coq for e in listed_)} {scale.coq}")


def assigned(x: int, value: Both) -> Both:
    """`x = E`."""
    target = variable(x).scenic
    return Both(f"{target} = {value.scenic}", f"Assign {x}%nat {value.coq}")


@dataclass(frozen=True)
class Program:
    """A program in both languages, and the reading of `require-time` under which it is run."""

    scenic: str
    coq: str
    reading: str


def program(seed: int) -> Program:
    """Some program: classes, an ego first or later, and statements."""
    random = Random(seed)
    writer = Writer(random, ways=random.choice((8, 8, 16)), slips=random.choice((0.0, 0.0, 0.0, 0.04)))
    writer.classes.extend(writer.class_() for _ in range(random.randrange(3)))
    lines = [line for c in writer.classes for line in (f"class {c.name}(Object):", *(f"    {NAMES[p]}: {e.scenic}" for p, e in c.defaults))]
    made: list[Both] = []
    count = random.randint(3, 8)
    where = random.choice((0, 0, 0, 1, 2, count + 1 if writer.slips else 0))
    for i in range(count):
        if i == where:
            value, class_ = writer.object()
            writer.objects[0] = class_
            made.append(assigned(0, value))
        made.append(writer.statement(len(lines) + len(made) + 1))
    reading = random.choice(("statement", "end"))
    text = "\n".join((*lines, *(s.scenic for s in made))) + "\n"
    return Program(text, f"({str(reading == 'end').lower()}, {listed(f'({s.coq})' for s in made)})", reading)
