# Section "Dynamic Scenarios", "Requirements and Monitors": a monitor of three cars that obey the traffic lights.
model scenic.domains.driving.model

ways = network.intersections[4].incomingLanes
carA = Car at ways[2].centerline.pointAlongBy(Range(2, 20)), with behavior FollowLaneObeyingTrafficLights(8)
carB = Car at ways[3].centerline.pointAlongBy(Range(2, 40)), with behavior FollowLaneObeyingTrafficLights(8)
carC = Car at ways[0].centerline.pointAlongBy(Range(2, 40)), with behavior FollowLaneObeyingTrafficLights(8)
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
