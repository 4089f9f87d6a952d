# On a road network
# The default map of the driving library; cars follow their lanes under Replay.
model scenic.domains.driving.model

ego = Car with behavior FollowLaneBehavior(target_speed=8)
other = Car ahead of ego by Range(8, 20), with behavior FollowLaneBehavior(target_speed=4)
