# Section "Dynamic Scenarios", "Interrupts": nested try-interrupt statements; Drive is the one above.
model scenic.domains.driving.model

behavior Drive():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToNextObstacle() < 20:
        do PassingBehavior()
    interrupt when self.timeToCollision() < 5:
        do CollisionAvoidance()

behavior DriveWithSuddenBrake():
    haveBraked = False
    try:
        do Drive()
    interrupt when self in targetRegion and not haveBraked:
        do StopBehavior() for 5 seconds
        haveBraked = True

lane = Uniform(*network.intersections[4].incomingLanes)
targetRegion = CircularRegion(lane.centerline.pointAlongBy(50), 8)
ego = Car at lane.centerline.pointAlongBy(Range(5, 15)), with behavior DriveWithSuddenBrake
