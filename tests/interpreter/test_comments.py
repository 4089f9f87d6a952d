"""`convert` keeps every comment, once, where it was or next to it; comments change nothing else, and converting again changes nothing."""

from __future__ import annotations

import io
import random
import tokenize
from collections import Counter
from itertools import product
from pathlib import Path

import pytest
from scenic_ref.interpreter.language.conversion import convert
from scenic_ref.interpreter.language.dialects import DIALECTS
from scenic_ref.interpreter.language.modules import library_of
from scenic_ref.interpreter.language.parser import parse
from scenic_ref.semantics.store.errors import ParseError
from scenic_ref.simulators.worlds import WORLDS


def converted(text: str, target: str, directory: Path | None = None) -> str:
    program = parse(text, str(directory / "p.scenic") if directory else "p.scenic")
    library = library_of(program, worlds=WORLDS, model=None, trust=False, directory=directory, dialect=None)
    return convert(program, target, library)


def comments(text: str) -> Counter[str]:
    """The comments of a text, as Python's own lexer finds them, without the one that names the dialect."""
    tokens = [t for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type == tokenize.COMMENT]
    named = text.startswith("# dialect:")
    return Counter(t.string.rstrip() for t in tokens[named:])


def check_kept(text: str, target: str, directory: Path | None = None) -> str:
    once = converted(text, target, directory)
    assert comments(once) == comments(text)
    assert converted(once, target, directory) == once
    return once


EVERYWHERE = '''\
\ufeffx = 1  # first
# dialect: of English

class A(Object):  # head of A
    # in A
    """doc
    # no comment
    """  # behind doc
    def f(self, a,  # a
          b):  # head of f
        return 1  # one
        # end of f

    # before width
    width: 2  # metres
    length: (1 +  # inside
             3)  # behind

    # end of A
# after A
s = \'\'\'a
# no comment\'\'\'
y = [1,  # one

  # two
  2]  # three
a = 1; b = 2  # both
if a:  # if
    b  # b
    # end of if
# before else
else:  # else
    "#"
    # end of else
if a: b  # one line
    # deep
scenario Main():  # Main
    # precondition
    precondition: True  # behind it
    # before setup
    setup:  # setup
        ego = Object  # ego
        # end of setup
    # before compose
    compose:
        # wait
        wait
    # end of Main
scenario Q():  # Q
    # param
    param x = 1,  # x
          y = 2  # y
    # end of Q
x = Object at (0, 0),  # at
   facing 3  # facing
@f  # decorator
# between
def g():
    return f"{y}#"  # z
    # end of g
  # between
# The end.
'''
KEPT = '''\
# dialect: scenic-3
x = 1  # first
# dialect: of English

class A(Object):  # head of A
    # in A
    'doc\\n    # no comment\\n    '  # behind doc
    # a
    def f(self, a, b):  # head of f
        return 1  # one
        # end of f

    # before width
    width: 2  # metres
    # inside
    length: 1 + 3  # behind

    # end of A
# after A
s = 'a\\n# no comment'
# one
# two
y = [1, 2]  # three
a = 1
b = 2  # both
if a:  # if
    b  # b
    # end of if
# before else
else:  # else
    '#'
    # end of else
if a:
    b  # one line
# deep
scenario Main():  # Main
    # precondition
    precondition: True  # behind it
    # before setup
    setup:  # setup
        ego = new Object  # ego
        # end of setup
    # before compose
    compose:
        # wait
        wait
    # end of Main
scenario Q():  # Q
    setup:
        # param
        # x
        param x = 1, y = 2  # y
        # end of Q
# at
x = new Object at (0, 0), facing 3  # facing
@f  # decorator
# between
def g():
    return f"""{(y)}#"""  # z
    # end of g
# between
# The end.
'''


def test_comments_stay_where_they_are() -> None:
    assert check_kept(EVERYWHERE, "scenic-3") == KEPT


def test_comments_of_statements_that_the_other_dialect_does_not_need() -> None:
    text = "# dialect: scenic-3\nmonitor M():\n    wait\n# required\nrequire monitor M()  # here\n# end\n"
    assert check_kept(text, "paper") == "monitor M:\n    wait\n# required\n# here\n# end\n"


