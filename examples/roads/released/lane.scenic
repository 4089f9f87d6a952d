# dialect: scenic-3
param use2DMap = True
param map = localPath('town.xodr')
model scenic.domains.driving.model
lane = Uniform(*network.lanes)
ego = new Car on lane.centerline
new Car on lane, with requireVisible False
