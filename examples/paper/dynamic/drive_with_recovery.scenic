# Section "Dynamic Scenarios", "Preconditions and Invariants": an invariant, and the exception that tells of its violation.
model scenic.domains.driving.model

behavior FollowLaneBehavior():
    invariant: self in road
    lane = Trajectory([self.lane])
    while True:
        take following(self, lane, lane.along(self.position), 4)

# A swerve onto the shoulder.
behavior CollisionAvoidance():
    while self in road:
        take SetThrottleAction(0.1), SetBrakeAction(0), SetSteerAction(0.3)
    for i in range(6):
        take SetSteerAction(0)

behavior Drive():
    while True:
        try:
            do FollowLaneBehavior()
        interrupt when self.distanceToClosest(Object) < 5:
            do CollisionAvoidance()
        except InvariantViolation:   # FollowLaneBehavior has failed
            do GetBackOntoRoad()

lane = Uniform(*network.intersections[4].incomingLanes)
spot = OrientedPoint at lane.centerline.pointAlongBy(Range(40, 50)), facing roadDirection
ego = Car behind spot by 15, with behavior Drive
Car left of spot by 1.6, facing 180 deg relative to roadDirection
