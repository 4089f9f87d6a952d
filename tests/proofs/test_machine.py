"""The machine of `proofs/kernel/Machine.v` and that in Python give a thousand programs the same scenes and probabilities, or the same errors.

None of the programs has noise: the theory's is a finite distribution that stands for the normal one, so that `mutate` is by 0, or of an object
whose deviations are 0.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random
from typing import Any

import pytest
import scenic_ref
from scenic_ref.errors import AttemptsExhausted, ScenicError
from scenic_ref.formats.scenes import Scene
from scenic_ref.semantics.kernel.config import PASS, Config, Stack, State
from scenic_ref.semantics.kernel.outcome import Observe, Outcome, Requirement
from scenic_ref.semantics.kernel.values import Instance
from scenic_ref.semantics.rules import RULES
from scenic_ref.semantics.scenes import statements, termination
from scenic_ref.semantics.space.vectors import Vector

from .coq import PROOFS, Term, evaluated, needs_coq

pytestmark = pytest.mark.slow

COUNT = 1000
STEPS = 3000
NAMES = {
    0: "position", 1: "heading", 2: "width", 3: "length", 4: "viewDistance", 5: "mutationScale", 6: "positionStdDev", 7: "headingStdDev",
    8: "allowCollisions", 9: "requireVisible", **{p: f"p{p}" for p in range(10, 16)},
}  # fmt: skip
OWN = (10, 11, 12, 13)
"""Properties that the classes of the programs define; others of these names are only specified."""
TOLD = f"""fun '(at_the_end, program) =>
    let q x := let r := Qred x in [Qnum r; Zpos (Qden r)] in
    let int n := Z.of_nat n in
    let told v := match v with
      | Number x => int 0 :: q x | Truth b => [int 1; int (if b then 1 else 0)] | Vector x y => int 2 :: q x ++ q y
      | Instance n => [int 3; int n] end in
    let all := flat_map (fun xv => int (fst xv) :: told (snd xv)) in
    let problem e := match e with
      | Not_defined _ => 0 | No_self => 1 | No_attribute => 2 | Type_error => 3 | Division_by_zero => 4 | No_scalars => 5 | Bad_parameters => 6
      | No_vector => 7 | Ill_formed (Resolution.SpecifiedTwice _ _ _) => 8 | Ill_formed (Resolution.MissingProperty _ _) => 9
      | Ill_formed (Resolution.CyclicDependencies _) => 10 | Ill_formed _ => 11 | Bad_property _ => 12 | Ego_is_no_object => 13
      | No_boolean _ => 14 | Bad_probability _ => 15 | Bad_scale => 16 | Not_mutable => 17 | No_ego => 18 | Beyond_the_core => 19 end in
    let ended e w := match e with
      | Accepted s => (int 0 :: int 0 :: w) :: all (its_params s) :: match its_ego s with Some v => told v | None => [] end :: map all (its_content s)
      | Rejected (Condition line) => [int 1 :: int line :: w]
      | Rejected (Collision _ _) => [int 2 :: int 0 :: w]
      | Rejected (Visibility _) => [int 3 :: int 0 :: w]
      | Failed e => [int 4 :: int (problem e) :: w] end in
    match upright_runs at_the_end {STEPS} program with
    | Some found => map (fun r => ended (snd r) (q (weight (fst r)))) found
    | None => [] end"""
"""What Coq is asked about a program: how each of its runs ends, and its probability, as lists of numbers."""
ERRORS = [
    ("RunError", "E-Variable"), ("RunError", "E-Variable"), ("AttributeError", ""), ("TypeError", ""), ("ZeroDivisionError", ""),
    ("RunError", "O-VectorOf"), ("RunError", "E-Distributions"), ("RunError", "P-At"), ("SpecifiedTwice", "R-SpecifiedTwice"),
    ("MissingProperty", "R-MissingProperty"), ("CyclicDependencies", "R-Cyclic"), ("SpecifiedTwiceOptionally", "R-SpecifiedTwiceOptionally"),
    ("RunError", "E-ObjectDefinition"), ("RunError", "S-Assignment"), ("RunError", "S-Require"), ("RunError", "S-SoftReq-Check"),
    ("RunError", "S-Mutate"), ("RunError", "S-Mutate"), ("RunError", "T-Mutate"), ("beyond the core", ""),
]  # fmt: skip
"""The errors of the theory as those of the Python: the class (of the exception, if the program raised one) and the rule."""


BEYOND = ERRORS[-1]
"""Of such programs the theory says nothing."""


# Programs


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


# What they do

Key = tuple[Any, ...]


@dataclass(frozen=True)
class Answer:
    """The scenes and their probabilities; where runs are rejected, with what probability (0, if there is no scene); the errors."""

    law: Mapping[Key, Fraction]
    rejected: Mapping[Key, Fraction]
    errors: frozenset[tuple[str, str]]


def by_the_theory(told: Term) -> Answer:
    """What Coq says about a program."""
    scenes: dict[Key, Fraction] = defaultdict(Fraction)
    rejected: dict[Key, Fraction] = defaultdict(Fraction)
    errors: set[tuple[str, str]] = set()
    assert told, "the theory ran out of steps"
    for (kind, detail, above, below), *scene in told:
        weight = Fraction(above, below)
        if kind == 0:
            params, ego, *objects = scene
            content = tuple(tuple(sorted((NAMES[p], v) for p, v in bindings(o) if p != 7)) for o in objects)
            scenes[tuple(sorted((f"a{x}", v) for x, v in bindings(params))), value(iter(ego)), content] += weight
        elif kind == 4:
            errors.add(ERRORS[detail])
        else:
            rejected[("require", detail) if kind == 1 else (("collision", "visibility")[kind - 2], 0)] += weight
    assert errors or sum(scenes.values()) + sum(rejected.values()) == 1
    accepted = sum(scenes.values())
    law = {scene: p / accepted for scene, p in scenes.items()}
    return Answer(law, dict(rejected) if accepted else dict.fromkeys(rejected, Fraction(0)), frozenset(errors))


def bindings(told: Sequence[int]) -> Iterator[tuple[int, Key]]:
    """Variables, parameters or properties, by their numbers, with their values."""
    rest = iter(told)
    for name in rest:
        yield name, value(rest)


def value(rest: Iterator[int]) -> Key:
    """The value that comes next: its kind, and its numbers."""
    kind = next(rest)
    if kind in (1, 3):
        return kind, Fraction(next(rest))
    return kind, *(Fraction(next(rest), next(rest)) for _ in range(2 if kind == 2 else 1))


def by_the_machine(one: Program, readings: Mapping[str, str] | None = None) -> Answer:
    """What the enumeration gives."""
    try:
        found = scenic_ref.loads(one.scenic, readings={"require-time": one.reading, **(readings or {})}).enumerate()
    except AttemptsExhausted as problem:
        return Answer({}, {place(r): Fraction(0) for r, _ in problem.stuck}, frozenset())  # type: ignore[arg-type]
    except ScenicError as problem:
        exception = getattr(problem, "exception", None)
        return Answer({}, {}, frozenset({(type(exception or problem).__name__, problem.rule)}))
    rejected: dict[Key, Fraction] = defaultdict(Fraction)
    for requirement, probability in found.stuck.items():
        rejected[place(requirement)] += probability
    return Answer(found.law(content_of), dict(rejected), frozenset())  # type: ignore[arg-type]


def place(requirement: Requirement) -> Key:
    """A requirement of the program by its line; of the default ones only the kind."""
    return requirement.kind, requirement.span.line if requirement.kind == "require" else 0


def content_of(scene: Scene) -> Key:
    """A scene as the theory tells it."""
    numbers = {o.made: i for i, o in enumerate(scene.objects)}

    def read(found: object) -> Key:
        if isinstance(found, bool):
            return 1, Fraction(found)
        if isinstance(found, Instance):
            return 3, Fraction(numbers[found.number])
        if isinstance(found, (Vector, tuple)):
            return 2, Fraction(found[0]), Fraction(found[1])
        return 0, Fraction(found)  # type: ignore[arg-type]

    objects: list[Key] = []
    for o in scene.objects:
        all_ = {**o.properties, "position": o.position, "heading": o.heading, "width": o.width, "length": o.length}
        objects.append(tuple(sorted((name, read(all_[name])) for p, name in NAMES.items() if p != 7 and name in all_)))
    assert scene.ego is not None
    return tuple(sorted((name, read(v)) for name, v in scene.params.items())), (3, Fraction(scene.ego.id)), tuple(objects)


def agree(machine: Answer, theory: Answer) -> bool:
    """Whether they say the same; where runs fail, the Python raises the error of one of them."""
    return machine.errors <= theory.errors if machine.errors else machine == theory


def telling() -> Iterator[Program]:
    """Programs that tell the readings of `soft` and `require-time` apart."""
    drawn, small = assigned(1, discrete([(number(Fraction(v)), Fraction(1)) for v in range(4)])), binary("<", variable(1), number(Fraction(1)))
    first = assigned(0, Both("Object", "(Object [] [])"))
    shown = Both("param a0 = x1", f"Param 0%nat {variable(1).coq}")
    for made in (
        [first, drawn, shown, Both(f"require[0.5] {small.scenic}", f"SoftRequire 4%nat {fraction(Fraction(1, 2))} {small.coq}")],
        [first, drawn, Both(f"require {truth(False).scenic}", f"Require 3%nat {truth(False).coq}"), assigned(2, variable(99))],
    ):
        for reading in ("statement", "end"):
            yield Program(
                "\n".join(s.scenic for s in made) + "\n", f"({str(reading == 'end').lower()}, {listed(f'({s.coq})' for s in made)})", reading
            )


PROGRAMS = [*telling(), *(program(seed) for seed in range(COUNT))]


@pytest.fixture(scope="module")
def theories(tmp_path_factory: pytest.TempPathFactory) -> list[Answer]:
    """What the theory says about the programs."""
    terms = [f"map ({TOLD}) {listed(one.coq for one in PROGRAMS)}"]
    answers = evaluated(["kernel.Distribution", "kernel.Machine"], terms, tmp_path_factory.mktemp("machine"))
    return [by_the_theory(told) for told in answers[0]]


def differences(theories: Sequence[Answer], readings: Mapping[str, str] | None = None) -> Iterator[Program]:
    """The programs to which the machine gives something else."""
    return (one for one, theory in zip(PROGRAMS, theories, strict=False) if not agree(by_the_machine(one, readings), theory))


@needs_coq
def test_the_machines_agree(theories: list[Answer]) -> None:
    assert len(theories) == len(PROGRAMS) >= COUNT
    wrong = [one.scenic for one in differences(theories)]
    assert not wrong, wrong[0]


@needs_coq
def test_the_programs_do_various_things(theories: list[Answer]) -> None:
    assert not any(BEYOND in one.errors for one in theories)
    lawful = [one for one in theories if not one.errors]
    assert len(lawful) > COUNT / 2
    assert sum(len(one.law) > 1 for one in lawful) > COUNT / 4
    assert sum(bool(one.law) and bool(one.rejected) for one in lawful) > COUNT / 10
    assert COUNT / 50 < sum(not one.law for one in lawful) < COUNT / 3
    kinds = Counter(kind for one in lawful if one.law for kind in {kind for kind, _ in one.rejected})
    assert min(kinds[kind] for kind in ("require", "collision", "visibility")) >= COUNT / 100, kinds
    errors = Counter(e for one in theories for e in one.errors)
    assert len(errors) >= 12 and sum(errors.values()) > COUNT / 10, errors


def unchecked(rule: str, requirement: Requirement, holds: object, stack: Stack, state: State) -> Outcome:
    """A rule for requirements that fires in any case."""
    return Observe(rule, requirement, Config(PASS, stack, state))


def all_hold(premises: Sequence[object], index: int, state: State) -> None:
    """Step 2 without its premises."""


def tails(node: object, stack: Stack, state: State) -> Config:
    """`require[p] B` that never enforces B."""
    return statements.skip(stack, state)


@needs_coq
@pytest.mark.parametrize(
    ("where", "name", "planted"),
    [(statements, "observed", unchecked), (termination, "check_default_requirements", all_hold), (statements, "check", tails)],
)
def test_a_machine_with_a_wrong_rule_is_noticed(
    where: object, name: str, planted: object, theories: list[Answer], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(where, name, planted)
    assert len(list(differences(theories[:100]))) >= 3


@needs_coq
@pytest.mark.parametrize("readings", [{"soft": "scene"}, {"require-time": "end"}, {"require-time": "statement"}])
def test_the_other_reading_is_noticed(readings: dict[str, str], theories: list[Answer]) -> None:
    assert any(differences(theories[:4], readings))


def test_the_rules_are_those_of_the_catalogue() -> None:
    text = (PROOFS / "kernel" / "Machine.v").read_text().partition("Inductive step ")[2].partition("Inductive stuck_at")[0]
    names = [name.replace("_", "-") for name in re.findall(r"^\| (\w+)", text, re.MULTILINE)]
    ours = [name for name in names if not f"{name}-".startswith("Premise-")]
    assert len(ours) > 25
    assert not [name for name in ours if not any(name == rule or name.startswith(f"{rule}-") for rule in RULES)]
