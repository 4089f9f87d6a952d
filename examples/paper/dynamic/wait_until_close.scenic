# The paper, Section "Dynamic Scenarios", "Execution of Behaviors" and "Behavior Arguments and Random Parameters".
model street

behavior WaitUntilClose(threshold=15):
    while (distance from self to ego) > threshold:
        wait
    do FollowLaneBehavior()

ego = Car at (1.75, 0), with behavior FollowLaneBehavior
carB = Car at (-1.75, 30), with behavior WaitUntilClose
carC = Car at (-1.75, 50), with behavior WaitUntilClose(20)
