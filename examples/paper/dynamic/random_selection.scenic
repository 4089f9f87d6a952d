# Section "Compositional Scenarios", "Random Selection of Scenarios": `do choose`, with weights, and `do shuffle`.
model scenic.domains.driving.model
from scenic.domains.driving.scenarios import *

behavior DriveCarefully():
    try:
        do FollowLaneObeyingTrafficLights()
    interrupt when self.distanceToNextObstacle() < 12:
        take SetThrottleAction(0), SetBrakeAction(1)
    interrupt when self.timeToCollision() < 1.5:
        do CollisionAvoidance()

scenario Main():
    setup:
        ego = Car with behavior DriveCarefully
    compose:
        do choose RedLightRunner, Jaywalker, ParkedCar
        do choose {RedLightRunner: 2, Jaywalker: 1, ParkedCar: 1}
        do shuffle RedLightRunner, Jaywalker, ParkedCar
