# The paper, Section "Dynamic Scenarios", "Stateful Behaviors".
model street

behavior Drive():
    do FollowLaneBehavior()

behavior DriveWithRandomStops():
    delay = Range(15, 30) seconds
    last_stop = 0
    try:
        do Drive()
    interrupt when simulation.currentTime - last_stop > delay:
        do StopBehavior() for 5 seconds
        delay = Range(15, 30) seconds
        last_stop = simulation.currentTime

ego = Car at (1.75, 0), with behavior DriveWithRandomStops
