# Section "Compositional Scenarios", "Modular Scenarios": two copies of a scenario.
model scenic.domains.driving.model

scenario ParkedCar(gap=0.25):
    precondition: ego.laneGroup._shoulder != None
    setup:
        spot = OrientedPoint on visible ego.laneGroup.curb
        parkedCar = Car left of spot by gap

scenario Main():
    setup:
        ego = Car
    compose:
        do ParkedCar(), ParkedCar(0.5)
