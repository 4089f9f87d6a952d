# dialect: scenic-3
# Three cars behind each other in one lane.
model scenic.domains.driving.model

def follower(leader, gap=5):
    return new Car following roadDirection from leader.position for -(gap + leader.length), with behavior FollowLaneBehavior(4)

ego = new Car on road, with behavior FollowLaneBehavior(4)
second = follower(ego, Range(3, 6))
third = follower(second, Range(3, 6))

require abs(relative heading of second) < 10 deg
require abs(relative heading of third) < 20 deg
