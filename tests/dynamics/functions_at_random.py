"""Random programs whose behaviors, conditions and requirements call functions, with closures, defaults, generators, exceptions and draws."""

from __future__ import annotations

import random

HEAD = """\
total = 0
known = [1, 2, 3]
table = {'a': 1, 'b': 2}
class Box(object):
    def __init__(self, v=1):
        self.v = v
    def grow(self, n=1):
        self.v += n
        return self
    def __len__(self):
        return 2
class Robot:
    allowCollisions: True
    x: Uniform(0, 1, 2)
    @property
    def double(self):
        return 2 * self.x
    @property
    def near(self):
        return [o.x for o in simulation().objects if o is not self and (distance from self to o) < 9]
    def plus(self, n=1, *more):
        return self.x + n + len(more)
"""


class Writer:
    """Writes the text of one program. Functions have a depth `n`, and call those before them, or themselves with less."""

    def __init__(self, seed: str) -> None:
        self.random = random.Random(seed)
        self.functions = 0
        self.names: list[str] = []

    def one(self, *options: str) -> str:
        """One of some texts."""
        return self.random.choice(options)

    def number(self, depth: int = 0) -> str:
        """An expression whose value is a whole number, mostly."""
        simple = ["1", "2", "n", "n", "r.x", "r.double", "total", "len(known)", *self.names]
        if depth > 2 or self.random.random() < 0.3:
            return self.random.choice(simple)
        a, b = (lambda: self.number(depth + 1)), (lambda: self.condition(depth + 1))
        return self.random.choice([
            lambda: f"({a()} {self.one('+', '-', '*', '%', '//')} {a()})", lambda: f"max({a()}, {a()})", lambda: f"abs({a()})", lambda: f"-{a()}",
            lambda: f"({a()} if {b()} else {a()})", lambda: f"[{a()}, {a()}][{self.one('0', '1', '-1', 'n')}]",
            lambda: f"len({self.several(depth + 1)})", lambda: f"sum({self.several(depth + 1)})",
            lambda: f"sum({a()} for i in {self.several(depth + 1)})", lambda: f"table[{self.one('a', 'b', 'c')!r}]",
            lambda: f"table.get('c', {a()})", lambda: f"(lambda a, b=2: a + b + {a()})({a()})", lambda: f"r.plus({a()})",
            lambda: f"r.plus({a()}, 1, 2)", lambda: f"Box({a()}).grow().v", lambda: f"Uniform({a()}, {a()})",
            lambda: f"Discrete({{1: 1, {a()} + 5: 2}})", lambda: f"sorted({self.several(depth + 1)})[0]",
            lambda: f"min({self.several(depth + 1)}, key=lambda v: -v)", lambda: f"int(str({a()}) + '1')", lambda: f"len(str({a()}))",
            lambda: self.call(depth + 1), lambda: self.call(depth + 1), lambda: f"round({a()} / 2)", lambda: f"(1, {a()})[1]",
            lambda: f"dict(a={a()})['a']", lambda: f"len({{{a()}, {a()}}})", lambda: f"max([v for v in range(3) if v < {a()}] or [7])",
            lambda: f"{{k: v for k, v in table.items()}}[{self.one('a', 'b')!r}]",
        ])()  # fmt: skip

    def several(self, depth: int) -> str:
        """An expression whose value is a list, mostly."""
        a = self.number(depth + 1)
        return self.one(
            "known", "r.near", "[1, 2]", "list(range(3))", f"[{a}, 2]", f"[{a} for i in range(2)]",
            f"[i + v for i in known for v in [1, {a}] if i != v]",
            "[a + b for a, b in zip(known, [4, 5])]", "[i * v for i, v in enumerate(known)]", f"list(map(lambda v: v + {a}, known))",
            f"list(filter(lambda v: v > {a}, known))", "(known + [4])[1:]", "sorted(table.values())", f"[(lambda: i + {a})() for i in known]",
        )  # fmt: skip

    def condition(self, depth: int = 0) -> str:
        """An expression whose value is a truth value, mostly."""
        a, b = self.number(depth + 1), self.number(depth + 1)
        c = f"{a} {self.one('<', '<=', '==', '!=')} {b}"
        return self.one(
            c, c, f"0 <= {a} < {b}", f"not ({c})", f"{c} and r.x < 2", f"r.x == 1 or {c}", f"any(v > {a} for v in known)",
            f"all([v != {a} for v in known])",
            f"{a} in known", f"isinstance(r, Robot) and {c}", f"(distance from r to (0, {a})) < 4", "r can see (0, 3)", "Uniform(True, False)",
            f"{a} not in table", "r.position.x < 2", f"'a' in table and {c}",
        )  # fmt: skip

    def call(self, depth: int) -> str:
        """A call of one of the functions so far."""
        if not self.functions or depth > 3:
            return "n"
        k = self.random.randrange(self.functions)
        a = self.number(depth + 1)
        return self.one(f"f{k}(r, {a} % 3)", f"f{k}(r, 1)", f"(f{k}(r, n - 1) if n > 0 else 0)", f"f{k}(r, n=2, m={a})")

    def block(self, depth: int = 0) -> list[str]:
        """Some statements of a function."""
        return [line for _ in range(self.random.randint(1, 3)) for line in self.statement(depth)]

    def statement(self, depth: int) -> list[str]:
        """A statement."""
        a = self.number()
        name = self.one("u", "v", "w")
        simple = [
            [f"{name} = {a}"], [f"{name} = {a}"], [f"m += {a}"], [f"m = m {self.one('+', '-')} {a}"], [f"return {a}"],
            [f"total = ({a}) % 5"], [f"known.append({a})" if self.random.random() < 0.2 else f"xs = [{a}]"], [self.call(1)],
            [f"a, (b, *c) = {a}, [1, 2, 3]", "m += b"], [f"assert {self.condition()}"], [f"raise {self.one('ValueError', 'KeyError')}({a})"],
            ["def inner(k=m):", "    nonlocal m", f"    m = k + {a}", "    return m", "m = inner() + inner(1)"], [f"require ({self.condition()})"],
            [f"d = {{'k': {a}}}", "d['k'] += 1", "m = d['k']"], ["table['a'] = m"],
            [f"g = (i + {a} for i in known)", "m = next(g)", "m += sum(g)"],
            [f"s = {a}", "s = f'{s} {m!r:>4}'", "m = len(s)"], ["p = (0, m) - (1, 1)", "m = m if p.x < 0 else 1"],
        ]  # fmt: skip
        if depth > 1 or self.random.random() < 0.6:
            return self.random.choice(simple)
        kind = self.random.randrange(5)
        if kind == 0:
            return [f"if {self.condition()}:", *indented(self.block(depth + 1)), "else:", *indented(self.block(depth + 1))]
        if kind == 1:
            leave = self.random.choice([[], [f"if {self.condition()}:", f"    {self.one('break', 'continue')}"]])
            return [f"for i in {self.several(1)}:", *indented([*leave, *self.block(depth + 1)]), *self.random.choice([[], ["else:", "    m += 1"]])]
        if kind == 2:
            return ["c = 0", f"while c < {self.one('2', '3')}:", *indented(["c += 1", *self.block(depth + 1)])]
        clause = self.one("ValueError", "(KeyError, IndexError)", "Exception", "AssertionError")
        handler = [f"except {clause}{self.one('', ' as problem')}:", *indented([*self.block(depth + 1), *self.random.choice([[], ["raise"]])])]
        final = ["finally:", "    m += 1"] if kind == 4 else []
        return ["try:", *indented(self.block(depth + 1)), *handler, *self.random.choice([[], ["else:", "    m += 2"]]), *final]

    def function(self) -> list[str]:
        """A function."""
        self.names = ["m"]
        body = ["global total", "if n < 0:", "    return m", *self.block(), *self.block()]
        head = self.one("r, n, m=1", "r, n, m=1", "r, n=0, *, m=2", "r, n, m=1, **more")
        lines = [f"def f{self.functions}({head}):", *indented([*body, f"return {self.number()}"])]
        self.functions += 1
        self.names = []
        return lines

    def program(self) -> str:
        """A whole program."""
        lines = [line for _ in range(self.random.randint(2, 4)) for line in self.function()]
        n = "n = 1"
        safe = ["try:", *indented([f"take {self.number()}, {self.call(0)}"]), "except Exception as problem:", "    take type(problem).__name__"]
        lines += ["behavior B(n=1):", *self.random.choice([[], [f"    invariant: f0(self, 1) != {self.one('77', '3')}"]])]
        lines += indented(["r = self", n, f"take {self.call(0)}", *safe, "for i in range(2):", *indented([f"x = {self.number()}", "take x, self.x"])])
        lines += indented(["try:", f"    take {self.number()}", "    wait", f"interrupt when {self.condition()}:", f"    take {self.number()}"])
        lines += ["ego = Robot with behavior B, with name 'ego'", "other = Robot at (3, 1), with behavior B(2), with name 'other'"]
        lines += ["r = ego", n, f"require always (f0(ego, 1) != {self.one('55', '2')})", "record f1(other, 1) as said"]
        lines += self.random.choice([[], [f"terminate when {self.condition()}"]])
        return HEAD + "\n".join(lines) + "\n"


def indented(lines: list[str]) -> list[str]:
    """The lines of a block."""
    return [f"    {line}" for line in lines]


def functional_program(seed: int, number: int) -> str:
    """Program `number` of a seed."""
    return Writer(f"{seed}/{number}").program()
