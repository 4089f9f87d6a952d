# Section "Dynamic Scenarios", "Terminating the Scenario": `terminate` in a monitor.
model scenic.domains.driving.model

lane = Uniform(*filter(lambda l: l._predecessor is None, network.lanes))
ego = Car at lane.centerline.pointAlongBy(40), with behavior FollowLaneObeyingTrafficLights(6)

monitor StopAfterTimeInIntersection:
    totalTime = 0
    while totalTime < 30:
        if ego in intersection:
            totalTime += 1
        wait
    terminate
