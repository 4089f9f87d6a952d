# Scenarios of the driving library: those that the paper names without defining them. Each happens to an ego that is there.

from scenic.domains.driving.arguments import check_arguments
from scenic.domains.driving.model import *

# The point of another element of its road that is beside a vehicle, or so many metres further along the vehicle's lane; not at the very end.
def beside(element, vehicle, metres):
    lane, line = Trajectory([vehicle.lane]), Trajectory([element])
    place = line.along(lane.point(lane.along(vehicle.position) + metres))
    return line.point(max(1, min(line.length - 1, place)))

# The lanes that a maneuver leads along.
def lanesOf(maneuver):
    return [maneuver.endLane] if maneuver.connectingLane is None else [maneuver.connectingLane, maneuver.endLane]

# The lanes that come after one: those of the first way straight on, else of the first maneuver.
def lanesAfter(lane):
    for maneuver in onward(lane)[:1]:
        return lanesOf(maneuver)
    return [] if lane._successor is None or lane._successor not in network.lanes else [lane._successor]

# The lanes from a vehicle's to the one that is so many metres further along them, or to the end of the road.
def wayAhead(vehicle, metres):
    way, more = [], [vehicle.lane]
    left = -metres - Trajectory(more).along(vehicle.position)
    while left < 1 and len(more) > 0:
        way.append(more[0])
        left += Trajectory(more[:1]).length
        more = more[1:] if len(more) > 1 else lanesAfter(way[-1])
    return way

# The point so many metres ahead of a vehicle along its lane and those after it; not at the very end of the road.
def pointAhead(way, vehicle, metres):
    if len(way) == 1:
        return beside(way[0], vehicle, metres)
    path = Trajectory(way)
    return path.point(min(path.length - 1, path.along(vehicle.position) + metres))

# The direction of traffic at a point of the last lane of a way.
def directionOn(way, point):
    return (roadDirection at point) if len(way) == 1 else way[-1].centerline.heading_at(point)

# How many metres of a vehicle's lane are ahead of it.
def leftOfLane(vehicle):
    lane = Trajectory([vehicle.lane])
    return lane.length - lane.along(vehicle.position)

# The place at the curb so many metres ahead of a vehicle.
def curbAhead(vehicle, metres):
    check_arguments('curbAhead', vehicle, metres)
    return OrientedPoint at beside(vehicle.laneGroup.curb, vehicle, metres), facing roadDirection

# The ways straight through the next intersection that cross a vehicle's, and whose lights stay red for some seconds.
def redWays(vehicle, seconds=5):
    lane = vehicle._lane
    own = [] if lane is None or lane._trafficLight is None else [m for m in lane.maneuvers if m.type is ManeuverType.STRAIGHT]
    ways = [m for m in own[0].conflictingManeuvers if m.type is ManeuverType.STRAIGHT] if len(own) > 0 else []
    return [m for m in ways if m.startLane._trafficLight is not None and staysRed(m.startLane._trafficLight, seconds)]

# How many metres a vehicle is from a path.
def off(path, vehicle):
    return distance from vehicle to path.point(path.along(vehicle.position))

# The lanes that the first of two vehicles goes along, which grow with each way that it chooses, and how far along them the second has come.
class Trail(object):
    def __init__(self, lanes, second):
        self.lanes = lanes
        self.first = None
        self.path = Trajectory(lanes)
        self.place = self.path.along(second.position)

    def lead(self, lanes):
        self.lanes = lanes
        self.path = Trajectory(lanes)

    # Where the first vehicle, with another behavior, has left the lanes, they go on along the maneuver that it is nearest to.
    def watch(self):
        least = off(self.path, self.first)
        if least < 1:
            return
        for i in range(max(0, len(self.lanes) - 4), len(self.lanes)):
            for maneuver in self.lanes[i].maneuvers:
                lanes = [*self.lanes[:i + 1], *lanesOf(maneuver)]
                away = off(Trajectory(lanes), self.first)
                if away < least - 0.5:
                    least = away
                    self.lead(lanes)

    def nextPlace(self, second):
        self.watch()
        self.place = self.path.along(second.position, self.place)
        return self.place

# The first of them: as FollowLaneBehavior, straight on where that is possible.
behavior LeadAlong(trail, speed):
    check_arguments('LeadAlong', trail, speed)
    place = trail.path.along(self.position)
    while True:
        if self.position in trail.lanes[-1] and len(trail.lanes[-1].maneuvers) > 0:
            trail.lead([*trail.lanes, *lanesOf(Uniform(*onward(trail.lanes[-1])))])
        place = trail.path.along(self.position, place)
        take following(self, trail.path, place, min(speed, stopping(trail.path.length - 3 - place)))

# The second: it stops before the end of the last road.
behavior FollowTrail(trail, speed):
    check_arguments('FollowTrail', trail, speed)
    while True:
        place = trail.nextPlace(self)
        take following(self, trail.path, place, min(speed, stopping(trail.path.length - 3 - place)))

