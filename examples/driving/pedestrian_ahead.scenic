# dialect: scenic-3
# A pedestrian stands in the lane; ego brakes before it.
model scenic.domains.driving.model

SAFETY_DISTANCE = 8

behavior EgoBehavior(target_speed=6):
    try:
        do FollowLaneBehavior(target_speed)
    interrupt when withinDistanceToAnyObjs(self, SAFETY_DISTANCE):
        take SetThrottleAction(0), SetBrakeAction(1)

lane = Uniform(*network.lanes)
spot = new OrientedPoint on lane.centerline
ego = new Car following roadDirection from spot for Range(-25, -15), with behavior EgoBehavior
new Pedestrian at spot, with regionContainedIn everywhere
require (distance from ego to intersection) > 5
terminate after 20 seconds
