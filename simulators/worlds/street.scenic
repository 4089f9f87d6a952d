# A straight street towards North, with a crossing at 60 m: a stand-in for the paper's driving library, until there is a road network.
# Metres; cars keep to the right of two lanes of 3.5 m. `scenic.domains.driving.model` will take its place.

from scenic.domains.driving.actions import *

road = RectangularRegion((0, 100), 0, 7, 300)
intersection = RectangularRegion((0, 60), 0, 7, 12)
curb = PolylineRegion([(3.5, -50), (3.5, 250)])
workspace = Workspace(RectangularRegion((0, 100), 0, 30, 300))
LANE = 1.75

class Car:
    position: Point in RectangularRegion((LANE, 0), 0, 0.1, 60)
    width: 2
    length: 4.5
    speed: 0
    visibleDistance: 100
    regionContainedIn: None

    # The paper names these two; here all that is near counts.
    def distanceToNextObstacle(self):
        return self.distanceToClosest(Object)

    def timeToCollision(self):
        return self.distanceToClosest(Object) / max(self.speed, 0.1)

class Pedestrian:
    position: Point in RectangularRegion((6, 40), 0, 2, 60)
    width: 0.75
    length: 0.75
    speed: 0

# Drive along the lane `x`, as fast as `target` (metres per second): to the right (positive) if the lane is there or the heading too far left.
behavior FollowLaneBehavior(target=8, x=LANE):
    while True:
        off = (x - self.position.x) / 20 + self.heading
        throttle = 0.5 if self.speed < target else 0
        brake = 0.3 if self.speed > target + 1 else 0
        take SetThrottleAction(throttle), SetBrakeAction(brake), SetSteerAction(max(-0.5, min(0.5, off)))

behavior StopBehavior():
    while True:
        take SetThrottleAction(0), SetBrakeAction(1)

# Change to the left lane for three seconds.
behavior PassingBehavior():
    do FollowLaneBehavior(10, -LANE) for 3 seconds

behavior CollisionAvoidance():
    do StopBehavior() for 1 seconds

behavior GetBackOntoRoad():
    do FollowLaneBehavior(3) until self in road

behavior WaitForTrafficLightBehavior():
    do StopBehavior() for 2 seconds

behavior TurnLeftBehavior():
    for i in range(20):
        take SetThrottleAction(0.2), SetBrakeAction(0), SetSteerAction(-0.4)

behavior FollowLaneAvoidingCollisions():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToClosest(Object) < 8:
        take SetThrottleAction(0), SetBrakeAction(1)
