# Section "Dynamic Scenarios", "Behavior Arguments and Random Parameters": a car before a crosswalk, on which somebody is.
model scenic.domains.driving.model

behavior AvoidPedestrian():
    threshold = Range(4, 7)
    while True:
        if self.distanceToClosest(Pedestrian) < threshold:
            strength = TruncatedNormal(0.8, 0.02, 0.5, 1)
            take SetBrakeAction(strength), SetThrottleAction(0)
        else:
            take SetThrottleAction(0.5), SetBrakeAction(0)

lane = Uniform(*network.intersections[4].incomingLanes)
crosswalk = OrientedPoint at lane.centerline.pointAlongBy(lane.centerline.length - 2.5), facing roadDirection
ego = Car behind crosswalk by 5.5, with behavior AvoidPedestrian
Pedestrian right of crosswalk by Range(0, 0.5), facing 90 deg relative to roadDirection, with behavior WalkForwardBehavior(1.4)
