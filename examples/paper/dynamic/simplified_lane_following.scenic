# Section "Dynamic Scenarios", "Agents, Actions, and Behaviors": a very simplified lane following, on a straight street.
param map = localPath('avenue.xodr')
model scenic.domains.driving.model

def controls(car):
    lane = Trajectory([car.lane])
    steering = lane.steering(car.position, car.heading, car.speed, car.length, lane.along(car.position))
    return (0.5 if car.speed < 8 else 0), steering

behavior FollowLaneBehavior():
    while True:
        throttle, steering = controls(self)    # compute controls
        take SetThrottleAction(throttle), SetSteerAction(steering)

lane = Uniform(*network.intersections[0].incomingLanes)
ego = Car on lane, facing Range(-10, 10) deg relative to roadDirection, with behavior FollowLaneBehavior
require (distance from ego to intersection) > 150
