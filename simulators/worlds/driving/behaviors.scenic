# Behaviors of the driving library: the released library's, and those that the paper names. Speeds in m/s, distances in metres.

from scenic.domains.driving.map import network
from scenic.domains.driving.roads import *
from scenic.domains.driving.actions import *
from scenic.domains.driving.arguments import check_arguments
from scenic.domains.driving.paths import Trajectory
from scenic.domains.driving.lights import *
from scenic.domains.driving.kinds import *

road = network.drivableRegion
roadOrShoulder = network.roadOrShoulder

# The actions that keep a vehicle on a path, `place` metres along it, at a speed; it slows down before bends.
def following(car, path, place, speed):
    error = min(speed, path.speed_limit(place)) - car.speed
    steer = path.steering(car.position, car.heading, car.speed, car.length, place)
    return (SetThrottleAction(max(0, min(1, error / 2))), SetBrakeAction(max(0, min(1, -error / 3))), SetSteerAction(steer))

# The speed from which one comes to rest softly in so many metres.
def stopping(metres):
    return (4 * max(0, metres)) ** 0.5

# How lanes go on: straight, if they can.
def onward(lane):
    straight = [m for m in lane.maneuvers if m.type is ManeuverType.STRAIGHT]
    return straight if straight else lane.maneuvers

def concatenateCenterlines(centerlines=[]):
    return PolylineRegion.unionAll(centerlines)

behavior StopBehavior():
    while True:
        take SetThrottleAction(0), SetBrakeAction(1)

behavior ConstantThrottleBehavior(x):
    check_arguments('ConstantThrottleBehavior', x)
    take SetThrottleAction(x), SetReverseAction(False), SetHandBrakeAction(False)

behavior AccelerateForwardBehavior():
    take SetReverseAction(False), SetHandBrakeAction(False), SetThrottleAction(0.5)

# To the end of a trajectory (lanes, lines or points, in order), slower in bends: at most at `turn_speed`, if it is given.
behavior FollowTrajectoryBehavior(target_speed=10, trajectory=None, turn_speed=None):
    check_arguments('FollowTrajectoryBehavior', target_speed, trajectory, turn_speed)
    path = Trajectory(trajectory)
    place = path.along(self.position)
    while place < path.length - 1:
        bend = turn_speed is not None and path.speed_limit(place) < target_speed
        take following(self, path, place, turn_speed if bend else target_speed)
        place = path.along(self.position, place)

# Along a trajectory through an intersection, until it ends or the vehicle has left the intersection, to which it may have to come first.
behavior TurnBehavior(trajectory, target_speed=6):
    check_arguments('TurnBehavior', trajectory, target_speed)
    path = Trajectory(trajectory)
    place = path.along(self.position)
    within = False
    while place < path.length - 1 and not (within and self._intersection is None):
        within = within or self._intersection is not None
        take following(self, path, place, target_speed)
        place = path.along(self.position, place)

# Along a lane, straight on where it goes on (else by some maneuver), until the road ends; then the vehicle stops.
behavior FollowLaneBehavior(target_speed=10, laneToFollow=None, is_oppositeTraffic=False):
    invariant: self in roadOrShoulder
    check_arguments('FollowLaneBehavior', target_speed, laneToFollow, is_oppositeTraffic)
    lane = self.lane if laneToFollow is None else laneToFollow
    while not is_oppositeTraffic and len(lane.maneuvers) > 0:
        maneuver = Uniform(*onward(lane))
        parts = [lane, maneuver.endLane] if maneuver.connectingLane is None else [lane, maneuver.connectingLane, maneuver.endLane]
        path = Trajectory(parts)
        end = path.length - maneuver.endLane.centerline.length
        place = path.along(self.position)
        while place < end:
            take following(self, path, place, target_speed)
            place = path.along(self.position, place)
        lane = maneuver.endLane
    path = Trajectory([lane], is_oppositeTraffic)
    place = path.along(self.position)
    while place < path.length - 5:
        take following(self, path, place, min(target_speed, stopping(path.length - 3 - place)))
        place = path.along(self.position, place)
    do StopBehavior()

# Into a section of a lane, which need not be beside the own one, and a little further; then the vehicle rolls on.
behavior LaneChangeBehavior(laneSectionToSwitch, is_oppositeTraffic=False, target_speed=10):
    check_arguments('LaneChangeBehavior', laneSectionToSwitch, is_oppositeTraffic, target_speed)
    lane = Trajectory([laneSectionToSwitch.lane], is_oppositeTraffic)
    begin = lane.along(self.position) + max(10, 1.5 * self.speed)
    path = Trajectory([self.position, lane.point(begin), lane.point(begin + 20)])
    place = 0
    while place < path.length - 18:
        take following(self, path, place, target_speed)
        place = path.along(self.position, place)
    take SetThrottleAction(0), SetSteerAction(0)

behavior DriveAvoidingCollisions(target_speed=25, avoidance_threshold=10):
    check_arguments('DriveAvoidingCollisions', target_speed, avoidance_threshold)
    try:
        do FollowLaneBehavior(target_speed)
    interrupt when self.distanceToNextObstacle() <= avoidance_threshold:
        take SetThrottleAction(0), SetBrakeAction(1)

