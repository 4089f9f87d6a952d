"""Names that a program declares, and statements that lack what belongs behind their keyword."""

from __future__ import annotations

import pytest
import scenic_ref
from scenic_ref.semantics.store.errors import CheckError

EGO = "ego = Object\n"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("def f():\n    nonlocal x\n    x = 1\n", 2, "`nonlocal x`: no function around this one has a variable x"),
        ("x = 1\ndef f():\n    nonlocal x\n", 3, "`nonlocal x`: no function around this one has a variable x"),
        ("class A:\n    y: 1\n    def f(self):\n        nonlocal y\n", 4, "`nonlocal y`: no function around this one has a variable y"),
        ("def g():\n    def f():\n        nonlocal y\n", 3, "`nonlocal y`: no function around this one has a variable y"),
        ("behavior B():\n    nonlocal y\n    wait\n", 2, "`nonlocal y`: no function around this one has a variable y"),
        ("x = 1\nglobal x\n", 2, "x is assigned before `global x`"),
        ("def f():\n    x = 1\n    global x\n", 3, "x is assigned before `global x`"),
        ("def f():\n    print(x)\n    global x\n", 3, "x is used before `global x`"),
        ("def f():\n    for x in [1]: pass\n    global x\n", 3, "x is assigned before `global x`"),
        ("def f():\n    import math\n    global math\n", 3, "math is assigned before `global math`"),
        ("behavior B():\n    x = 1\n    global x\n    wait\n", 3, "x is assigned before `global x`"),
        ("def g():\n    x = 1\n    def f():\n        x = 2\n        nonlocal x\n", 5, "x is assigned before `nonlocal x`"),
        ("def f(x):\n    global x\n", 2, "`global x`: x is a parameter of this function"),
        ("def f(x):\n    nonlocal x\n", 2, "`nonlocal x`: x is a parameter of this function"),
        ("def f():\n    global x\n    nonlocal x\n", 2, "x is declared both `global` and `nonlocal`"),
        ("behavior B():\n    take\n", 2, "`take` needs an action"),
        ("behavior B():\n    do\n", 2, "`do` needs a behavior or a scenario"),
        ("behavior B():\n    do choose\n", 2, "`do choose` needs behaviors or scenarios"),
        ("behavior B():\n    if True:\n        do shuffle\n", 3, "`do shuffle` needs behaviors or scenarios"),
        ("behavior B():\n    override\n", 2, "`override` needs an object and specifiers"),
        ("require\n", 1, "`require` needs a condition"),
        ("require always\n", 1, "`require always` needs a condition"),
        ("param\n", 1, "`param` needs a parameter and its value"),
        ("model\n", 1, "`model` needs the name of a world model"),
    ],
)
def test_a_program_is_refused_that_says(text: str, line: int, message: str) -> None:
    with pytest.raises(CheckError) as raised:
        scenic_ref.loads(text + EGO)
    assert (raised.value.message, raised.value.span.line) == (message, line)


@pytest.mark.parametrize("body", ["[y for y in x]", "g = lambda a=x: a", "[z for y in x for z in y]"])
def test_the_first_iterable_and_default_values_are_of_the_scope_around(body: str) -> None:
    with pytest.raises(CheckError, match="x is used before `global x`"):
        scenic_ref.loads(f"def f():\n    {body}\n    global x\n" + EGO)


@pytest.mark.parametrize(
    "text",
    [
        "def f():\n    global x\n    x = 1\nf()\nparam r = x\n",
        "global x\nx = 1\nparam r = x\n",
        "def g():\n    y = 0\n    def f():\n        nonlocal y\n        y = 1\n    f()\n    return y\nparam r = g()\n",
        "def g(y):\n    def f():\n        def h():\n            nonlocal y\n            y = 1\n        h()\n    f()\n    return y\nparam r = g(0)\n",
        "def f():\n    def h(): return x\n    global x\n    x = 1\nf()\nparam r = x\n",  # `x` is another function's there
        "def f():\n    [x for x in [2]]\n    global x\n    x = 1\nf()\nparam r = x\n",
        "def f():\n    {x: y for x, y in [(1, 2)] if x}\n    global x\n    x = 1\nf()\nparam r = x\n",
        "def f():\n    g = lambda x: x\n    global x\n    x = 1\nf()\nparam r = x\n",
        "def f():\n    g = lambda: x\n    global x\n    x = 1\nf()\nparam r = x\n",
        "def g():\n    y = 0\n    def f():\n        [y for y in [2]]\n        nonlocal y\n        y = 1\n    f()\n    return y\nparam r = g()\n",
        "class C(object):\n    d = {}\n    final = 1\n    d[final] = 1\nparam r = C.d[1]\n",
        "class C(object):\n    d = {}\n    dynamic, additive = 1, 2\n    d[dynamic, additive] = 1\nparam r = C.d[1, 2]\n",
        "def take(): pass\ntake\nparam r = 1\n",
        "do = 1\ndo\nparam r = do\n",
        "def f(require): \n    require\n    return require\nparam r = f(1)\n",
        "always = True\nrequire always\nparam r = 1\n",
    ],
)
def test_a_program_is_accepted_as_in_python(text: str) -> None:
    assert scenic_ref.loads(text + EGO).sample().params["r"] == 1
