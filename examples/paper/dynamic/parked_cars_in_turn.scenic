# The paper, Section "Compositional Scenarios", "Parallel and Sequential Composition".
model street

scenario ParkedCar(gap=0.25):
    setup:
        spot = OrientedPoint at (3.5, ego.position.y + Range(15, 25)), facing 0
        parkedCar = Car left of spot by gap

scenario Main():
    setup:
        ego = Car at (-1.75, 0), with behavior FollowLaneBehavior(8, -1.75)
    compose:
        do ParkedCar(gap=0.25) for 3 seconds
        while True:
            subScenario = ParkedCar(gap=0.5)
            do subScenario until distance past subScenario.parkedCar > 10
