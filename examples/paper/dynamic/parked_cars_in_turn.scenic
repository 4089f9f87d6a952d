# Section "Compositional Scenarios", "Parallel and Sequential Composition": one parked car after the other, beside a slow ego.
param map = localPath('avenue.xodr')
model scenic.domains.driving.model

scenario ParkedCar(gap=0.25):
    precondition: ego.laneGroup._shoulder != None
    setup:
        spot = OrientedPoint on visible ego.laneGroup.curb
        parkedCar = Car left of spot by gap

scenario Main():
    setup:
        lane = Uniform(*network.intersections[0].incomingLanes)
        ego = Car at lane.centerline.pointAlongBy(5), with behavior FollowLaneBehavior(4)
    compose:
        while True:
            do ParkedCar(gap=0.25) for 30 seconds
            do ParkedCar(gap=0.5) for 30 seconds
