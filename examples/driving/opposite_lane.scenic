# dialect: scenic-3
# A car in the lane beside ego's, in the other direction.
model scenic.domains.driving.model

ego = new Car with behavior FollowLaneBehavior(6)
group = ego.laneGroup.opposite
lane = Uniform(*group.lanes)
new Car on lane, with requireVisible False, with behavior FollowLaneBehavior(6)
