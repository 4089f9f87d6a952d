# dialect: scenic-3
# Drivers whose decisions are made of many small functions: a model of how they follow, a memory, and a judgement of what is near.
model scenic.domains.driving.model

import math

DESIRED = Range(6, 9)
HEADWAY = 1.4
COMFORT = 2.0
STRONGEST = 6.0
EXPONENT = 4

class Memory(object):
    def __init__(self, size=5):
        self.size = size
        self.seen = []
        self.worst = math.inf

    def note(self, gap):
        self.seen = (self.seen + [gap])[-self.size:]
        self.worst = min(self.worst, gap)
        return self.average()

    def average(self):
        return sum(self.seen) / len(self.seen) if self.seen else math.inf

    def shrinks(self):
        return len(self.seen) > 1 and all(b <= a for a, b in zip(self.seen, self.seen[1:]))

def clamped(value, low=0.0, high=1.0):
    return max(low, min(high, value))

def square(x):
    return x * x

def between(one, other):
    return distance from one to other

def bearing(one, other):
    aside = other.position - one.position
    return math.atan2(-aside.x, aside.y) - one.heading

def wrapped(angle):
    while angle > math.pi:
        angle -= 2 * math.pi
    while angle <= -math.pi:
        angle += 2 * math.pi
    return angle

def is_ahead(one, other, cone=0.5):
    return abs(wrapped(bearing(one, other))) < cone

def others(one):
    return [o for o in simulation().objects if o is not one]

def leader_of(one, reach=50):
    near = [o for o in others(one) if is_ahead(one, o) and between(one, o) < reach]
    best = None
    for o in near:
        if best is None or between(one, o) < between(one, best):
            best = o
    return best

def gap_to(one, other):
    return max(0.1, between(one, other) - (one.length + other.length) / 2)

def closing(one, other):
    return one.speed - other.speed

def wished_gap(one, other):
    dynamic = one.speed * closing(one, other) / (2 * math.sqrt(COMFORT * STRONGEST))
    return 2 + max(0, one.speed * HEADWAY + dynamic)

def free_road(one, desired):
    return 1 - (one.speed / desired) ** EXPONENT

def interaction(one, other):
    return square(wished_gap(one, other) / gap_to(one, other))

def acceleration(one, desired):
    wish = COMFORT * free_road(one, desired)
    other = leader_of(one)
    return wish if other is None else wish - COMFORT * interaction(one, other)

def pedals(wish):
    return (clamped(wish / COMFORT), 0.0) if wish >= 0 else (0.0, clamped(-wish / STRONGEST))

def urgency(one):
    times = [gap_to(one, o) / closing(one, o) for o in others(one) if is_ahead(one, o) and closing(one, o) > 0.1]
    return 1 / min(times) if times else 0.0

def is_dangerous(one, memory):
    return urgency(one) > 0.5 or (memory.shrinks() and memory.average() < 4)

def point_to_follow(one):
    return one.lane.flowFrom(one.position, max(4, 0.7 * one.speed))

def aside_of_lane(one):
    aside = point_to_follow(one) - one.position
    return wrapped(math.atan2(-aside.x, aside.y) - one.heading)

def steering(one):
    return clamped(-1.5 * aside_of_lane(one), -1, 1)

behavior Follow(desired, memory):
    while True:
        wish = acceleration(self, desired)
        other = leader_of(self)
        if other is not None:
            memory.note(gap_to(self, other))
        throttle, brake = pedals(wish)
        take SetThrottleAction(throttle), SetBrakeAction(brake), SetSteerAction(steering(self))

behavior Drive(desired):
    memory = Memory()
    try:
        do Follow(desired, memory)
    interrupt when is_dangerous(self, memory):
        take SetThrottleAction(0), SetBrakeAction(1), SetSteerAction(steering(self))

def is_slow(one, limit=0.3):
    return one.speed < limit

ego = new Car with behavior Drive(DESIRED)
leader = new Car ahead of ego by Range(10, 18), with behavior Drive(DESIRED / 2)
third = new Car behind ego by Range(8, 12), with behavior Drive(DESIRED), with requireVisible False
require leader in ego.lane
record initial (gap_to(ego, leader)) as gap