behavior KeepAway(trail, speed):
    check_arguments('KeepAway', trail, speed)
    try:
        do FollowTrail(trail, speed)
    interrupt when self.distanceToNextObstacle() <= 10:
        take SetThrottleAction(0), SetBrakeAction(1)

# A driver who closes up to the car ahead, then falls back and keeps away.
behavior CloseUpAndFallBack(leader, trail, speed=10):
    check_arguments('CloseUpAndFallBack', leader, trail, speed)
    try:
        do FollowTrail(trail, speed) until (distance from self to leader) < 9
        do FollowTrail(trail, 2) until (distance from self to leader) > 20
        do KeepAway(trail, leader.speed)
    interrupt when self.timeToCollision() < 1 or self.distanceToNextObstacle() < 2:
        take SetThrottleAction(0), SetBrakeAction(1)

# A parked vehicle leaves the shoulder for a lane of its road.
behavior PullOutBehavior(lane, target_speed=8):
    check_arguments('PullOutBehavior', lane, target_speed)
    do LaneChangeBehavior(lane.sections[0], False, target_speed)
    do FollowLaneBehavior(target_speed)

# A pedestrian waits until a vehicle comes near, and walks to the other side.
behavior CrossInFrontOf(vehicle, other, speed, threshold):
    check_arguments('CrossInFrontOf', vehicle, other, speed, threshold)
    while (distance from self to vehicle) > threshold:
        take SetWalkingSpeedAction(0)
    do WalkForwardBehavior(speed) until (distance from self to other) < 0.5
    take SetWalkingSpeedAction(0)

# Ego follows a car, too closely at first, also through intersections. Near the end of ego's lane that car is on one of the lanes after it.
scenario FollowingScenario(gap=20, speed=5):
    precondition: check_arguments('FollowingScenario', gap, speed) is None
    precondition: ego._lane is not None
    setup:
        way = wayAhead(ego, gap)
        spot = pointAhead(way, ego, gap)
        trail = Trail(way, ego)
        leadCar = Car at spot, facing directionOn(way, spot), with behavior LeadAlong(trail, speed)
        trail.first = leadCar
        override ego with behavior CloseUpAndFallBack(leadCar, trail)

# The paper's scenario of this name: a car parked at the curb pulls out ahead of `target`, which keeps away; it ends when that car is in the lane.
scenario ParkedCarPullingAheadOf(target, metres=25, gap=0.25):
    precondition: check_arguments('ParkedCarPullingAheadOf', target, metres, gap) is None
    precondition: target._laneGroup is not None and target._laneGroup._shoulder is not None
    precondition: target._lane is not None and leftOfLane(target) > metres + 25
    setup:
        override target with behavior FollowLaneAvoidingCollisions
        lane = target.lane
        parkedCar = Car left of curbAhead(target, metres) by gap, with behavior PullOutBehavior(lane)
        terminate when parkedCar in lane

# While ego comes to an intersection, a car from the side drives on at a red light; it ends when this car has left the intersection.
scenario RedLightRunner(speed=9):
    precondition: check_arguments('RedLightRunner', speed) is None
    precondition: len(redWays(ego)) > 0
    setup:
        way = Uniform(*redWays(ego))
        line = way.startLane.trafficLight.stopLine(way.startLane)
        runner = Car at way.startLane.centerline.pointAlongBy(max(0, line - 25)), with speed speed,
                     with behavior FollowTrajectoryBehavior(speed, [way.startLane, way.connectingLane, way.endLane])
        terminate when runner in way.endLane

# A pedestrian walks across the road ahead of ego; it ends when ego is past, or the pedestrian has crossed.
scenario Jaywalker(gap=25, speed=1.5):
    precondition: check_arguments('Jaywalker', gap, speed) is None
    precondition: ego._laneGroup is not None and ego._laneGroup._sidewalk is not None
    precondition: ego._laneGroup is not None and ego._laneGroup._opposite is not None and ego._laneGroup._opposite._sidewalk is not None
    setup:
        other = beside(ego.laneGroup.opposite.sidewalk, ego, gap)
        jaywalker = Pedestrian at beside(ego.laneGroup.sidewalk, ego, gap), facing toward other,
                        with behavior CrossInFrontOf(ego, other, speed, gap)
        terminate when (distance past jaywalker) > 5 or (distance from jaywalker to other) < 0.5

# The paper's scenario of this name; it ends when ego is past the parked car.
scenario ParkedCar(gap=0.25):
    precondition: check_arguments('ParkedCar', gap) is None
    precondition: ego._laneGroup is not None and ego._laneGroup._shoulder is not None
    setup:
        spot = OrientedPoint on visible ego.laneGroup.curb
        parkedCar = Car left of spot by gap
        terminate when (distance past parkedCar) > 10

# One of some scenarios, by a place: less than 30 m from traffic lights the first, elsewhere one of the others.
def pickNextScenario(position, scenarios):
    check_arguments('pickNextScenario', position, scenarios)
    near = [i for i in network.intersections if i.isSignalized and (distance from position to i) < 30]
    return scenarios[0]() if len(near) > 0 else Uniform(*scenarios[1:])()
