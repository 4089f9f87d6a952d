# dialect: scenic-3
# Requirements over time: never too near, and at some time far from the start.
model scenic.domains.driving.model

start = new Point on road
ego = new Car at start, facing roadDirection, with behavior FollowLaneBehavior(8)
leader = new Car ahead of ego by Range(12, 20), with behavior FollowLaneBehavior(8)
require leader in ego.lane
require always (distance from ego to leader) > 1
require eventually (distance from ego to start) > 5
terminate after 10 seconds
