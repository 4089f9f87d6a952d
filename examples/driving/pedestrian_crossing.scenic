# dialect: scenic-3
# A pedestrian begins to walk across the road when ego comes near.
model scenic.domains.driving.model

behavior CrossWhenNear(vehicle, threshold=15):
    while (distance from self to vehicle) > threshold:
        take SetWalkingSpeedAction(0)
    while True:
        take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(1.2)

behavior EgoBehavior():
    try:
        do FollowLaneBehavior(target_speed=7)
    interrupt when withinDistanceToAnyPedestrians(self, 10):
        take SetThrottleAction(0), SetBrakeAction(1)

road_ahead = Uniform(*network.roads)
lane = Uniform(*road_ahead.lanes)
spot = new OrientedPoint on lane.centerline
ego = new Car following roadDirection from spot for Range(-30, -20), with behavior EgoBehavior
walker = new Pedestrian right of spot by 4, facing 90 deg relative to spot.heading, with regionContainedIn everywhere, with behavior CrossWhenNear(ego)
require (distance from ego to intersection) > 10
