# The paper, Section "Dynamic Scenarios", "Terminating the Scenario".
model street

start = Point in RectangularRegion((1.75, 0), 0, 0.1, 20)
ego = Car at start, with behavior FollowLaneBehavior
terminate when (distance to start) >= 50

monitor StopAfterTimeInIntersection:
    totalTime = 0
    while totalTime < 30:
        if ego in intersection:
            totalTime += 1
        wait
    terminate
