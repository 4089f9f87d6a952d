# dialect: scenic-3
# Ego waits before an intersection until the other car is through.
model scenic.domains.driving.model

inter = Uniform(*network.intersections)
straight = Uniform(*filter(lambda m: m.type is ManeuverType.STRAIGHT, inter.maneuvers))
mine = Uniform(*straight.conflictingManeuvers)

behavior Wait(car):
    try:
        do FollowTrajectoryBehavior(6, [mine.startLane, mine.connectingLane, mine.endLane])
    interrupt when (distance from self to inter) < 6 and (distance from car to inter) < 20:
        take SetThrottleAction(0), SetBrakeAction(1)

other = new Car on straight.startLane.centerline, with requireVisible False,
    with behavior FollowTrajectoryBehavior(7, [straight.startLane, straight.connectingLane, straight.endLane])
ego = new Car on mine.startLane.centerline, with behavior Wait(other)
require 10 < (distance from ego to inter) < 30
require 5 < (distance from other to inter) < 20
