# Section "Compositional Scenarios", "Interrupts, Overriding, and Initial Scenarios": alone (--scenario TwoLanePedestrianScenario), or with an ego that is there.
model scenic.domains.driving.model

scenario TwoLanePedestrianScenario():
    setup:
        if in initial scenario:  # create ego car on random 2-lane road
            roads = filter(lambda r: len(r.lanes) == 2, network.roads)
            road = Uniform(*roads)  # pick uniformly from list
            ego = Car on road
        else:  # use existing ego car; require it is on a 2-lane road
            require len(ego.road.lanes) == 2
            road = ego.road
        Pedestrian on visible road.sidewalkRegion, with behavior WalkAlongSidewalkBehavior(1.2)

scenario Main():
    setup:
        ego = Car with behavior FollowLaneBehavior(5)
    compose:
        do TwoLanePedestrianScenario()
