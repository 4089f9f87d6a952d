# Section "Compositional Scenarios", "Parallel and Sequential Composition": a new parked car when ego is past the last one.
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
        ego = Car at lane.centerline.pointAlongBy(5), with behavior FollowLaneBehavior
    compose:
        while True:
            subScenario = ParkedCar(gap=0.25)
            do subScenario until distance past subScenario.parkedCar > 10
