# dialect: scenic-3
# Ego turns left while a car goes straight in a lane that conflicts.
model scenic.domains.driving.model

inter = Uniform(*filter(lambda i: len(i.incomingLanes) > 2, network.intersections))
turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, inter.maneuvers))
other = Uniform(*turn.conflictingManeuvers)

ego = new Car on turn.startLane.centerline,
    with behavior FollowTrajectoryBehavior(5, [turn.startLane, turn.connectingLane, turn.endLane])
crossing = new Car on other.startLane.centerline, with requireVisible False,
    with behavior FollowTrajectoryBehavior(7, [other.startLane, other.connectingLane, other.endLane])
require 8 < (distance from ego to inter) < 25
require 8 < (distance from crossing to inter) < 25
