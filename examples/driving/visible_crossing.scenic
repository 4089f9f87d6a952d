# dialect: scenic-3
# A pedestrian whom ego sees, near the edge of its lane group.
model scenic.domains.driving.model

ego = new Car with behavior FollowLaneBehavior(4), with viewAngle 90 deg, with visibleDistance 30
spot = new OrientedPoint on visible ego.laneGroup.curb
walker = new Pedestrian right of spot by 1, facing 90 deg relative to spot.heading, with regionContainedIn everywhere
require ego can see walker
