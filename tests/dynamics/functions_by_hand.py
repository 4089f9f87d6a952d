"""Programs by hand about functions that behaviors, conditions and requirements call."""

from __future__ import annotations

FUNCTIONS = {
    "recursion": """
def f(n):
    return 1 if n < 2 else n * f(n - 1) % 1000
behavior B:
    take f(5), f(100)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "recursion without end": """
def f(n):
    return f(n + 1)
behavior B:
    take f(1)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "default arguments are evaluated once": """
xs = []
def f(a=Uniform(1, 2), b=xs):
    xs.append(a)
    return a, len(xs), b if b is not xs else 0
behavior B:
    take f(), f(), f(5), f(b=7), f(1, 2)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "keywords and stars": """
def f(a, *rest, y=0, **more):
    return a, len(rest), y, more
def g(a, /, *, k):
    return a + k
def h(a, b):
    return b - a
behavior B:
    take f(1, 2, 3, z=4, y=5), f(*[1, 2], **{'y': 3}), g(1, k=2), h(1, 2)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "arguments that do not fit": """
def f(a, b=1):
    return a + b
behavior B:
    for call in [lambda: f(), lambda: f(1, 2, 3), lambda: f(1, a=2), lambda: f(1, c=2)]:
        try:
            take call()
        except TypeError as problem:
            take str(problem)
ego = Object with behavior B
""",
    "closures see what changes": """
def f():
    n = 1
    def inner():
        return n
    a = inner()
    n = 5
    return a, inner(), [g() for g in [lambda: n, inner]]
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "names are those of the definition": """
k = 1
def g():
    return k
def f():
    k = 5
    return g(), k
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "nonlocal and global": """
total = 1
def f():
    n = 1
    def inner():
        nonlocal n
        global total
        n += 1
        total += 10
    inner()
    inner()
    return n
behavior B:
    take f(), total
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a loop variable of a comprehension is its own": """
def f():
    i = 9
    xs = [i * j for i in range(3) for j in (1, i) if i != j]
    d = {i: i + 1 for i in range(2)}
    return i, xs, d
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "generators go no further than needed": """
seen = []
def look(v):
    seen.append(v)
    return v > 1
def f():
    a = any(look(v) for v in [1, 2, 3])
    b = all(look(v) for v in (0, 5))
    return a, b, list(seen), sum(v for v in range(4)), max(v % 3 for v in range(5))
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "generators and other iterables": """
def f():
    found = []
    for i, x in enumerate('ab'):
        found.append((i, x))
    for a, b in zip([1, 2], {3: 4}):
        found.append(a + b)
    for k in {'x': 1}.items():
        found.append(k)
    for v in map(lambda q: q + 1, {5}):
        found.append(v)
    return found
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "exceptions": """
def g(n):
    if n == 1: raise ValueError('one')
    if n == 2: return [][3]
    return 1 // (3 - n)
def f(n):
    try:
        m = g(n)
    except ValueError as problem:
        return 'v', str(problem)
    except (IndexError, KeyError):
        try:
            raise
        except LookupError as again:
            return type(again).__name__
    except ArithmeticError:
        return 'a'
    else:
        return 'no', m
behavior B:
    take f(0), f(1), f(2), f(3)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "an exception that nothing catches": """
def f():
    raise KeyError('k')
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "finally": """
def f(n):
    xs = []
    try:
        if n: return xs
        xs.append(1)
    finally:
        xs.append(2)
    for i in range(4):
        try:
            if i == 1: continue
            if i == 3: break
            xs.append(i)
        finally:
            xs.append(-i)
    return xs
def g():
    try:
        raise KeyError
    finally:
        return 3
behavior B:
    take f(0), f(1), f(2), g()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a run that is rejected does not go through finally": """
def f():
    try:
        require Uniform(True, False)
    finally:
        return 1
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "loops": """
def f():
    n = 0
    for x in [1, 2, 3, 4]:
        if x == 2: continue
        if x == 4: break
        n += x
    else:
        n = 99
    while n < 9:
        n += 2
    else:
        n += 100
    xs = [1]
    for x in xs:
        if x < 3: xs.append(x + 1)
    return n, xs
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "draws in functions": """
def d():
    return Discrete({1: 2, 7: 1})
def f(n):
    y = Uniform(1, 2)
    return y if n < 2 else (y, f(n - 1), resample(y))
behavior B:
    take f(2), [d() for i in range(2)], resample(f(1)), Uniform(5, 6)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "methods and properties": """
class Robot:
    x: Uniform(1, 2)
    @property
    def double(self):
        return self.x * 2
    @property
    def odd(self):
        raise ValueError(self.x)
    def plus(self, n=1):
        return self.double + n
    @staticmethod
    def seven():
        return 7
behavior B:
    take self.double, self.plus(), self.plus(n=4), self.seven(), getattr(self, 'double'), super
    try:
        take self.odd
    except ValueError as problem:
        take str(problem)
    self.double
ego = Robot with behavior B
""",
    "a property that draws": """
class Robot:
    @property
    def odd(self):
        return 5 if Uniform(1, 2) > 1 else 6
behavior B:
    take self.odd
ego = Robot with behavior B
""",
    "a property that makes an object": """
class Robot:
    @property
    def odd(self):
        return Object at (9, 9)
behavior B:
    take self.odd
ego = Robot with behavior B
""",
    "classes of Python": """
class Box(object):
    def __init__(self, v=1):
        self.v = v
    def grow(self, n=1):
        self.v += n
        return self
    @property
    def twice(self):
        return 2 * self.v
    def __len__(self):
        return 4
def f():
    b = Box(3).grow().grow(n=5)
    return b.v, b.twice, len(b), isinstance(b, Box)
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "conditions, guards and requirements": """
def late(n):
    return simulation.currentTime > n
behavior C:
    precondition: late(0)
    invariant: not late(6)
    while True:
        take 2
behavior B:
    try:
        take 1
        do C()
    interrupt when late(3) and any(late(n) for n in range(4, 5)):
        take 3
ego = Object with behavior B
require always not late(100)
terminate when late(9)
""",
    "operators": """
def f(o):
    v = o.position + (1, 2) * 2 - o.position
    return v, -v.x, distance from o to (3, 4), o can see (1, 1), (front of o).position, (0, 0) in CircularRegion((0, 0), 3), o in everywhere
def g():
    return 3 in [3], 1 < 2 < 2, 1 < 2 <= 2 != 3, 7 // 2, 2.0 ** 0.5, 'a' + 'b', [1] + [2], -7 % 3, 1 / 2
behavior B:
    take f(self), g()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "texts and containers": """
def f(n):
    d = {'a': n, **{'b': 2}}
    d['c'] = [n, *range(2)]
    d['c'][0] += 1
    a, (b, *rest) = 1, [2, 3, 4]
    del d['b']
    s = f'{n:>3}|{d!r}'
    return s, d['c'][1:], rest[-1], d['c'][1], {1, n}, (lambda q, k=2: q * k)(n), n if n else 0, not n, n or 5, None is n
behavior B:
    take f(3)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "what is stored and read": """
xs = [Range(0, 1), Uniform(4, 5), 3]
class Box(object):
    kind = 'box'
    def __init__(self, v):
        self.v, self.w = v, [v]
        self.kind = self.kind + '!'
    @property
    def twice(self):
        return self.v * 2
    def __getattr__(self, name):
        return name
class Plain(object):
    pass
def f():
    b, p = Box(3), Plain()
    b.v = 5
    b.w[0] = p.x = 7
    b.u = b.w[-1:] + [1, 2, 3][::2]
    (q, r), *s = (1, 2), 3, 4
    q, r = r, q
    try:
        b.twice = 9
    except AttributeError as problem:
        q = type(problem).__name__
    return b.v, b.w, b.u, b.kind, b.twice, b.nothing, p.x, q, r, s, xs[0:2][1], 2.0 ** 3, (-2.0) ** 2, (-2.0) ** -3, 0.0 ** 2
def g():
    y = xs[1]
    found = [(i, a, b) for i, (a, b) in enumerate(zip([1, 2], (3, 4)))]
    for a, b in zip(range(2), [5, 6]):
        found.append(a + b)
    return resample(y), found, sum([0.5, 0.25]), sum([1, 2]), max([1.5, 2.5]), min([4])
behavior B:
    take f(), g()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "names that are not there": """
def f():
    try:
        return later
    except NameError:
        return 'no'
    later = 1
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a list that is both given and changed": """
xs = [1]
def f(ys):
    ys += [2]
    ys.append(3)
    return ys is xs
behavior B:
    take f(xs), xs
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a loop over an iterator that changes a list": """
xs = [0]
behavior B:
    for x in iter([1, 2, 3]):
        xs[0] += 1
        take x, xs[0]
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a global variable of a loop before what the machine runs": """
def f():
    global i
    found = []
    for i in [1, 2, 3]:
        text = f'{i}'
        found.append((i, text))
    return found
behavior B:
    take f(), i
    take f(), i
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a truth value with an effect": """
class Box(object):
    n = 0
    def __bool__(self):
        self.n = self.n + 1
        return self.n % 2 == 0
b = Box()
behavior B:
    for k in range(4):
        if b:
            take 'even', b.n
        else:
            take 'odd', b.n
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "attributes after attempts that were rejected": """
class Box(object): pass
b = Box()
b.v = 0.0
def f(q):
    q.v = q.v + 1.0
    q.w = 3
    return q.v
behavior B:
    while True:
        take f(b)
ego = Object with behavior B, with x Uniform(1, 2, 3, 4, 5)
require always ego.x > 4 or b.v < 2
""",
    "a global exception after attempts that were rejected": """
e = 5.0
def f():
    global e
    z = e
    try:
        x = [][0]
    except IndexError as e:
        pass
    return z
behavior B:
    take f()
    while True:
        take 1
ego = Object with behavior B, with x Uniform(1, 2, 3, 4, 5)
require always ego.x > 4 or simulation.currentTime < 2
""",
    "variables of a monitor after attempts that were rejected": """
class Box(object): pass
q = Box()
q.v = -1
k = Uniform(1, 2, 3, 4, 5)
behavior B:
    while True:
        take q.v
monitor M:
    try:
        y = x + 1
    except NameError:
        y = 0
    x = y
    q.v = y
    require k > 4
    while True:
        wait
ego = Object with behavior B
""",
    "a property that raises AttributeError where there is __getattr__": """
class Box(object):
    @property
    def p(self):
        raise AttributeError('x')
    def __getattr__(self, name):
        return 5
b = Box()
behavior B:
    try:
        take b.p
    except AttributeError:
        take 'raised'
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "functions with methods of their own for equality": """
log = []
class Box(object):
    def __eq__(self, other):
        log.append('eq')
        return True
    def __hash__(self):
        log.append('hash')
        return 1
    def __call__(self, x):
        return 'mine'
b = Box()
behavior B:
    take b(1), b(v for v in [1])
    take len(log)
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "an argument that counts how often it is written out": """
class Box(object):
    n = 0
    def __repr__(self):
        self.n = self.n + 1
        return str(self.n)
b = Box()
behavior C(what):
    for k in range(3):
        take k, what.n
behavior B:
    do C(b)
    take b.n
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "the length of a long list again and again": """
xs = list(range(1000000))
behavior B:
    n = 0
    for i in range(1000):
        n += len(xs)
    take n
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a long range that is numbered": """
behavior B:
    for i, k in enumerate(range(10000000)):
        take i
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a long condition of a loop": f"""
def f():
    n = 20000
    while n > 0 and {" and ".join(["n > 0 - 1 + 1 - 1"] * 40)}:
        n = n - 1
    return n
behavior B:
    take f()
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    "a property that takes long": """
class Box(object):
    @property
    def p(self):
        n = 20000
        while n > 0 and n > 0 - 1 + 1 and n > -1 and n > -2:
            n = n - 1
        return n
b = Box()
behavior B:
    take b.p
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""",
    **{f"a property that calls itself {often} times": f"""
class Box(object):
    n = 0
    @property
    def p(self):
        self.n = self.n - 1
        return 0 if self.n <= 0 else 1 + self.p
b = Box()
def f(n):
    b.n = n
    return b.p
behavior B:
    take f({often})
ego = Object with behavior B, with x Uniform(1, 2), with name 'ego'
""" for often in (40, 41, 100)},
}
"""Their simulations are the same by both backends; errors are, too."""
ERRORS = {
    "recursion without end", "an exception that nothing catches", "a property that draws", "a property that makes an object",
    "the length of a long list again and again", "a long range that is numbered", "a long condition of a loop", "a property that takes long",
    "a property that calls itself 41 times", "a property that calls itself 100 times",
}
"""Those that end with one."""
LEFT = {*ERRORS, "names that are not there", "variables of a monitor after attempts that were rejected"}
"""Those of which the machine runs whole simulations."""
