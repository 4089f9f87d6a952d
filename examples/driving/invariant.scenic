# dialect: scenic-3
# A behavior whose invariant fails where the road ends, and what is done then.
model scenic.domains.driving.model

behavior Straight():
    invariant: self in road
    while True:
        take SetThrottleAction(0.4), SetSteerAction(0)

behavior Careful():
    try:
        do Straight()
    except InvariantViolation:
        while True:
            take SetThrottleAction(0), SetBrakeAction(1)

ego = new Car with behavior Careful
