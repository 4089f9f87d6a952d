# dialect: scenic-3
# A car parked at an angle at the curb, near ego.
model scenic.domains.driving.model

ego = new Car with behavior FollowLaneBehavior(6)
spot = new OrientedPoint on visible curb
badAngle = Uniform(1, -1) * Range(10, 20) deg
parked = new Car left of spot by 0.5, facing badAngle relative to roadDirection, with regionContainedIn everywhere
require (distance to parked) > 8
