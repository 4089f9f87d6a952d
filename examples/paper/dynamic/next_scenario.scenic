# Section "Compositional Scenarios", "Random Selection of Scenarios": a function that picks a scenario.
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
        chosenScenario = pickNextScenario(ego.position, [RedLightRunner, Jaywalker, ParkedCar])
        do chosenScenario