behavior FollowLaneAvoidingCollisions():
    do DriveAvoidingCollisions(10, 8)

behavior WalkForwardBehavior(speed=0.5):
    check_arguments('WalkForwardBehavior', speed)
    while True:
        take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(speed)

# Along the sidewalk to its end.
behavior WalkAlongSidewalkBehavior(speed=1.4):
    check_arguments('WalkAlongSidewalkBehavior', speed)
    path = Trajectory([network.sidewalkAt(self.position, reject='the pedestrian is not on a sidewalk')])
    place = path.along(self.position)
    while place < path.length - 1:
        take SetWalkingDirectionAction(angle from self to path.point(place + 2)), SetWalkingSpeedAction(speed)
        place = path.along(self.position, place)
    take SetWalkingSpeedAction(0)

# The actions with which a pedestrian or a vehicle moves ahead at a speed.
def moving(one, speed):
    if isinstance(one, Walks):
        return (SetWalkingDirectionAction(one.heading), SetWalkingSpeedAction(speed))
    return (SetSpeedAction(speed),)

# Across the way of another object when that comes near, so fast (but not slower than `min_speed`) that both meet; when the other one has passed,
# with the final speed.
behavior CrossingBehavior(reference_actor, min_speed=1, threshold=10, final_speed=None):
    check_arguments('CrossingBehavior', reference_actor, min_speed, threshold, final_speed)
    while (distance from self to reference_actor) > threshold:
        take moving(self, 0)
    apart = (self.position - reference_actor.position).rotatedBy(-reference_actor.heading)
    while apart.y > 0:
        take moving(self, max(min_speed, apart.x * reference_actor.speed / apart.y))
        apart = (self.position - reference_actor.position).rotatedBy(-reference_actor.heading)
    while True:
        take moving(self, final_speed if final_speed else min_speed)

# Past what is ahead: over to the next lane for passing (of the other direction, if there is no other), and back.
behavior PassingBehavior(target_speed=12):
    check_arguments('PassingBehavior', target_speed)
    own = self.laneSection
    other = own._fasterLane if own._fasterLane is not None else own._laneToLeft
    if other is None:
        do FollowLaneBehavior(5) for 1 seconds
    else:
        opposite = other.isForward is not own.isForward
        do LaneChangeBehavior(other, opposite, target_speed)
        do FollowLaneBehavior(target_speed, other.lane, opposite) for 2 seconds
        do LaneChangeBehavior(own, False, target_speed)

behavior CollisionAvoidance():
    do StopBehavior() until self.timeToCollision() > 5 or self.speed < 0.1
    take SetThrottleAction(0), SetBrakeAction(1)

# Along the nearest lane, slowly, until all of the vehicle is on the road.
behavior GetBackOntoRoad():
    nearest = min(network.lanes, key=lambda lane: lane.distance_to(self.position))
    path = Trajectory([nearest])
    while not (self in road):
        take following(self, path, path.along(self.position), 3)

# To the line before the traffic light of the lane (or as near to it as one can still brake), and there until it is green.
behavior WaitForTrafficLightBehavior(target_speed=10):
    check_arguments('WaitForTrafficLightBehavior', target_speed)
    lane = self.lane
    light = lane._trafficLight
    path = Trajectory([lane])
    place = path.along(self.position)
    while light is not None and getTrafficLightStatus(light) != 'green':
        left = light.stopLine(lane) - place - self.length / 2 - 1
        take following(self, path, place, min(target_speed, stopping(left)))
        place = path.along(self.position, place)

# Along the lane, waiting at traffic lights that are not green; who can no more stop before the line with a strong brake drives on.
behavior FollowLaneObeyingTrafficLights(target_speed=10):
    check_arguments('FollowLaneObeyingTrafficLights', target_speed)
    try:
        do FollowLaneBehavior(target_speed)
    interrupt when withinDistanceToRedYellowTrafficLight(self, 6 + self.speed * self.speed / 4) and canStop(self):
        do WaitForTrafficLightBehavior(target_speed)

# Whether a vehicle can still stop before the light of its lane.
def canStop(vehicle):
    lane = vehicle._lane
    left = lane._trafficLight.stopLine(lane) - Trajectory([lane]).along(vehicle.position) - vehicle.length / 2
    return left > vehicle.speed * vehicle.speed / 10

# Left through the next intersection, until the vehicle is straight in the lane there.
behavior TurnLeftBehavior():
    lane = self.lane
    left = [m for m in lane.maneuvers if m.type is ManeuverType.LEFT_TURN]
    require len(left) > 0
    maneuver = Uniform(*left)
    do FollowTrajectoryBehavior(6, [lane, maneuver.connectingLane, maneuver.endLane.centerline.pointAlongBy(12)])
    take SetSteerAction(0)

# A driver of the simulator's (`--simulator sumo`), until SetAutopilotAction(False).
behavior AutopilotBehavior():
    take SetAutopilotAction(True)
    while True:
        wait
