# It brakes in time: a dynamic program
# Replay runs it. Runs in which ego comes too close are rejected.
from scenic.domains.driving.actions import *

class Car:
    width: 2
    length: 4.5
    speed: 0

behavior StopInTime():
    try:
        while True:
            take SetThrottleAction(0.5), SetBrakeAction(0)
    interrupt when self.distanceToClosest(Object) < 12:
        take SetBrakeAction(1)

ego = Car at (0, 0), with behavior StopInTime
other = Car at (0, Range(15, 40))

require always (distance to other) > 6
terminate when ego.speed == 0 and simulation.currentTime > 1
