# Section "Dynamic Scenarios", "Behavior Arguments and Random Parameters": two cars that wait, with thresholds of their own.
model scenic.domains.driving.model

behavior WaitUntilClose(threshold=15):
    while (distance from self to ego) > threshold:
        wait
    do FollowLaneBehavior()

ego = Car
carB = Car visible, with behavior WaitUntilClose
carC = Car visible, with behavior WaitUntilClose(20)
