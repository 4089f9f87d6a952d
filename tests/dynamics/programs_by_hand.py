"""Programs over time, written to reach each statement of behaviors, and each way out of one, by both backends."""

from __future__ import annotations

BY_HAND = {
    "variables": """
n = 0
def twice(x): return 2 * x
behavior B(a, b=Range(0, 1), *rest, c=3, **more):
    global n
    x = y = a
    n = n + 1
    x += 2
    x -= 0.5
    x *= 3
    z = [x, y]
    z.append(n)
    z[0] += 1
    u, (v, w) = 1, (2, 3)
    take x, y, z, u, v, w, b, rest, c, more, twice(x)
    del y
    take n, resample(b), [i * i for i in range(3)], (lambda q: q + x)(1)
    def inner(t):
        return t + x
    take inner(2), f"{x:.1f}", {'a': 1}, {1, 2}, x if x > 2 else 0, not x, -x, +x, x // 2, x % 2, x ** 2, 7 / 2
    take x > 1 > 0, 1 in z, x is None, x and 0, 0 or x, self is ego, None, True, z[-1], z[0:2]
ego = Object with behavior B(1, Range(0, 1), 7, d=9)
other = Object at 5 @ 0, with behavior B(2)
""",
    "loops": """
behavior B:
    for i in [1, 2, 3]:
        if i == 2: continue
        take i
    else:
        take 'else'
    for i in range(5):
        try:
            while True:
                take i
                if i == 1: break
                try:
                    take 'deep'
                    if simulation.currentTime > 6: break
                interrupt when simulation.currentTime == 5:
                    take 'inner'
                    continue
        interrupt when simulation.currentTime == 4:
            take 'handler'
            continue
        interrupt when simulation.currentTime == 9:
            break
        take 'after', i
    while simulation.currentTime < 12:
        wait
    else:
        take 'over'
    return 5
ego = Object with behavior B
""",
    "exceptions": """
behavior Guarded(n):
    precondition: simulation.currentTime < n
    invariant: simulation.currentTime < n + 1
    while True:
        take n
behavior B:
    try:
        do Guarded(2)
    except InvariantViolation as e:
        take 'caught', str(type(e))
    else:
        take 'never'
    finally:
        take 'finally'
    for i in range(3):
        try:
            if i == 0: raise ValueError('v')
            if i == 1: [][1]
            take 1 / (i - 2)
        except (IndexError, ValueError) as e:
            try:
                raise
            except IndexError:
                take 'index'
            except Exception as f:
                take 'other', f.args
        except ZeroDivisionError:
            try:
                do Guarded(1)
            except GuardViolation:
                take 'violated'
                break
        finally:
            take 'last', i
    try:
        try:
            take 'x'
            abort
        interrupt when False:
            pass
        except ValueError:
            pass
        else:
            take 'not after abort'
        finally:
            take 'but this'
        assert simulation.currentTime < 3, 'late'
    except AssertionError as e:
        take e.args
ego = Object with behavior B
""",
    "together": """
behavior A(n):
    for i in range(n):
        take Uniform(*range(9)), n
behavior T(n):
    take Range(0, 1)
    terminate
behavior B:
    do A(2), A(3)
    do A(4), A(1) for 2 steps
    do choose A(1), A(2)
    do shuffle {A(1): 2, A(2): 1} until simulation.currentTime > 7
    do A(9), T(1)
ego = Object with behavior B
other = Object at 5 @ 0, with behavior A(5)
""",
    "requirements": """
behavior B:
    x = Uniform(1, 2, 3, 4)
    require x < 4
    require[0.5] x < 2
    take x
    self.color = Range(0, 1)
    take self.color
    take x
monitor M:
    while simulation.currentTime < 3:
        take 5
        wait
    if Uniform(0, 1) == 0: terminate
require always ego.position.x < 100
require eventually simulation.currentTime >= 2
terminate when Uniform(0, 0, 0, 0, 1) == 1
ego = Object with behavior B, with color 3
""",
    "scenarios": """
behavior B(n):
    while True:
        take n, self.speed
scenario Part(n):
    setup:
        Object at (10 * n, 0), with behavior B(n), with speed n
        override ego with behavior B(n + 100), with speed 3
        require eventually simulation.currentTime > n
        monitor M:
            while True:
                wait
    compose:
        wait
        wait
scenario Main():
    setup:
        ego = Object with behavior B(0), with speed 1
    compose:
        wait
        do Part(1), Part(2)
        try:
            do choose {Part(3): 1, Part(4): 2} for 3 steps
        interrupt when simulation.currentTime == 5:
            do Part(5)
        wait
""",
    "queries": """
behavior B:
    while True:
        take self.heading + 1, (distance from self to other), (relative heading of other), (angle to other), self can see other
        take (0 @ 1 offset along self.heading by 1 @ 0), self.position.distanceTo(other.position), other in workspace, simulation.objects
        take (front of self).position, self.position + (1 @ 2), (1, 2) + self.position
        take abs(-2), max(1, 3), min([4, 2]), len([1]), round(2.6), math.sin(1)
import math
workspace = Workspace(RectangularRegion(0 @ 0, 0, 50, 50))
ego = Object facing 20 deg, with behavior B
other = Object at Range(3, 9) @ 4, with requireVisible False
""",
    "nested definitions": """
def make(k):
    behavior Inner(a):
        x = a + k
        take x
        take k
    return Inner
C = make(5)
behavior B:
    do C(2)
    do make(7)(1)
    local = C
    do local(3)
ego = Object with behavior B
""",
    "randomness that is carried": """
behavior Use(v):
    take v, resample(v), resample(v)
behavior B:
    x = Range(0, 1)
    y = x
    take x, y, resample(y), x + y, [x, y]
    do Use(y)
    do Use(x if x > 0.5 else y)
    z = (x, y)
    take resample(z[0]) if False else z
ego = Object with behavior B
""",
    "guards and handlers": """
behavior Sometimes(k):
    precondition: simulation.currentTime < k
    take 'sometimes', k
behavior Changing:
    self.level = self.level + 1
    take 'changes'
    self.level = self.level + 1
behavior Flat:
    invariant: self.level < 2
    take 'flat'
    do Changing
    take 'not reached'
behavior Short:
    invariant: simulation.currentTime < 4
    try:
        while True:
            take 'short'
    interrupt when simulation.currentTime >= 4:
        take 'not reached either'
behavior B:
    do choose Sometimes(9), Sometimes(1)
    do shuffle {Sometimes(3): 1, Sometimes(4): 2}
    try:
        do Short
    except InvariantViolation:
        take 'caught', simulation.currentTime
    try:
        try:
            take 'inside'
            raise ValueError
        finally:
            take 'finally'
    except ValueError:
        take 'outside'
    try:
        do Flat
    except GuardViolation:
        take 'violated'
    do Flat
ego = Object with behavior B, with level 0
""",
    "handlers of no time": """
n = 0
behavior Never:
    precondition: False
    take 'never'
behavior Often:
    take 'often'
behavior B:
    global n
    try:
        take 'body'
        take 'more'
    interrupt when n < 3:
        n = n + 1
    take n
    for i in range(5):
        do choose Never(), Often(), Never()
ego = Object with behavior B
""",
    "a later dialect": """
behavior A(n):
    while True:
        take n
behavior B():
    wait for 2 steps
    wait until simulation().currentTime >= 4
    try:
        do A(1) for 0.3 seconds
        terminate simulation
    interrupt when simulation().currentTime >= 30:
        wait
monitor M(n):
    for i in range(n):
        wait
    terminate
require monitor M(9)
terminate after 11 steps
record simulation().currentTime as time
record initial ego.position
record final Range(0, 1) as last
class Thing:
    x: Range(0, 1)
ego = new Thing with behavior B()
other = new Thing at (5, 0), with behavior A(self.x)
""",
}  # fmt: skip
"""Programs with what those at random seldom have."""
