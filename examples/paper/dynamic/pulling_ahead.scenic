# Section "Compositional Scenarios", "Interrupts, Overriding, and Initial Scenarios": an interrupt in a compose block, and `override`.
# The condition uses what the first statement of the body makes: the listing needs --reading interrupt-first-step=later-steps.
param map = localPath('avenue.xodr')
model scenic.domains.driving.model
from scenic.domains.driving.scenarios import FollowingScenario, PullOutBehavior, curbAhead

scenario ParkedCarPullingAheadOf(target):
    setup:
        override target with behavior FollowLaneAvoidingCollisions
        parkedCar = Car left of curbAhead(target, 25) by 0.25, with behavior PullOutBehavior(target.lane)
        lane = target.lane
        terminate when parkedCar in lane

scenario Main():
    setup:
        group = Uniform(*network.intersections[0].incomingLanes).group
        ego = Car at group.lanes[0].centerline.pointAlongBy(20)
    compose:
        try:
            following = FollowingScenario()
            do following
        interrupt when distance to following.leadCar < 10:
            do ParkedCarPullingAheadOf(following.leadCar)
