# The paper, Section "Dynamic Scenarios", "Agents, Actions, and Behaviors" (both listings; the controls are those of a stand-in street).
model street

behavior Follow():
    while True:
        throttle, steering = (0.5 if self.speed < 8 else 0), self.heading
        take SetThrottleAction(throttle), SetSteerAction(steering)

ego = Car with behavior FollowLaneBehavior
Car at (1.75, 80), with behavior Follow
