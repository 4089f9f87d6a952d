# The paper, Section "Dynamic Scenarios", "Requirements and Monitors": a monitor.
model street

ego = Car at (1.75, -20)
carA = Car at (1.75, 45), with behavior FollowLaneBehavior
carB = Car at (-1.75, 42), with behavior FollowLaneBehavior(8, -1.75)
carC = Car at (1.75, Range(20, 40)), with behavior FollowLaneBehavior

monitor CarCEntersLast:
    seenA, seenB = False, False
    while not (seenA and seenB):
        require carC not in intersection
        if carA in intersection:
            seenA = True
        if carB in intersection:
            seenB = True
        wait
