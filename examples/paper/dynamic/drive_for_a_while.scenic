# Section "Dynamic Scenarios", "Interrupts": a time limit, from the border of the map to about the other one.
model scenic.domains.driving.model

behavior DriveForAWhile():
    do FollowLaneBehavior() for 30 seconds

lane = Uniform(*filter(lambda l: l._predecessor is None, network.lanes))
ego = Car at lane.centerline.pointAlongBy(5), with behavior DriveForAWhile
