# Section "Dynamic Scenarios", "Interrupts": a car that brakes while another one, which comes from the other side, is near.
model scenic.domains.driving.model

behavior FollowAvoidingObstacles():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToClosest(Object) < 5:
        take SetBrakeAction(1)

lane = Uniform(*network.intersections[4].incomingLanes)
ego = Car at lane.centerline.pointAlongBy(Range(5, 15)), with behavior FollowAvoidingObstacles
Car at lane.group.opposite.lanes[0].centerline.pointAlongBy(Range(15, 25)), with behavior FollowLaneBehavior(5)
