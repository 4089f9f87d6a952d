# Section "Dynamic Scenarios", "Requirements and Monitors": a monitor of three cars that obey the traffic lights.
model scenic.domains.driving.model

ways = network.intersections[4].incomingLanes
carA = Car at ways[0].centerline.pointAlongBy(Range(40, 80)), with behavior FollowLaneObeyingTrafficLights
carB = Car at ways[Uniform(1, 2)].centerline.pointAlongBy(Range(40, 80)), with behavior FollowLaneObeyingTrafficLights
carC = Car at ways[Uniform(1, 2, 3)].centerline.pointAlongBy(Range(40, 80)), with behavior FollowLaneObeyingTrafficLights
ego = carC

monitor CarCEntersLast:
    seenA, seenB = False, False
    while not (seenA and seenB):
        require carC not in intersection
        if carA in intersection:
            seenA = True
        if carB in intersection:
            seenB = True
        wait
