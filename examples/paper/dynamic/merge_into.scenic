# Section "Dynamic Scenarios", "Preconditions and Invariants": a precondition, which holds of one of the three lanes to choose from.
param map = localPath('avenue.xodr')
model scenic.domains.driving.model

behavior MergeInto(newLane):
    precondition: self.lane is not newLane and self.road is newLane.road
    do LaneChangeBehavior(newLane.sections[0])
    do FollowLaneBehavior()

ways = network.intersections[0].incomingLanes
own = ways[0].group.lanes[0]
ego = Car at own.centerline.pointAlongBy(Range(50, 100)), with speed 8, with behavior MergeInto(Uniform(own, own.group.lanes[1], ways[2]))
