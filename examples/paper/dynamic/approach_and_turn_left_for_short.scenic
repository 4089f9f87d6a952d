# Section "Dynamic Scenarios", "Interrupts": `do`-`until`.
model scenic.domains.driving.model

behavior ApproachAndTurnLeft():
    do FollowLaneBehavior() until (distance from self to intersection) < 10
    do WaitForTrafficLightBehavior()
    do TurnLeftBehavior()

lane = Uniform(*network.intersections[4].incomingLanes)
ego = Car at lane.centerline.pointAlongBy(Range(84, 86)), with behavior ApproachAndTurnLeft
