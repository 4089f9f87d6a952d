# dialect: scenic-3
# Cars on lanes that are drawn, none too near to another, and pedestrians on sidewalks.
model scenic.domains.driving.model

ego = new Car with behavior FollowLaneBehavior(target_speed=6)

for i in range(3):
    lane = Uniform(*network.lanes)
    new Car on lane.centerline, with requireVisible False, with behavior FollowLaneBehavior(target_speed=Range(4, 8))

new Pedestrian on sidewalk, with requireVisible False
