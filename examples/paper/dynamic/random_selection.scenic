# Section "Compositional Scenarios", "Random Selection of Scenarios": `do choose`, with weights, and `do shuffle`.
model scenic.domains.driving.model
from scenic.domains.driving.scenarios import *

# A driver who brakes for others, and has a green light at every intersection.
behavior DriveCarefully():
    try:
        do FollowLaneBehavior(8)
    interrupt when withinDistanceToRedYellowTrafficLight(self, 40):
        setClosestTrafficLightStatus(self, 'green')
    interrupt when self.distanceToNextObstacle() < 12:
        take SetThrottleAction(0), SetBrakeAction(1)
    interrupt when self.timeToCollision() < 1.5:
        do CollisionAvoidance()

scenario Main():
    setup:
        lane = Uniform(*filter(lambda l: l._predecessor is None, network.lanes))
        ego = Car at lane.centerline.pointAlongBy(Range(5, 40)), with behavior DriveCarefully
    compose:
        do choose RedLightRunner, Jaywalker, ParkedCar
        do choose {RedLightRunner: 2, Jaywalker: 1, ParkedCar: 1}
        do shuffle RedLightRunner, Jaywalker, ParkedCar
