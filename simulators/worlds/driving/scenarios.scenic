# Scenarios of the driving library: those that the paper names without defining them. Each happens to an ego that is there.

from scenic.domains.driving.model import *

# The point of another element of its road that is beside a vehicle, or so many metres further along the vehicle's lane; not at the very end.
def beside(element, vehicle, metres):
    lane, line = Trajectory([vehicle.lane]), Trajectory([element])
    place = line.along(lane.point(lane.along(vehicle.position) + metres))
    return line.point(max(1, min(line.length - 1, place)))

# The place at the curb so many metres ahead of a vehicle.
def curbAhead(vehicle, metres):
    return OrientedPoint at beside(vehicle.laneGroup.curb, vehicle, metres), facing roadDirection

# The ways straight through the next intersection that cross a vehicle's, and whose lights stay red for some seconds.
def redWays(vehicle, seconds=5):
    lane = vehicle._lane
    own = [] if lane is None or lane._trafficLight is None else [m for m in lane.maneuvers if m.type is ManeuverType.STRAIGHT]
    ways = [m for m in own[0].conflictingManeuvers if m.type is ManeuverType.STRAIGHT] if len(own) > 0 else []
    return [m for m in ways if m.startLane._trafficLight is not None and staysRed(m.startLane._trafficLight, seconds)]

# A driver who closes up to the car ahead, then falls back and keeps away.
behavior CloseUpAndFallBack(leader, speed=10):
    try:
        do FollowLaneBehavior(speed) until (distance from self to leader) < 9
        do FollowLaneBehavior(2) until (distance from self to leader) > 20
        do DriveAvoidingCollisions(leader.speed, 10)
    interrupt when self.timeToCollision() < 1 or self.distanceToNextObstacle() < 2:
        take SetThrottleAction(0), SetBrakeAction(1)

# A parked vehicle leaves the shoulder for a lane of its road.
behavior PullOutBehavior(lane, target_speed=8):
    do LaneChangeBehavior(lane.sections[0], False, target_speed)
    do FollowLaneBehavior(target_speed)

# A pedestrian waits until a vehicle comes near, and walks to the other side.
behavior CrossInFrontOf(vehicle, other, speed, threshold):
    do CrossingBehavior(vehicle, speed, threshold) until (distance from self to other) < 0.5
    take SetWalkingSpeedAction(0)

# Ego follows a car, too closely at first.
scenario FollowingScenario(gap=20, speed=5):
    precondition: ego._lane is not None
    setup:
        leadCar = Car at beside(ego.lane, ego, gap), with behavior FollowLaneBehavior(speed)
        override ego with behavior CloseUpAndFallBack(leadCar)

# While ego comes to an intersection, a car from the side drives on at a red light; it ends when this car has left the intersection.
scenario RedLightRunner(speed=9):
    precondition: len(redWays(ego)) > 0
    setup:
        way = Uniform(*redWays(ego))
        line = way.startLane.trafficLight.stopLine(way.startLane)
        runner = Car at way.startLane.centerline.pointAlongBy(max(0, line - 25)), with speed speed,
                     with behavior FollowTrajectoryBehavior(speed, [way.startLane, way.connectingLane, way.endLane])
        terminate when runner in way.endLane

# A pedestrian walks across the road ahead of ego; it ends when ego is past, or the pedestrian has crossed.
scenario Jaywalker(gap=25, speed=1.5):
    precondition: ego._laneGroup is not None and ego._laneGroup._sidewalk is not None
    precondition: ego._laneGroup is not None and ego._laneGroup._opposite is not None and ego._laneGroup._opposite._sidewalk is not None
    setup:
        other = beside(ego.laneGroup.opposite.sidewalk, ego, gap)
        jaywalker = Pedestrian at beside(ego.laneGroup.sidewalk, ego, gap), facing toward other,
                        with behavior CrossInFrontOf(ego, other, speed, gap)
        terminate when (distance past jaywalker) > 5 or (distance from jaywalker to other) < 0.5

# The paper's scenario of this name; it ends when ego is past the parked car.
scenario ParkedCar(gap=0.25):
    precondition: ego._laneGroup is not None and ego._laneGroup._shoulder is not None
    setup:
        spot = OrientedPoint on visible ego.laneGroup.curb
        parkedCar = Car left of spot by gap
        terminate when (distance past parkedCar) > 10

# One of some scenarios, by a place: less than 30 m from traffic lights the first, elsewhere one of the others.
def pickNextScenario(position, scenarios):
    near = [i for i in network.intersections if i.isSignalized and (distance from position to i) < 30]
    return scenarios[0]() if len(near) > 0 else Uniform(*scenarios[1:])()
