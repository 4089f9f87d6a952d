# The paper, Section "Compositional Scenarios", "Interrupts, Overriding, and Initial Scenarios": `interrupt` in a compose block, `override`.
# The condition uses what the first statements of the body make, so that the listing needs --reading interrupt-first-step=later-steps.
model street

scenario FollowingScenario():
    setup:
        leadCar = Car at (-1.75, 25), with behavior FollowLaneBehavior(5, -1.75)

scenario ParkedCarPullingAheadOf(target):
    setup:
        override target with behavior FollowLaneAvoidingCollisions
        parkedCar = Car at (3, target.position.y + 15), with behavior FollowLaneBehavior(3)
        terminate when (distance from parkedCar to target) > 25

scenario Main():
    setup:
        ego = Car at (-1.75, 0), with behavior FollowLaneBehavior(8, -1.75)
    compose:
        try:
            following = FollowingScenario()
            do following
        interrupt when distance to following.leadCar < 15:
            do ParkedCarPullingAheadOf(following.leadCar) for 5 seconds
