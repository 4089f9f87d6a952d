# dialect: scenic-3
# A car ahead in the same lane that drives more slowly.
model scenic.domains.driving.model

param speed = Range(2, 5)

ego = new Car with behavior DriveAvoidingCollisions(target_speed=8, avoidance_threshold=10)
leader = new Car ahead of ego by Range(8, 15), with behavior FollowLaneBehavior(target_speed=globalParameters.speed)
require leader in ego.lane
