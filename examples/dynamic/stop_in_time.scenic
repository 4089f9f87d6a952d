# A car drives towards another one and brakes when it is close. Runs in which it comes too close are rejected:
# what is left are the starts from which the brakes suffice. Try
#     scenic-ref simulate examples/dynamic/stop_in_time.scenic --simulator kinematic -n 20 -o runs.jsonl

from scenic.domains.driving.actions import *

class Car:
    width: 2
    length: 4.5
    speed: 0

behavior Go(throttle=0.5):
    while True:
        take SetThrottleAction(throttle), SetBrakeAction(0)

behavior StopInTime():
    try:
        do Go()
    interrupt when self.distanceToClosest(Object) < 12:
        take SetBrakeAction(1)

ego = Car at (0, 0), with behavior StopInTime
other = Car at (0, Range(15, 40))

require always (distance to other) > 6
terminate when ego.speed == 0 and simulation.currentTime > 1
