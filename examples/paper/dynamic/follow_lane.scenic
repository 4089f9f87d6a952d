# Section "Dynamic Scenarios", "Agents, Actions, and Behaviors": a car with a behavior of the driving library.
model scenic.domains.driving.model
Car with behavior FollowLaneBehavior

ego = Car
