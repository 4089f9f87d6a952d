# On a road network
# The map that the driving library makes; see Replay.
model scenic.domains.driving.model

ego = Car with behavior FollowLaneBehavior(target_speed=8)
other = Car ahead of ego by Range(8, 20),
    with behavior FollowLaneBehavior(target_speed=4)
