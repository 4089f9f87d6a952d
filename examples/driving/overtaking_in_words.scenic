# dialect: scenic-3
# A car that swerves and comes back, by steering of its own.
model scenic.domains.driving.model

behavior Swerve(strength):
    do FollowLaneBehavior(6) for 1 seconds
    for side in (-1, 1, 1, -1):
        for i in range(4):
            take SetSteerAction(side * strength), SetThrottleAction(0.2)
    do FollowLaneBehavior(6)

ego = new Car with behavior Swerve(Range(0.05, 0.1))
require (distance from ego to intersection) > 20
