# dialect: scenic-3
# Noise on where two cars are.
model scenic.domains.driving.model

ego = new Car with behavior FollowLaneBehavior(5)
other = new Car ahead of ego by 15, with regionContainedIn everywhere
mutate other by 0.5
