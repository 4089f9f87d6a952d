# dialect: scenic-3
# Two scenarios, one after the other, of the same cars.
model scenic.domains.driving.model

scenario Main():
    setup:
        ego = new Car with behavior FollowLaneBehavior(5)
    compose:
        do Follower(ego, Range(8, 14)) for 3 seconds
        do Nothing() for 2 seconds

scenario Follower(car, gap):
    setup:
        new Car following roadDirection from car.position for -gap, with requireVisible False, with behavior FollowLaneBehavior(5)

scenario Nothing():
    setup:
        terminate after 30 seconds
