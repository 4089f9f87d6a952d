"""Random programs with noise. What turns may collide and need not be seen, so that all boxes that matter are upright."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from random import Random

from .core_programs import NAMES, Both, Class, Program, Writer, assigned, attribute, binary, decimal, fraction, listed, number, truth, variable

SCALE, POSITION, HEADING, COLLIDES, SEEN = 5, 6, 7, 8, 9
WAYS, POSES = 8, 64
"""What the draws of a program, and the values of its noise, multiply up to, at most."""


@dataclass(frozen=True)
class Noisy(Class):
    """A class whose objects have so many different poses when they are mutated; whether they turn."""

    poses: int = 1
    turns: bool = False


@dataclass
class NoisyWriter(Writer):
    """Makes up a program with `mutate` statements; `there` are the classes of all objects, and `poses` bounds what their noise multiplies up to."""

    there: list[Noisy] = field(default_factory=list[Noisy])
    poses: int = POSES

    def may_move(self, poses: int) -> bool:
        """Whether there may be noise of so many values; if so, it is counted."""
        if poses > self.poses:
            return False
        self.poses //= poses
        return True

    def class_(self) -> Noisy:
        """A class with deviations of its own."""
        random, plain = self.random, super().class_()
        turns = random.random() < 0.4
        moves = random.random() < 0.8
        fixed = (POSITION, HEADING, *((COLLIDES, SEEN) if turns else ()))
        defaults = [
            *((p, e) for p, e in plain.defaults if p not in fixed),
            (POSITION, number(Fraction(random.choice((1, 2, 4)) if moves else 0, 2))),
            (HEADING, number(Fraction(random.choice((1, 2)) if turns else 0, 4))),
            *(((COLLIDES, truth(True)), (SEEN, truth(False))) if turns else ()),
        ]
        random.shuffle(defaults)
        return Noisy(plain.name, tuple(defaults), plain.has, ways=plain.ways, poses=(4 if moves else 1) * (2 if turns else 1), turns=turns)

    def object(self) -> tuple[Both, Noisy]:
        """An object definition, some with a scale from the beginning."""
        random = self.random
        class_: Noisy = random.choice(self.classes)  # type: ignore[assignment]
        self.ways = max(1, self.ways // class_.ways)
        self.made += 1
        place = binary("@", number(Fraction(random.choice((2, 3)) * self.made)), self.likely_place())
        specifiers = [("at", "At", place)]
        if random.random() < 0.5:
            specifiers.append(("with p12", "(With 12%nat)", self.number(1)))
        if random.random() < 0.5:
            specifiers.append(("with viewDistance", "(With viewDistance)", number(Fraction(random.randint(3, 9)))))
        if random.random() < 0.2 and self.may_move(class_.poses):
            specifiers.append((f"with {NAMES[SCALE]}", "(With mutationScale)", number(Fraction(random.randint(1, 2)))))
        random.shuffle(specifiers)
        text = f"{class_.name} {', '.join(f'{words} {value.scenic}' for words, _, value in specifiers)}"
        own = f"(Object {class_.own()} {listed(f'({kind}, {value.coq})' for _, kind, value in specifiers)})"
        self.there.append(class_)
        return Both(f"({text})", own), class_

    def statement(self, line: int) -> Both:
        """More of them are `mutate` statements."""
        return self.mutation() if self.objects and self.random.random() < 0.2 else super().statement(line)

    def likely(self) -> Both:
        """Often it is about where an object is."""
        random = self.random
        if not self.objects or random.random() < 0.3:
            return super().likely()
        place = attribute(attribute(variable(random.choice(list(self.objects))), "position"), random.choice("xy"))
        return binary("<=", place, number(Fraction(random.randint(1, 6 * self.made), 2)))

    def mutation(self) -> Both:
        """A `mutate` of some objects, or of all; by 0 where there would be too many poses."""
        random = self.random
        chosen = random.sample(list(self.objects), min(len(self.objects), random.choice((0, 1, 1, 2))))
        poses = 1
        for class_ in [self.objects[x] for x in chosen] or self.there:
            poses *= class_.poses  # type: ignore[attr-defined]
        scale = Fraction(random.choice((1, 2, 2, 4)), 2) if self.may_move(poses) else Fraction(0)
        by = "" if scale == 1 and random.random() < 0.5 else f" by {decimal(scale)}"
        names = [variable(x) for x in chosen]
        text = " ".join(("mutate", *filter(None, [", ".join(x.scenic for x in names)]))) + by
        return Both(text, f"Mutate {listed(x.coq for x in names)} (Constant (Number {fraction(scale)}))")


def noisy_program(seed: int) -> Program:
    """Some program: an ego, other objects, and noise on some of them at the end."""
    random = Random(seed)
    writer = NoisyWriter(random, ways=WAYS)
    writer.classes.extend(writer.class_() for _ in range(random.randint(1, 3)))
    lines = [line for c in writer.classes for line in (f"class {c.name}(Object):", *(f"    {NAMES[p]}: {e.scenic}" for p, e in c.defaults))]
    value, class_ = writer.object()
    writer.objects[0] = class_
    made = [assigned(0, value)]
    for _ in range(random.randint(2, 6)):
        made.append(writer.statement(len(lines) + len(made) + 1))
    made.append(writer.mutation())
    reading = random.choice(("statement", "end"))
    text = "\n".join((*lines, *(s.scenic for s in made))) + "\n"
    return Program(text, f"({str(reading == 'end').lower()}, {listed(f'({s.coq})' for s in made)})", reading)
