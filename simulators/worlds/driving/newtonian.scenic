# The released model of its Newtonian simulator: the driving library, whose vehicles have their controls as properties, as they are set now.

from scenic.domains.driving.model import *

class NewtonianActor(DrivingObject):
    controls_shown: True
    throttle: 0
    brake: 0
    steer: 0
    hand_brake: False
    reverse: False

class Vehicle(Vehicle, NewtonianActor):
    pass

class Car(Car, NewtonianActor):
    pass

class Pedestrian(Pedestrian, NewtonianActor):
    pass

class Debris:
    position: Point in workspace
    heading: Range(0, 360) deg
