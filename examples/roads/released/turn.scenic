# dialect: scenic-3
param use2DMap = True
param map = localPath('town.xodr')
model scenic.domains.driving.model
crossing = Uniform(*network.intersections)
turn = Uniform(*crossing.maneuvers)
ego = new Car on turn.startLane.centerline
new Car on turn.endLane.centerline, with requireVisible False
require (distance from ego to crossing) < 20
