# Section "Dynamic Scenarios", "Terminating the Scenario": `terminate when`; a car that drives is one whose class says so.
model scenic.domains.driving.model

class Car(Car):
    behavior: FollowLaneBehavior

start = Point on road
ego = Car at start
terminate when (distance to start) >= 50
