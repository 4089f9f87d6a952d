# The paper, Section "Dynamic Scenarios", "Interrupts".
model street

behavior FollowAvoidingObstacles():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToClosest(Object) < 5:
        take SetBrakeAction(1)

ego = Car at (1.75, 0), with behavior FollowAvoidingObstacles
Car at (-1.75, 20)
