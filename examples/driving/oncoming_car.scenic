# dialect: scenic-3
# A car comes towards ego.
model scenic.domains.driving.model

ego = new Car with behavior FollowLaneBehavior(5)
other = new Car offset by Range(-8, 8) @ Range(20, 40), facing roadDirection, with viewAngle 30 deg, with behavior FollowLaneBehavior(5)
require other can see ego
require abs((relative heading of other) - 180 deg) < 30 deg or abs((relative heading of other) + 180 deg) < 30 deg
