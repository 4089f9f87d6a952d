# The names of the released model of LGSVL, on roads without LGSVL: the driving library.

from scenic.domains.driving.model import *
from scenic.domains.driving.missing import refused

class EgoCar(Car):
    pass

class Bus(Vehicle):
    width: 2.5
    length: 10

class ApolloCar(Car):
    refusal: refused('ApolloCar', 'use Car')

class Waypoint:
    refusal: refused('Waypoint', 'use FollowTrajectoryBehavior with points')

def DriveTo(*arguments, **options):
    refused('DriveTo', 'use FollowTrajectoryBehavior')

def FollowWaypoints(*arguments, **options):
    refused('FollowWaypoints', 'use FollowTrajectoryBehavior')

def WalkBehavior(*arguments, **options):
    refused('WalkBehavior', 'use WalkForwardBehavior or WalkAlongSidewalkBehavior')
