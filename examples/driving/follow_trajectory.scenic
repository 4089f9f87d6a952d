# dialect: scenic-3
# Ego takes a maneuver of an intersection that is drawn.
model scenic.domains.driving.model

inter = Uniform(*network.intersections)
maneuver = Uniform(*inter.maneuvers)
trajectory = [maneuver.startLane, maneuver.connectingLane, maneuver.endLane]

ego = new Car on maneuver.startLane.centerline,
    with behavior FollowTrajectoryBehavior(target_speed=6, trajectory=trajectory)
require 10 < (distance from ego to inter) < 30
