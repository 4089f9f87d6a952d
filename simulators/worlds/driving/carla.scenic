# The names of the released model of CARLA, on roads without CARLA: the driving library, with vehicles and things that stand about as boxes.

from scenic.domains.driving.model import *
from scenic.domains.driving.missing import refused

class Motorcycle(Vehicle):
    walks: True
    width: 1
    length: 2

class Van(Vehicle):
    width: 2
    length: 5.5

class Bus(Vehicle):
    width: 2.5
    length: 10

# What stands on the road: all of one size, that of the released model before it knew CARLA's shapes.
class Prop(DrivingObject):
    regionContainedIn: road
    position: Point on road
    heading: Range(0, 360) deg
    width: 0.5
    length: 0.5

class Trash(Prop):
    pass

class Cone(Prop):
    pass

class Debris(Prop):
    pass

class VendingMachine(Prop):
    pass

class Chair(Prop):
    pass

class BusStop(Prop):
    pass

class Advertisement(Prop):
    pass

class Garbage(Prop):
    pass

class Container(Prop):
    pass

class Table(Prop):
    pass

class Barrier(Prop):
    pass

class PlantPot(Prop):
    pass

class Mailbox(Prop):
    pass

class Gnome(Prop):
    pass

class CreasedBox(Prop):
    pass

class Case(Prop):
    pass

class Box(Prop):
    pass

class Bench(Prop):
    pass

class Barrel(Prop):
    pass

class ATM(Prop):
    pass

class Kiosk(Prop):
    pass

class IronPlate(Prop):
    pass

class CarlaActor(DrivingObject):
    refusal: refused('CarlaActor', 'derive the class from Vehicle, Pedestrian or Prop')

def WalkBehavior(*arguments, **options):
    refused('WalkBehavior', 'use WalkForwardBehavior or WalkAlongSidewalkBehavior')

# Shapes of CARLA: whatever is asked of them is refused.
class Blueprints(object):
    def __getattr__(self, name):
        refused(f'blueprints.{name}', 'a text such as `with blueprint \'vehicle.lincoln.mkz\'` is accepted, and changes nothing')

blueprints = Blueprints()
