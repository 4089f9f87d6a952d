# dialect: scenic-3
# Ego turns right; the run ends when it has left the intersection.
model scenic.domains.driving.model

inter = Uniform(*network.intersections)
turn = Uniform(*filter(lambda m: m.type is ManeuverType.RIGHT_TURN, inter.maneuvers))

behavior TurnAndGoOn():
    do FollowTrajectoryBehavior(5, [turn.startLane, turn.connectingLane, turn.endLane])
    do FollowLaneBehavior(6)

ego = new Car on turn.startLane.centerline, with behavior TurnAndGoOn
require (distance from ego to inter) < 20
terminate when (ego in turn.endLane)
