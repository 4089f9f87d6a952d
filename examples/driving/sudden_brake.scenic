# dialect: scenic-3
# The car ahead brakes for a while, and ego stops behind it.
model scenic.domains.driving.model

BRAKE_AFTER = Range(2, 4)

behavior LeaderBehavior():
    do FollowLaneBehavior(target_speed=6) for BRAKE_AFTER seconds
    do Braking() for 2 seconds
    do FollowLaneBehavior(target_speed=6)

behavior Braking():
    while True:
        take SetThrottleAction(0), SetBrakeAction(1)

behavior EgoBehavior(threshold=12):
    try:
        do FollowLaneBehavior(target_speed=6)
    interrupt when withinDistanceToObjsInLane(self, threshold):
        take SetThrottleAction(0), SetBrakeAction(1)

ego = new Car with behavior EgoBehavior
leader = new Car ahead of ego by Range(10, 16), with behavior LeaderBehavior
require leader in ego.lane
