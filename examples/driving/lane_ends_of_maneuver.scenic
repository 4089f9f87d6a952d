# dialect: scenic-3
# Cars at the ends of the lanes that lead into an intersection.
model scenic.domains.driving.model

inter = Uniform(*network.intersections)
lane = Uniform(*inter.incomingLanes)
ego = new Car at lane.centerline[-1] offset by 0 @ -4, facing roadDirection, with regionContainedIn everywhere
out = Uniform(*inter.outgoingLanes)
new Car at out.centerline[0], facing roadDirection, with requireVisible False, with regionContainedIn everywhere
require lane.road is not out.road
