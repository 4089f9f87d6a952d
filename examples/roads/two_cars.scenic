# A car on any road, and another one ahead of it, whose lane may end there.
model scenic.domains.driving.model
param map = localPath('town.xodr')
ego = Car on road
Car ahead of ego by Range(5, 20)
