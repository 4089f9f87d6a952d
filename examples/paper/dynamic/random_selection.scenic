# The paper, Section "Compositional Scenarios", "Random Selection of Scenarios": a function that picks, `do choose`, `do shuffle`.
model street

scenario Jaywalker():
    setup:
        Pedestrian at (6, ego.position.y + 20)

scenario ParkedCar():
    precondition: ego.position.y > 5
    setup:
        Car at (2.4, ego.position.y + 30)

scenario SlowCar(y=40):
    setup:
        Car at (1.75, ego.position.y + y), with behavior FollowLaneBehavior(4)

def pickNextScenario(position):
    return Jaywalker() if position.y < 1 else SlowCar()

scenario Main():
    setup:
        ego = Car at (-1.75, 0), with behavior FollowLaneBehavior(8, -1.75)
    compose:
        chosenScenario = pickNextScenario(ego.position)
        do chosenScenario for 1 seconds
        do choose Jaywalker, SlowCar, ParkedCar for 1 seconds
        do choose {Jaywalker: 2, SlowCar: 1, ParkedCar: 1} for 1 seconds
        do shuffle SlowCar(60), SlowCar(75) for 2 seconds
