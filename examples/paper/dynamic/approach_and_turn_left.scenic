# Section "Dynamic Scenarios", "Interrupts": `abort`.
model scenic.domains.driving.model

behavior ApproachAndTurnLeft():
    try:
        do FollowLaneBehavior()
    interrupt when (distance from self to intersection) < 10:
        abort    # cancel lane following
    do WaitForTrafficLightBehavior()
    do TurnLeftBehavior()

lane = Uniform(*network.intersections[4].incomingLanes)
ego = Car at lane.centerline.pointAlongBy(Range(84, 86)), with behavior ApproachAndTurnLeft
