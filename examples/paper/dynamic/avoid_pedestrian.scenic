# The paper, Section "Dynamic Scenarios", "Behavior Arguments and Random Parameters".
model street

behavior AvoidPedestrian():
    threshold = Range(4, 7)
    while True:
        if self.distanceToClosest(Pedestrian) < threshold:
            strength = TruncatedNormal(0.8, 0.02, 0.5, 1)
            take SetBrakeAction(strength), SetThrottleAction(0)
        else:
            take SetThrottleAction(0.5), SetBrakeAction(0)

ego = Car at (1.75, 0), with behavior AvoidPedestrian
Pedestrian at (4, 25)
