# The paper, Section "Dynamic Scenarios", "Interrupts": `abort`, and the short form of it.
model street

behavior ApproachAndTurnLeft():
    try:
        do FollowLaneBehavior()
    interrupt when (distance from self to intersection) < 10:
        abort    # cancel lane following
    do WaitForTrafficLightBehavior()
    do TurnLeftBehavior()

behavior Shorthand():
    do FollowLaneBehavior() until (distance from self to intersection) < 10
    do WaitForTrafficLightBehavior()
    do TurnLeftBehavior()

ego = Car at (1.75, 30), with behavior ApproachAndTurnLeft
Car at (1.75, 0), with behavior Shorthand
