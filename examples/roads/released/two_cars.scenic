# dialect: scenic-3
param use2DMap = True
param map = localPath('town.xodr')
model scenic.domains.driving.model
ego = new Car on road
new Car ahead of ego by Range(5, 20)
