# dialect: scenic-3
# Things lie in the lane ahead; ego stops before them.
model scenic.domains.driving.model

class Debris:
    width: Range(0.3, 0.8)
    length: Range(0.3, 0.8)
    position: new Point on road
    heading: Range(0, 360) deg

behavior EgoBehavior():
    try:
        do FollowLaneBehavior(7)
    interrupt when withinDistanceToAnyObjs(self, 12):
        take SetThrottleAction(0), SetBrakeAction(0.8)

ego = new Car with behavior EgoBehavior
first = new Debris following roadDirection from ego.position for Range(20, 25)
second = new Debris following roadDirection from first.position for Range(2, 4)
require (distance from first to intersection) > 3
