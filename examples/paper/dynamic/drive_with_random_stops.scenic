# Section "Dynamic Scenarios", "Stateful Behaviors": stops after times that are drawn anew; Drive is the one of "Interrupts".
param map = localPath('avenue.xodr')
model scenic.domains.driving.model

behavior Drive():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToNextObstacle() < 20:
        do PassingBehavior()
    interrupt when self.timeToCollision() < 5:
        do CollisionAvoidance()

behavior DriveWithRandomStops():
    delay = Range(15, 30) seconds
    last_stop = 0
    try:
        do Drive()
    interrupt when simulation.currentTime - last_stop > delay:
        do StopBehavior() for 5 seconds
        delay = Range(15, 30) seconds
        last_stop = simulation.currentTime

lane = Uniform(*network.intersections[0].incomingLanes)
ego = Car at lane.centerline.pointAlongBy(5), with behavior DriveWithRandomStops
