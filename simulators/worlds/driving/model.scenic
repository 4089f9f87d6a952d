# The driving library: a road network, and the classes of what is on it (the released library's names; docs/worlds.md).

from scenic.domains.driving.map import network
from scenic.domains.driving.roads import *
from scenic.domains.driving.actions import *

road = network.drivableRegion
curb = network.curbRegion
sidewalk = network.sidewalkRegion
shoulder = network.shoulderRegion
roadOrShoulder = road.union(shoulder)
intersection = network.intersectionRegion
roadDirection = network.roadDirection
workspace = Workspace(everywhere)

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

class Vehicle(DrivingObject):
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

class Pedestrian(DrivingObject):
    regionContainedIn: network.walkableRegion
    position: Point on network.walkableRegion
    heading: Range(0, 360) deg
    width: 0.75
    length: 0.75
