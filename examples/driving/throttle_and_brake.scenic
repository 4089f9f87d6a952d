# dialect: scenic-3
# Controls without a road: accelerate, coast, brake.
model scenic.domains.driving.model

behavior Program(throttle):
    for i in range(20):
        take SetThrottleAction(throttle)
    for i in range(10):
        take SetThrottleAction(0)
    while self.speed > 0.2:
        take SetBrakeAction(0.5)

ego = new Car with behavior Program(Range(0.2, 0.6)), with regionContainedIn everywhere
terminate when simulation().currentTime > 60
