# Section "Dynamic Scenarios", "Interrupts": a hierarchy of behaviors, on a street with two lanes for each direction.
param map = localPath('avenue.xodr')
model scenic.domains.driving.model

behavior Drive():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToNextObstacle() < 20:
        do PassingBehavior()
    interrupt when self.timeToCollision() < 5:
        do CollisionAvoidance()

lane = Uniform(*network.intersections[0].incomingLanes)
start = OrientedPoint at lane.centerline.pointAlongBy(Range(50, 100)), facing roadDirection
require lane is lane.group.lanes[0]
ego = Car at start, with behavior Drive
stopped = Car ahead of start by Range(70, 90)
