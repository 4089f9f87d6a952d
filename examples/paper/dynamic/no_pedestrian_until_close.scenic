# Section "Dynamic Scenarios", "Requirements and Monitors": `require` in a behavior.
model scenic.domains.driving.model

behavior WaitUntilClose(threshold=15):
    while (distance from self to ego) > threshold:
        require self.distanceToClosest(Pedestrian) > threshold
        wait
    do FollowLaneBehavior()

lane = Uniform(*network.intersections[4].incomingLanes)
ego = Car at lane.centerline.pointAlongBy(Range(8, 14)), with behavior FollowLaneBehavior
waiting = Car at lane.group.opposite.lanes[0].centerline.pointAlongBy(Range(35, 45)), with behavior WaitUntilClose
Pedestrian on lane.road.sidewalkRegion, with behavior WalkAlongSidewalkBehavior
