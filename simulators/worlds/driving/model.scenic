# The driving library: a road network, and the classes of what is on it (the released library's names; docs/worlds.md).

import math
from scenic.domains.driving.map import network
from scenic.domains.driving.paths import Trajectory
from scenic.domains.driving.roads import *
from scenic.simulators.utils.colors import Color
from scenic.domains.driving.actions import *
from scenic.domains.driving.controllers import *
from scenic.domains.driving.lights import *
from scenic.domains.driving.kinds import *
from scenic.domains.driving.behaviors import *
from scenic.domains.driving.arguments import check_arguments

road = network.drivableRegion
curb = network.curbRegion
sidewalk = network.sidewalkRegion
shoulder = network.shoulderRegion
roadOrShoulder = network.roadOrShoulder
intersection = network.intersectionRegion
roadDirection = network.roadDirection
workspace = network.workspace

# What an object is on: each has a form with an underscore, which is None where the other rejects the run.
class DrivingObject:
    requireVisible: False
    viewAngle: 90 deg

    @property
    def isVehicle(self):
        return False

    @property
    def isCar(self):
        return False

    @property
    def lane(self):
        return network.laneAt(self.position, reject='the object is not in a lane')

    @property
    def _lane(self):
        return network.laneAt(self.position)

    @property
    def laneSection(self):
        return network.laneSectionAt(self.position, reject='the object is not in a lane')

    @property
    def _laneSection(self):
        return network.laneSectionAt(self.position)

    @property
    def laneGroup(self):
        return network.laneGroupAt(self.position, reject='the object is not in a lane')

    @property
    def _laneGroup(self):
        return network.laneGroupAt(self.position)

    @property
    def oppositeLaneGroup(self):
        return self.laneGroup.opposite

    @property
    def road(self):
        return network.roadAt(self.position, reject='the object is not on a road')

    @property
    def _road(self):
        return network.roadAt(self.position)

    @property
    def intersection(self):
        return network.intersectionAt(self.position, reject='the object is not in an intersection')

    @property
    def _intersection(self):
        return network.intersectionAt(self.position)

    @property
    def crossing(self):
        return network.crossingAt(self.position, reject='the object is not on a crosswalk')

    @property
    def _crossing(self):
        return network.crossingAt(self.position)

    @property
    def element(self):
        return network.elementAt(self.position, reject='the object is on no element of the road network')

    @property
    def _element(self):
        return network.elementAt(self.position)

    # The gap to the next object ahead on the way along the lane; infinite if there is none.
    def distanceToNextObstacle(self):
        lane = self._lane
        gap = math.inf
        if lane is None:
            return gap
        ways = [lane] + [m.connectingLane if m.connectingLane is not None else m.endLane for m in lane.maneuvers]
        for way in ways:
            path = Trajectory([lane]) if way is lane else Trajectory([lane, way])
            here = path.along(self.position)
            for other in simulation().objects:
                if other is self:
                    continue
                there = path.along(other.position)
                if there > here and (distance from other to path.point(there)) < 2:
                    gap = min(gap, there - here - (self.length + other.length) / 2)
        return max(0, gap)

    # The least time in which another object is met, if both go on as they do; infinite if none is.
    def timeToCollision(self):
        least = math.inf
        for other in simulation().objects:
            if other is self:
                continue
            apart = other.position - self.position
            toward = self.velocity - other.velocity
            closing = apart.dot(toward)
            if closing <= 0:
                continue
            time = closing / toward.dot(toward)
            direction = math.atan2(-toward.x, toward.y)
            if (apart - toward * time).norm() < reach(self, direction + math.pi / 2) + reach(other, direction + math.pi / 2) + 0.5:
                least = min(least, max(0, time - (reach(self, direction) + reach(other, direction)) / toward.norm()))
        return least

# How far an object reaches from its middle in a direction.
def reach(object, direction):
    turned = direction - object.heading
    return (abs(math.cos(turned)) * object.length + abs(math.sin(turned)) * object.width) / 2

class Vehicle(DrivingObject, Steers):
    drives: True
    regionContainedIn: roadOrShoulder
    position: Point on road
    heading: (roadDirection at self.position) + self.roadDeviation
    roadDeviation: 0
    width: 2
    length: 4.5

    @property
    def isVehicle(self):
        return True

class Car(Vehicle):
    @property
    def isCar(self):
        return True

class NPCCar(Car):
    pass

class Pedestrian(DrivingObject, Walks):
    walks: True
    regionContainedIn: network.walkableRegion
    position: Point on network.walkableRegion
    heading: Range(0, 360) deg
    width: 0.75
    length: 0.75

class Bicycle(Vehicle):
    walks: True
    width: 1
    length: 2

class Truck(Vehicle):
    width: 2.5
    length: 7

# Whether a vehicle, another object or a pedestrian is near; of objects and pedestrians only those count that the car sees.
def withinDistanceToAnyCars(car, thresholdDistance):
    check_arguments('withinDistanceToAnyCars', car, thresholdDistance)
    return any([(distance from car to o) < thresholdDistance for o in simulation().objects if o is not car and isinstance(o, Vehicle)])

def withinDistanceToAnyObjs(vehicle, thresholdDistance):
    check_arguments('withinDistanceToAnyObjs', vehicle, thresholdDistance)
    seen = [distance from vehicle to o for o in simulation().objects if o is not vehicle and (vehicle can see o)]
    return any([0.1 <= d < thresholdDistance for d in seen])

def withinDistanceToAnyPedestrians(vehicle, thresholdDistance):
    check_arguments('withinDistanceToAnyPedestrians', vehicle, thresholdDistance)
    front = (front of vehicle).position
    return any([(distance from front to o) < thresholdDistance for o in simulation().objects if isinstance(o, Pedestrian) and (vehicle can see o)])

# The same, of what is in the same lane, or in the same intersection.
def withinDistanceToObjsInLane(vehicle, thresholdDistance):
    check_arguments('withinDistanceToObjsInLane', vehicle, thresholdDistance)
    inter = network.intersectionAt(vehicle.position)
    for o in simulation().objects:
        if o is vehicle or not (vehicle can see o) or not (0.1 <= (distance from vehicle to o) < thresholdDistance):
            continue
        if inter is network.intersectionAt(o.position) if inter is not None else network.laneAt(vehicle.position) is network.laneAt(o.position):
            return True
    return False
