# The paper, Section "Dynamic Scenarios", "Preconditions and Invariants": all three listings, with a lane as a region of the street.
model street

leftLane = RectangularRegion((-1.75, 100), 0, 3.5, 300)

behavior MergeInto(newLane):
    precondition: self not in newLane and self in road
    do FollowLaneBehavior(8, -1.75) until self in newLane

behavior FollowRoad():
    invariant: self in road
    while True:
        take SetThrottleAction(0.5), SetSteerAction(0.02)

behavior Drive():
    do MergeInto(leftLane)
    while True:
        try:
            do FollowRoad()
        interrupt when self.distanceToClosest(Object) < 5:
            do CollisionAvoidance()
        except InvariantViolation:   # FollowRoad has failed
            do GetBackOntoRoad()

ego = Car at (1.75, 0), with behavior Drive
