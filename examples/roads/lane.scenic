# A car in the middle of a lane that is drawn, and another one in the same lane.
model scenic.domains.driving.model
param map = localPath('town.xodr')
lane = Uniform(*network.lanes)
ego = Car on lane.centerline
Car on lane, with requireVisible False
