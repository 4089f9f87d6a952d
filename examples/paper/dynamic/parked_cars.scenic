# The paper, Section "Compositional Scenarios", "Modular Scenarios" (the precondition is one that this street can have).
model street

scenario ParkedCar(gap=0.25):
    precondition: ego in road
    setup:
        spot = OrientedPoint at (3.5, Range(20, 100)), facing 0
        parkedCar = Car left of spot by gap

scenario Main():
    setup:
        ego = Car at (-1.75, 0), with behavior FollowLaneBehavior(8, -1.75)
    compose:
        do ParkedCar(), ParkedCar(0.5)