def test_comments_of_an_else_that_becomes_an_elif() -> None:
    text = "if a:\n    b\nelse:  # else\n    # inner\n    if c:  # if\n        d\n        # end\n    else:  # last\n        e\n    # behind\n"
    expected = "if a:\n    b\nelif c:  # else\n    # inner\n    # if\n    d\n    # end\nelse:  # last\n    e\n# behind\n"
    assert check_kept(text, "paper") == expected


def test_the_mark_of_the_dialect_is_the_first_line_and_no_other() -> None:
    assert check_kept("# dialect: scenic-3\n# dialect: of English\nx = 1\n", "paper") == "# dialect: paper\n# dialect: of English\nx = 1\n"
    assert check_kept("x = [  # dialect: D\n  1]\n", "paper") == "# dialect: paper\n# dialect: D\nx = [1]\n"
    assert converted("# dialect: scenic-3 of 2024\nx = 1\n", "scenic-2.1") == "# dialect: scenic-2.1 of 2024\nx = 1\n"


def test_a_program_of_comments_only() -> None:
    assert converted("# one\n\n  # two", "scenic-3") == "# dialect: scenic-3\n# one\n\n# two\n"


PROGRAM = '''\
"""Cars,
and more."""
import math
param time = 12, weather = 'sun'
class Car(Object):
    """A car.

    Not long.
    """
    width: 2
    def area(self, factor,
             offset=[0, 0]):
        return self.width * self.length * factor + offset[0]
    length: Uniform(4,
                    5)
behavior Go(speed):
    precondition: speed > 0
    invariant: True
    try:
        while True:
            wait
    interrupt when (simulation().currentTime
                    > 3):
        if speed: abort
        else:
            wait; wait
    except ValueError as e:
        pass
    else:
        wait
    finally:
        pass
ego = Car at Vector(0,
                    1 + \\
                    2), facing 30 deg
others = [Car at Vector(5 * i, 9) for i in range(3)]; k = {'a#': [1, 2],
    "b": (
        3)}

for i in range(2):
    for j in range(2):
        if i:
            k[i] = f'{j}#'
        elif j:
            k[j] = \'\'\'
                # no comment
            \'\'\'
        else:
            while False: pass
require (distance from ego to others[0]) > 3
scenario Part(n):
    precondition: n
    x = n
    y = 3
'''


def sprinkled(text: str, generator: random.Random, count: int) -> str:
    """The program with comments at random places where they change nothing else."""
    meant = parse(text).statements
    for number in range(count):
        lines = text.split("\n")
        place = generator.randrange(text.startswith("# dialect:"), len(lines))
        if generator.random() < 0.5:
            lines[place] += f" # c{number}."
        else:
            lines[place:place] = [" " * generator.randrange(14) + f"# c{number}."] + [""] * generator.randrange(2)
        try:
            if parse("\n".join(lines)).statements == meant:
                text = "\n".join(lines)
        except ParseError:
            pass  # behind a backslash
    return text


@pytest.mark.sampled(8)
@pytest.mark.parametrize("source, target", list(product(DIALECTS, DIALECTS)))
@pytest.mark.parametrize("seed", range(2))
def test_comments_anywhere_are_kept_and_change_nothing_else(source: str, target: str, seed: int) -> None:
    generator = random.Random(f"{source} {target} {seed}")
    new, clock = "new Car" if source == "scenic-3" else "Car", "simulation()" if DIALECTS[source].released else "simulation"
    text = f"# dialect: {source}\n" * (source != "paper") + PROGRAM.replace("= Car", f"= {new}").replace("[Car", f"[{new}")
    text = text.replace("simulation()", clock)
    with_comments = sprinkled(text, generator, 40)
    assert sum(comments(with_comments).values()) > 20
    assert parse(check_kept(with_comments, target)).statements == parse(converted(text, target)).statements


@pytest.mark.sampled(8)
@pytest.mark.parametrize("path", sorted(Path("examples").rglob("*.scenic")), ids=str)
def test_comments_of_the_examples_are_kept(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    own = parse(text, str(path)).dialect
    for target in ("scenic-2.1", "scenic-3", own if own.startswith("scenic") else "paper"):
        text = check_kept(text, target, path.parent)
    generator = random.Random(str(path))
    check_kept(sprinkled(text, generator, 10), "scenic-3", path.parent)
