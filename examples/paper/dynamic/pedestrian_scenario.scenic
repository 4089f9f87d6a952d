# The paper, Section "Compositional Scenarios", "Interrupts, Overriding, and Initial Scenarios": `in initial scenario`, with two streets to choose from.
model street

behavior Walk():
    take SetWalkingDirectionAction(90 deg), SetWalkingSpeedAction(1.2)

scenario TwoLanePedestrianScenario():
    setup:
        if in initial scenario:  # create ego car on a random lane
            lane = Uniform(*filter(lambda x: x > 0, [1.75, -1.75, 1.5]))  # pick uniformly from list
            ego = Car at (lane, 0), with behavior FollowLaneBehavior
        else:  # use existing ego car; require it is on the street
            require ego in road
        Pedestrian at (5.5, Range(20, 40)), with behavior Walk

scenario Main():
    setup:
        ego = Car at (1.75, -20), with behavior FollowLaneBehavior
    compose:
        wait
        do TwoLanePedestrianScenario() for 2 seconds
